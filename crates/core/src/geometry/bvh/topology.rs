//! The binary tree that the wide hierarchy is collapsed from.

use super::Reference;
use crate::digest::{GOLDEN, mix};
use glam::Vec3;
use obvhs::{
    aabb::Aabb,
    bvh2::reinsertion::ReinsertionOptimizer,
    ploc::{PlocBuilder, PlocSearchDistance, SortPrecision},
};

/// A node of the binary tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary {
    pub lo: Vec3,
    pub hi: Vec3,
    /// Of an inner node: its first child, the second follows. Of a leaf: the reference.
    pub first: u32,
    /// References below; 1 for a leaf.
    pub count: u32,
}

impl Binary {
    /// A leaf whose reference is not known yet.
    pub const EMPTY: Binary = Binary { lo: Vec3::ZERO, hi: Vec3::ZERO, first: 0, count: 1 };
}

/// Share of the nodes that are put back where they cost least, in the first of several rounds. [Meister and Bittner 2018b]
const REINSERTED: f32 = 0.02;

/// Builds the tree by parallel locally-ordered clustering. [Meister and Bittner 2018] The root is the first node, children
/// come after their parents.
///
/// Clustering only decides who is next to whom; boxes are those of the references, in their own scale.
pub(super) fn cluster(references: &[Reference]) -> Vec<Binary> {
    let boxes = shaken(references);
    let indices = (0..references.len() as u32).collect();
    let mut tree =
        PlocBuilder::with_capacity(boxes.len()).build(PlocSearchDistance::High, &boxes, indices, SortPrecision::U64, 0);
    ReinsertionOptimizer::default().run(&mut tree, REINSERTED, None);
    // Reinsertion leaves children anywhere; they come after their parents again, in pairs.
    let mut nodes = vec![Binary::EMPTY];
    let mut pending = vec![(0, 0)];
    while let Some((from, to)) = pending.pop() {
        let n = &tree.nodes[from];
        if n.is_leaf() {
            nodes[to].first = tree.primitive_indices[n.first_index as usize];
        } else {
            let first = nodes.len();
            nodes[to] = Binary { first: first as u32, count: 0, ..nodes[to] };
            nodes.extend([Binary::EMPTY; 2]);
            pending.push((n.first_index as usize + 1, first + 1));
            pending.push((n.first_index as usize, first));
        }
    }
    bound(&mut nodes, references);
    nodes
}

/// Gives boxes and counts to nodes, from the leaves on.
pub(super) fn bound(nodes: &mut [Binary], references: &[Reference]) {
    for i in (0..nodes.len()).rev() {
        let node = nodes[i];
        nodes[i] = if node.count == 1 {
            let reference = &references[node.first as usize];
            Binary { lo: reference.lo, hi: reference.hi, ..node }
        } else {
            let (a, b) = (nodes[node.first as usize], nodes[node.first as usize + 1]);
            Binary { lo: a.lo.min(b.lo), hi: a.hi.max(b.hi), first: node.first, count: a.count + b.count }
        };
    }
}

/// What lengths in a tree are multiplied by so that areas neither overflow nor vanish: its root becomes half a unit long.
pub(super) fn unit_scale(root: &Binary) -> f32 {
    let extent = (root.hi * 0.5 - root.lo * 0.5).max_element();
    let scale = if extent > 0.0 { 0.5 / extent } else { 0.0 };
    if scale.is_finite() { scale } else { f32::MAX }
}

/// The boxes in the unit cube, each moved by a small part of its own size.
///
/// In the unit cube, areas neither overflow nor vanish. The shaking breaks ties: clustering merges neighbours that each
/// are the other's best, and resolves ties to the later one, so among equal boxes, or in a row of equidistant ones, all
/// would point ahead and only the last two agree, in each of as many rounds as there are boxes.
fn shaken(references: &[Reference]) -> Vec<Aabb> {
    let (lo, hi) =
        references.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), r| (lo.min(r.lo), hi.max(r.hi)));
    // In double precision, as enormous extents overflow.
    let (lo, hi) = (lo.as_dvec3(), hi.as_dvec3());
    let extent = (hi - lo).max_element();
    let scale = if extent > 0.0 { extent.recip() } else { 0.0 };
    references
        .iter()
        .enumerate()
        .map(|(i, r)| {
            let (a, b) = ((r.lo.as_dvec3() - lo) * scale, (r.hi.as_dvec3() - lo) * scale);
            // The second term: some units in the last place of the unit cube's coordinates.
            let size = (b - a).max_element() * 0.01 + 4.0 * f64::from(f32::EPSILON);
            let shake = noise(i as u64) * size;
            Aabb::new((a + shake).as_vec3().into(), (b + shake).as_vec3().into())
        })
        .collect()
}

/// Three numbers in [-0.5, 0.5) that depend on `i` alone.
fn noise(i: u64) -> glam::DVec3 {
    let z = mix((i + 1).wrapping_mul(GOLDEN));
    let part = |shift: u32| ((z >> shift) & 0x1f_ffff) as f64 / f64::from(1 << 21) - 0.5;
    glam::DVec3::new(part(0), part(21), part(42))
}
