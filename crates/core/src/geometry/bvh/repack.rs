//! Dividing the smallest subtrees of the binary tree once more, so that packs become full.
//!
//! Clustering merges what is nearest, without regard to how many triangles a pack holds: its subtrees of four or fewer, which
//! packs are made of, hold three on average and less among long triangles. Division from above by the surface area heuristic
//! [MacDonald and Booth 1990], with packs as what is counted, fills them. Further up clustering does as well.

use super::{
    Reference,
    node::LANES,
    topology::{Binary, bound, unit_scale},
};
use crate::parallel;
use glam::Vec3;

/// Most references of a subtree that is divided once more.
const SMALL: u32 = 256;
/// Most references that all places for a cut are tried of; of more, those between bins.
const SWEPT: usize = 32;
/// Bins on an axis.
const BINS: usize = 32;

/// Divides the subtrees of up to [`SMALL`] references once more.
pub(super) fn repack(tree: &[Binary], references: &[Reference]) -> Vec<Binary> {
    let mut packed = vec![Binary::EMPTY];
    packed.reserve(tree.len());
    let mut ids = Vec::with_capacity(references.len());
    // Small subtrees: how many references, and where their nodes begin.
    let mut small = Vec::new();
    let mut pending = vec![(0, 0)];
    let mut below = Vec::new();
    while let Some((from, to)) = pending.pop() {
        let node = &tree[from];
        if node.count == 1 {
            packed[to] = *node;
            continue;
        }
        let first = packed.len();
        packed[to] = Binary { first: first as u32, count: node.count, ..Binary::EMPTY };
        if node.count > SMALL {
            packed.extend([Binary::EMPTY; 2]);
            pending.push((node.first as usize + 1, first + 1));
            pending.push((node.first as usize, first));
            continue;
        }
        // Of `n` references there are two times `n` nodes but two below the root.
        packed.resize(first + 2 * node.count as usize - 2, Binary::EMPTY);
        small.push((node.count as usize, first));
        below.push(from);
        while let Some(n) = below.pop() {
            if tree[n].count == 1 {
                ids.push(tree[n].first);
            } else {
                below.extend([tree[n].first as usize + 1, tree[n].first as usize]);
            }
        }
    }
    let scale = unit_scale(&tree[0]);
    let mut jobs = Vec::with_capacity(small.len());
    let (mut nodes, mut at, mut ids) = (&mut packed[..], 0, &ids[..]);
    for (count, first) in small {
        let (below, rest) = nodes[first - at..].split_at_mut(2 * count - 2);
        (nodes, at) = (rest, first + below.len());
        let (these, rest) = ids.split_at(count);
        ids = rest;
        jobs.push((these, below, first));
    }
    parallel::for_each(&mut jobs, |(ids, nodes, first)| {
        let mut items: Vec<Item> = ids.iter().map(|&id| Item::new(id, &references[id as usize], scale)).collect();
        divide(&mut items, nodes, *first);
    });
    drop(jobs);
    bound(&mut packed, references);
    packed
}

type Bounds = (Vec3, Vec3);
const NOTHING: Bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);

fn joined(a: Bounds, b: Bounds) -> Bounds {
    (a.0.min(b.0), a.1.max(b.1))
}

/// Half the area of a box.
fn area((lo, hi): Bounds) -> f32 {
    let d = hi - lo;
    d.x * d.y + d.y * d.z + d.z * d.x
}

/// A reference, scaled so that areas neither overflow nor vanish.
#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds,
    center: Vec3,
    id: u32,
}

impl Item {
    fn new(id: u32, reference: &Reference, scale: f32) -> Item {
        let (lo, hi) = (reference.lo * scale, reference.hi * scale);
        Item { bounds: (lo, hi), center: (lo + hi) * 0.5, id }
    }
}

/// Makes the nodes below one that holds the items, two or more; `nodes[0]` is number `first` of the tree.
fn divide(items: &mut [Item], nodes: &mut [Binary], first: usize) {
    let at = if items.len() > SWEPT { between_bins(items) } else { None };
    let at = at.unwrap_or_else(|| between_items(items));
    let (left, right) = items.split_at_mut(at);
    let (pair, below) = nodes.split_at_mut(2);
    let (left_below, right_below) = below.split_at_mut(2 * left.len() - 2);
    let (left_first, right_first) = (first + 2, first + 2 + left_below.len());
    for (child, items, below, first) in [(0, left, left_below, left_first), (1, right, right_below, right_first)] {
        if let [item] = items {
            pair[child] = Binary { first: item.id, count: 1, ..Binary::EMPTY };
        } else {
            pair[child] = Binary { first: first as u32, count: items.len() as u32, ..Binary::EMPTY };
            divide(items, below, first);
        }
    }
}

/// Sorts along the best axis, and says how many come first; every number is tried.
fn between_items(items: &mut [Item]) -> usize {
    let n = items.len();
    // What fits in one pack costs by what is in it, should it be torn apart after all.
    let cost = |bounds, count: usize| area(bounds) * if n <= LANES { count } else { count.div_ceil(LANES) } as f32;
    let mut best = (f32::INFINITY, 1);
    let mut best_order: Vec<u64> = (0..n as u64).collect();
    let mut order = Vec::with_capacity(n);
    let mut right = vec![0.0; n];
    for axis in 0..3 {
        order.clear();
        order.extend(items.iter().enumerate().map(|(i, item)| u64::from(ordered(item.center[axis])) << 32 | i as u64));
        order.sort_unstable();
        let bounds_of = |entry: u64| items[entry as u32 as usize].bounds;
        let mut bounds = NOTHING;
        for i in (1..n).rev() {
            bounds = joined(bounds, bounds_of(order[i]));
            right[i] = cost(bounds, n - i);
        }
        let mut bounds = NOTHING;
        let before = best.0;
        for i in 1..n {
            bounds = joined(bounds, bounds_of(order[i - 1]));
            let both = cost(bounds, i) + right[i];
            if both < best.0 {
                best = (both, i);
            }
        }
        if best.0 < before {
            best_order.copy_from_slice(&order);
        }
    }
    let sorted: Vec<Item> = best_order.iter().map(|&entry| items[entry as u32 as usize]).collect();
    items.copy_from_slice(&sorted);
    best.1
}

