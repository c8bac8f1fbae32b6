//! The candidates of a beam, tested ray by ray.

use super::list::Places;
use crate::geometry::primitive::{Cone, Disk, Kernel, Plane, Triangle, for_each_primitive};
use crate::geometry::traverse::test_place;
use crate::geometry::{Rays, Search, Visitor};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

macro_rules! define_resolve {
    ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
        impl Search<'_> {
            /// Shows `visitor` every hit of the primitives at the given places that can matter to it.
            #[inline(always)]
            pub fn resolve<S: Simd, V: Visitor<S>>(
                &self,
                simd: S,
                places: &Places,
                rays: &Rays<S::f32s>,
                visitor: &mut V,
            ) {
                $(for (block, place) in places.$blocks() {
                    let index = self.geometry.$blocks[block].indices[place];
                    if visitor.accepts(index) {
                        let t_min = visitor.t_min(index);
                        let (mask, t) = test_place!($kernel, $blocks, self, simd, block, place, rays, t_min);
                        visitor.hit(mask & t.simd_le(visitor.limit()), t, index);
                        if visitor.is_finished() {
                            return;
                        }
                    }
                })+
            }
        }
    };
}
for_each_primitive!(define_resolve);
