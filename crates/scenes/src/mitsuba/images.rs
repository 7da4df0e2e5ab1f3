//! Images as textures use them: within their bounds, each once.

use super::{
    ahead::ImageFile,
    texture::{Domain, Value},
};
use etendue_core::{rgb::Rgb, texture::Raster};
use std::{
    cell::{Cell, RefCell},
    collections::HashMap,
};

/// An image file with the bounds of its values, by their bits.
type Key = (ImageFile, u32, u32);

/// What is held of one kind of value.
pub(super) type Held<T> = RefCell<HashMap<Key, Raster<T>>>;

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
        image: &Raster<Rgb>,
        domain: Domain,
        note: impl FnOnce(String),
    ) -> Raster<T> {
        let (least, most) = domain.bounds();
        let key = (file.clone(), least.to_bits(), most.to_bits());
        if let Some(held) = T::held(self).borrow().get(&key) {
            return held.clone();
        }
        let mut image = T::image(image);
        // One by one only for how many there are.
        let outside = |value: &T| !value.is_within(least, most);
        let moved = if image.is_within(least, most) { 0 } else { image.values().into_iter().filter(outside).count() };
        if moved > 0 {
            let (path, all) = (file.path.display(), image.len());
            note(format!("{path}: {moved} of {all} texels are not from {least} to {most} and are moved there"));
            image = image.map(|v| if v.is_nan() { least.max(0.0) } else { v.clamp(least, most) });
        }
        T::held(self).borrow_mut().insert(key, image.clone());
        image
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
