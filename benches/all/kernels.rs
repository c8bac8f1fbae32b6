//! Each primitive's kernel: a packet of rays against one primitive after the other, and one ray against eight at once.

use crate::rays::{COUNT, Rays};
use crate::shapes::mixture;
use divan::{Bencher, counter::ItemsCount};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::Vec3;
use raywalk::geometry::primitive::{Cone, Disk, Kernel, Plane, Sphere, Triangle};
use raywalk::geometry::{self, BLOCK, Block, Geometry};
use raywalk::math::{SimdToken, V3, dispatch};

/// Nearest hit of all rays with all blocks, a packet at a time.
fn packets<S: Simd, K: Kernel<N>, const N: usize>(simd: S, blocks: &[Block<N>], rays: &Rays) -> f32 {
    simd.vectorize(
        #[inline(always)]
        || {
            let zero = S::f32s::splat(simd, 0.0);
            let mut nearest = S::f32s::splat(simd, f32::MAX);
            for at in (0..COUNT).step_by(S::f32s::LEN) {
                let [origin, direction] =
                    [&rays.origin, &rays.direction].map(|[x, y, z]| V3::load(simd, &x[at..], &y[at..], &z[at..]));
                let packet = geometry::Rays::new(origin, direction);
                for block in blocks {
                    for place in 0..block.len as usize {
                        let (hit, t) = K::intersect(&block.splat(simd, place), &packet, zero);
                        nearest = hit.select(t.min(nearest), nearest);
                    }
                }
            }
            nearest.reduce_min()
        },
    )
}

/// Nearest hit of all rays with all blocks, a ray at a time.
fn rays_one_by_one<S: Simd, K: Kernel<N>, const N: usize>(simd: S, blocks: &[Block<N>], rays: &Rays) -> f32 {
    simd.vectorize(
        #[inline(always)]
        || {
            let zero = f32x8::splat(simd, 0.0);
            let mut nearest = f32x8::splat(simd, f32::MAX);
            for at in 0..COUNT {
                let [origin, direction] =
                    [&rays.origin, &rays.direction].map(|[x, y, z]| V3::splat(simd, Vec3::new(x[at], y[at], z[at])));
                let ray = geometry::Rays::new(origin, direction);
                for block in blocks {
                    let (hit, t) = K::intersect(&block.load(simd), &ray, zero);
                    nearest = hit.select(t.min(nearest), nearest);
                }
            }
            nearest.reduce_min()
        },
    )
}

/// Both ways through the kernel of one type; counted are tests of a ray against a primitive.
macro_rules! kernel_benches {
    ($($module:ident: $kernel:ident in $blocks:ident;)+) => {
        $(mod $module {
            use super::*;

            #[divan::bench]
            fn packet_against_one(bencher: Bencher) {
                let (geometry, rays) = (Geometry::build(mixture(BLOCK)), Rays::coherent(Vec3::splat(2.0)));
                bencher.counter(ItemsCount::new(COUNT * BLOCK)).bench(
                    || dispatch!(SimdToken::best(), simd => packets::<_, $kernel, _>(simd, &geometry.$blocks, &rays)),
                );
            }

            #[divan::bench]
            fn ray_against_eight(bencher: Bencher) {
                let (geometry, rays) = (Geometry::build(mixture(BLOCK)), Rays::coherent(Vec3::splat(2.0)));
                bencher.counter(ItemsCount::new(COUNT * BLOCK)).bench(
                    || dispatch!(SimdToken::best(), simd => rays_one_by_one::<_, $kernel, _>(simd, &geometry.$blocks, &rays)),
                );
            }
        })+
    };
}
kernel_benches! {
    sphere: Sphere in spheres;
    triangle: Triangle in triangles;
    disk: Disk in disks;
    cone: Cone in cones;
    plane: Plane in planes;
}
