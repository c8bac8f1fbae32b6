//! The walk of a ray through the tree of a shared mesh: which triangles it may meet.
//!
//! The ray is taken into the space of the mesh to be held against boxes, and for nothing else. What can be left out is
//! bounded by what the triangle kernel does in the world:
//!
//! - Whether it hits is decided as if each corner had been moved by some rounding errors of the coordinates in play. So
//!   the *line* of the ray passes the true triangle within [`SLACK`] of those: boxes are widened by what such a ball
//!   measures in the space of the mesh. Where on the line the box lies does not matter.
//! - The distance is a mean of the corners' own depths along the ray, all but for rounding. So it lies between the
//!   least and the greatest depth of anything in the box, widened as well. (The stretch of the line within the box says
//!   less than one might think: of triangles seen edge-on, the kernel's distance may lie outside of it.)

use super::{Instances, SharedTriangle};
use crate::geometry::beam::SLACK;
use crate::geometry::bvh::{Child, Leaf, WIDTH};
use crate::geometry::traverse::Pending;
use crate::geometry::{BLOCK, Block};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::Vec3;

/// Boxes are widened by this share of the largest coordinate of line and mesh, for the rounding of the walk's own tests.
const OWN_PADDING: f64 = 4e-6;
/// What the way into the mesh's space may be off by, as a share of the coordinates there.
const F64_PADDING: f64 = 1e-14;
/// Components of a direction below this are taken for this, so that no box test makes a NaN.
const LEAST_COMPONENT: f64 = 1e-30;
/// Triangles that are remembered for not being looked at again.
const RECENT: usize = 64;

/// Triangles that a ray may meet, in the world.
#[derive(Debug)]
pub(in crate::geometry) struct Met {
    /// Those of the last leaf.
    pub block: Block<10>,
    /// Some of those that were met before.
    recent: [u32; RECENT],
}

impl Met {
    /// None yet.
    pub const NONE: Self = Self { block: Block::EMPTY, recent: [u32::MAX; RECENT] };
}

/// What is left of a walk.
#[derive(Clone, Copy, Debug)]
enum Left {
    /// The subtrees that wait.
    Subtrees(usize),
    /// All leaves from this one on, whatever their boxes.
    Leaves(usize),
}

/// A ray on its way through an instance.
#[derive(Debug)]
pub(in crate::geometry) struct Walk<'a> {
    instances: &'a Instances,
    number: u32,
    /// A point of the line, moved either way by the padding.
    origin_plus: Vec3,
    origin_minus: Vec3,
    inverse: Vec3,
    /// The depth along the ray of a point p of the mesh's space is p·`deepening` + `depth`, give or take `slack`.
    deepening: Vec3,
    least_depth: f32,
    greatest_depth: f32,
    left: Left,
}

impl<'a> Walk<'a> {
    /// A ray that comes to an instance. Without room on the stack it looks at everything, and asks no box.
    pub fn new(instances: &'a Instances, number: u32, origin: Vec3, direction: Vec3, stack: &mut [Pending]) -> Self {
        let instance = &instances.placed[number as usize];
        let mesh = &instances.meshes[instance.mesh as usize];
        let (origin, direction) = (origin.as_dvec3(), direction.as_dvec3());
        let slack = f64::from(SLACK) * (origin.abs().max_element() + instance.reach);

        let from = instance.to_mesh.transform_point3(origin);
        let along = instance.to_mesh.matrix3 * direction;
        let along = along * along.length().recip();
        // The point of the line that is nearest to the middle of the mesh: numbers stay small wherever the ray starts.
        let point = from + along * (mesh.middle() - from).dot(along);
        let own = OWN_PADDING * (mesh.reach() + point.abs().max_element()) + F64_PADDING * from.abs().max_element();
        let padding = instance.ball * slack + own;
        let invert = |component: f64| (component.abs().max(LEAST_COMPONENT).copysign(component)).recip() as f32;

        let to_world = instance.to_world.matrix();
        let deepening = to_world.matrix3.transpose() * direction;
        let depth = direction.dot(to_world.translation - origin);
        let left = match stack.first_mut() {
            None => Left::Leaves(0),
            Some(root) => {
                *root = Pending { child: Child::Node(0), near: f32::NEG_INFINITY };
                Left::Subtrees(1)
            }
        };
        Self {
            instances,
            number,
            origin_plus: (point + padding).as_vec3(),
            origin_minus: (point - padding).as_vec3(),
            inverse: Vec3::new(invert(along.x), invert(along.y), invert(along.z)),
            deepening: deepening.as_vec3(),
            least_depth: (depth - slack) as f32,
            greatest_depth: (depth + slack) as f32,
            left,
        }
    }

