//! From the binary tree to the wide one, at the least expected cost.

use super::{
    node::WIDTH,
    topology::{Binary, unit_scale},
};
use glam::Vec3;

/// Expected cost of testing the eight boxes of a node, in units of which the constants below are multiples.
const NODE_COST: f32 = 1.0;
/// Expected cost of testing a pack, however full.
const PACK_COST: f32 = 0.5;
/// Expected cost of a curved shape or an instance.
const OTHER_COST: f32 = 2.0;

/// Half the surface area of a box, relative to `scale` so that it neither overflows nor vanishes.
fn area(node: &Binary, scale: f32) -> f32 {
    let d: Vec3 = (node.hi - node.lo) * scale;
    d.x * d.y + d.y * d.z + d.z * d.x
}

/// The least expected costs of each subtree of a binary tree, as a leaf, an inner node or a list of up to seven of both.
///
/// [Ylitie et al. 2017, sec. 3.1]
pub(super) struct Plan<'a> {
    nodes: &'a [Binary],
    /// `costs[n][i - 1]`: that of node `n` as at most `i` roots.
    costs: Vec<[f32; WIDTH - 1]>,
    /// Whether a node is cheapest as a leaf.
    leaf: Vec<bool>,
}

impl<'a> Plan<'a> {
    /// Plans the collapse; `fits` says of a node with two references or more whether a pack can hold it.
    pub fn new(nodes: &'a [Binary], lone_cost: impl Fn(&Binary) -> Lone, fits: impl Fn(usize) -> bool) -> Plan<'a> {
        let scale = unit_scale(&nodes[0]);
        let mut plan = Plan { nodes, costs: vec![[0.0; WIDTH - 1]; nodes.len()], leaf: vec![false; nodes.len()] };
        for n in (0..nodes.len()).rev() {
            let node = &nodes[n];
            // The term keeps costs apart where all boxes are flat and all areas vanish.
            let a = area(node, scale) + f32::MIN_POSITIVE;
            if node.count == 1 {
                let cost = match lone_cost(node) {
                    Lone::Triangle => PACK_COST,
                    Lone::Other => OTHER_COST,
                };
                plan.costs[n] = [a * cost; WIDTH - 1];
                plan.leaf[n] = true;
                continue;
            }
            let first = node.first as usize;
            let as_leaf = if fits(n) { a * PACK_COST } else { f32::INFINITY };
            let as_node = plan.best_split(first, WIDTH).1 + a * NODE_COST;
            plan.leaf[n] = as_leaf <= as_node;
            plan.costs[n][0] = if plan.leaf[n] { as_leaf } else { as_node };
            for i in 2..WIDTH {
                plan.costs[n][i - 1] = plan.best_split(first, i).1.min(plan.costs[n][i - 2]);
            }
        }
        plan
    }

    /// The expected cost of the whole.
    pub fn cost(&self) -> f32 {
        self.costs[0][0]
    }

    /// The expected cost of a node as one root.
    pub fn cost_of(&self, n: usize) -> f32 {
        self.costs[n][0]
    }

    /// Whether a node becomes a leaf when it is one root.
    pub fn is_leaf(&self, n: usize) -> bool {
        self.leaf[n]
    }

    /// How many of `i` roots the first of two sibling subtrees gets, and the cost of both.
    fn best_split(&self, first: usize, i: usize) -> (usize, f32) {
        let (a, b) = (&self.costs[first], &self.costs[first + 1]);
        let mut best = (1, f32::INFINITY);
        for k in 1..i {
            let cost = a[k - 1] + b[i - k - 1];
            if cost < best.1 {
                best = (k, cost);
            }
        }
        best
    }

    /// Lists the roots of the children of the inner node `n`.
    pub fn children(&self, n: usize, out: &mut Vec<usize>) {
        let first = self.nodes[n].first as usize;
        let (k, _) = self.best_split(first, WIDTH);
        self.roots(first, k, out);
        self.roots(first + 1, WIDTH - k, out);
    }

    /// Lists the at most `i` roots that node `n` is cheapest as.
    fn roots(&self, n: usize, i: usize, out: &mut Vec<usize>) {
        // `i` shrinks with each level.
        if i == 1 || self.nodes[n].count == 1 {
            out.push(n);
            return;
        }
        if self.costs[n][i - 2] <= self.costs[n][i - 1] {
            return self.roots(n, i - 1, out);
        }
        let first = self.nodes[n].first as usize;
        let (k, _) = self.best_split(first, i);
        self.roots(first, k, out);
        self.roots(first + 1, i - k, out);
    }
}

/// What a single reference is.
pub(super) enum Lone {
    /// A triangle.
    Triangle,
    /// A curved shape or an instance.
    Other,
}
