//! Triangles of meshes: what the hierarchy and shading need of them.

use super::{
    Mesh,
    offset::{ROUNDOFF, gamma},
    surface::{Local, tangents},
};
use crate::{
    has::{LOBES, TEXTURES},
    rgb::Rgb,
};
use glam::{DVec3, Vec2, Vec3};

/// Padding of a triangle's box, as a multiple of its largest extent.
///
/// The intersection test rounds the vertices, seen from the ray, by some units in the last place; the box grows by as
/// much, so that a ray which the test lets hit the triangle does not miss the box. The part of that rounding that grows
/// with the distance is in the box test, see [`super::bvh`].
pub(super) const BOX_PADDING: f32 = 16.0 * ROUNDOFF;

/// The unit normal on the side from which the vertices appear counter-clockwise, or `None` for a triangle whose area
/// is zero within the rounding of double precision.
#[inline]
pub(super) fn normal(v: [Vec3; 3]) -> Option<Vec3> {
    let [a, b, c] = v;
    // In single precision where that loses no more than 40 units roundoff: all but slivers and tiny triangles.
    let (e1, e2) = (b - a, c - a);
    let n = e1.cross(e2);
    let square = n.length_squared();
    if square > 1e-2 * (e1.length_squared() * e2.length_squared()) && square.is_normal() {
        return Some(n * (1.0 / square.sqrt()));
    }
    precise_normal(v)
}

/// [`normal`] in double precision.
#[cold]
fn precise_normal(v: [Vec3; 3]) -> Option<Vec3> {
    let [a, b, c] = v;
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    let (e1, e2) = (b - a, c - a);
    let n: DVec3 = e1.cross(e2);
    let square = n.length_squared();
    let noise = 16.0 * f64::EPSILON;
    // False for NaN, too.
    (square > noise * noise * e1.length_squared() * e2.length_squared()).then(|| (n / square.sqrt()).as_vec3())
}

/// Bounds that the intersection test's rounding does not escape.
pub(super) fn bounds(v: [Vec3; 3]) -> (Vec3, Vec3) {
    let lo = v[0].min(v[1]).min(v[2]);
    let hi = v[0].max(v[1]).max(v[2]);
    let pad = (hi - lo).max_element() * BOX_PADDING;
    let down = |x: f32, pad: f32| if pad > 0.0 { (x - pad).next_down() } else { x };
    (
        Vec3::new(down(lo.x, pad), down(lo.y, pad), down(lo.z, pad)),
        Vec3::new(-down(-hi.x, pad), -down(-hi.y, pad), -down(-hi.z, pad)),
    )
}

impl Mesh {
    /// The vertices of a triangle.
    #[inline]
    pub(super) fn vertices(&self, element: u32) -> [Vec3; 3] {
        let [a, b, c] = self.triangles[element as usize];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// What is known at barycentric coordinates (u, v) of a triangle.
    #[inline]
    pub(super) fn surface<const HAS: u32>(&self, element: u32, u: f32, v: f32) -> Local {
        let [a, b, c] = self.vertices(element);
        let w = 1.0 - u - v;
        let (wa, ub, vc) = (a * w, b * u, c * v);
        let p = wa + ub + vc;
        // [Pharr et al. 2023, sec. 6.8.5]; the second term because `w` is rounded, so that the weights sum to 1 only nearly.
        let p_error = (wa.abs() + ub.abs() + vc.abs()) * gamma(7) + a.abs() * gamma(2);
        // The hierarchy holds no triangle without a normal.
        let ng = normal([a, b, c]).unwrap_or(Vec3::Y);
        let ns = if self.normals.is_empty() {
            ng
        } else {
            let [i, j, k] = self.triangles[element as usize];
            let (na, nb, nc) = (self.normals[i as usize], self.normals[j as usize], self.normals[k as usize]);
            match (na * w + nb * u + nc * v).try_normalize() {
                Some(n) if n.dot(ng) < 0.0 => -n,
                Some(n) => n,
                None => ng,
            }
        };
        if HAS & (TEXTURES | LOBES) == 0 {
            return Local::bare(p, p_error, ng, ns);
        }
        let (uv, dpdu, dpdv) = if self.uvs.is_empty() {
            (Vec2::new(u, v), b - a, c - a)
        } else {
            let [i, j, k] = self.triangles[element as usize];
            let (ta, tb, tc) = (self.uvs[i as usize], self.uvs[j as usize], self.uvs[k as usize]);
            let (d1, d2) = (tb - ta, tc - ta);
            // Solves e1 = d1.x dpdu + d1.y dpdv, e2 = d2.x dpdu + d2.y dpdv. [Pharr et al. 2023, sec. 6.5.3]
            let determinant = d1.x * d2.y - d1.y * d2.x;
            let (e1, e2) = (b - a, c - a);
            let dpdv = if HAS & TEXTURES == 0 { Vec3::ZERO } else { (e2 * d1.x - e1 * d2.x) / determinant };
            (ta * w + tb * u + tc * v, (e1 * d2.y - e2 * d1.y) / determinant, dpdv)
        };
        let (dpdu, dpdv) = tangents(ng, dpdu, dpdv);
        let color = if HAS & TEXTURES == 0 || self.colors.is_empty() {
            Rgb::WHITE
        } else {
            let [i, j, k] = self.triangles[element as usize];
            self.colors[i as usize] * w + self.colors[j as usize] * u + self.colors[k as usize] * v
        };
        Local { p, p_error, ng, ns, dpdu, dpdv, uv, color }
    }
}
