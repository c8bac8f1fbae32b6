//! What is left of light that passes through transparent things.

use super::Occluders;
use crate::geometry::opaque::Listed;
use crate::geometry::{NO_PRIMITIVE, NextCrossing, Stack};
use crate::math::V3;
use crate::render::frame::Frame;
use crate::render::gather;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Shadow rays on their way.
pub(super) struct Flight<S: Simd> {
    pub origin: V3<S::f32s>,
    /// Unit direction to the light.
    pub direction: V3<S::f32s>,
    /// The primitive that each ray leaves for good, or [`NO_PRIMITIVE`].
    pub sources: S::u32s,
    /// Where the light is; 0 for rays that are left out.
    pub limit: S::f32s,
}

/// What transparent things leave of the light: t·color at each crossing, multiplied in the order of (t, primitive).
pub(super) fn transmittance<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    occluders: &Occluders<'_, S>,
    flight: &Flight<S>,
    opaque: Listed<'_>,
    stack: &mut Stack,
) -> V3<S::f32s> {
    let &Flight { origin, direction, sources, limit } = flight;
    simd.vectorize(
        #[inline(always)]
        || {
            let zero = S::f32s::splat(simd, 0.0);
            let mut arriving: V3<S::f32s> = V3::all(S::f32s::splat(simd, 1.0));
            let (mut last_t, mut last_primitive) = (zero, S::u32s::splat(simd, NO_PRIMITIVE));
            // As for opaque occluders, the interval's end is exclusive.
            let open = limit.simd_gt(zero);
            let mut limit = open.select(S::f32s::from_bits(limit.to_bits() - 1), zero - 1.0);
            loop {
                let mut next = NextCrossing::new(simd, opaque, sources, (last_t, last_primitive), limit);
                occluders.visit(simd, origin, direction, stack, &mut next);
                let found = next.closest.primitive.simd_ne(S::u32s::splat(simd, NO_PRIMITIVE));
                if !found.any_true() {
                    return arriving;
                }
                let primitives = next.closest.primitive;
                let crossed = gather::transmission(simd, frame, &primitives, [origin, direction], next.closest.t);
                arriving = V3::select(found, arriving * crossed, arriving);
                let dark = arriving.x.simd_eq(zero) & arriving.y.simd_eq(zero) & arriving.z.simd_eq(zero);
                limit = (found & !dark).select(limit, zero - 1.0);
                last_t = found.select(next.closest.t, last_t);
                last_primitive = found.select(primitives, last_primitive);
            }
        },
    )
}
