//! The candidates of a beam, tested ray by ray.

use super::list::{Candidates, Member};
use super::outline::Outline;
use super::projection::Points;
use crate::geometry::primitive::{Cone, Cutout, Disk, Kernel, Plane, Sphere, Triangle, for_each_primitive};
use crate::geometry::traverse::test_place;
use crate::geometry::{PrimitiveIndex, Rays, Search, Visitor};
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Shows `$visitor` every hit of the candidates of one type that can matter to it.
macro_rules! resolve_all {
    (
        $kernel:ident, $intersect:ident, $fields:literal, $outline:literal, $blocks:ident, $search:ident, $simd:ident,
        $candidates:ident, $points:ident, $rays:ident, $visitor:ident
    ) => {
        for at in 0..$candidates.$blocks.len() {
            let Member { index, block, place } = $candidates.$blocks.member(at);
            if <$kernel as Outline<$fields, $outline>>::LOOK_FIRST {
                let outline: [S::f32s; $outline] = $candidates.$blocks.outline($simd, at);
                let passed_by = $kernel::is_passed_by(&outline, $points, $visitor.limit());
                if (passed_by | $visitor.excludes($simd, index)).all_true() {
                    continue;
                }
            }
            let (block, place) = (block as usize, usize::from(place));
            if $visitor.accepts(index) {
                let t_min = $visitor.t_min(index);
                let (mask, t) = test_place!($kernel, $intersect, $blocks, $search, $simd, block, place, &$rays, t_min);
                $visitor.hit(mask & t.simd_le($visitor.limit()), t, index);
                if $visitor.is_finished() {
                    return;
                }
            }
        }
    };
}

macro_rules! define_resolve {
    ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
        impl Search<'_> {
            /// Shows `visitor` every hit of the candidates that can matter to it. `points` are the rays as the candidates'
            /// beam sees them.
            #[inline(always)]
            pub fn resolve<S: Simd, V: Visitor<S>>(
                &self,
                simd: S,
                candidates: &Candidates,
                points: &Points<S::f32s>,
                origin: V3<S::f32s>,
                direction: V3<S::f32s>,
                visitor: &mut V,
            ) {
                $(if !candidates.$blocks.is_empty() {
                    let rays = if $kernel::NEEDS_FRAME {
                        Rays::new(origin, direction)
                    } else {
                        Rays::bare(origin, direction)
                    };
                    if $kernel::HAS_SIDES && self.passes_backs(visitor) {
                        resolve_all!(
                            $kernel, intersect_front, $fields, $outline, $blocks, self, simd, candidates, points, rays,
                            visitor
                        );
                    } else {
                        resolve_all!(
                            $kernel, intersect, $fields, $outline, $blocks, self, simd, candidates, points, rays, visitor
                        );
                    }
                })+
            }
        }

        impl Candidates {
            /// Whether `primitive` is the only candidate.
            pub fn are_only(&self, primitive: PrimitiveIndex) -> bool {
                self.len() == 1 $(&& (0..self.$blocks.len()).all(|at| self.$blocks.member(at).index == primitive))+
            }

            /// Whether, by the look of their outlines, no ray can hit any candidate but the one that all of them leave,
            /// nor can any between the rays.
            #[inline(always)]
            pub fn lie_beside<S: Simd, F: Lanes<S>>(
                &self,
                simd: S,
                points: &Points<F>,
                source: PrimitiveIndex,
            ) -> bool {
                $(for at in 0..self.$blocks.len() {
                    let outline: [F; $outline] = self.$blocks.outline(simd, at);
                    if self.$blocks.member(at).index != source && !$kernel::lies_beside(&outline, points) {
                        return false;
                    }
                })+
                true
            }

            /// Whether, by the look of their outlines, no ray can hit any candidate that matters to `visitor`.
            #[inline(always)]
            pub fn are_passed_by<S: Simd, V: Visitor<S>>(
                &self,
                simd: S,
                points: &Points<S::f32s>,
                visitor: &V,
            ) -> bool {
                $(for at in 0..self.$blocks.len() {
                    let mut passed_by = visitor.excludes(simd, self.$blocks.member(at).index);
                    if <$kernel as Outline<$fields, $outline>>::LOOK_FIRST {
                        let outline: [S::f32s; $outline] = self.$blocks.outline(simd, at);
                        passed_by |= $kernel::is_passed_by(&outline, points, visitor.limit());
                    }
                    if !passed_by.all_true() {
                        return false;
                    }
                })+
                true
            }
        }
    };
}
for_each_primitive!(define_resolve);
