//! Lights without an extent that throw a picture: spot lights with one, and projectors.

use super::{delta::SpotCone, textured::overall_mean};
use crate::{
    distribution::Piecewise2d,
    rgb::Rgb,
    texture::{Texture, TexturePoint},
};
use glam::{DAffine3, DVec3, Vec2, Vec3};

/// A picture thrown from a point; ready to render.
///
/// Directions are those of the points of a plane at distance 1 at right angles to the axis. An area of the plane is seen at
/// `cos^3` of its size.
#[derive(Clone, Debug)]
pub(super) struct Picture {
    pub position: Vec3,
    /// Unit axis, and the unit directions in which the picture's texture coordinates grow.
    axis: Vec3,
    right: Vec3,
    up: Vec3,
    /// Half the width and height of the picture on the plane.
    half: Vec2,
    texture: Texture<Rgb>,
    kind: Kind,
    /// Over the picture, in proportion to the flux; `None` for a black one.
    cells: Option<Piecewise2d>,
    /// Flux in watts, by luminance.
    pub flux: f64,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// The picture is a factor on the intensity.
    Spot { intensity: Rgb, cone: SpotCone },
    /// The picture is the irradiance on the plane.
    Projector,
}

/// Bounds of the number of cells along a side of a picture.
const CELLS: (u32, u32) = (32, 512);
/// Share of the picture's overall mean in the density: no direction in which light goes, if only between the points that
/// were looked at, is then never sampled.
const OVERALL: f64 = 0.1;

impl Picture {
    /// A spot light; its cutoff is below a right angle.
    pub fn spot(
        position: DVec3,
        (cone, cutoff): (SpotCone, f64),
        intensity: Rgb,
        (texture, up): (Texture<Rgb>, DVec3),
    ) -> Picture {
        let axis = cone.axis.as_dvec3();
        let up = (up - axis * up.dot(axis)).normalize();
        // The cone touches the picture's sides.
        let half = Vec2::splat(cutoff.tan() as f32);
        Picture::new(position, [axis.cross(up), up, axis], half, texture, Kind::Spot { intensity, cone })
    }

    /// A projector.
    pub fn projector(to_world: &DAffine3, fov_x: f64, aspect: f64, texture: Texture<Rgb>) -> Picture {
        let matrix = to_world.matrix3;
        let axis = matrix.z_axis.normalize();
        let up = (matrix.y_axis - axis * matrix.y_axis.dot(axis)).normalize();
        let right = axis.cross(up);
        // Its own x is to the left; a reflection stays.
        let right = if right.dot(matrix.x_axis) > 0.0 { -right } else { right };
        let half_width = (0.5 * fov_x).tan();
        let half = Vec2::new(half_width as f32, (half_width / aspect) as f32);
        Picture::new(to_world.translation, [right, up, axis], half, texture, Kind::Projector)
    }

    fn new(position: DVec3, axes: [DVec3; 3], half: Vec2, texture: Texture<Rgb>, kind: Kind) -> Picture {
        let [right, up, axis] = axes.map(DVec3::as_vec3);
        let position = position.as_vec3();
        let mut picture = Picture { position, axis, right, up, half, texture, kind, cells: None, flux: 0.0 };
        picture.fill();
        picture
    }

