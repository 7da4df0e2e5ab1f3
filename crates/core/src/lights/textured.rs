//! Area lights whose radiance varies.

use super::area::{AreaPoint, AreaShape, Emitter};
use crate::{
    geometry::{Axes, Cylinder, Sphere},
    rgb::Rgb,
    texture::{Texture, TexturePoint},
};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// What the texture of an emissive shape is looked up with: the same as where a ray hits it.
#[derive(Clone, Copy, Debug)]
pub enum Coordinates {
    /// Interpolated over a triangle.
    Vertices {
        /// Texture coordinates of the vertices.
        uvs: [Vec2; 3],
        /// Their colours.
        colors: [Rgb; 3],
    },
    /// Those of a curved shape with these axes.
    Curved(Axes),
}

/// The texture of one emissive shape.
#[derive(Clone, Debug)]
pub(super) struct Textured {
    pub texture: Arc<Texture<Rgb>>,
    coordinates: Coordinates,
}

/// Share of a texture's overall mean in what an element is chosen by: no element that emits at all, if only between the
/// points that were looked at, is then never chosen.
const OVERALL: f32 = 0.1;

impl Textured {
    pub fn new(texture: Arc<Texture<Rgb>>, coordinates: Coordinates) -> Textured {
        Textured { texture, coordinates }
    }

    /// Radiance from a point of the shape.
    #[inline]
    pub fn radiance(&self, shape: &AreaShape, point: &AreaPoint) -> Rgb {
        self.texture.at(&self.look_up(shape, point))
    }

    #[inline]
    fn look_up(&self, shape: &AreaShape, point: &AreaPoint) -> TexturePoint {
        let curved = |uv| TexturePoint { uv, color: Rgb::WHITE };
        match (&self.coordinates, shape) {
            (Coordinates::Vertices { uvs, colors }, _) => {
                let Vec3 { x, y, z } = point.weights;
                TexturePoint {
                    uv: uvs[0] * x + uvs[1] * y + uvs[2] * z,
                    color: colors[0] * x + colors[1] * y + colors[2] * z,
                }
            }
            (Coordinates::Curved(axes), AreaShape::Sphere(s)) => {
                curved(Sphere::uv(axes, if s.inverted { -point.normal } else { point.normal }))
            }
            (Coordinates::Curved(axes), AreaShape::Disk(d)) => curved(d.uv(axes, point.p - d.center)),
            (Coordinates::Curved(axes), AreaShape::Cylinder(c)) => {
                let along = (point.p - c.from).dot(c.axis) / c.axis.length_squared();
                curved(Vec2::new(Cylinder::u(axes, if c.inverted { -point.normal } else { point.normal }), along))
            }
            (Coordinates::Curved(_), AreaShape::Triangle(_)) => curved(Vec2::ZERO),
        }
    }

    /// What the choice of lights goes by: the mean radiance of points all over the shape, and a share of the texture's.
    pub fn mean(&self, emitter: &Emitter, overall: Rgb) -> Rgb {
        // A mesh has many triangles, other shapes stand alone.
        let side = if matches!(emitter.shape, AreaShape::Triangle(_)) { 4 } else { 16 };
        let mut sum = Rgb::BLACK;
        for i in 0..side * side {
            let u = (Vec2::new((i % side) as f32, (i / side) as f32) + 0.5) / side as f32;
            sum += self.radiance(&emitter.shape, &emitter.sample_point(u));
        }
        let mean = sum * (1.0 / (side * side) as f32);
        match &*self.texture {
            // Over a triangle they are interpolated: where none of the vertices emits, nothing does.
            Texture::VertexColor => mean,
            _ => mean * (1.0 - OVERALL) + overall * OVERALL,
        }
    }
}

/// The mean of a texture's values; black for vertex colours, which are not its own.
pub(super) fn overall_mean(texture: &Texture<Rgb>) -> Rgb {
    let mean = |values: &[Rgb]| {
        // Added in double precision: a bitmap may have millions of texels.
        let sum = values.iter().fold([0.0; 3], |sum, v| {
            let v = v.to_array().map(f64::from);
            [sum[0] + v[0], sum[1] + v[1], sum[2] + v[2]]
        });
        let [r, g, b] = sum.map(|s| (s / values.len() as f64) as f32);
        Rgb::new(r, g, b)
    };
    match texture {
        Texture::Constant(value) => *value,
        Texture::Checkerboard { even, odd, .. } => mean(&[*even, *odd]),
        Texture::Bitmap { bitmap, .. } => mean(&bitmap.values()),
        Texture::VertexColor => Rgb::BLACK,
    }
}
