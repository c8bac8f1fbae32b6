//! Rays that do not keep together: one ray at a time against eight boxes, then against eight primitives.
//!
//! A packet whose rays fly apart visits the union of what they need. Such packets come here instead, lane by lane,
//! with the same kernels, so the same hits.

use super::bvh::{Bvh, Child, Leaf, Node};
use super::holes::Places;
use super::primitive::{Cone, Cutout, Disk, Kernel, Plane, Sphere, Triangle, for_each_primitive};
use super::traverse::{Pending, STACK};
use super::{BLOCK, Block, Packet, PrimitiveIndex, PrimitiveKind, Rays, Search, SphereTerms, Visitor};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::Vec3;

/// One ray of a packet.
pub(super) struct Ray<S: Simd> {
    pub lane: usize,
    pub rays: Rays<f32x8<S>>,
    origin_plus: Vec3,
    origin_minus: Vec3,
    inverse: Vec3,
}

impl<S: Simd> Ray<S> {
    #[inline(always)]
    fn of_packet(simd: S, packet: &Packet<S>, lane: usize) -> Self {
        let (origin, padding) = (packet.rays.origin.lane(lane), packet.padding());
        Self {
            lane,
            rays: Rays::splat(simd, &packet.rays, lane),
            origin_plus: origin + padding,
            origin_minus: origin - padding,
            inverse: packet.rays.inverse_of(lane),
        }
    }

    /// Which of a node's padded boxes the ray enters before `limit`, and how far away: the arithmetic of
    /// [`Packet::enter_box`], eight boxes at once.
    #[inline(always)]
    fn enter_boxes(&self, simd: S, node: &Node, limit: f32) -> (u64, f32x8<S>) {
        let mut near = f32x8::splat(simd, 0.0);
        let mut far = f32x8::splat(simd, limit);
        for axis in 0..3 {
            let inverse = self.inverse[axis];
            let to_min = (f32x8::from_slice(simd, &node.min[axis]) - self.origin_plus[axis]) * inverse;
            let to_max = (f32x8::from_slice(simd, &node.max[axis]) - self.origin_minus[axis]) * inverse;
            let (entry, exit) = if inverse < 0.0 { (to_max, to_min) } else { (to_min, to_max) };
            near = near.max(entry);
            far = far.min(exit);
        }
        (near.simd_le(far).to_bitmask(), near)
    }
}

impl Search<'_> {
    /// Walks the tree for each ray of a packet on its own.
    #[inline(always)]
    pub(super) fn visit_tree_by_rays<S: Simd, V: Visitor<S>>(
        &self,
        simd: S,
        bvh: &Bvh,
        packet: &Packet<S>,
        stack: &mut [Pending; STACK],
        visitor: &mut V,
    ) {
        for lane in 0..S::f32s::LEN {
            if visitor.lane_limit(lane) >= 0.0 {
                let ray = Ray::of_packet(simd, packet, lane);
                self.visit_tree_by_ray(simd, bvh, &ray, stack, visitor);
            }
        }
    }

    #[inline(always)]
    fn visit_tree_by_ray<S: Simd, V: Visitor<S>>(
        &self,
        simd: S,
        bvh: &Bvh,
        ray: &Ray<S>,
        stack: &mut [Pending; STACK],
        visitor: &mut V,
    ) {
        stack[0] = Pending { child: Child::Node(0), near: 0.0 };
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let Pending { child, near } = stack[depth];
            let limit = visitor.lane_limit(ray.lane);
            if near > limit {
                if limit < 0.0 {
                    return;
                }
                continue;
            }
            let node = match child {
                Child::None => continue,
                Child::Leaf(leaf) => {
                    self.visit_leaf_by_ray(simd, leaf, ray, visitor);
                    continue;
                }
                Child::Node(number) => &bvh.nodes[number as usize],
                Child::Instance(number) => {
                    self.visit_instance_by_ray(simd, number, ray, &mut stack[depth..], visitor);
                    continue;
                }
            };
            let (mut candidates, distances) = ray.enter_boxes(simd, node, limit);
            let bottom = depth;
            while candidates != 0 && depth < STACK {
                let place = candidates.trailing_zeros() as usize;
                candidates &= candidates - 1;
                let near = distances[place];
                Pending { child: node.children[place], near }.insert(stack, bottom..depth);
                depth += 1;
            }
        }
    }
}

/// Shows `visitor` the hits in a bit set that a lane has on eight primitives.
#[inline(always)]
pub(super) fn show<S: Simd, V: Visitor<S>>(
    lane: usize,
    mut hits: u64,
    t: f32x8<S>,
    primitives: &[PrimitiveIndex; BLOCK],
    visitor: &mut V,
) {
    while hits != 0 {
        let place = hits.trailing_zeros() as usize;
        hits &= hits - 1;
        let primitive = primitives[place];
        if t[place] <= visitor.lane_limit(lane) && visitor.accepts(primitive) {
            visitor.lane_hit(lane, t[place], primitive);
        }
    }
}

/// Distances to eight primitives: spheres by the terms at hand, all others by the method `$intersect` of their kernel.
macro_rules! test {
    (Sphere, $intersect:ident, $blocks:ident, $search:ident, $simd:ident, $block:expr, $ray:ident, $t_min:ident) => {
        match $search.sphere_terms {
            SphereTerms::None => Sphere::intersect(&$search.geometry.spheres[$block].load($simd), &$ray.rays, $t_min),
            SphereTerms::Exact(terms) => {
                Sphere::intersect_terms(&terms[$block].load($simd), $ray.rays.direction, $t_min)
            }
            SphereTerms::Difference(terms) => {
                Sphere::intersect_difference(&terms[$block].load($simd), $ray.rays.direction, $t_min)
            }
        }
    };
    ($kernel:ident, $intersect:ident, $blocks:ident, $search:ident, $simd:ident, $block:expr, $ray:ident, $t_min:ident) => {{
        let fields = $search.geometry.$blocks[$block].load($simd);
        let (mut mask, t) = $kernel::$intersect(&fields, &$ray.rays, $t_min);
        if $kernel::HAS_HOLES {
            mask = $search.geometry.meets_no_hole($simd, &fields, &$ray.rays, mask, $block as u32, Places::OwnLane);
        }
        (mask, t)
    }};
}

macro_rules! define_leaf_tests {
    ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
        impl Search<'_> {
            /// Tests one ray against the primitives of a leaf, all at once.
            fn visit_leaf_by_ray<S: Simd, V: Visitor<S>>(&self, simd: S, leaf: Leaf, ray: &Ray<S>, visitor: &mut V) {
                simd.vectorize(
                    #[inline(always)]
                    || match leaf.kind {
                        $(PrimitiveKind::$kernel => {
                            let number = leaf.block as usize;
                            let Block { indices, len, .. } = &self.geometry.$blocks[number];
                            let t_min = visitor.lane_t_min(simd, ray.lane, indices);
                            let (mask, t) = if $kernel::HAS_SIDES && self.passes_backs(visitor) {
                                test!($kernel, intersect_front, $blocks, self, simd, number, ray, t_min)
                            } else {
                                test!($kernel, intersect, $blocks, self, simd, number, ray, t_min)
                            };
                            let used = (1_u64 << len) - 1;
                            show(ray.lane, mask.to_bitmask() & used, t, indices, visitor);
                        })+
                    },
                );
            }
        }
    };
}
for_each_primitive!(define_leaf_tests);

const _: () = assert!(BLOCK == 8, "a block's primitives fill eight lanes");
