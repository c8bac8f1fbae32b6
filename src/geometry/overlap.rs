//! Primitives whose bounds overlap a box.

use super::bvh::{Bvh, Child, Leaf, Node, WIDTH};
use super::primitive::{Cone, Cutout, Disk, Plane, Sphere, Triangle, for_each_primitive};
use super::{Aabb, Geometry, PrimitiveIndex, PrimitiveKind};

impl Geometry {
    /// Calls `visit` for every primitive whose bounds overlap `within`; those of planes are infinite.
    pub(super) fn overlapping(&self, within: &Aabb, visit: &mut impl FnMut(PrimitiveIndex)) {
        match &self.bvh {
            Some(bvh) => {
                self.visit_blocks(&[PrimitiveKind::Plane], within, visit);
                self.overlapping_in_tree(bvh, within, visit);
            }
            // Where there are instances, there is a tree.
            None => self.visit_blocks(PrimitiveKind::ALL, within, visit),
        }
    }

    fn visit_blocks(&self, kinds: &[PrimitiveKind], within: &Aabb, visit: &mut impl FnMut(PrimitiveIndex)) {
        for &kind in kinds {
            for block in 0..self.blocks_of(kind) as u32 {
                self.overlapping_in_leaf(Leaf { kind, block }, within, visit);
            }
        }
    }

    fn overlapping_in_tree(&self, bvh: &Bvh, within: &Aabb, visit: &mut impl FnMut(PrimitiveIndex)) {
        let mut waiting = vec![Child::Node(0)];
        while let Some(child) = waiting.pop() {
            match child {
                Child::None => {}
                Child::Leaf(leaf) => self.overlapping_in_leaf(leaf, within, visit),
                Child::Instance(number) => self.instances.overlapping(number, within, visit),
                Child::Node(number) => {
                    let node = &bvh.nodes[number as usize];
                    waiting.extend((0..WIDTH).filter(|&place| overlaps(node, place, within)).map(|i| node.children[i]));
                }
            }
        }
    }
}

/// Whether a child's box overlaps `within`.
fn overlaps(node: &Node, place: usize, within: &Aabb) -> bool {
    (0..3).all(|axis| node.min[axis][place] <= within.max[axis] && node.max[axis][place] >= within.min[axis])
}

macro_rules! define_leaf_overlaps {
    ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
        impl Geometry {
            fn overlapping_in_leaf(&self, leaf: Leaf, within: &Aabb, visit: &mut impl FnMut(PrimitiveIndex)) {
                match leaf.kind {
                    $(PrimitiveKind::$kernel => {
                        let block = &self.$blocks[leaf.block as usize];
                        for place in 0..block.len as usize {
                            if block.bounds_of::<$kernel>(place).overlaps(within) {
                                visit(block.indices[place]);
                            }
                        }
                    })+
                }
            }
        }
    };
}
for_each_primitive!(define_leaf_overlaps);
