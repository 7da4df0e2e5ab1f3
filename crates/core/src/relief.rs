//! Textures that change shading normals.

use crate::{
    geometry::Surface,
    rgb::Rgb,
    texture::{Texture, TexturePoint},
};
use glam::Vec3;

/// A texture that changes shading normals.
#[derive(Clone, Debug, PartialEq)]
pub enum Relief {
    /// The surface displaced along its normal [Blinn 1978].
    Bump {
        /// Height, in the units of the scene.
        height: Texture<f32>,
        /// Factor on the height.
        scale: f32,
    },
    /// Normals in the frame of the texture coordinates.
    NormalMap {
        /// Components from -1 to 1 stored as 0 to 1; z is along the shading normal.
        normals: Texture<Rgb>,
    },
}

impl Relief {
    /// Changes the shading normal at a point; it stays in the hemisphere of the geometric normal.
    ///
    /// Where the texture coordinates have no derivatives, or the texture holds no direction, nothing changes.
    pub fn apply(&self, surface: &mut Surface) {
        let point = TexturePoint { uv: surface.uv, color: surface.color };
        let n = surface.ns;
        let changed = match self {
            Relief::Bump { height, scale } => {
                let slope = height.gradient(&point) * *scale;
                // [Blinn 1978]: the derivatives of the displaced point, without the term in the normal's own derivative, which
                // is small with the height.
                let along_u = surface.dpdu + n * (slope.x - n.dot(surface.dpdu));
                let along_v = surface.dpdv + n * (slope.y - n.dot(surface.dpdv));
                along_u.cross(along_v)
            }
            Relief::NormalMap { normals } => {
                let color = normals.at(&point);
                let local = Vec3::new(color.r, color.g, color.b) * 2.0 - 1.0;
                let Some(tangent) = (surface.dpdu - n * n.dot(surface.dpdu)).try_normalize() else { return };
                let bitangent = n.cross(tangent);
                // Mirrored texture coordinates mirror the map.
                let bitangent = if bitangent.dot(surface.dpdv) < 0.0 { -bitangent } else { bitangent };
                tangent * local.x + bitangent * local.y + n * local.z
            }
        };
        if let Some(changed) = changed.try_normalize() {
            surface.ns = if changed.dot(surface.ng) < 0.0 { -changed } else { changed };
        }
    }
}
