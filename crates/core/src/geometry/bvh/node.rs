//! What traversal reads from memory.

use glam::{Vec3, Vec4};

/// Children of a node.
pub(in crate::geometry) const WIDTH: usize = 8;
/// Triangles of a pack.
pub(in crate::geometry) const LANES: usize = 4;

/// What a slot of a node refers to, in 32 bits: an inner node, a pack of triangles, a curved shape or an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::geometry) struct Child(pub u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const OTHER: u32 = 1 << 30;
    const INSTANCE: u32 = 1 << 29;
    /// Mask of the index, and the number of nodes, packs, curved shapes or instances that a hierarchy can hold.
    pub const MAX: u32 = Child::INSTANCE - 1;

    pub fn node(index: u32) -> Child {
        Child(index)
    }
    pub fn pack(index: u32) -> Child {
        Child(Child::LEAF | index)
    }
    pub fn curved(index: u32) -> Child {
        Child(Child::LEAF | Child::OTHER | index)
    }
    pub fn instance(index: u32) -> Child {
        Child(Child::LEAF | Child::OTHER | Child::INSTANCE | index)
    }
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Child::LEAF != 0
    }
    /// Of a leaf: whether it holds no triangles.
    #[inline(always)]
    pub fn is_other(self) -> bool {
        self.0 & Child::OTHER != 0
    }
    /// Of a leaf without triangles: whether it is an instance.
    #[inline(always)]
    pub fn is_instance(self) -> bool {
        self.0 & Child::INSTANCE != 0
    }
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & Child::MAX) as usize
    }
}

/// An inner node: the boxes of up to eight children, by coordinate.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(in crate::geometry) struct Node {
    /// `bounds[axis][0]` are the lower, `bounds[axis][1]` the upper bounds.
    pub bounds: [[[f32; WIDTH]; 2]; 3],
    /// What the boxes hold.
    pub children: [Child; WIDTH],
}

impl Node {
    /// No child: boxes that no ray enters.
    pub const EMPTY: Node =
        Node { bounds: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3], children: [Child(u32::MAX); WIDTH] };

    pub fn set(&mut self, slot: usize, lo: Vec3, hi: Vec3, child: Child) {
        for axis in 0..3 {
            self.bounds[axis][0][slot] = lo[axis];
            self.bounds[axis][1][slot] = hi[axis];
        }
        self.children[slot] = child;
    }
}

/// Up to four triangles, by coordinate.
#[derive(Clone, Debug)]
#[repr(C)]
pub(in crate::geometry) struct Pack {
    /// `vertices[vertex][axis][lane]`; NaN in lanes not used, which no test passes.
    pub vertices: [[Vec4; 3]; 3],
    /// Primitive of each lane.
    pub primitives: [u32; LANES],
}

impl Pack {
    /// No triangle.
    pub const EMPTY: Pack = Pack { vertices: [[Vec4::NAN; 3]; 3], primitives: [u32::MAX; LANES] };

    pub fn set(&mut self, lane: usize, triangle: [Vec3; 3], primitive: u32) {
        for (vertex, p) in triangle.into_iter().enumerate() {
            for axis in 0..3 {
                self.vertices[vertex][axis][lane] = p[axis];
            }
        }
        self.primitives[lane] = primitive;
    }

    /// The vertices of one lane.
    #[inline(always)]
    pub fn triangle(&self, lane: usize) -> [Vec3; 3] {
        self.vertices.map(|v| Vec3::new(v[0][lane], v[1][lane], v[2][lane]))
    }
}
