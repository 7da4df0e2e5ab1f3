//! Building the hierarchy.

use super::{
    Bvh, Child, Pack,
    collapse::{Lone, Plan},
    node::{LANES, WIDTH},
    repack::repack,
    split::cut,
    topology::{Binary, cluster, unit_scale},
};
use crate::parallel;
use glam::{Vec3, Vec3Swizzles};

/// What a reference refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::geometry) enum Kind {
    /// A triangle, by primitive.
    Triangle,
    /// A curved shape, by its index among the curved shapes.
    Curved,
    /// An instance, by its index.
    Instance,
}

/// What the hierarchy is built over.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry) struct Reference {
    /// Lower bounds, finite.
    pub lo: Vec3,
    /// Upper bounds, finite.
    pub hi: Vec3,
    /// What it is.
    pub kind: Kind,
    /// Which of its kind.
    pub index: u32,
}

const ROOM: &str = "no more primitives than a hierarchy has room for";

impl Bvh {
    /// Builds the hierarchy; `triangle` gives the vertices of a primitive.
    pub fn build(mut references: Vec<Reference>, triangle: impl Fn(u32) -> [Vec3; 3]) -> Bvh {
        if references.is_empty() {
            return Bvh::default();
        }
        assert!(references.len() <= (Child::MAX / 2) as usize, "more than {} primitives", Child::MAX / 2);
        cut(&mut references, &triangle);
        let clustered = cluster(&references);
        let packed = repack(&clustered, &references);
        let (clustered_plan, packed_plan) =
            parallel::join(|| plan(&clustered, &references), || plan(&packed, &references));
        // Full packs are worth a worse tree in most places, but not in all.
        let (binary, plan) = if packed_plan.cost() < clustered_plan.cost() {
            (&packed, packed_plan)
        } else {
            (&clustered, clustered_plan)
        };
        let mut emitter = Emitter {
            binary,
            plan,
            references: &references,
            triangle,
            bvh: Bvh { bounds: Some((binary[0].lo, binary[0].hi)), ..Bvh::default() },
        };
        emitter.run();
        emitter.bvh
    }
}

/// Plans the wide tree.
fn plan<'a>(binary: &'a [Binary], references: &[Reference]) -> Plan<'a> {
    // Which nodes hold triangles only: those that may become packs.
    let mut triangles = vec![true; binary.len()];
    for n in (0..binary.len()).rev() {
        let first = binary[n].first as usize;
        triangles[n] = if binary[n].count == 1 {
            references[first].kind == Kind::Triangle
        } else {
            triangles[first] && triangles[first + 1]
        };
    }
    let lone = |leaf: &Binary| match references[leaf.first as usize].kind {
        Kind::Triangle => Lone::Triangle,
        Kind::Curved | Kind::Instance => Lone::Other,
    };
    Plan::new(binary, lone, |n| triangles[n] && binary[n].count as usize <= LANES)
}

/// Writes the wide tree.
struct Emitter<'a, F> {
    binary: &'a [Binary],
    plan: Plan<'a>,
    references: &'a [Reference],
    triangle: F,
    bvh: Bvh,
}

