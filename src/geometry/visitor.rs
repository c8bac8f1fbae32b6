//! What a traversal does with the hits it finds.

use super::opaque::Listed;
use super::{BLOCK, NO_PRIMITIVE, Opaque, PrimitiveIndex};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

/// Lane mask of native width.
pub type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// Receives the hits of a packet.
pub trait Visitor<S: Simd> {
    /// Whether what is seen from one side only lets rays through from behind, as for rays that look for what is seen.
    /// Light and walkers are stopped from either side.
    #[inline(always)]
    fn passes_backs(&self) -> bool {
        false
    }

    /// Whether a primitive takes part at all.
    #[inline(always)]
    fn accepts(&mut self, _primitive: PrimitiveIndex) -> bool {
        true
    }

    /// Lanes for which hits on `primitive` do not count.
    #[inline(always)]
    fn excludes(&self, simd: S, _primitive: PrimitiveIndex) -> Mask<S> {
        Mask::<S>::splat(simd, false)
    }

    /// Distance beyond which (exclusive) a hit on `primitive` counts.
    fn t_min(&self, primitive: PrimitiveIndex) -> S::f32s;

    /// Greatest distance (inclusive) that is still of interest; negative for lanes that are finished.
    fn limit(&self) -> S::f32s;

    /// A hit of the masked lanes, at distances within the interval.
    fn hit(&mut self, mask: Mask<S>, t: S::f32s, primitive: PrimitiveIndex);

    /// Whether no lane has any interest left.
    fn is_finished(&self) -> bool;

    /// [`limit`](Self::limit) of one lane.
    fn lane_limit(&self, lane: usize) -> f32;

    /// [`t_min`](Self::t_min) of one lane towards each of eight primitives.
    fn lane_t_min(&self, simd: S, lane: usize, primitives: &[PrimitiveIndex; BLOCK]) -> f32x8<S>;

    /// [`hit`](Self::hit) of one lane.
    fn lane_hit(&mut self, lane: usize, t: f32, primitive: PrimitiveIndex);
}

/// Finds the minimum of (t, primitive) a lane, of what is seen.
#[derive(Clone, Copy, Debug)]
pub struct ClosestHit<S: Simd> {
    t_min: S::f32s,
    /// Distance of the best hit so far, or the limit that it was made with where nothing was hit.
    pub t: S::f32s,
    /// The primitive that was hit, or [`NO_PRIMITIVE`].
    pub primitive: S::u32s,
}

impl<S: Simd> ClosestHit<S> {
    /// Nothing hit yet; hits count in (`t_min`, `t_max`].
    #[inline(always)]
    pub fn new(simd: S, t_min: S::f32s, t_max: S::f32s) -> Self {
        Self { t_min, t: t_max.min(S::f32s::splat(simd, f32::MAX)), primitive: S::u32s::splat(simd, NO_PRIMITIVE) }
    }
}

impl<S: Simd> Visitor<S> for ClosestHit<S> {
    #[inline(always)]
    fn passes_backs(&self) -> bool {
        true
    }

    #[inline(always)]
    fn t_min(&self, _primitive: PrimitiveIndex) -> S::f32s {
        self.t_min
    }

    #[inline(always)]
    fn limit(&self) -> S::f32s {
        self.t
    }

    #[inline(always)]
    fn hit(&mut self, mask: Mask<S>, t: S::f32s, primitive: PrimitiveIndex) {
        let index = S::u32s::splat(t.token(), primitive);
        let wins = mask & (t.simd_lt(self.t) | (t.simd_eq(self.t) & index.simd_lt(self.primitive)));
        self.t = wins.select(t, self.t);
        self.primitive = wins.select(index, self.primitive);
    }

    #[inline(always)]
    fn is_finished(&self) -> bool {
        false
    }

    #[inline(always)]
    fn lane_limit(&self, lane: usize) -> f32 {
        self.t[lane]
    }

    #[inline(always)]
    fn lane_t_min(&self, simd: S, lane: usize, _primitives: &[PrimitiveIndex; BLOCK]) -> f32x8<S> {
        f32x8::splat(simd, self.t_min[lane])
    }

    #[inline(always)]
    fn lane_hit(&mut self, lane: usize, t: f32, primitive: PrimitiveIndex) {
        if t < self.t[lane] || (t == self.t[lane] && primitive < self.primitive[lane]) {
            self.t[lane] = t;
            self.primitive[lane] = primitive;
        }
    }
}

/// Finds whether anything lies in the way, and remembers one thing that does.
#[derive(Clone, Copy)]
pub struct AnyHit<'a, S: Simd> {
    limit: S::f32s,
    sources: S::u32s,
    opaque: Opaque<'a>,
    /// Lanes with something in the way.
    pub blocked: Mask<S>,
    /// The primitive found last, or [`NO_PRIMITIVE`].
    pub blocker: PrimitiveIndex,
    /// Whether something transparent was passed over. If not, a finished traversal proves that no ray that is not
    /// blocked crosses anything.
    pub passed_transparent: bool,
}

impl<'a, S: Simd> AnyHit<'a, S> {
    /// Nothing found yet; hits count in (0, `limit`), and lanes with a limit of 0 or less are left alone. A lane's
    /// `source` is a primitive that it cannot hit, or [`NO_PRIMITIVE`].
    #[inline(always)]
    pub fn new(simd: S, limit: S::f32s, sources: S::u32s, opaque: Opaque<'a>) -> Self {
        let limit = limit.min(S::f32s::splat(simd, f32::MAX));
        // The interval's end is exclusive: what lies at the light does not shadow it.
        let zero = S::f32s::splat(simd, 0.0);
        let below = S::f32s::from_bits(limit.to_bits() - 1);
        let limit = limit.simd_gt(zero).select(below, zero - 1.0);
        let blocked = Mask::<S>::splat(simd, false);
        Self { limit, sources, opaque, blocked, blocker: NO_PRIMITIVE, passed_transparent: false }
    }
}

