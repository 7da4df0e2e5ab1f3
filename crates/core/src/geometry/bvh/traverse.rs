//! Walking the hierarchy.

use super::{Bvh, Child, Prepared, node::WIDTH, prepared::STRETCH};
use crate::geometry::{Hit, NO_INSTANCE, dispatch::prefetch};

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
    pub fn walk<const ANY: bool, const OTHER: bool>(
        &self,
        ray: &Prepared,
        instance: u32,
        best: &mut Best,
        other: impl FnMut(Child, &mut Best) -> bool,
    ) -> bool {
        let Some(root) = self.root else { return false };
        if self.stack <= SMALL_STACK {
            self.walk_with::<ANY, OTHER>(&mut [0; SMALL_STACK], root, ray, instance, best, other)
        } else if self.stack <= LARGE_STACK {
            self.walk_with::<ANY, OTHER>(&mut [0; LARGE_STACK], root, ray, instance, best, other)
        } else {
            self.walk_with::<ANY, OTHER>(&mut vec![0; self.stack], root, ray, instance, best, other)
        }
    }

    #[inline(always)]
    fn walk_with<const ANY: bool, const OTHER: bool>(
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
                let (enter, mut hits) = ray.boxes(node, best.cutoff);
                if hits != 0 {
                    let slot = (hits.trailing_zeros() / 8) as usize % WIDTH;
                    hits &= hits - 1;
                    if hits == 0 {
                        at = node.children[slot];
                        continue;
                    }
                    let bottom = top;
                    // One of them comes next; by the time the others do, they have arrived.
                    self.prefetch::<OTHER>(node.children[slot]);
                    let mut entry = pack(enter[slot], node.children[slot]);
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
                        let slot = (hits.trailing_zeros() / 8) as usize % WIDTH;
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
                if ANY || f32::from_bits((entry >> 32) as u32) <= best.hit.t * STRETCH {
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
        let triangles = &self.packs[at.index()];
        let (edges, mut hits) = ray.edges(triangles);
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            if ray.starts_on(triangles, lane) {
                continue;
            }
            if let Some((t, u, v)) = ray.decide(triangles, &edges, lane) {
                if ANY {
                    return true;
                }
                best.offer(Hit { t, u, v, primitive: triangles.primitives[lane], instance });
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
