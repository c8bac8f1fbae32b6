//! An eight-wide bounding volume hierarchy over blocks of primitives.

mod build;
mod cluster;
mod reinsert;

pub use build::{LeafMembers, build};

use super::{Aabb, PrimitiveKind};

/// Children of a node.
pub const WIDTH: usize = 8;

/// A leaf: one block of one type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaf {
    /// Type of its primitives.
    pub kind: PrimitiveKind,
    /// Index among the blocks of that type.
    pub block: u32,
}

/// What a child of a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Child {
    /// Nothing; its box is empty.
    None,
    /// Another node.
    Node(u32),
    /// A block of primitives.
    Leaf(Leaf),
    /// An instance of a mesh that has a tree of its own.
    Instance(u32),
}

/// Eight boxes, coordinate by coordinate, and what is in them.
#[derive(Clone, Debug)]
pub struct Node {
    /// Least corners: `min[axis][child]`.
    pub min: [[f32; WIDTH]; 3],
    /// Greatest corners: `max[axis][child]`.
    pub max: [[f32; WIDTH]; 3],
    /// What is in each box.
    pub children: [Child; WIDTH],
}

/// Corner of an empty child's inverted box: finite, so that no arithmetic on it makes a NaN.
const FAR: f32 = 1e30;

impl Node {
    const EMPTY: Self = Self { min: [[FAR; WIDTH]; 3], max: [[-FAR; WIDTH]; 3], children: [Child::None; WIDTH] };

    fn set(&mut self, place: usize, bounds: Aabb, child: Child) {
        for axis in 0..3 {
            self.min[axis][place] = bounds.min[axis];
            self.max[axis][place] = bounds.max[axis];
        }
        self.children[place] = child;
    }
}

/// The tree. Node 0 is the root.
#[derive(Debug)]
pub struct Bvh {
    /// Nodes, parents before children.
    pub nodes: Vec<Node>,
    /// How many leaves there are.
    pub leaves: usize,
}

impl Bvh {
    /// Bytes held, by capacity.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
    }
}