impl<S: Simd> Visitor<S> for AnyHit<'_, S> {
    #[inline(always)]
    fn accepts(&mut self, primitive: PrimitiveIndex) -> bool {
        let accepted = self.opaque.contains(primitive);
        self.passed_transparent |= !accepted;
        accepted
    }

    #[inline(always)]
    fn excludes(&self, _simd: S, primitive: PrimitiveIndex) -> Mask<S> {
        self.sources.simd_eq(primitive) | self.limit.simd_lt(0.0)
    }

    #[inline(always)]
    fn t_min(&self, _primitive: PrimitiveIndex) -> S::f32s {
        S::f32s::splat(self.limit.token(), 0.0)
    }

    #[inline(always)]
    fn limit(&self) -> S::f32s {
        self.limit
    }

    #[inline(always)]
    fn hit(&mut self, mask: Mask<S>, _t: S::f32s, primitive: PrimitiveIndex) {
        let mask = mask & self.sources.simd_ne(primitive);
        if mask.any_true() {
            self.blocked |= mask;
            self.limit = mask.select(S::f32s::splat(self.limit.token(), -1.0), self.limit);
            self.blocker = primitive;
        }
    }

    #[inline(always)]
    fn is_finished(&self) -> bool {
        self.limit.simd_lt(S::f32s::splat(self.limit.token(), 0.0)).all_true()
    }

    #[inline(always)]
    fn lane_limit(&self, lane: usize) -> f32 {
        self.limit[lane]
    }

    #[inline(always)]
    fn lane_t_min(&self, simd: S, _lane: usize, _primitives: &[PrimitiveIndex; BLOCK]) -> f32x8<S> {
        f32x8::splat(simd, 0.0)
    }

    #[inline(always)]
    fn lane_hit(&mut self, lane: usize, _t: f32, primitive: PrimitiveIndex) {
        if self.sources[lane] != primitive {
            self.blocked.set(lane, true);
            self.limit[lane] = -1.0;
            self.blocker = primitive;
        }
    }
}

/// Finds the next crossing of a transparent primitive in the order of (t, primitive).
#[derive(Clone, Copy, Debug)]
pub struct NextCrossing<'a, S: Simd> {
    opaque: Listed<'a>,
    sources: S::u32s,
    last_t: S::f32s,
    last_primitive: S::u32s,
    /// The crossing found.
    pub closest: ClosestHit<S>,
}

impl<'a, S: Simd> NextCrossing<'a, S> {
    /// Looks beyond the crossing (`last_t`, `last_primitive`); at the start that is (0, [`NO_PRIMITIVE`]). As for
    /// [`AnyHit`], a lane does not see its source.
    #[inline(always)]
    pub fn new(
        simd: S,
        opaque: Listed<'a>,
        sources: S::u32s,
        (last_t, last_primitive): (S::f32s, S::u32s),
        limit: S::f32s,
    ) -> Self {
        Self { opaque, sources, last_t, last_primitive, closest: ClosestHit::new(simd, last_t, limit) }
    }
}

impl<S: Simd> Visitor<S> for NextCrossing<'_, S> {
    #[inline(always)]
    fn accepts(&mut self, primitive: PrimitiveIndex) -> bool {
        !self.opaque.contains(primitive)
    }

    #[inline(always)]
    fn excludes(&self, _simd: S, primitive: PrimitiveIndex) -> Mask<S> {
        self.sources.simd_eq(primitive)
    }

    #[inline(always)]
    fn t_min(&self, primitive: PrimitiveIndex) -> S::f32s {
        // A later primitive may be crossed at the very distance of the last crossing.
        let simd = self.last_t.token();
        let later = self.last_primitive.simd_lt(S::u32s::splat(simd, primitive));
        let at_last = self.last_t.simd_gt(S::f32s::splat(simd, 0.0));
        (later & at_last).select(S::f32s::from_bits(self.last_t.to_bits() - 1), self.last_t)
    }

    #[inline(always)]
    fn limit(&self) -> S::f32s {
        self.closest.t
    }

    #[inline(always)]
    fn hit(&mut self, mask: Mask<S>, t: S::f32s, primitive: PrimitiveIndex) {
        self.closest.hit(mask & self.sources.simd_ne(primitive), t, primitive);
    }

    #[inline(always)]
    fn is_finished(&self) -> bool {
        false
    }

    #[inline(always)]
    fn lane_limit(&self, lane: usize) -> f32 {
        self.closest.t[lane]
    }

    #[inline(always)]
    fn lane_t_min(&self, simd: S, lane: usize, primitives: &[PrimitiveIndex; BLOCK]) -> f32x8<S> {
        let (last_t, last_primitive) = (self.last_t[lane], self.last_primitive[lane]);
        f32x8::from_fn(simd, |place| {
            let later = last_t > 0.0 && last_primitive < primitives[place];
            if later { f32::from_bits(last_t.to_bits() - 1) } else { last_t }
        })
    }

    #[inline(always)]
    fn lane_hit(&mut self, lane: usize, t: f32, primitive: PrimitiveIndex) {
        if self.sources[lane] != primitive {
            self.closest.lane_hit(lane, t, primitive);
        }
    }
}
