//! Rays through a tree: closest hits of rays that keep together and of rays that do not, and shadow rays.

use crate::rays::{COUNT, Rays};
use crate::shapes::terrain;
use divan::{Bencher, counter::ItemsCount};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use raywalk::geometry::{AnyHit, ClosestHit, Geometry, NO_PRIMITIVE, Opaque, Packet, Search, Stack};
use raywalk::math::{SimdToken, V3, dispatch};

/// How many rays found something.
fn trace<S: Simd>(simd: S, geometry: &Geometry, rays: &Rays, shadow: bool, stack: &mut Stack) -> u32 {
    simd.vectorize(
        #[inline(always)]
        || {
            let search = Search::new(geometry, true);
            let (zero, far) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 100.0));
            let mut found = 0;
            for at in (0..COUNT).step_by(S::f32s::LEN) {
                let [origin, direction] =
                    [&rays.origin, &rays.direction].map(|[x, y, z]| V3::load(simd, &x[at..], &y[at..], &z[at..]));
                let packet = Packet::new(geometry, origin, direction);
                found += if shadow {
                    let sources = S::u32s::splat(simd, NO_PRIMITIVE);
                    let mut visitor = AnyHit::new(simd, far, sources, Opaque::All);
                    search.traverse(simd, &packet, stack, &mut visitor);
                    visitor.blocked.to_bitmask().count_ones()
                } else {
                    let mut visitor = ClosestHit::new(simd, zero, far);
                    search.traverse(simd, &packet, stack, &mut visitor);
                    visitor.t.simd_lt(far).to_bitmask().count_ones()
                };
            }
            found
        },
    )
}

fn bench(bencher: Bencher, rays: &Rays, shadow: bool) {
    let (geometry, mut stack) = (Geometry::build(terrain(240)), Stack::default());
    bencher
        .counter(ItemsCount::new(COUNT))
        .bench_local(|| dispatch!(SimdToken::best(), simd => trace(simd, &geometry, rays, shadow, &mut stack)));
}

#[divan::bench]
fn coherent(bencher: Bencher) {
    bench(bencher, &Rays::coherent(Vec3::new(0.0, 3.0, 7.0)), false);
}

#[divan::bench]
fn incoherent(bencher: Bencher) {
    bench(bencher, &Rays::incoherent(), false);
}

#[divan::bench]
fn shadow(bencher: Bencher) {
    bench(bencher, &Rays::incoherent(), true);
}
