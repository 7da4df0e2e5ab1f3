//! Searching. Everything here is inlined into the entry points of [`super::dispatch`], which compile it for the processor.
//!
//! Pruning loses nothing to rounding: a box's nearest point is no farther than any point inside along each axis, and rounded
//! differences, squares and sums, taken in the same order, keep that order.

use super::{BUCKET, KdTree, LEAF, Neighbour, WIDTH};
use glam::Vec3;

/// Every level adds at most seven entries to what waits, and eight to the power of nine buckets hold all that a tree can.
const STACK: usize = 7 * 10 + 2;

/// Squared distances to the points of each bucket that may hold any nearer than `bound`, nearest boxes first, with the index
/// of its first point. `visit` says how near points must be from then on.
#[inline(always)]
fn traverse<P>(tree: &KdTree<P>, from: Vec3, mut bound: f32, mut visit: impl FnMut(&[f32; BUCKET], u32, f32) -> f32) {
    if tree.buckets.is_empty() {
        return;
    }
    let mut stack = [0u64; STACK];
    let mut waiting = 1;
    stack[0] = u64::from(if tree.nodes.is_empty() { LEAF } else { 0 });
    while waiting > 0 {
        waiting -= 1;
        let next = stack[waiting];
        if f32::from_bits((next >> 32) as u32) >= bound {
            continue;
        }
        let next = next as u32;
        if next & LEAF != 0 {
            let bucket = (next & !LEAF) as usize;
            let [x, y, z] = &tree.buckets[bucket].0;
            let mut d2 = [0.0; BUCKET];
            for i in 0..BUCKET {
                let (dx, dy, dz) = (x[i] - from.x, y[i] - from.y, z[i] - from.z);
                d2[i] = dx * dx + dy * dy + dz * dz;
            }
            bound = visit(&d2, (bucket * BUCKET) as u32, bound);
            continue;
        }
        let node = &tree.nodes[next as usize];
        let mut d2 = [0.0; WIDTH];
        for (i, d2) in d2.iter_mut().enumerate() {
            let outside = |axis: usize, from: f32| {
                let (below, above) = (node.low[axis][i] - from, from - node.high[axis][i]);
                let out = if below > above { below } else { above };
                if out > 0.0 { out } else { 0.0 }
            };
            let (dx, dy, dz) = (outside(0, from.x), outside(1, from.y), outside(2, from.z));
            *d2 = dx * dx + dy * dy + dz * dz;
        }
        // The nearest last, so that it is taken first.
        let first = waiting;
        for (d2, child) in d2.iter().zip(&node.child) {
            if *d2 < bound {
                let entry = u64::from(d2.to_bits()) << 32 | u64::from(*child);
                let mut at = waiting;
                while at > first && stack[at - 1] < entry {
                    stack[at] = stack[at - 1];
                    at -= 1;
                }
                stack[at] = entry;
                waiting += 1;
            }
        }
    }
}

/// The bound that lets pass what is at most `radius` away: the least number above its square.
#[inline(always)]
fn bound(radius: f32) -> f32 {
    if radius >= 0.0 { (radius * radius).next_up() } else { 0.0 }
}

/// The `k` nearest of those that `keep` keeps, in no order, in the front of `found`; returns how many.
#[inline(always)]
pub(super) fn k_nearest<P>(
    tree: &KdTree<P>,
    from: Vec3,
    k: usize,
    radius: f32,
    found: &mut Vec<Neighbour>,
    keep: impl Fn(u32) -> bool,
) -> usize {
    if k == 0 {
        return 0;
    }
    // Found points are only sorted out when there are more than `most`: selecting the k nearest among many at once is cheaper
    // than keeping them ordered.
    let most = k + k / 2 + BUCKET;
    if found.len() < most + BUCKET {
        found.resize(most + BUCKET, Neighbour(0));
    }
    let found = &mut found[..most + BUCKET];
    let mut count = 0;
    traverse(tree, from, bound(radius), |d2, first, mut bound| {
        let room: &mut [Neighbour; BUCKET] =
            (&mut found[count..count + BUCKET]).try_into().expect("there is room for a bucket");
        let mut near = 0u32;
        for (i, d2) in d2.iter().enumerate() {
            near |= u32::from(*d2 < bound) << i;
        }
        let mut added = 0;
        while near != 0 {
            let i = near.trailing_zeros();
            near &= near - 1;
            let index = first + i;
            room[added % BUCKET] = Neighbour::new(d2[i as usize % BUCKET], index);
            added += usize::from(keep(index));
        }
        count += added;
        if count > most {
            bound = select(&mut found[..count], k);
            count = k;
        }
        bound
    });
    if count > k {
        select(&mut found[..count], k);
        count = k;
    }
    count
}

/// Brings the `k` nearest to the front; returns the squared distance of the farthest of them.
#[inline(always)]
fn select(found: &mut [Neighbour], k: usize) -> f32 {
    found.select_nth_unstable(k - 1).1.distance_squared()
}

/// All at most `radius` away.
#[inline(always)]
pub(super) fn within<P>(tree: &KdTree<P>, from: Vec3, radius: f32, mut visit: impl FnMut(Neighbour)) {
    traverse(tree, from, bound(radius), |d2, first, bound| {
        for (i, d2) in d2.iter().enumerate() {
            if *d2 < bound {
                visit(Neighbour::new(*d2, first + i as u32));
            }
        }
        bound
    });
}
