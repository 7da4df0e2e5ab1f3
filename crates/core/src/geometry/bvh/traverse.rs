//! Walking the hierarchy.

use super::{
    Bvh, Child, Prepared,
    node::{LANES, WIDTH},
    stack::{Entry, Stack},
};
use crate::geometry::{
    Hit, NO_INSTANCE,
    dispatch::{Kernel, prefetch},
};
use std::mem::MaybeUninit;

/// Entries of the stack in the frame of a walk; what needs more takes its stack from the heap.
const STACK: usize = 128;

/// The best hit so far, and how far it is still worth looking.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry) struct Best {
    hit: Hit,
    cutoff: f32,
    found: bool,
}

impl Best {
    #[inline(always)]
    pub fn new(t_max: f32) -> Best {
        let hit = Hit { t: t_max, u: 0.0, v: 0.0, primitive: 0, instance: NO_INSTANCE };
        Best { hit, cutoff: Prepared::cutoff(t_max), found: false }
    }

    /// Takes a hit when it is nearer, or as near with the smaller number: whatever the order of visits, the same one wins.
    #[inline(always)]
    pub fn offer(&mut self, hit: Hit) {
        let best = &self.hit;
        let wins = hit.t < best.t
            || self.found && hit.t == best.t && (hit.instance, hit.primitive) < (best.instance, best.primitive);
        if wins {
            *self = Best { hit, cutoff: Prepared::cutoff(hit.t), found: true };
        }
    }

    #[inline(always)]
    pub fn found(&self) -> Option<Hit> {
        self.found.then_some(self.hit)
    }
}

impl Bvh {
    /// Visits what the ray may hit, the near before the far. `ANY`: visits first what hides most, and returns true at the
    /// first hit. `OTHER`: there may be leaves that are no triangles; `other` is called for them, and says whether they were
    /// hit.
    #[inline(always)]
    pub fn walk<K: Kernel, const ANY: bool, const OTHER: bool>(
        &self,
        ray: &Prepared,
        instance: u32,
        best: &mut Best,
        other: impl FnMut(Child, &mut Best) -> bool,
    ) -> bool {
        let Some(root) = self.root else { return false };
        if self.stack <= STACK {
            let mut entries = [MaybeUninit::uninit(); STACK];
            self.walk_with::<K, ANY, OTHER>(Stack::new(&mut entries), root, ray, instance, best, other)
        } else {
            let mut entries = vec![MaybeUninit::uninit(); self.stack];
            self.walk_with::<K, ANY, OTHER>(Stack::new(&mut entries), root, ray, instance, best, other)
        }
    }

    #[inline(always)]
    fn walk_with<K: Kernel, const ANY: bool, const OTHER: bool>(
        &self,
        mut stack: Stack,
        root: Child,
        ray: &Prepared,
        instance: u32,
        best: &mut Best,
        mut other: impl FnMut(Child, &mut Best) -> bool,
    ) -> bool {
        let mut at = root;
        loop {
            if at.is_leaf() {
                if OTHER && at.is_other() {
                    if other(at, best) && ANY {
                        return true;
                    }
                } else if self.leaf::<ANY>(at, ray, instance, best) {
                    return true;
                }
            } else if let Some(next) = self.node::<K, ANY>(at, ray, best.cutoff, &mut stack) {
                at = next;
                continue;
            }
            // The next that is not beyond the best hit.
            at = loop {
                let Some(entry) = stack.pop() else { return false };
                if ANY || entry.within(best.cutoff) {
                    break entry.child();
                }
            };
        }
    }

    /// The child of a node that comes next, if the ray enters any; the others go onto the stack, the near above the far.
    ///
    /// Up to three, as mostly, are ordered without a branch that depends on the order.
    #[inline(always)]
    fn node<K: Kernel, const ANY: bool>(
        &self,
        at: Child,
        ray: &Prepared,
        cutoff: f32,
        stack: &mut Stack,
    ) -> Option<Child> {
        let node = self.arena.node(at);
        let (enter, mut hits) = K::boxes(ray, node, cutoff);
        if hits == 0 {
            return None;
        }
        if hits & (hits - 1) == 0 {
            return Some(node.children[hits.trailing_zeros() as usize % WIDTH]);
        }
        if ANY {
            // Distances tell nothing; the last slot first, as it hides most, and nothing is beyond what has not been hit.
            let mut slot = hits.trailing_zeros() as usize % WIDTH;
            while hits & (hits - 1) != 0 {
                prefetch(&self.arena, node.children[slot]);
                stack.push(Entry::new(0.0, node.children[slot]));
                hits &= hits - 1;
                slot = hits.trailing_zeros() as usize % WIDTH;
            }
            return Some(node.children[slot]);
        }
        let mut next = || {
            let slot = hits.trailing_zeros() as usize % WIDTH;
            hits &= hits - 1;
            // One of them comes next; by the time the others do, they have arrived.
            prefetch(&self.arena, node.children[slot]);
            (Entry::new(enter[slot], node.children[slot]), hits != 0)
        };
        let ((first, _), (second, more)) = (next(), next());
        let (near, far) = (first.min(second), first.max(second));
        if !more {
            stack.push(far);
            return Some(near.child());
        }
        let (third, mut more) = next();
        let (middle, far) = (far.min(third), far.max(third));
        let (near, middle) = (near.min(middle), near.max(middle));
        let bottom = stack.len();
        stack.push(far);
        stack.push(middle);
        if !more {
            return Some(near.child());
        }
        stack.push(near);
        while more {
            let entry;
            (entry, more) = next();
            stack.insert(entry, bottom);
        }
        stack.pop().map(Entry::child)
    }

    /// Tests the triangles of a leaf.
    #[inline(always)]
    fn leaf<const ANY: bool>(&self, at: Child, ray: &Prepared, instance: u32, best: &mut Best) -> bool {
        let pack = self.arena.pack(at);
        let edges = ray.edges(pack);
        if edges.lanes == 0 {
            return false;
        }
        let between = ray.between(&edges, best.hit.t);
        if between.sure != 0 {
            let points = ray.points(&edges, &between);
            for lane in lanes(between.sure) {
                let primitive = pack.primitives[lane];
                if ray.lies_on::<ANY>(primitive) {
                    continue;
                }
                if ANY {
                    return true;
                }
                best.offer(Hit { t: points.t[lane], u: points.v[lane], v: points.w[lane], primitive, instance });
            }
        }
        for lane in lanes(between.doubtful) {
            let primitive = pack.primitives[lane];
            if ray.lies_on::<ANY>(primitive) {
                continue;
            }
            if let Some((t, u, v)) = ray.decide(pack, lane) {
                if ANY {
                    return true;
                }
                best.offer(Hit { t, u, v, primitive, instance });
            }
        }
        false
    }
}

/// The numbers of the bits that are set.
#[inline(always)]
fn lanes(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}
