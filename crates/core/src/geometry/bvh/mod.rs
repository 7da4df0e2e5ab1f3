//! The bounding volume hierarchy: eight-wide nodes over packs of up to four triangles.
//!
//! Built once ([`build`]), then read only ([`traverse`]). Nodes and packs hold all that traversal touches and nothing else.
//!
//! **Nothing leaks.** The triangle test decides on which side of an edge a ray passes from the edge's two vertices and the
//! ray alone, so two triangles that share the edge agree. [Woop et al. 2013] It sees the vertices rounded by some units
//! in the last place of their distance from the ray's origin. Two allowances make the box test admit every hit: the boxes
//! of triangles are padded relative to their extent, and the far distance is stretched relative to itself, which covers
//! the rest of that rounding, in proportion to the distance, and the rounding of the box test. [Ize 2013]

mod build;
mod collapse;
mod node;
mod prepared;
mod repack;
mod split;
mod stack;
mod topology;
pub(super) mod traverse;

pub(super) use build::{Kind, Reference};
pub(super) use node::{Arena, Child, Node, Pack, WIDTH};
pub(super) use prepared::{Prepared, ROW};

use glam::Vec3;

/// A hierarchy over the primitives of the top level, or of one group.
#[derive(Debug, Default)]
pub(super) struct Bvh {
    /// Inner nodes, and leaves of triangles.
    arena: Arena,
    /// Where traversal starts; `None` when there is nothing.
    root: Option<Child>,
    /// Entries that a traversal stack can need.
    stack: usize,
    /// Bounds of everything.
    bounds: Option<(Vec3, Vec3)>,
}

impl Bvh {
    /// Bounds of everything, `None` when there is nothing.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.bounds
    }

    /// Bytes of nodes and packs.
    pub fn memory_bytes(&self) -> usize {
        self.arena.memory_bytes()
    }
}
