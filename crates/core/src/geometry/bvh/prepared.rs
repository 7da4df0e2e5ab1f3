//! The tests of boxes and triangles against a ray that has been prepared for them.

use super::node::{LANES, Node, Pack, WIDTH};
use crate::{
    geometry::offset::ROUNDOFF,
    ray::{PrimitiveId, Ray},
};
use glam::{Vec3, Vec4};

/// Factor on far distances; twice the 14 units roundoff that the test of a triangle may move what it tests, and room for
/// the three roundings of the box test itself.
pub(super) const STRETCH: f32 = 1.0 + 34.0 * ROUNDOFF;

/// Bytes of a row of bounds: the same bound of all boxes of a node.
pub(in crate::geometry) const ROW: usize = size_of::<[f32; WIDTH]>();

/// A ray, and what the tests need of it.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry) struct Prepared {
    origin: [f32; 3],
    direction: Vec3,
    /// One over each component of the direction, bounded; see [`inverse`].
    inverse: [f32; 3],
    /// The same, stretched: for the planes through which a ray leaves a box.
    inverse_far: [f32; 3],
    /// Which bounds of boxes the ray meets first, by axis: where their row begins among [`Node::bounds`], in bytes.
    near: [usize; 3],
    /// The axes: two others, then the one along which the direction is largest.
    axes: [usize; 3],
    /// The shear that takes the direction to the third axis, and the scale along that axis. [Woop et al. 2013, sec. 3.1]
    shear: [f32; 3],
    t_max: f32,
    /// The triangle that the ray starts on.
    leaves: u32,
    /// That on which it ends.
    arrives: u32,
}

impl Prepared {
    /// A ray among the primitives of `instance` (or of the top level).
    #[inline(always)]
    pub fn new(ray: &Ray, instance: u32) -> Prepared {
        let direction = ray.direction;
        let d = direction.to_array();
        let a = direction.abs();
        let (yz, largest) = if a.y >= a.z { (1, a.y) } else { (2, a.z) };
        let z: usize = if a.x >= largest { 0 } else { yz };
        let x = if z == 2 { 0 } else { z + 1 };
        let y = 3 - z - x;
        let scale = 1.0 / d[z];
        let inverse = [inverse(d[0]), inverse(d[1]), inverse(d[2])];
        Prepared {
            origin: ray.origin.to_array(),
            direction,
            inverse,
            inverse_far: [inverse[0] * STRETCH, inverse[1] * STRETCH, inverse[2] * STRETCH],
            // By the sign bit: the inverse of -0.0 is negative infinity.
            near: [negative(d[0]) * ROW, (2 + negative(d[1])) * ROW, (4 + negative(d[2])) * ROW],
            axes: [x, y, z],
            shear: [d[x] * scale, d[y] * scale, scale],
            t_max: ray.t_max,
            leaves: within(ray.leaves, instance),
            arrives: within(ray.arrives, instance),
        }
    }

    /// The largest `t` that a box may be entered at, given the best hit so far.
    #[inline(always)]
    pub fn cutoff(t: f32) -> f32 {
        // Finite, as a box beside a ray parallel to it is entered at infinity.
        min(t, 0.5 * f32::MAX) * STRETCH
    }

    /// What the boxes of a node are tested with: where the ray starts, the inverses for near and for far planes, and where
    /// the row of near planes of each axis begins, in bytes; that of far planes differs by the bit [`ROW`].
    #[inline(always)]
    pub fn slabs(&self) -> (&[f32; 3], &[f32; 3], &[f32; 3], &[usize; 3]) {
        (&self.origin, &self.inverse, &self.inverse_far, &self.near)
    }

    /// Where the ray enters each box, and a bit for each that it enters before `cutoff`.
    #[inline(always)]
    pub fn boxes(&self, node: &Node, cutoff: f32) -> ([f32; WIDTH], u32) {
        let ([ox, oy, oz], [ix, iy, iz], [fx, fy, fz], near) = self.slabs();
        let [x, y, z] = &node.bounds;
        let side = |row: usize| row / ROW % 2;
        let (nx, ny, nz) = (side(near[0]), side(near[1]), side(near[2]));
        let (x0, x1, y0, y1, z0, z1) = (&x[nx], &x[nx ^ 1], &y[ny], &y[ny ^ 1], &z[nz], &z[nz ^ 1]);
        let mut enter = [0.0f32; WIDTH];
        let mut hits = 0;
        for i in 0..WIDTH {
            let near = max((x0[i] - ox) * ix, max((y0[i] - oy) * iy, max((z0[i] - oz) * iz, 0.0)));
            // Stretched against the rounding of both. [Ize 2013, sec. 3]
            let far = min((x1[i] - ox) * fx, min((y1[i] - oy) * fy, min((z1[i] - oz) * fz, cutoff)));
            enter[i] = near;
            hits |= u32::from(near <= far) << i;
        }
        (enter, hits)
    }

