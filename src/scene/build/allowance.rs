//! How much a search may look at before it is given up.

use crate::geometry::visitor::Mask;
use crate::geometry::{BLOCK, ClosestHit, PrimitiveIndex, Visitor};
use fearless_simd::{Simd, f32x8};
use std::cell::Cell;

/// Steps between two questions whether the search is still wanted.
const STEPS_BETWEEN_QUESTIONS: u64 = 1 << 12;

/// Steps that searches may take. Counted and not timed: what comes of them is the same on every machine.
pub struct Allowance<'a> {
    left: Cell<u64>,
    wanted: &'a dyn Fn() -> bool,
}

impl<'a> Allowance<'a> {
    /// As many as it takes.
    pub fn unlimited() -> Self {
        Self::new(u64::MAX, &|| true)
    }

    /// So many `steps`, and none soon after `wanted` says no.
    pub fn new(steps: u64, wanted: &'a dyn Fn() -> bool) -> Self {
        Self { left: Cell::new(steps), wanted }
    }

    /// Takes some steps. False if there are not so many left: then nothing is.
    pub fn take(&self, steps: u64) -> bool {
        let before = self.left.get();
        let left = before.saturating_sub(steps);
        let asks = before / STEPS_BETWEEN_QUESTIONS != left / STEPS_BETWEEN_QUESTIONS;
        let left = if asks && !(self.wanted)() { 0 } else { left };
        self.left.set(left);
        left > 0
    }

    /// Whether nothing is left: what was found last means nothing.
    pub fn is_spent(&self) -> bool {
        self.left.get() == 0
    }
}

/// Finds what [`ClosestHit`] does, as long as the allowance lasts. For rays that are traversed alone: every look at a
/// subtree is a step.
pub struct Allowed<'a, S: Simd> {
    pub closest: ClosestHit<S>,
    pub allowance: &'a Allowance<'a>,
    /// Whether only what is seen counts. If not, surfaces that are seen from one side only are met from either side.
    pub seen_only: bool,
}

impl<S: Simd> Visitor<S> for Allowed<'_, S> {
    #[inline(always)]
    fn passes_backs(&self) -> bool {
        self.seen_only
    }

    #[inline(always)]
    fn t_min(&self, primitive: PrimitiveIndex) -> S::f32s {
        self.closest.t_min(primitive)
    }

    #[inline(always)]
    fn limit(&self) -> S::f32s {
        self.closest.limit()
    }

    #[inline(always)]
    fn hit(&mut self, mask: Mask<S>, t: S::f32s, primitive: PrimitiveIndex) {
        self.closest.hit(mask, t, primitive);
    }

    #[inline(always)]
    fn is_finished(&self) -> bool {
        self.allowance.is_spent()
    }

    #[inline(always)]
    fn lane_limit(&self, lane: usize) -> f32 {
        let limit = self.closest.lane_limit(lane);
        // Lanes to spare take nothing, or it would matter how many there are.
        if limit < 0.0 || self.allowance.take(1) { limit } else { -1.0 }
    }

    #[inline(always)]
    fn lane_t_min(&self, simd: S, lane: usize, primitives: &[PrimitiveIndex; BLOCK]) -> f32x8<S> {
        self.closest.lane_t_min(simd, lane, primitives)
    }

    #[inline(always)]
    fn lane_hit(&mut self, lane: usize, t: f32, primitive: PrimitiveIndex) {
        self.closest.lane_hit(lane, t, primitive);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_ends_when_it_is_used_up_or_nobody_wants_it() {
        let few = Allowance::new(3, &|| true);
        assert!(few.take(2) && !few.is_spent());
        assert!(!few.take(1) && few.is_spent() && !few.take(1));
        let unwanted = Allowance::new(u64::MAX, &|| false);
        assert!((0..2 * STEPS_BETWEEN_QUESTIONS).any(|_| !unwanted.take(1)));
        assert!(Allowance::unlimited().take(u64::MAX / 2));
    }
}
