//! A kd-tree over points that carry something: k nearest neighbours and all neighbours within a radius.
//!
//! It needs no scene and serves in anybody's renderer:
//!
//! ```
//! use etendue_photon::kd_tree::{KdTree, Neighbours};
//! use glam::Vec3;
//!
//! let tree = KdTree::new((0..100).map(|i| (Vec3::X * i as f32, i)).collect());
//! let mut found = Neighbours::default();
//! let mut three: Vec<i32> =
//!     tree.k_nearest(Vec3::X * 41.2, 3, f32::INFINITY, &mut found).iter().map(|n| *tree.payload(n.index())).collect();
//! three.sort();
//! assert_eq!(three, [40, 41, 42]);
//! let mut count = 0;
//! tree.within(Vec3::ZERO, 10.0, |_| count += 1);
//! assert_eq!(count, 11);
//! ```
//!
//! Points lie in buckets of sixteen, coordinate by coordinate, so that sixteen distances are computed at once. A node has eight
//! children with tight boxes around their points, and eight distances to boxes are computed at once: photons lie on
//! surfaces, and what a splitting plane alone leaves possible is mostly empty. Beside the payload a point takes 14 bytes.

mod build;
mod dispatch;
mod search;

use glam::Vec3;

/// Points in a bucket.
const BUCKET: usize = 16;
/// Children of a node.
const WIDTH: usize = 8;
/// Marks a child that is a bucket.
const LEAF: u32 = 1 << 31;

/// A bucket: coordinates by axis. What is left over in the last one is not a number, which no distance reaches.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct Bucket([[f32; BUCKET]; 3]);

/// Boxes around the points of each child, by axis; a box without points is everted. A child is the index of a node, or that
/// of a bucket and [`LEAF`].
#[derive(Clone, Debug)]
#[repr(C, align(32))]
struct Node {
    low: [[f32; WIDTH]; 3],
    high: [[f32; WIDTH]; 3],
    child: [u32; WIDTH],
}

/// Points with a payload each, arranged for queries; see the [module](self).
#[derive(Clone, Debug)]
pub struct KdTree<P> {
    /// Every node before its children; empty where one bucket holds everything.
    nodes: Vec<Node>,
    buckets: Vec<Bucket>,
    /// In the order of the buckets.
    payloads: Vec<P>,
}

/// A point that a query has found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(transparent)]
pub struct Neighbour(u64);

impl Neighbour {
    #[inline(always)]
    fn new(distance_squared: f32, index: u32) -> Neighbour {
        // Numbers that are not negative are ordered like their bits.
        Neighbour(u64::from(distance_squared.to_bits()) << 32 | u64::from(index))
    }

    /// The square of its distance.
    #[inline(always)]
    pub fn distance_squared(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    /// Its place in the tree: what [`KdTree::payload`] and [`KdTree::position`] take.
    #[inline(always)]
    pub fn index(self) -> u32 {
        self.0 as u32
    }
}

/// Room for what queries find; it grows to the largest `k` and is used again.
#[derive(Clone, Debug, Default)]
pub struct Neighbours(Vec<Neighbour>);

impl<P> KdTree<P> {
    /// Most points that a tree can hold.
    pub const LIMIT: usize = 1 << 31;

    /// Number of points.
    pub fn len(&self) -> usize {
        self.payloads.len()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.payloads.is_empty()
    }

    /// What a point carries; `index` is below [`KdTree::len`].
    #[inline]
    pub fn payload(&self, index: u32) -> &P {
        &self.payloads[index as usize]
    }

    /// What the points carry, in the tree's order.
    pub fn payloads(&self) -> &[P] {
        &self.payloads
    }

    /// The same, to be changed: no query depends on it.
    pub fn payloads_mut(&mut self) -> &mut [P] {
        &mut self.payloads
    }

    /// Where a point is; `index` is below [`KdTree::len`].
    #[inline]
    pub fn position(&self, index: u32) -> Vec3 {
        let (bucket, slot) = (&self.buckets[index as usize / BUCKET].0, index as usize % BUCKET);
        Vec3::new(bucket[0][slot], bucket[1][slot], bucket[2][slot])
    }

    /// Bytes held beside the payload.
    pub fn structure_bytes(&self) -> u64 {
        (self.nodes.capacity() * size_of::<Node>() + self.buckets.capacity() * size_of::<Bucket>()) as u64
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> u64 {
        self.structure_bytes() + (self.payloads.capacity() * size_of::<P>()) as u64
    }
}

#[cfg(test)]
mod tests;
