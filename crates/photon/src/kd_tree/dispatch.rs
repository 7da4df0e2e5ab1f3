//! The queries, compiled twice: for any processor, and for those with eight lanes.

use super::{KdTree, Neighbour, Neighbours, search};
use glam::Vec3;

impl<P> KdTree<P> {
    /// The `k` points nearest to `from` among those at most `radius` away (which may be infinite), in no order; fewer where
    /// there are not so many. Of points equally far from `from`, which are found when not all can be depends on the tree.
    #[inline]
    pub fn k_nearest<'a>(&self, from: Vec3, k: usize, radius: f32, found: &'a mut Neighbours) -> &'a [Neighbour] {
        self.k_nearest_where(from, k, radius, found, |_| true)
    }

    /// [`KdTree::k_nearest`] among the points whose index `keep` keeps.
    #[inline]
    pub fn k_nearest_where<'a>(
        &self,
        from: Vec3,
        k: usize,
        radius: f32,
        found: &'a mut Neighbours,
        keep: impl Fn(u32) -> bool,
    ) -> &'a [Neighbour] {
        let k = k.min(self.len());
        let count = lanes::k_nearest(self, from, k, radius, &mut found.0, keep);
        &found.0[..count]
    }

    /// Visits every point at most `radius` away, in an order that depends on the tree alone.
    #[inline]
    pub fn within(&self, from: Vec3, radius: f32, visit: impl FnMut(Neighbour)) {
        lanes::within(self, from, radius, visit);
    }
}

#[cfg(not(target_arch = "x86_64"))]
use search as lanes;

/// The same code with AVX2 where the processor has it: the compiler then takes eight numbers at once where it takes four.
/// Products and sums stay apart, so the results have the same bits.
#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "a function for a processor's extension is safe to call once the extension is detected")]
mod lanes {
    use super::{KdTree, Neighbour, search};
    use glam::Vec3;

    #[inline]
    pub fn k_nearest<P>(
        tree: &KdTree<P>,
        from: Vec3,
        k: usize,
        radius: f32,
        found: &mut Vec<Neighbour>,
        keep: impl Fn(u32) -> bool,
    ) -> usize {
        #[target_feature(enable = "avx2")]
        fn wide<P>(
            tree: &KdTree<P>,
            from: Vec3,
            k: usize,
            radius: f32,
            found: &mut Vec<Neighbour>,
            keep: impl Fn(u32) -> bool,
        ) -> usize {
            search::k_nearest(tree, from, k, radius, found, keep)
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has what the function is compiled for.
            unsafe { wide(tree, from, k, radius, found, keep) }
        } else {
            search::k_nearest(tree, from, k, radius, found, keep)
        }
    }

    #[inline]
    pub fn within<P>(tree: &KdTree<P>, from: Vec3, radius: f32, visit: impl FnMut(Neighbour)) {
        #[target_feature(enable = "avx2")]
        fn wide<P>(tree: &KdTree<P>, from: Vec3, radius: f32, visit: impl FnMut(Neighbour)) {
            search::within(tree, from, radius, visit);
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has what the function is compiled for.
            unsafe { wide(tree, from, radius, visit) }
        } else {
            search::within(tree, from, radius, visit);
        }
    }
}
