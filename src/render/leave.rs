//! Where rays start that leave a surface. The one definition: every path takes its margin from here.

use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;

/// Rays start this far off the surface that they leave, as a share of the largest coordinate that made the hit point:
/// sixteen units in the last place, so that it holds at any scale of a scene.
const MARGIN: f32 = 1.0 / (1 << 19) as f32;

/// Least cosine at which a ray moves along itself only. Flatter ones would have to go too far.
const FLATTEST: f32 = 1.0 / 16.0;

/// The margin at a hit point of a given scale.
#[inline(always)]
pub fn margin<S: Simd>(scale: S::f32s) -> S::f32s {
    scale * MARGIN
}

/// How far shadow rays may go that start at [`start`]: what lies at the light itself does not shadow it, and the
/// start has already moved towards it.
#[inline(always)]
pub fn reach<S: Simd>(distance: S::f32s, margin: S::f32s) -> S::f32s {
    distance - margin * (2.0 / FLATTEST)
}

/// The start of rays along `direction` from `position`, on the side of `normal`, `margin` off the surface.
///
/// The ray moves along itself, so that its line stays the same: mirrors that mirror each other would multiply any
/// sideways step. Only what a flat ray lacks of the margin is added along the normal.
#[inline(always)]
pub fn start<S: Simd>(
    position: V3<S::f32s>,
    normal: V3<S::f32s>,
    margin: S::f32s,
    direction: V3<S::f32s>,
) -> V3<S::f32s> {
    let cosine = normal.dot(direction);
    let ahead = margin / cosine.max(FLATTEST);
    let lacking = (margin - ahead * cosine).max(0.0);
    position + direction.scale(ahead) + normal.scale(lacking)
}

/// [`start`] of a single ray.
pub fn start_one(position: Vec3, normal: Vec3, margin: f32, direction: Vec3) -> Vec3 {
    let cosine = normal.dot(direction);
    let ahead = margin / cosine.max(FLATTEST);
    let lacking = (margin - ahead * cosine).max(0.0);
    position + direction * ahead + normal * lacking
}