    /// Tests a pack against the ray's line.
    #[inline(always)]
    pub fn edges(&self, pack: &Pack) -> Edges {
        let [x, y, z] = self.axes;
        let o = &self.origin;
        let (ox, oy, oz) = (Vec4::splat(o[x]), Vec4::splat(o[y]), Vec4::splat(o[z]));
        let (sx, sy) = (Vec4::splat(self.shear[0]), Vec4::splat(self.shear[1]));
        let [a, b, c] = &pack.vertices;
        let (az, bz, cz) = (a[z] - oz, b[z] - oz, c[z] - oz);
        let (ax, ay) = ((a[x] - ox) - sx * az, (a[y] - oy) - sy * az);
        let (bx, by) = ((b[x] - ox) - sx * bz, (b[y] - oy) - sy * bz);
        let (cx, cy) = ((c[x] - ox) - sx * cz, (c[y] - oy) - sy * cz);
        // [Woop et al. 2013, sec. 3.2]
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        let zero = Vec4::ZERO;
        let left = u.cmpge(zero) & v.cmpge(zero) & w.cmpge(zero);
        let right = u.cmple(zero) & v.cmple(zero) & w.cmple(zero);
        Edges { lanes: (left | right).bitmask(), weights: [u, v, w], depths: [az, bz, cz] }
    }

    /// Which of the triangles that [`Prepared::edges`] leaves the ray meets between its ends, as far as single precision
    /// decides it; those of which no part is as near as `nearest` are left out.
    #[inline(always)]
    pub fn between(&self, edges: &Edges, nearest: f32) -> Between {
        let scale = Vec4::splat(self.shear[2]);
        let [a, b, c] = edges.depths;
        let (a, b, c) = (a * scale, b * scale, c * scale);
        let zero = Vec4::ZERO;
        let (least, most) = (a.min(b.min(c)), a.max(b.max(c)));
        // The hit's distance is a mean of the vertices': between those there is no doubt on which side of either end it
        // lies. An edge function that is zero is, or hides, one of the other sign.
        let [u, v, w] = edges.weights;
        let inside = u.cmpne(zero) & v.cmpne(zero) & w.cmpne(zero);
        let sure = inside & least.cmpgt(zero) & (most * STRETCH).cmplt(Vec4::splat(self.t_max));
        let beyond = least.cmpgt(Vec4::splat(nearest)) | most.cmple(zero);
        let lanes = edges.lanes & !beyond.bitmask();
        let sure = lanes & sure.bitmask();
        Between { sure, doubtful: lanes & !sure, distances: [a, b, c], least, most }
    }

    /// Whether the ray starts on a triangle or, where it has an end (`ANY`), ends on it.
    #[inline(always)]
    pub fn lies_on<const ANY: bool>(&self, primitive: u32) -> bool {
        primitive == self.leaves || ANY && primitive == self.arrives
    }

    /// Where the ray meets the triangles.
    #[inline(always)]
    pub fn points(&self, edges: &Edges, between: &Between) -> Points {
        let [u, v, w] = edges.weights;
        let [a, b, c] = between.distances;
        let inverse = Vec4::ONE / (u + v + w);
        let (v, w) = (v * inverse, w * inverse);
        // From one vertex on, so that a plane at right angles to the axis has one distance exactly.
        let t = (a + (v * (b - a) + w * (c - a))).max(between.least).min(between.most);
        Points { t: t.to_array(), v: v.to_array(), w: w.to_array() }
    }

