//! Building: points are split at medians along the longest side of their box, eight ways a node.

use super::{BUCKET, Bucket, KdTree, LEAF, Node, WIDTH};
use etendue_core::parallel;
use glam::Vec3;

/// A point on its way to its bucket.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
struct Item {
    p: [f32; 3],
    index: u32,
}

/// Smallest and largest coordinates.
#[derive(Clone, Copy)]
struct Bounds {
    low: [f32; 3],
    high: [f32; 3],
}

/// From this many points on, both sides of a split are worked on at once.
const APART: usize = 4096;

impl<P: Copy> KdTree<P> {
    /// Arranges points. On any number of threads the same points in the same order give the same tree. A point with a
    /// coordinate that is not finite is never found.
    ///
    /// # Panics
    /// With more than [`KdTree::LIMIT`] points.
    pub fn new(points: Vec<(Vec3, P)>) -> KdTree<P> {
        assert!(points.len() <= Self::LIMIT, "too many points: {}", points.len());
        let mut items: Vec<Item> = (0..).zip(&points).map(|(index, (p, _))| Item { p: p.to_array(), index }).collect();
        let buckets = points.len().div_ceil(BUCKET);
        let mut tree = KdTree {
            nodes: vec![EMPTY; node_count(buckets)],
            buckets: vec![Bucket([[f32::NAN; BUCKET]; 3]); buckets],
            payloads: Vec::new(),
        };
        let bounds = Bounds::of(&items);
        let place = Place { items: &mut items, nodes: &mut tree.nodes, buckets: &mut tree.buckets, node: 0, bucket: 0 };
        place.subtree(&bounds);
        tree.payloads = items.iter().map(|item| points[item.index as usize].1).collect();
        tree
    }
}

const EMPTY: Node =
    Node { low: [[f32::INFINITY; WIDTH]; 3], high: [[f32::NEG_INFINITY; WIDTH]; 3], child: [LEAF; WIDTH] };

/// Buckets of a full child of a node over `buckets > 1` buckets: the largest power of eight below their number. All children
/// but the last are full.
fn child_capacity(buckets: usize) -> usize {
    let mut capacity = 1;
    while capacity * WIDTH < buckets {
        capacity *= WIDTH;
    }
    capacity
}

/// Nodes over so many buckets.
fn node_count(buckets: usize) -> usize {
    if buckets <= 1 {
        return 0;
    }
    let capacity = child_capacity(buckets);
    1 + buckets / capacity * full_count(capacity) + node_count(buckets % capacity)
}

/// Nodes over a power of eight of buckets: `1 + 8 + ...`, the sum of the powers below it.
fn full_count(capacity: usize) -> usize {
    (capacity - 1) / (WIDTH - 1)
}

impl Bounds {
    fn of(items: &[Item]) -> Bounds {
        let mut bounds = Bounds { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };
        for item in items {
            for axis in 0..3 {
                bounds.low[axis] = bounds.low[axis].min(item.p[axis]);
                bounds.high[axis] = bounds.high[axis].max(item.p[axis]);
            }
        }
        bounds
    }

    fn longest_axis(&self) -> usize {
        let side = |axis: usize| self.high[axis] - self.low[axis];
        let first = if side(1) > side(0) { 1 } else { 0 };
        if side(2) > side(first) { 2 } else { first }
    }
}

/// Items and where their part of the tree goes: slices of nodes and buckets, and the indices of the first of each.
struct Place<'a> {
    items: &'a mut [Item],
    nodes: &'a mut [Node],
    buckets: &'a mut [Bucket],
    node: u32,
    bucket: u32,
}

impl<'a> Place<'a> {
    /// Arranges a bucket, or a node and all below it.
    fn subtree(self, bounds: &Bounds) {
        if self.buckets.len() <= 1 {
            let Some(bucket) = self.buckets.first_mut() else { return };
            for (slot, item) in self.items.iter().enumerate() {
                for axis in 0..3 {
                    bucket.0[axis][slot] = item.p[axis];
                }
            }
            return;
        }
        let capacity = child_capacity(self.buckets.len());
        let (node, below) = self.nodes.split_first_mut().expect("there is a node over several buckets");
        let place = Place { nodes: below, node: self.node + 1, ..self };
        let mut children = [None; WIDTH];
        place.children(bounds, capacity, &mut children);
        for (slot, (child, bounds)) in children.into_iter().flatten().enumerate() {
            node.child[slot] = child;
            for axis in 0..3 {
                node.low[axis][slot] = bounds.low[axis];
                node.high[axis][slot] = bounds.high[axis];
            }
        }
    }

    /// Splits in halves down to single children, and arranges those.
    fn children(self, bounds: &Bounds, capacity: usize, found: &mut [Option<(u32, Bounds)>]) {
        let count = self.buckets.len().div_ceil(capacity);
        if count == 1 {
            let child = if self.buckets.len() == 1 { LEAF | self.bucket } else { self.node };
            found[0] = Some((child, *bounds));
            return self.subtree(bounds);
        }
        let left_count = count.div_ceil(2);
        let (left_buckets, left_nodes) = (left_count * capacity, left_count * full_count(capacity));
        let axis = bounds.longest_axis();
        let middle = left_buckets * BUCKET;
        self.items.select_nth_unstable_by(middle, |a, b| a.p[axis].total_cmp(&b.p[axis]));
        let (left, right) = self.items.split_at_mut(middle);
        let (left_bounds, right_bounds) = (Bounds::of(left), Bounds::of(right));
        let apart = left.len() + right.len() >= APART;
        let (nodes, right_nodes) = self.nodes.split_at_mut(left_nodes);
        let (buckets, right_buckets) = self.buckets.split_at_mut(left_buckets);
        let right = Place {
            items: right,
            nodes: right_nodes,
            buckets: right_buckets,
            node: self.node + left_nodes as u32,
            bucket: self.bucket + left_buckets as u32,
        };
        let left = Place { items: left, nodes, buckets, node: self.node, bucket: self.bucket };
        let (found, right_found) = found.split_at_mut(left_count);
        let left = || left.children(&left_bounds, capacity, found);
        let right = || right.children(&right_bounds, capacity, right_found);
        if apart {
            parallel::join(left, right);
        } else {
            left();
            right();
        }
    }
}
