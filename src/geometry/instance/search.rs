//! Searches that come to an instance.

use super::walk::{Met, Walk};
use crate::geometry::primitive::Kernel;
use crate::geometry::single::{Ray, show};
use crate::geometry::traverse::Pending;
use crate::geometry::{Packet, PrimitiveIndex, Rays, Search, Triangle, Visitor};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

impl Search<'_> {
    /// Shows `visitor` every hit on an instance that can matter to it. Without room on the stack every triangle is tested.
    pub(in crate::geometry) fn visit_instance<S: Simd, V: Visitor<S>>(
        &self,
        simd: S,
        number: u32,
        packet: &Packet<S>,
        stack: &mut [Pending],
        visitor: &mut V,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let mut met = Met::NONE;
                let passes_backs = visitor.passes_backs() && self.geometry.instances.placed[number as usize].one_sided;
                for lane in 0..S::f32s::LEN {
                    if visitor.lane_limit(lane) < 0.0 {
                        continue;
                    }
                    let (origin, direction) = (packet.rays.origin.lane(lane), packet.rays.direction.lane(lane));
                    let mut walk = Walk::new(&self.geometry.instances, number, origin, direction, stack);
                    while walk.step(simd, visitor.lane_limit(lane), stack, &mut met) {
                        // All rays are tested: what one may meet others are likely to.
                        for place in 0..met.block.len as usize {
                            let fields = met.block.splat(simd, place);
                            test_triangle::<S, V>(
                                met.block.indices[place],
                                &fields,
                                &packet.rays,
                                passes_backs,
                                visitor,
                            );
                        }
                    }
                    if stack.is_empty() {
                        return;
                    }
                }
            },
        );
    }

    /// [`visit_instance`](Self::visit_instance) for one ray of a packet.
    pub(in crate::geometry) fn visit_instance_by_ray<S: Simd, V: Visitor<S>>(
        &self,
        simd: S,
        number: u32,
        ray: &Ray<S>,
        stack: &mut [Pending],
        visitor: &mut V,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let mut met = Met::NONE;
                let passes_backs = visitor.passes_backs() && self.geometry.instances.placed[number as usize].one_sided;
                let (origin, direction) = (ray.rays.origin.lane(0), ray.rays.direction.lane(0));
                let mut walk = Walk::new(&self.geometry.instances, number, origin, direction, stack);
                while walk.step(simd, visitor.lane_limit(ray.lane), stack, &mut met) {
                    if met.block.len == 0 {
                        continue;
                    }
                    let indices = &met.block.indices;
                    let t_min = visitor.lane_t_min(simd, ray.lane, indices);
                    let fields = met.block.load(simd);
                    let (mask, t) = if passes_backs {
                        Triangle::intersect_front(&fields, &ray.rays, t_min)
                    } else {
                        Triangle::intersect(&fields, &ray.rays, t_min)
                    };
                    let used = (1_u64 << met.block.len) - 1;
                    show(ray.lane, mask.to_bitmask() & used, t, indices, visitor);
                }
            },
        );
    }

    /// Tests one triangle of a shared mesh.
    pub(in crate::geometry) fn test_shared<S: Simd, V: Visitor<S>>(
        &self,
        simd: S,
        primitive: PrimitiveIndex,
        rays: &Rays<S::f32s>,
        visitor: &mut V,
    ) {
        let own = self.geometry.shared_fields(primitive);
        simd.vectorize(
            #[inline(always)]
            || {
                let mut fields = [S::f32s::splat(simd, 0.0); 10];
                for (field, own) in fields.iter_mut().zip(own) {
                    *field = S::f32s::splat(simd, own);
                }
                test_triangle::<S, V>(primitive, &fields, rays, self.passes_backs(visitor), visitor);
            },
        );
    }
}

#[inline(always)]
fn test_triangle<S: Simd, V: Visitor<S>>(
    primitive: PrimitiveIndex,
    fields: &[S::f32s; 10],
    rays: &Rays<S::f32s>,
    passes_backs: bool,
    visitor: &mut V,
) {
    if visitor.accepts(primitive) {
        let t_min = visitor.t_min(primitive);
        let (mask, t) = if passes_backs {
            Triangle::intersect_front(fields, rays, t_min)
        } else {
            Triangle::intersect(fields, rays, t_min)
        };
        visitor.hit(mask & t.simd_le(visitor.limit()), t, primitive);
    }
}