    /// Decides about a triangle that [`Prepared::between`] leaves in doubt: (t, u, v) of a hit in (0, t_max).
    #[inline(never)]
    pub fn decide(&self, pack: &Pack, lane: usize) -> Option<(f32, f32, f32)> {
        // Once more, so that what is rare does not keep the tests of others out of registers.
        let edges = self.edges(pack);
        let [mut u, mut v, mut w] = edges.weights.map(|e| e[lane]);
        if u == 0.0 || v == 0.0 || w == 0.0 {
            [u, v, w] = self.exact_edges(pack, lane);
            if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
                return None;
            }
        }
        let determinant = u + v + w;
        // Zero: the line lies in the triangle's plane. Not a number: a lane not used.
        if determinant == 0.0 || determinant.is_nan() {
            return None;
        }
        let inverse = 1.0 / determinant;
        let (v, w) = (v * inverse, w * inverse);
        let [a, b, c] = edges.depths.map(|depth| depth[lane] * self.shear[2]);
        let most = max(a, max(b, c));
        let t = self.exact_t(pack, lane, most)?;
        Some((t, v, w))
    }

    /// The edge functions' signs without rounding: products of two floats are exact in double precision, and so is the
    /// sign of their difference. [Woop et al. 2013, sec. 3.2]
    #[cold]
    fn exact_edges(&self, pack: &Pack, lane: usize) -> [f32; 3] {
        let [x, y, z] = self.axes;
        let [[ax, ay], [bx, by], [cx, cy]] = pack.vertices.map(|p| {
            let depth = p[z][lane] - self.origin[z];
            [x, y].map(|k| {
                let shear = if k == x { self.shear[0] } else { self.shear[1] };
                f64::from((p[k][lane] - self.origin[k]) - shear * depth)
            })
        });
        [(cx * by - cy * bx) as f32, (ax * cy - ay * cx) as f32, (bx * ay - by * ax) as f32]
    }

    /// Where the ray meets the triangle's plane, in double precision: for rays that leave or end near the plane, where
    /// the sign of `t`, or of `t_max - t`, must be right. `None` outside (0, t_max).
    fn exact_t(&self, pack: &Pack, lane: usize, most: f32) -> Option<f32> {
        let [a, b, c] = pack.triangle(lane).map(Vec3::as_dvec3);
        let n = (b - a).cross(c - a);
        let t = n.dot(a - Vec3::from_array(self.origin).as_dvec3()) / n.dot(self.direction.as_dvec3());
        if !(t > 0.0 && t < f64::from(self.t_max)) {
            return None;
        }
        // Seen edge-on, the plane may be met far from the triangle, whose edges the rounded test finds around the ray.
        let t = min(t as f32, most);
        // What rounding to single precision moved onto an end goes back inside.
        let end = self.t_max.next_down();
        Some(if t > end { end } else { t })
    }
}

/// A pack as the ray's line sees it.
pub(in crate::geometry) struct Edges {
    /// The triangles that the line passes through or, by rounding, may pass through: a bit for each.
    pub lanes: u32,
    /// The three edge functions: scaled barycentric coordinates.
    weights: [Vec4; 3],
    /// The vertices' distances along the ray's largest axis.
    depths: [Vec4; 3],
}

/// The triangles of a pack that lie between the ray's ends.
pub(in crate::geometry) struct Between {
    /// Those that are hit for sure.
    pub sure: u32,
    /// Those that need [`Prepared::decide`].
    pub doubtful: u32,
    /// The vertices' ray parameters.
    distances: [Vec4; 3],
    /// The least and the most of the three.
    least: Vec4,
    most: Vec4,
}

/// Where a ray meets the triangles of a pack.
pub(in crate::geometry) struct Points {
    /// Ray parameters.
    pub t: [f32; LANES],
    /// Barycentric coordinates of the second vertices.
    pub v: [f32; LANES],
    /// Barycentric coordinates of the third vertices.
    pub w: [f32; LANES],
}

/// One over a component of a direction, finite even for zero, with its sign: zero times infinity is not a number. Boxes
/// are wider than what is in them, so a ray that runs in the plane of a box's side misses nothing that it could hit.
#[inline(always)]
fn inverse(d: f32) -> f32 {
    const MOST: f32 = 1e37;
    let inverse = 1.0 / d;
    max(min(inverse, MOST), -MOST)
}

/// The number of a primitive if it is seen through `instance`.
#[inline(always)]
fn within(id: PrimitiveId, instance: u32) -> u32 {
    if id.instance == instance { id.primitive } else { u32::MAX }
}

/// 1 for a negative number, -0.0 included, else 0.
#[inline(always)]
fn negative(x: f32) -> usize {
    (x.to_bits() >> 31) as usize
}

/// The larger of the two; `b` if either is not a number. One instruction, unlike [`f32::max`].
#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of the two; `b` if either is not a number.
#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
