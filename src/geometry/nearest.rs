//! The nearest point of any surface: what a body that must not touch anything asks for.
//!
//! Without direction, so without gaps: whatever is near enough to matter is found, however thin. In f64 and one point
//! at a time; a few dozen of these are asked for between two frames, where a frame asks for millions of rays.

use super::bvh::{Bvh, Child, Leaf, Node, WIDTH};
use super::primitive::{Cone, Cutout, Disk, Kernel, Plane, Sphere, Triangle, for_each_primitive};
use super::{Geometry, PrimitiveKind};
use glam::DVec3;

/// The nearest point found so far.
pub(super) struct Nearest {
    pub point: DVec3,
    /// Squared distance within which a surface is of interest.
    pub within: f64,
    found: Option<DVec3>,
}

impl Nearest {
    pub fn offer(&mut self, candidate: DVec3) {
        let distance = candidate.distance_squared(self.point);
        if distance < self.within {
            self.within = distance;
            self.found = Some(candidate);
        }
    }
}

impl Geometry {
    /// The point of any surface that is nearest to `point`, if there is one closer than `within`. Holes are filled.
    pub fn nearest(&self, point: DVec3, within: f64) -> Option<DVec3> {
        let mut nearest = Nearest { point, within: within * within, found: None };
        match &self.bvh {
            Some(bvh) => {
                self.offer_all(&[PrimitiveKind::Plane], &mut nearest);
                self.offer_tree(bvh, &mut nearest);
            }
            None => self.offer_all(PrimitiveKind::ALL, &mut nearest),
        }
        nearest.found
    }

    fn offer_all(&self, kinds: &[PrimitiveKind], nearest: &mut Nearest) {
        for &kind in kinds {
            for block in 0..self.blocks_of(kind) as u32 {
                self.offer_leaf(Leaf { kind, block }, nearest);
            }
        }
    }

    fn offer_tree(&self, bvh: &Bvh, nearest: &mut Nearest) {
        let mut waiting = vec![(0.0, Child::Node(0))];
        while let Some((distance, child)) = waiting.pop() {
            if distance >= nearest.within {
                continue;
            }
            match child {
                Child::None => {}
                Child::Leaf(leaf) => self.offer_leaf(leaf, nearest),
                Child::Instance(number) => self.instances.offer_nearest(number, nearest),
                Child::Node(number) => {
                    let node = &bvh.nodes[number as usize];
                    let before = waiting.len();
                    let children =
                        (0..WIDTH).map(|place| (box_distance(node, place, nearest.point), node.children[place]));
                    waiting.extend(children.filter(|(distance, _)| *distance < nearest.within));
                    // The nearest on top.
                    waiting[before..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
                }
            }
        }
    }
}

/// The squared distance of a point from a child's box; of a point inside, 0.
fn box_distance(node: &Node, place: usize, point: DVec3) -> f64 {
    (0..3)
        .map(|axis| {
            let (min, max) = (f64::from(node.min[axis][place]), f64::from(node.max[axis][place]));
            let outside = (min - point[axis]).max(point[axis] - max).max(0.0);
            outside * outside
        })
        .sum()
}

macro_rules! define_leaf_offers {
    ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
        impl Geometry {
            fn offer_leaf(&self, leaf: Leaf, nearest: &mut Nearest) {
                match leaf.kind {
                    $(PrimitiveKind::$kernel => {
                        let block = &self.$blocks[leaf.block as usize];
                        for place in 0..block.len as usize {
                            nearest.offer($kernel::nearest_to(&block.get(place), nearest.point));
                        }
                    })+
                }
            }
        }
    };
}
for_each_primitive!(define_leaf_offers);
