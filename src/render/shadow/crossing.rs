//! What is left of light that passes through transparent things.

use super::Occluders;
use crate::geometry::opaque::Listed;
use crate::geometry::{NO_PRIMITIVE, NextCrossing, Stack};
use crate::math::V3;
use crate::render::frame::Frame;
use crate::render::gather::{self, Hits, bits};
use crate::render::leave;
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
            // Where several things touch, what shares an edge may not come one after the other.
            let mut recent = [Crossings { primitives: last_primitive, t: last_t }; RECENT];
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
                let this = Crossings { primitives, t: next.closest.t };
                let mut counts = found;
                for last in &recent {
                    counts &= !last.share_an_edge_with(simd, frame, &this, [origin, direction]);
                }
                recent.rotate_right(1);
                recent[0] = this;
                arriving = V3::select(counts, arriving * crossed, arriving);
                let dark = arriving.x.simd_eq(zero) & arriving.y.simd_eq(zero) & arriving.z.simd_eq(zero);
                limit = (found & !dark).select(limit, zero - 1.0);
                last_t = found.select(next.closest.t, last_t);
                last_primitive = found.select(primitives, last_primitive);
            }
        },
    )
}

/// Crossings that are remembered.
const RECENT: usize = 4;

/// A crossing of each lane.
#[derive(Clone, Copy)]
struct Crossings<S: Simd> {
    /// What is crossed, or [`NO_PRIMITIVE`].
    primitives: S::u32s,
    t: S::f32s,
}

impl<S: Simd> Crossings<S> {
    /// The lanes that cross the edge between two faces of an object: both are hit, at the same distance and from the same
    /// side, and it is one crossing.
    #[inline(always)]
    fn share_an_edge_with(
        &self,
        simd: S,
        frame: &Frame<'_>,
        next: &Self,
        [origin, direction]: [V3<S::f32s>; 2],
    ) -> <S::f32s as SimdBase<S>>::Mask {
        let nothing = S::u32s::splat(simd, NO_PRIMITIVE);
        let scale = origin.x.abs().max(origin.y.abs()).max(origin.z.abs()) + next.t;
        let near = (next.t - self.t).simd_le(leave::margin::<S>(scale));
        let both = self.primitives.simd_ne(nothing) & next.primitives.simd_ne(nothing) & near;
        let mut same = both.to_bitmask();
        let geometry = &frame.scene.geometry;
        for lane in bits(same) {
            let [a, b] = [self, next].map(|crossings| crossings.primitives.as_slice()[lane]);
            // One primitive that is met twice is curved: in and out again.
            if a == b || geometry.object_of(a) != geometry.object_of(b) {
                same &= !(1 << lane);
            }
        }
        if same != 0 {
            let from_behind = |crossings: &Self| {
                let hits = Hits::new(simd, crossings.primitives.as_slice());
                let normal = gather::surfaces(simd, frame, &hits, origin, direction, crossings.t).point.normal;
                normal.dot(direction).simd_gt(S::f32s::splat(simd, 0.0)).to_bitmask()
            };
            same &= !(from_behind(self) ^ from_behind(next));
        }
        <S::f32s as SimdBase<S>>::Mask::from_bitmask(simd, same)
    }
}
