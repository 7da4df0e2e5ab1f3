//! Textures that change shading normals.
//!
//! A relief's normal `m` may lead away from who looks at it, although the surface itself does not. It is then seen turned about
//! the surface's normal `n` by half a turn, as in Mitsuba: no point that is in sight is black for lack of a visible side. And light
//! that grazes the surface is dimmed as by facets that stand as steeply as `m` [Estevez et al. 2019, Ray Tracing Gems ch. 12],
//! so that it does not end at a hard edge where it passes below `m`'s horizon.

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
        /// Components from -1 to 1 stored as 0 to 1: x is along the growing `u`, z along the shading normal.
        normals: Texture<Rgb>,
        /// Where y is.
        bitangent: Bitangent,
    },
    /// One relief for both sides: a dent of the front is a bump of the back, even of a surface whose back scatters as its front
    /// does and would have the mirror image.
    Sheet(Box<Relief>),
}

/// Where the second component of a normal map points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bitangent {
    /// Where `v` grows: mirrored texture coordinates mirror the map (as in glTF).
    AlongV,
    /// Where it makes the frame right-handed, whatever the texture coordinates do (as in Mitsuba).
    RightHanded,
}

impl Relief {
    /// The unit normal of the relief at a point. `None` where the texture coordinates have no derivatives, or the texture
    /// holds no direction: the surface's own normal stays.
    pub fn normal(&self, surface: &Surface) -> Option<Vec3> {
        let point = TexturePoint { uv: surface.uv, color: surface.color };
        let n = surface.ns;
        match self {
            Relief::Bump { height, scale } => {
                let slope = height.gradient(&point) * *scale;
                // [Blinn 1978]: the derivatives of the displaced point, without the term in the normal's own derivative, which
                // is small with the height.
                let along_u = surface.dpdu + n * (slope.x - n.dot(surface.dpdu));
                let along_v = surface.dpdv + n * (slope.y - n.dot(surface.dpdv));
                let m = along_u.cross(along_v).try_normalize()?;
                Some(if m.dot(surface.ng) < 0.0 { -m } else { m })
            }
            Relief::NormalMap { normals, bitangent } => {
                let color = normals.at(&point);
                let local = Vec3::new(color.r, color.g, color.b) * 2.0 - 1.0;
                let tangent = (surface.dpdu - n * n.dot(surface.dpdu)).try_normalize()?;
                let across = n.cross(tangent);
                let mirrored = *bitangent == Bitangent::AlongV && across.dot(surface.dpdv) < 0.0;
                let across = if mirrored { -across } else { across };
                (tangent * local.x + across * local.y + n * local.z).try_normalize()
            }
            Relief::Sheet(relief) => relief.normal(surface),
        }
    }
}

/// A relief at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt {
    /// The surface's own unit shading normal `n`.
    n: Vec3,
    /// The unit normal `m` of the relief, and the same turned by half a turn about `n`.
    normals: [Vec3; 2],
    /// Whether the back is the mirror image of the front.
    two_sided: bool,
}

impl Tilt {
    /// A relief of normal `m` on a surface of normal `n`; `None` where they are the same. A back that scatters as the front
    /// does, `two_sided`, is its mirror image; otherwise the surface is one sheet, with one relief for both sides.
    #[inline]
    pub fn new(n: Vec3, m: Vec3, two_sided: bool) -> Option<Tilt> {
        let turned = n * (2.0 * n.dot(m)) - m;
        (turned != m).then_some(Tilt { n, normals: [m, turned], two_sided })
    }

    /// Both normals that the relief can be seen with, first the one that stands where nothing is turned, on the side of the
    /// surface that `w` is on.
    #[inline]
    pub fn normals(&self, w: Vec3) -> [Vec3; 2] {
        let [m, turned] = self.normals;
        // Behind, what mirrors m in the surface's plane is the turned one, reversed.
        if self.two_sided && w.dot(self.n) < 0.0 { [turned, m] } else { [m, turned] }
    }

    /// The normal that is seen from the direction `view`: on the side of the surface that `view` is on, if either is.
    #[inline]
    pub fn seen_from(&self, view: Vec3) -> Vec3 {
        let [straight, turned] = self.normals(view);
        if view.dot(self.n) * view.dot(straight) > 0.0 { straight } else { turned }
    }

    /// What is left of light that arrives from the direction `light`. [Estevez et al. 2019]
    #[inline]
    pub fn shadowing(&self, light: Vec3) -> f32 {
        let (tilt, grazing) = (self.n.dot(self.normals[0]), self.n.dot(light));
        let (cos2_tilt, cos2) = ((tilt * tilt).min(1.0), (grazing * grazing).min(1.0));
        // The squared roughness, an eighth of the squared tangent of the tilt and no more than 1, times the squared tangent of
        // the light's angle.
        let roughness2 = (0.125 * (1.0 - cos2_tilt) / cos2_tilt).min(1.0);
        let square = roughness2 * (1.0 - cos2) / cos2;
        if square > 0.0 { 2.0 / (1.0 + (1.0 + square).sqrt()) } else { 1.0 }
    }
}
