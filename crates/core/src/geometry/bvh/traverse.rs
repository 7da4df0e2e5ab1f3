//! Walking the hierarchy.

use super::{
    Bvh, Child, Prepared,
    node::{LANES, WIDTH},
};
use crate::geometry::{
    Hit, NO_INSTANCE,
    dispatch::{Kernel, prefetch},
};

/// Entries of the stack in the frame of a walk through a flat hierarchy, kept small because it is cleared for each ray.
const SMALL_STACK: usize = 32;
/// The same for deeper ones; what needs more takes its stack from the heap.
const LARGE_STACK: usize = 128;

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
    /// Visits what the ray may hit, the near before the far. `ANY`: returns true at the first hit, in no order. `OTHER`: there
    /// may be leaves that are no triangles; `other` is called for them, and says whether they were hit.
    #[inline(always)]
    pub fn walk<K: Kernel, const ANY: bool, const OTHER: bool>(
        &self,
        ray: &Prepared,
        instance: u32,
        best: &mut Best,
        other: impl FnMut(Child, &mut Best) -> bool,
    ) -> bool {
        let Some(root) = self.root else { return false };
        if self.stack <= SMALL_STACK {
            self.walk_with::<K, ANY, OTHER>(&mut [0; SMALL_STACK], root, ray, instance, best, other)
        } else if self.stack <= LARGE_STACK {
            self.walk_with::<K, ANY, OTHER>(&mut [0; LARGE_STACK], root, ray, instance, best, other)
        } else {
            self.walk_with::<K, ANY, OTHER>(&mut vec![0; self.stack], root, ray, instance, best, other)
        }
    }

    #[inline(always)]
    fn walk_with<K: Kernel, const ANY: bool, const OTHER: bool>(
        &self,
        stack: &mut [u64],
        root: Child,
        ray: &Prepared,
        instance: u32,
        best: &mut Best,
        mut other: impl FnMut(Child, &mut Best) -> bool,
    ) -> bool {
        let mut top = 0;
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
            } else {
                let node = &self.nodes[at.index()];
                let (enter, mut hits) = K::boxes(ray, node, best.cutoff);
                if hits != 0 {
                    let slot = hits.trailing_zeros() as usize % WIDTH;
                    hits &= hits - 1;
                    if hits == 0 {
                        at = node.children[slot];
                        continue;
                    }
                    let bottom = top;
                    // One of them comes next; by the time the others do, they have arrived.
                    self.prefetch::<OTHER>(node.children[slot]);
                    let mut entry = pack(enter[slot], node.children[slot]);
                    if hits & (hits - 1) == 0 {
                        // Two, as most often: the nearer next, without a way over the stack.
                        let slot = hits.trailing_zeros() as usize % WIDTH;
                        self.prefetch::<OTHER>(node.children[slot]);
                        let other = pack(enter[slot], node.children[slot]);
                        stack[top] = entry.max(other);
                        top += 1;
                        at = Child(entry.min(other) as u32);
                        continue;
                    }
                    loop {
                        // Insertion, the nearest on top: few are hit at a time.
                        let mut i = top;
                        if !ANY {
                            while i > bottom && stack[i - 1] < entry {
                                stack[i] = stack[i - 1];
                                i -= 1;
                            }
                        }
                        stack[i] = entry;
                        top += 1;
                        if hits == 0 {
                            break;
                        }
                        let slot = hits.trailing_zeros() as usize % WIDTH;
                        hits &= hits - 1;
                        self.prefetch::<OTHER>(node.children[slot]);
                        entry = pack(enter[slot], node.children[slot]);
                    }
                }
            }
            // The next that is not beyond the best hit.
            loop {
                if top == 0 {
                    return false;
                }
                top -= 1;
                let entry = stack[top];
                if ANY || f32::from_bits((entry >> 32) as u32) <= best.cutoff {
                    at = Child(entry as u32);
                    break;
                }
            }
        }
    }

    /// Brings near what a slot refers to.
    #[inline(always)]
    fn prefetch<const OTHER: bool>(&self, child: Child) {
        if !child.is_leaf() {
            if let Some(node) = self.nodes.get(child.index()) {
                prefetch(node);
            }
        } else if !(OTHER && child.is_other())
            && let Some(triangles) = self.packs.get(child.index())
        {
            prefetch(triangles);
        }
    }

    /// Tests the triangles of a leaf.
    #[inline(always)]
    fn leaf<const ANY: bool>(&self, at: Child, ray: &Prepared, instance: u32, best: &mut Best) -> bool {
        let pack = &self.packs[at.index()];
        let edges = ray.edges(pack);
        if edges.lanes == 0 {
            return false;
        }
        let distances = ray.distances(pack, &edges, best.hit.t);
        if ANY && distances.hit != 0 {
            return true;
        }
        let mut hits = distances.hit;
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize % LANES;
            hits &= hits - 1;
            let (t, u, v) = (distances.t[lane], distances.v[lane], distances.w[lane]);
            best.offer(Hit { t, u, v, primitive: pack.primitives[lane], instance });
        }
        let mut doubtful = distances.doubtful;
        while doubtful != 0 {
            let lane = doubtful.trailing_zeros() as usize % LANES;
            doubtful &= doubtful - 1;
            if let Some((t, u, v)) = ray.decide(pack, &edges, lane) {
                if ANY {
                    return true;
                }
                best.offer(Hit { t, u, v, primitive: pack.primitives[lane], instance });
            }
        }
        false
    }
}

/// A stack entry; entries order as their distances, which are not negative, do.
#[inline(always)]
fn pack(enter: f32, child: Child) -> u64 {
    u64::from(enter.to_bits()) << 32 | u64::from(child.0)
}
