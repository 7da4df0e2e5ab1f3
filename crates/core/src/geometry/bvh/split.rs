//! Cutting the boxes of long triangles before the hierarchy is built: a box around a long thin triangle that runs askew is
//! nearly empty, and overlaps everything near it.

use super::{Kind, Reference};
use glam::{DVec3, Vec3};
use std::{cmp::Ordering, collections::BinaryHeap};

/// Boxes of less than this multiple of the median area are left alone,
const LEAST_OF_MEDIAN: f64 = 4.0;
/// and those of less than this multiple of the mean.
const LEAST_OF_MEAN: f64 = 0.6;
/// What both halves together may have of a box's area for the cut to be worth its while. A compact triangle's halves have
/// three quarters, those of a long one that runs askew one half.
const MOST_LEFT: f64 = 0.65;
/// Most boxes that are added, as a share of those there are.
const BUDGET: f64 = 0.44;

/// A box that is worth cutting.
struct Candidate {
    /// Area that the cut saves.
    saved: f64,
    /// Which reference.
    index: usize,
    halves: [(DVec3, DVec3); 2],
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Candidate) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Candidate {}
impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Candidate) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Candidate {
    fn cmp(&self, other: &Candidate) -> Ordering {
        // Of equal savings the reference that came first.
        self.saved.total_cmp(&other.saved).then(other.index.cmp(&self.index))
    }
}

/// Replaces references to long triangles by several, each with the box of a part, those that save most area first.
///
/// As the presplitting of [Karras and Aila 2013, sec. 4.3] with cuts in the middle of the longest side.
pub(super) fn cut(references: &mut Vec<Reference>, triangle: &impl Fn(u32) -> [Vec3; 3]) {
    let area = |r: &Reference| half_area(r.lo.as_dvec3(), r.hi.as_dvec3());
    let mut areas: Vec<f64> = references.iter().map(area).collect();
    let mean = areas.iter().sum::<f64>() / areas.len() as f64;
    let middle = areas.len() / 2;
    let median = *areas.select_nth_unstable_by(middle, f64::total_cmp).1;
    let least = (LEAST_OF_MEDIAN * median).max(LEAST_OF_MEAN * mean);
    let candidate = |index: usize, r: &Reference| {
        let whole = area(r);
        if r.kind != Kind::Triangle || whole.partial_cmp(&least) != Some(Ordering::Greater) {
            return None;
        }
        let halves = halves(r, triangle(r.index));
        let saved = whole - halves.iter().map(|(lo, hi)| half_area(*lo, *hi)).sum::<f64>();
        (saved >= (1.0 - MOST_LEFT) * whole && saved.is_finite()).then_some(Candidate { saved, index, halves })
    };
    let mut queue: BinaryHeap<Candidate> = references.iter().enumerate().filter_map(|(i, r)| candidate(i, r)).collect();
    let most = references.len() + (references.len() as f64 * BUDGET) as usize;
    while references.len() < most {
        let Some(Candidate { index, halves: [a, b], .. }) = queue.pop() else { break };
        let whole = references[index];
        let part = |(lo, hi): (DVec3, DVec3)| Reference {
            // Rounded outwards, and no larger than the whole.
            lo: lo.as_vec3().map(f32::next_down).max(whole.lo),
            hi: hi.as_vec3().map(f32::next_up).min(whole.hi),
            ..whole
        };
        references[index] = part(a);
        references.push(part(b));
        for i in [index, references.len() - 1] {
            queue.extend(candidate(i, &references[i]));
        }
    }
}

/// Boxes of the two parts of a triangle within its box, cut in the middle of the box's longest side; each is as much wider
/// than its part as the whole box is wider than the triangle.
fn halves(r: &Reference, vertices: [Vec3; 3]) -> [(DVec3, DVec3); 2] {
    let (lo, hi) = (r.lo.as_dvec3(), r.hi.as_dvec3());
    let side = hi - lo;
    let axis = if side.x >= side.y && side.x >= side.z {
        0
    } else if side.y >= side.z {
        1
    } else {
        2
    };
    let middle = 0.5 * (lo[axis] + hi[axis]);
    let extent = vertices[0].max(vertices[1]).max(vertices[2]) - vertices[0].min(vertices[1]).min(vertices[2]);
    let pad = f64::from(extent.max_element() * crate::geometry::triangle::BOX_PADDING);
    let vertices = vertices.map(Vec3::as_dvec3);
    let (mut left, mut right) = (hi, lo);
    left[axis] = middle;
    right[axis] = middle;
    [(lo, left), (right, hi)].map(|(lo, hi)| {
        let mut bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        clip(&vertices, lo - pad, hi + pad, &mut |p| bounds = (bounds.0.min(p), bounds.1.max(p)));
        ((bounds.0 - pad).max(lo), (bounds.1 + pad).min(hi))
    })
}

/// Calls `found` with the corners of the part of a polygon that lies in a box. [Sutherland and Hodgman 1974]
fn clip(polygon: &[DVec3], lo: DVec3, hi: DVec3, found: &mut impl FnMut(DVec3)) {
    // A triangle cut by six planes has at most nine corners.
    let mut corners = [DVec3::ZERO; 9];
    let mut count = polygon.len();
    corners[..count].copy_from_slice(polygon);
    for (axis, bound, sign) in (0..3).flat_map(|axis| [(axis, lo[axis], 1.0), (axis, hi[axis], -1.0)]) {
        let inside = |p: DVec3| (p[axis] - bound) * sign;
        let before = corners;
        let mut kept = 0;
        let mut keep = |p: DVec3| {
            if kept < corners.len() {
                corners[kept] = p;
                kept += 1;
            }
        };
        for i in 0..count {
            let (a, b) = (before[i], before[(i + 1) % count]);
            let (da, db) = (inside(a), inside(b));
            if da >= 0.0 {
                keep(a);
            }
            if (da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0) {
                let mut p = a + (b - a) * (da / (da - db));
                p[axis] = bound;
                keep(p);
            }
        }
        count = kept;
    }
    corners[..count].iter().copied().for_each(found);
}

fn half_area(lo: DVec3, hi: DVec3) -> f64 {
    let d = (hi - lo).max(DVec3::ZERO);
    d.x * d.y + d.y * d.z + d.z * d.x
}
