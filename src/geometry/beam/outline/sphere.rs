//! Spheres: balls.

use super::{Outline, ball_outside, no_nearer_than};
use crate::geometry::beam::projection::Beam;
use crate::geometry::primitive::Sphere;
use crate::math::{Lanes, V3};
use fearless_simd::Simd;

/// Numbers of a ball's outline: centre x, y, z, radius with and without margin, nearness.
const BALL: usize = 6;

impl Outline<4, BALL> for Sphere {
    #[inline(always)]
    fn outline<S: Simd, F: Lanes<S>>(fields: &[F; 4], beam: &Beam<'_>) -> [F; BALL] {
        let slack = beam.projection.slack * 2.0;
        let center = beam.projection.view(V3::new(fields[0], fields[1], fields[2]));
        let larger = fields[3] + slack;
        let smaller = (fields[3] - slack).max(0.0);
        let [_, _, nearest] = no_nearer_than(center.z - larger, beam);
        [center.x, center.y, center.z, larger, smaller, nearest]
    }

    #[inline(always)]
    fn misses<S: Simd, F: Lanes<S>>(outline: &[F; BALL], beam: &Beam<'_>) -> F::Mask {
        let [x, y, z, larger, ..] = *outline;
        let w = if beam.projection.parallel { F::splat(x.token(), 1.0) } else { z };
        ball_outside([x, y, w, larger], beam)
    }

    #[inline(always)]
    fn covers<S: Simd, F: Lanes<S>>(outline: &[F; BALL], beam: &Beam<'_>) -> F::Mask {
        let [x, y, z, larger, smaller, _] = *outline;
        let radius_squared = smaller * smaller;
        let center = V3::new(x, y, z);
        if beam.projection.parallel {
            let (across, up) = (farther(x, beam.x), farther(y, beam.y));
            return (across * across + up * up).simd_lt(radius_squared);
        }
        // From inside it hides only what is outside of it all, which is seldom worth a test.
        let mut covered = center.dot(center).simd_gt(larger * larger);
        for corner in beam.corners() {
            let corner = V3::splat(x.token(), corner);
            let along = center.dot(corner);
            let aside = center - corner.scale(along);
            covered &= aside.dot(aside).simd_lt(radius_squared) & along.simd_gt(0.0);
        }
        covered
    }

    #[inline(always)]
    fn nearest<S: Simd, F: Lanes<S>>(outline: &[F; BALL]) -> [F; 3] {
        let zero = F::splat(outline[0].token(), 0.0);
        [zero, zero, outline[5]]
    }

    fn farthest(&[x, y, z, _, smaller, _]: &[f32; BALL], beam: &Beam<'_>) -> [f32; 3] {
        if beam.projection.parallel {
            return [0.0, 0.0, -z - beam.projection.slack];
        }
        // Hits lie this side of the plane through the circle in which the ball is touched from the apex.
        let squared = x * x + y * y + z * z;
        let height = squared - smaller * smaller + squared * 1e-6;
        [x / height, y / height, z / height]
    }
}

/// The larger distance of x from either end of a range.
#[inline(always)]
fn farther<S: Simd, F: Lanes<S>>(x: F, [from, to]: [f32; 2]) -> F {
    (x - from).abs().max((x - to).abs())
}