    /// Finds the density and the flux.
    fn fill(&mut self) {
        let (least, most) = CELLS;
        let (size, texels) = match (&self.texture, self.kind) {
            (Texture::Constant(_), Kind::Projector) => ([1, 1], [1, 1]),
            (Texture::Bitmap { bitmap, .. }, _) => {
                let texels = bitmap.size();
                (texels.map(|n| n.clamp(least, most)), texels)
            }
            _ => ([most / 4; 2], [1, 1]),
        };
        // Every texel of a large picture is looked at, and no cell at fewer than four points.
        let points = [0, 1].map(|i| texels[i].div_ceil(size[i]).max(2));
        let overall = f64::from(match self.kind {
            Kind::Spot { intensity, .. } => (overall_mean(&self.texture) * intensity).luminance(),
            Kind::Projector => overall_mean(&self.texture).luminance(),
        });
        let mut weights = Vec::with_capacity((size[0] * size[1]) as usize);
        let step = Vec2::new((size[0] * points[0]) as f32, (size[1] * points[1]) as f32).recip();
        for (row, column) in (0..size[1]).flat_map(|row| (0..size[0]).map(move |column| (row, column))) {
            let mut sum = 0.0;
            for (j, i) in (0..points[1]).flat_map(|j| (0..points[0]).map(move |i| (j, i))) {
                let at = Vec2::new((column * points[0] + i) as f32, (row * points[1] + j) as f32) + 0.5;
                sum += self.flux_density(at * step);
            }
            let mean = sum / f64::from(points[0] * points[1]);
            weights.push(mean * (1.0 - OVERALL) + overall * OVERALL);
        }
        let cell = self.area() / weights.len() as f64;
        self.flux = weights.iter().sum::<f64>() * cell;
        self.cells = Piecewise2d::new(&weights, size[0] as usize);
    }

    /// Area of the picture on the plane.
    fn area(&self) -> f64 {
        4.0 * f64::from(self.half.x) * f64::from(self.half.y)
    }

    /// From the light to a place of the picture, on the plane.
    #[inline]
    fn to_plane(&self, uv: Vec2) -> Vec3 {
        let at = (2.0 * uv - 1.0) * self.half;
        self.axis + self.right * at.x + self.up * at.y
    }

    /// Where in the picture a unit direction leads, and its cosine to the axis; `None` past the picture.
    #[inline]
    fn place_of(&self, direction: Vec3) -> Option<(Vec2, f32)> {
        let cos = direction.dot(self.axis);
        if cos.is_nan() || cos <= 0.0 {
            return None;
        }
        let at = Vec2::new(direction.dot(self.right), direction.dot(self.up)) / (cos * self.half);
        let uv = 0.5 + 0.5 * at;
        let inside = (0.0..1.0).contains(&uv.x) && (0.0..1.0).contains(&uv.y);
        inside.then_some((uv, cos))
    }

    /// Luminance of the flux per area of the plane, at a place of the picture.
    fn flux_density(&self, uv: Vec2) -> f64 {
        let value = self.texture.at(&TexturePoint { uv, color: Rgb::WHITE });
        f64::from(match self.kind {
            Kind::Spot { intensity, cone } => {
                let direction = self.to_plane(uv).normalize();
                let cos = direction.dot(self.axis);
                (value * intensity).luminance() * cone.falloff(direction) * (cos * cos * cos)
            }
            Kind::Projector => value.luminance(),
        })
    }

    /// Radiant intensity in a unit direction.
    #[inline]
    pub fn intensity(&self, direction: Vec3) -> Rgb {
        let Some((uv, cos)) = self.place_of(direction) else { return Rgb::BLACK };
        let value = self.texture.at(&TexturePoint { uv, color: Rgb::WHITE });
        match self.kind {
            Kind::Spot { intensity, cone } => value * intensity * cone.falloff(direction),
            Kind::Projector => value * (1.0 / (cos * cos * cos)),
        }
    }

    /// Samples a direction, nearly in proportion to the intensity.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Option<Vec3> {
        let (uv, _) = self.cells.as_ref()?.sample(u);
        Some(self.to_plane(uv).normalize())
    }

    /// Density of [`Picture::sample`] per steradian.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let (Some(cells), Some((uv, cos))) = (&self.cells, self.place_of(direction)) else { return 0.0 };
        cells.pdf(uv) / (4.0 * self.half.x * self.half.y * (cos * cos * cos))
    }

    /// Bytes held, the image left out.
    pub fn table_bytes(&self) -> u64 {
        size_of::<Picture>() as u64 + self.cells.as_ref().map_or(0, Piecewise2d::memory_bytes)
    }
}
