//! Images as textures use them: within their bounds, each once.

use super::{
    ahead::{ImageFile, Picture},
    texture::{Domain, Value},
};
use etendue_core::{rgb::Rgb, texture::Bitmap};
use rayon::prelude::*;
use std::{
    cell::{Cell, RefCell},
    collections::HashMap,
    sync::Arc,
};

/// An image file with the bounds of its values, by their bits.
type Key = (ImageFile, u32, u32);

/// What is held of one kind of value.
pub(super) type Held<T> = RefCell<HashMap<Key, Arc<Bitmap<T>>>>;

/// The images of a scene's textures.
#[derive(Default)]
pub(super) struct Images {
    pub(super) colours: Held<Rgb>,
    pub(super) numbers: Held<f32>,
    vertex_colors: Cell<usize>,
}

impl Images {
    /// An image whose values lie in a domain: those that do not are moved to its nearest end (what is no number, to the
    /// lower), and noted.
    pub(super) fn within<T: Value>(
        &self,
        file: &ImageFile,
        picture: &Picture,
        domain: Domain,
        note: impl FnOnce(String),
    ) -> Arc<Bitmap<T>> {
        let (least, most) = domain.bounds();
        let key = (file.clone(), least.to_bits(), most.to_bits());
        if let Some(held) = T::held(self).borrow().get(&key) {
            return held.clone();
        }
        let image = &picture.bitmap;
        let known = picture.within_1 && least <= 0.0 && most >= 1.0;
        let outside = |t: &Rgb| usize::from(!T::of(*t).is_within(least, most));
        let moved: usize = if known { 0 } else { image.texels.par_iter().map(outside).sum() };
        let bounded = |v: f32| if v.is_nan() { least.max(0.0) } else { v.clamp(least, most) };
        let bitmap = match T::shared(image).filter(|_| moved == 0) {
            Some(shared) => shared,
            None => {
                let texels = image.texels.par_iter().map(|t| T::of(*t).map(bounded)).collect();
                Arc::new(Bitmap { width: image.width, height: image.height, texels })
            }
        };
        if moved > 0 {
            let (path, all) = (file.path.display(), image.texels.len());
            note(format!("{path}: {moved} of {all} texels are not from {least} to {most} and are moved there"));
        }
        T::held(self).borrow_mut().insert(key, bitmap.clone());
        bitmap
    }

    /// Counts a texture of vertex colours.
    pub(super) fn meet_vertex_colors(&self) {
        self.vertex_colors.set(self.vertex_colors.get() + 1);
    }

    /// How many textures of vertex colours have been met.
    pub(super) fn vertex_colors(&self) -> usize {
        self.vertex_colors.get()
    }
}