/// Bits that order as the number does.
fn ordered(x: f32) -> u32 {
    let bits = x.to_bits();
    bits ^ if bits >> 31 == 1 { u32::MAX } else { 1 << 31 }
}

/// Puts those of the best half first, and says how many they are; boundaries of bins are tried. [Wald 2007] `None` when all
/// are in one place.
fn between_bins(items: &mut [Item]) -> Option<usize> {
    let (lo, hi) = items.iter().fold(NOTHING, |b, item| joined(b, (item.center, item.center)));
    // Along an axis on which all are in one place this is infinite, and so not used.
    let bins_per_length = BINS as f32 / (hi - lo);
    let bins_of = |item: &Item| ((item.center - lo) * bins_per_length).min(Vec3::splat((BINS - 1) as f32));
    let mut bins = [[(NOTHING, 0_usize); BINS]; 3];
    for item in items.iter() {
        let at = bins_of(item);
        for axis in 0..3 {
            let (bounds, count) = &mut bins[axis][at[axis] as usize];
            *bounds = joined(*bounds, item.bounds);
            *count += 1;
        }
    }
    let mut best = (f32::INFINITY, 0, 0);
    for axis in (0..3).filter(|&axis| hi[axis] > lo[axis]) {
        let bins = &bins[axis];
        let cost = |(bounds, count): (Bounds, usize)| match count {
            0 => f32::INFINITY,
            _ => area(bounds) * count.div_ceil(LANES) as f32,
        };
        let merged = |a: (Bounds, usize), b: (Bounds, usize)| (joined(a.0, b.0), a.1 + b.1);
        let mut right = [0.0; BINS];
        let mut sum = (NOTHING, 0);
        for b in (1..BINS).rev() {
            sum = merged(sum, bins[b]);
            right[b] = cost(sum);
        }
        let mut sum = (NOTHING, 0);
        for b in 1..BINS {
            sum = merged(sum, bins[b - 1]);
            let both = cost(sum) + right[b];
            if both < best.0 {
                best = (both, axis, b);
            }
        }
    }
    let (cost, axis, boundary) = best;
    if cost == f32::INFINITY {
        return None;
    }
    let mut at = 0;
    for i in 0..items.len() {
        if (bins_of(&items[i])[axis] as usize) < boundary {
            items.swap(i, at);
            at += 1;
        }
    }
    Some(at)
}

#[cfg(test)]
mod tests {
    use super::{super::Kind, *};
    use crate::geometry::bvh::topology::cluster;
    use rand::{RngExt, SeedableRng};

    fn reference(at: Vec3, size: Vec3) -> Reference {
        Reference { lo: at, hi: at + size, kind: Kind::Triangle, index: 0 }
    }

    /// Every reference is in one leaf, every node holds what is below it, and children come after their parents.
    fn check(tree: &[Binary], references: &[Reference]) {
        assert_eq!(tree.len(), 2 * references.len() - 1);
        let mut seen = vec![false; references.len()];
        let mut pending = vec![0];
        while let Some(n) = pending.pop() {
            let node = &tree[n];
            if node.count == 1 {
                assert!(!std::mem::replace(&mut seen[node.first as usize], true));
                let r = &references[node.first as usize];
                assert!(node.lo == r.lo && node.hi == r.hi);
                continue;
            }
            let first = node.first as usize;
            assert!(first > n);
            let (a, b) = (&tree[first], &tree[first + 1]);
            assert!(node.lo == a.lo.min(b.lo) && node.hi == a.hi.max(b.hi) && node.count == a.count + b.count);
            pending.extend([first, first + 1]);
        }
        assert!(seen.into_iter().all(|seen| seen));
    }

    #[test]
    fn every_reference_stays_in_the_tree_once() {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(7);
        let mut point = move || Vec3::new(rng.random(), rng.random(), rng.random());
        for n in [1, 2, 3, 5, 33, 256, 257, 5000] {
            let spread: Vec<_> = (0..n).map(|_| reference(point(), point() * 0.1)).collect();
            let coincident = vec![reference(Vec3::ONE, Vec3::X); n];
            let line: Vec<_> = (0..n).map(|i| reference(Vec3::X * i as f32, Vec3::ZERO)).collect();
            let enormous: Vec<_> = (0..n).map(|_| reference(point() * -3e38, point() * 3e38)).collect();
            for references in [spread, coincident, line, enormous] {
                let clustered = cluster(&references);
                check(&clustered, &references);
                check(&repack(&clustered, &references), &references);
            }
        }
    }

    #[test]
    fn packs_get_full() {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(8);
        let mut point = move || Vec3::new(rng.random(), rng.random(), 0.0);
        let references: Vec<_> = (0..4000).map(|_| reference(point(), Vec3::splat(1e-3))).collect();
        let tree = repack(&cluster(&references), &references);
        // Largest subtrees that a pack holds.
        let (mut packs, mut pending) = (0, vec![0]);
        while let Some(n) = pending.pop() {
            if tree[n].count as usize <= LANES {
                packs += 1;
            } else {
                pending.extend([tree[n].first as usize, tree[n].first as usize + 1]);
            }
        }
        let fill = references.len() as f64 / f64::from(packs);
        assert!(fill > 3.5, "{fill}");
    }
}
