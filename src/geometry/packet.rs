//! One ray a lane, with what a box test needs of it.

use super::bvh::{Node, WIDTH};
use super::primitive::HIT_PADDING;
use super::{Geometry, Rays};
use crate::math::V3;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};
use glam::Vec3;

/// Boxes are widened by this share of the largest coordinate in play. A kernel's hit can lie outside of the true
/// shape by a few rounding errors of its operands, each at most 2^-24 of that coordinate; boxes must not cull it.
const BOX_PADDING: f32 = 4e-6;

/// Packets whose directions differ by more than this in some component are traced ray by ray. Measured: packets
/// win by 2-4 where rays keep together and lose by as much where they do not; between 0.2 and 0.6 little changes.
const MOST_SPREAD: f32 = 0.3;

/// A packet of rays, one a lane.
#[derive(Clone, Copy, Debug)]
pub struct Packet<S: Simd> {
    /// The rays.
    pub rays: Rays<S::f32s>,
    padding: f32,
    reach: Reach,
}

/// Intervals over all lanes of a packet, axis by axis, for testing a box against all of its rays at once.
#[derive(Clone, Copy, Debug)]
struct Reach {
    origin_min: Vec3,
    origin_max: Vec3,
    inverse_min: Vec3,
    inverse_max: Vec3,
}

impl<S: Simd> Packet<S> {
    /// A packet in the space of `geometry`.
    #[inline(always)]
    pub fn new(geometry: &Geometry, origin: V3<S::f32s>, direction: V3<S::f32s>) -> Self {
        let rays = Rays::new(origin, direction);
        let reach = Reach {
            origin_min: least_lanes::<S>(origin),
            origin_max: largest_lanes::<S>(origin),
            inverse_min: least_lanes::<S>(rays.inverse),
            inverse_max: largest_lanes::<S>(rays.inverse),
        };
        let farthest = reach.origin_min.abs().max(reach.origin_max.abs()).max_element();
        Self { rays, padding: (farthest + geometry.reach()) * BOX_PADDING, reach }
    }

    /// How far beyond their faces boxes reach.
    #[inline(always)]
    pub(super) fn padding(&self) -> f32 {
        self.padding
    }

    /// Whether the rays fly close enough together to share a walk through the tree.
    #[inline(always)]
    pub fn is_coherent(&self) -> bool {
        let spread = largest_lanes::<S>(self.rays.direction) - least_lanes::<S>(self.rays.direction);
        spread.max_element() < MOST_SPREAD
    }

    /// Which of a node's boxes any ray of the packet could enter before `limit`: an overestimate of
    /// [`enter_box`](Self::enter_box), eight boxes at once.
    #[inline(always)]
    pub fn may_enter(&self, simd: S, node: &Node, limit: f32) -> u32 {
        type Boxes<S> = f32x8<S>;
        let mut near = Boxes::splat(simd, 0.0);
        let mut far = Boxes::splat(simd, limit);
        for axis in 0..3 {
            let (inverse_min, inverse_max) = (self.reach.inverse_min[axis], self.reach.inverse_max[axis]);
            if (inverse_min < 0.0) != (inverse_max < 0.0) {
                continue;
            }
            // The same operations as in `enter_box`, at the ends of the intervals: rounding is monotonic,
            // so that no lane's own result lies outside.
            let to_min = Boxes::from_slice(simd, &node.min[axis]) - (self.reach.origin_max[axis] + self.padding);
            let to_max = Boxes::from_slice(simd, &node.max[axis]) - (self.reach.origin_min[axis] - self.padding);
            let (entry, exit) = if inverse_max < 0.0 { (to_max, to_min) } else { (to_min, to_max) };
            near = near.max((entry * inverse_min).min(entry * inverse_max));
            far = far.min((exit * inverse_min).max(exit * inverse_max));
        }
        let mask: mask32x8<S> = near.simd_le(far);
        mask.to_bitmask() as u32
    }

    /// Which rays enter a padded box before their `limit`, and how far away.
    #[inline(always)]
    pub fn enter_box(&self, node: &Node, child: usize, limit: S::f32s) -> (<S::f32s as SimdBase<S>>::Mask, S::f32s) {
        let (near_x, far_x) =
            self.slab(node.min[0][child], node.max[0][child], self.rays.origin.x, self.rays.inverse.x);
        let (near_y, far_y) =
            self.slab(node.min[1][child], node.max[1][child], self.rays.origin.y, self.rays.inverse.y);
        let (near_z, far_z) =
            self.slab(node.min[2][child], node.max[2][child], self.rays.origin.z, self.rays.inverse.z);
        let zero = S::f32s::splat(limit.token(), 0.0);
        let near = near_x.max(near_y).max(near_z.max(zero));
        let far = far_x.min(far_y).min(far_z.min(limit));
        // At equal distance a box is not skipped: what is in it may win the tie.
        (near.simd_le(far), near)
    }

    /// Where rays enter and leave the space between two padded planes across one axis.
    #[inline(always)]
    fn slab(&self, min: f32, max: f32, origin: S::f32s, inverse: S::f32s) -> (S::f32s, S::f32s) {
        let simd = origin.token();
        let to_min = (S::f32s::splat(simd, min) - (origin + self.padding)) * inverse;
        let to_max = (S::f32s::splat(simd, max) - (origin - self.padding)) * inverse;
        (to_min.min(to_max), to_min.max(to_max))
    }
}

const _: () = assert!(BOX_PADDING >= 2.0 * HIT_PADDING, "no box hides a hit, its own rounding included");

const _: () = assert!(WIDTH == 8, "a node's boxes fill eight lanes");

// Functions, not closures: those would not be inlined into the code of their SIMD level.

/// The least of all lanes, component by component.
#[inline(always)]
fn least_lanes<S: Simd>(v: V3<S::f32s>) -> Vec3 {
    Vec3::new(v.x.reduce_min(), v.y.reduce_min(), v.z.reduce_min())
}

/// The largest of all lanes, component by component.
#[inline(always)]
fn largest_lanes<S: Simd>(v: V3<S::f32s>) -> Vec3 {
    Vec3::new(v.x.reduce_max(), v.y.reduce_max(), v.z.reduce_max())
}
