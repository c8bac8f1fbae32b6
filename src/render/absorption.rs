//! Light that bodies take along the way (Beer and Lambert): exp(-absorption · length).

use super::frame::Frame;
use super::media::OUTSIDE;
use super::shade::present;
use super::tile::Worker;
use crate::geometry::NO_PRIMITIVE;
use crate::math::V3;
use crate::math::power::exp;
use crate::scene::Scene;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;

/// Weakens the rays in `worker.rays` by what they crossed inside of bodies.
#[inline(always)]
pub(super) fn absorb<S: Simd>(simd: S, frame: &Frame<'_>, worker: &mut Worker) {
    let Worker { rays, media, .. } = worker;
    for at in (0..rays.len()).step_by(S::f32s::LEN) {
        let lanes = S::u32s::from_slice(simd, &rays.media[at..at + S::f32s::LEN]);
        let mut left = lanes.simd_ne(OUTSIDE).to_bitmask() & present::<S>(rays, at);
        while left != 0 {
            let list = lanes.as_slice()[left.trailing_zeros() as usize];
            let same = lanes.simd_eq(list);
            left &= !same.to_bitmask();
            let absorption = media.current(list).map_or(Vec3::ZERO, |body| absorption_of(frame.scene, body));
            if absorption != Vec3::ZERO {
                let missed = S::u32s::from_slice(simd, &rays.primitive[at..at + S::f32s::LEN]).simd_eq(NO_PRIMITIVE);
                let t = S::f32s::from_slice(simd, &rays.t[at..at + S::f32s::LEN]);
                let length = missed.select(S::f32s::splat(simd, f32::INFINITY), t);
                let left = transmittance(simd, absorption, length);
                let weight: V3<S::f32s> = rays.weights(simd, at);
                rays.weights_mut().store::<S>(at, V3::select(same, weight * left, weight));
            }
        }
    }
}

/// What is left after a way through a body.
#[inline(always)]
fn transmittance<S: Simd>(simd: S, absorption: Vec3, length: S::f32s) -> V3<S::f32s> {
    let mut left = [S::f32s::splat(simd, 1.0); 3];
    for (left, a) in left.iter_mut().zip(absorption.to_array()) {
        // An infinite way without absorption takes nothing.
        if a != 0.0 {
            *left = exp::<S, S::f32s>(length * -a);
        }
    }
    V3::new(left[0], left[1], left[2])
}

fn absorption_of(scene: &Scene, object: u32) -> Vec3 {
    scene.material_of(object).absorption
}