impl<F: Fn(u32) -> [Vec3; 3]> Emitter<'_, F> {
    fn run(&mut self) {
        if self.plan.is_leaf(0) {
            self.bvh.root = Some(self.leaf(0));
            return;
        }
        let root = self.node();
        self.bvh.root = Some(root);
        // Depth first, so that what is near in space is near in memory. Entries: binary node, wide node, depth.
        let mut pending = vec![(0, root, 1)];
        let mut depth = 0;
        let mut children = Vec::with_capacity(WIDTH);
        let filled = self.filled();
        while let Some((from, to, level)) = pending.pop() {
            depth = depth.max(level);
            children.clear();
            self.plan.children(from, &mut children);
            // A ray that asks only whether anything is in its way visits the last slot first: there goes what hides most for
            // the cost of looking, as in [Nah and Manocha 2014].
            let worth = |n: usize| filled[n] / self.plan.cost_of(n);
            children.sort_by(|&a, &b| worth(a).total_cmp(&worth(b)));
            for (slot, &n) in children.iter().enumerate() {
                let child = if self.plan.is_leaf(n) {
                    self.leaf(n)
                } else {
                    let node = self.node();
                    pending.push((n, node, level + 1));
                    node
                };
                let (lo, hi) = (self.binary[n].lo, self.binary[n].hi);
                self.bvh.arena.node_mut(to).set(slot, lo, hi, child);
            }
        }
        // On the way down each node leaves all its children but one on the stack.
        self.bvh.stack = depth * (WIDTH - 1) + 1;
        self.bvh.arena.settle();
    }

    /// How much surface is in each node of the binary tree, about.
    fn filled(&self) -> Vec<f32> {
        let mut filled = vec![0.0; self.binary.len()];
        let scale = unit_scale(&self.binary[0]);
        for (n, node) in self.binary.iter().enumerate().rev() {
            let (first, extent) = (node.first as usize, node.hi * scale - node.lo * scale);
            filled[n] = if node.count > 1 {
                filled[first] + filled[first + 1]
            } else if self.references[first].kind == Kind::Triangle {
                let [a, b, c] = (self.triangle)(self.references[first].index).map(|p| p * scale);
                // Of a triangle in parts each has as large a share as of the length that is cut most: mostly the only one.
                let share = extent / (a.max(b).max(c) - a.min(b).min(c));
                share.to_array().into_iter().fold(1.0, f32::min) * (b - a).cross(c - a).length()
            } else {
                // That of a sphere in the box.
                extent.dot(extent.yzx())
            };
        }
        filled
    }

    /// Adds a wide node.
    fn node(&mut self) -> Child {
        self.bvh.arena.push_node().expect(ROOM)
    }

    /// Makes a leaf of a binary node.
    fn leaf(&mut self, n: usize) -> Child {
        let node = self.binary[n];
        if node.count == 1 {
            let reference = self.references[node.first as usize];
            match reference.kind {
                Kind::Triangle => {}
                Kind::Curved => return Child::curved(reference.index),
                Kind::Instance => return Child::instance(reference.index),
            }
        }
        let mut pack = Pack::EMPTY;
        let mut lane = 0;
        // At most four leaves below, hence at most three levels.
        let mut pending = vec![n];
        while let Some(n) = pending.pop() {
            let node = self.binary[n];
            if node.count == 1 {
                let primitive = self.references[node.first as usize].index;
                // Two parts of a triangle may have come together again.
                if !pack.primitives.contains(&primitive) {
                    pack.set(lane, (self.triangle)(primitive), primitive);
                    lane += 1;
                }
            } else {
                pending.extend([node.first as usize + 1, node.first as usize]);
            }
        }
        self.bvh.arena.push_pack(pack).expect(ROOM)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fence of pales and a wall, of as many triangles in boxes of the same size, either of them first in space, whatever
    /// the unit of length.
    #[test]
    fn what_hides_most_is_visited_first_by_rays_that_ask_for_anything() {
        let cases = [1.0, 1e15, 1e-15].into_iter().flat_map(|scale| [(100.0, scale), (-100.0, scale)]);
        for (fence, scale) in cases {
            let mut triangles = Vec::new();
            for i in 0..16 {
                let (x, y) = ((i % 4) as f32, (i / 4) as f32);
                let corner = |x: f32, y: f32| Vec3::new(x, y, 0.1 * x);
                let wall = [corner(x, y), corner(x + 1.0, y), corner(x, y + 1.0)];
                let pale = [corner(x, y), corner(x + 0.01, y), corner(x + 1.0, y + 1.0)].map(|p| p + fence * Vec3::X);
                triangles.extend([wall, pale].map(|triangle| triangle.map(|p| p * scale)));
            }
            let references = (0..).zip(&triangles).map(|(index, [a, b, c])| Reference {
                lo: a.min(*b).min(*c),
                hi: a.max(*b).max(*c),
                kind: Kind::Triangle,
                index,
            });
            let bvh = Bvh::build(references.collect(), |i| triangles[i as usize]);
            let root = bvh.arena.node(bvh.root.unwrap());
            let last = root.children.iter().rposition(|child| *child != Child(u32::MAX)).unwrap();
            assert!(last > 0 && root.bounds[0][0][last].abs() < 50.0 * scale, "{root:?}");
        }
    }
}