    /// Goes a step on, to a node or a leaf, and leaves in `met` what the ray may meet there no farther away than `limit`:
    /// often nothing. False if there is no step left. Triangles that are in `met` already may be left out.
    ///
    /// A step is little work, whatever the mesh: who walks may give up between two.
    #[inline(always)]
    pub fn step<S: Simd>(&mut self, simd: S, limit: f32, stack: &mut [Pending], met: &mut Met) -> bool {
        met.block.len = 0;
        match self.left {
            Left::Leaves(leaf) => {
                if leaf >= self.leaves().len() {
                    return false;
                }
                self.left = Left::Leaves(leaf + 1);
                self.look_at(simd, leaf, None, met);
            }
            Left::Subtrees(0) => return false,
            Left::Subtrees(_) if limit < 0.0 => return false,
            Left::Subtrees(waiting) => {
                self.left = Left::Subtrees(waiting - 1);
                match stack[waiting - 1] {
                    Pending { near, .. } if near > limit => {}
                    Pending { child: Child::None | Child::Instance(_), .. } => {}
                    Pending { child: Child::Node(node), .. } => self.open(simd, node, limit, stack),
                    Pending { child: Child::Leaf(Leaf { block, .. }), .. } => {
                        self.look_at(simd, block as usize, Some(limit), met);
                    }
                }
            }
        }
        true
    }

    fn leaves(&self) -> &'a [super::shared::Triangles] {
        &self.instances.meshes[self.instances.placed[self.number as usize].mesh as usize].leaves
    }

    /// Lets those of a node's subtrees wait that the ray may meet.
    #[inline(always)]
    fn open<S: Simd>(&mut self, simd: S, node: u32, limit: f32, stack: &mut [Pending]) {
        let mesh = self.instances.placed[self.number as usize].mesh;
        let node = &self.instances.meshes[mesh as usize].nodes[node as usize];
        let Left::Subtrees(bottom) = self.left else { return };
        let Some(siblings) = stack.get_mut(bottom..bottom + WIDTH) else {
            // Deeper than any tree of ours: give up the order, never a hit.
            self.left = Left::Leaves(0);
            return;
        };
        let (mut places, nearest) = self.meets(simd, &node.min, &node.max, limit);
        let mut count = 0;
        while places != 0 {
            let place = places.trailing_zeros() as usize;
            places &= places - 1;
            let mut at = count;
            while at > 0 && siblings[at - 1].near < nearest[place] {
                siblings[at] = siblings[at - 1];
                at -= 1;
            }
            siblings[at] = Pending { child: node.children[place], near: nearest[place] };
            count += 1;
        }
        self.left = Left::Subtrees(bottom + count);
    }

    /// Moves triangles of a leaf to the world: all of them if there is no limit, else those that the ray may meet.
    #[inline(always)]
    fn look_at<S: Simd>(&self, simd: S, leaf: usize, limit: Option<f32>, met: &mut Met) {
        let triangles = &self.leaves()[leaf];
        let mut places = (1_u64 << triangles.len) - 1;
        if let Some(limit) = limit {
            places &= self.meets(simd, &triangles.min, &triangles.max, limit).0;
        }
        met.block.len = 0;
        let first = self.instances.placed[self.number as usize].first;
        while places != 0 {
            let triangle = triangles.numbers[places.trailing_zeros() as usize];
            places &= places - 1;
            let known = &mut met.recent[triangle as usize % RECENT];
            if *known != triangle {
                *known = triangle;
                let fields = self.instances.fields_of_solid(SharedTriangle { instance: self.number, triangle });
                if let Some(fields) = fields {
                    met.block.push(fields, first + triangle);
                }
            }
        }
    }

    /// Which of eight boxes the ray may meet something in, and how near that may be.
    #[inline(always)]
    fn meets<S: Simd>(&self, simd: S, min: &[[f32; WIDTH]; 3], max: &[[f32; WIDTH]; 3], limit: f32) -> (u64, f32x8<S>) {
        let mut enter = f32x8::splat(simd, f32::NEG_INFINITY);
        let mut leave = f32x8::splat(simd, f32::INFINITY);
        let mut nearest = f32x8::splat(simd, self.least_depth);
        let mut farthest = f32x8::splat(simd, self.greatest_depth);
        for axis in 0..3 {
            let (min, max) = (f32x8::from_slice(simd, &min[axis]), f32x8::from_slice(simd, &max[axis]));
            let inverse = self.inverse[axis];
            let to_min = (min - self.origin_plus[axis]) * inverse;
            let to_max = (max - self.origin_minus[axis]) * inverse;
            enter = enter.max(to_min.min(to_max));
            leave = leave.min(to_min.max(to_max));
            let (at_min, at_max) = (min * self.deepening[axis], max * self.deepening[axis]);
            nearest += at_min.min(at_max);
            farthest += at_min.max(at_max);
        }
        let zero = f32x8::splat(simd, 0.0);
        let met = enter.simd_le(leave) & nearest.simd_le(f32x8::splat(simd, limit)) & farthest.simd_ge(zero);
        (met.to_bitmask(), nearest)
    }
}

const _: () = assert!(BLOCK == WIDTH, "what is met in a leaf fits a block");
