//! What traversal reads from memory.

use crate::geometry::dispatch::ask_for_large_pages;
use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

/// Children of a node.
pub(in crate::geometry) const WIDTH: usize = 8;
/// Triangles of a pack.
pub(in crate::geometry) const LANES: usize = 4;

/// What a slot of a node refers to, in 32 bits: an inner node, a pack of triangles, a curved shape or an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(in crate::geometry) struct Child(pub u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const OTHER: u32 = 1 << 30;
    const INSTANCE: u32 = 1 << 29;
    /// Mask of the index, and the number of units, curved shapes or instances that a hierarchy can hold.
    pub const MAX: u32 = Child::INSTANCE - 1;

    /// The node that begins with a unit of the [`Arena`].
    pub fn node(unit: u32) -> Child {
        Child(unit)
    }
    /// The pack that begins with a unit of the [`Arena`].
    pub fn pack(unit: u32) -> Child {
        Child(Child::LEAF | unit)
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
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(in crate::geometry) struct Node {
    /// `bounds[axis][0]` are the lower, `bounds[axis][1]` the upper bounds.
    pub bounds: [[[f32; WIDTH]; 2]; 3],
    /// What the boxes hold, by how much it hides for the cost of looking, the most last.
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
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
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

/// What nodes and packs are made of: half a cache line.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub(in crate::geometry) struct Unit([u32; 8]);

/// Units of a node.
const NODE: usize = size_of::<Node>() / size_of::<Unit>();
/// Units of a pack.
const PACK: usize = size_of::<Pack>() / size_of::<Unit>();

/// Nodes and packs in one piece of memory, parents before children and what is near in space mostly near in memory.
#[derive(Debug, Default)]
pub(in crate::geometry) struct Arena(Vec<Unit>);

const THERE: &str = "a child refers to units that there are";

impl Arena {
    /// Adds a node without children; `None` when there is no room for more.
    pub fn push_node(&mut self) -> Option<Child> {
        let unit = self.push(bytemuck::must_cast::<Node, [Unit; NODE]>(Node::EMPTY))?;
        Some(Child::node(unit))
    }

    /// Adds a pack; `None` when there is no room for more.
    pub fn push_pack(&mut self, pack: Pack) -> Option<Child> {
        let unit = self.push(bytemuck::must_cast::<Pack, [Unit; PACK]>(pack))?;
        Some(Child::pack(unit))
    }

    fn push<const N: usize>(&mut self, units: [Unit; N]) -> Option<u32> {
        let unit = u32::try_from(self.0.len()).ok().filter(|unit| *unit <= Child::MAX)?;
        self.0.extend(units);
        Some(unit)
    }

    /// The node that a child refers to.
    #[inline(always)]
    pub fn node(&self, child: Child) -> &Node {
        bytemuck::must_cast_ref(self.units::<NODE>(child))
    }

    /// The same, to be filled.
    pub fn node_mut(&mut self, child: Child) -> &mut Node {
        bytemuck::must_cast_mut(self.0[child.index()..].first_chunk_mut::<NODE>().expect(THERE))
    }

    /// The pack that a child refers to.
    #[inline(always)]
    pub fn pack(&self, child: Child) -> &Pack {
        bytemuck::must_cast_ref(self.units::<PACK>(child))
    }

    #[inline(always)]
    fn units<const N: usize>(&self, child: Child) -> &[Unit; N] {
        self.0[child.index()..].first_chunk().expect(THERE)
    }

    /// Where the first unit is.
    #[inline(always)]
    pub fn start(&self) -> *const Unit {
        self.0.as_ptr()
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&self.0[..])
    }

    /// Moves everything to memory that holds it exactly and, where the system lets one ask, is of large pages: the walk of a
    /// ray jumps about in it, and every page that it comes to has to be looked up.
    pub fn settle(&mut self) {
        let mut settled = Vec::with_capacity(self.0.len());
        ask_for_large_pages(settled.spare_capacity_mut());
        settled.extend_from_slice(&self.0);
        self.0 = settled;
    }
}
