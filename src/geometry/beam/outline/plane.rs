//! Planes: bounds of nearness, and the horizon.

use super::{CERTAIN, NEAREST, Outline, choose, times};
use crate::geometry::beam::projection::Beam;
use crate::geometry::primitive::Plane;
use crate::math::{Lanes, V3};
use fearless_simd::Simd;

/// Numbers of a plane's outline: as a triangle's without bounds, and with one side, the horizon.
const PLANE: usize = 9;

impl Outline<4, PLANE> for Plane {
    #[inline(always)]
    fn outline<S: Simd, F: Lanes<S>>(fields: &[F; 4], beam: &Beam<'_>) -> [F; PLANE] {
        let simd = fields[0].token();
        let projection = beam.projection;
        let (zero, one) = (F::splat(simd, 0.0), F::splat(simd, 1.0));
        let world_normal = V3::new(fields[0], fields[1], fields[2]);
        let normal = projection.turn(world_normal);
        let height = fields[3] - world_normal.dot(V3::splat(simd, projection.apex));
        let share = projection.slack_share;
        let slack = fields[3].abs() * share + projection.slack;
        let (certain, horizon, nearest, farthest);
        if projection.parallel {
            // z = (height - nx x - ny y) / nz, and kernels ask for its sign, too.
            certain = normal.z.abs().simd_gt(share * CERTAIN);
            let (slope_x, slope_y) = (normal.x / normal.z, normal.y / normal.z);
            let off = slack / normal.z.abs();
            let level = -(height / normal.z);
            // No horizon: every ray meets the plane somewhere, but perhaps behind its start.
            horizon = [zero, zero, one * 4.0];
            nearest = [slope_x, slope_y, level + off];
            farthest = [slope_x, slope_y, level - off];
        } else {
            certain = height.abs().simd_gt(slack * CERTAIN);
            let plane = times([normal.x, normal.y, normal.z], one / height);
            // A ray nearly along the plane is off by the rounding of its own direction.
            let grazing = F::splat(simd, share * beam.longest()) / height.abs();
            let off = slack * 2.0 / height.abs();
            horizon = times(plane, height.abs() * (1.0 / (share * beam.longest())));
            let [a, b, c] = times(plane, one + off);
            nearest = [a, b, c + grazing];
            let [a, b, c] = times(plane, one - off);
            farthest = [a, b, c - grazing];
        }
        let horizon = choose(certain, horizon, [zero; 3]);
        let nearest = choose(certain, nearest, [zero, zero, F::splat(simd, NEAREST)]);
        [nearest[0], nearest[1], nearest[2], farthest[0], farthest[1], farthest[2], horizon[0], horizon[1], horizon[2]]
    }

    #[inline(always)]
    fn misses<S: Simd, F: Lanes<S>>(outline: &[F; PLANE], beam: &Beam<'_>) -> F::Mask {
        beam.range([outline[6], outline[7], outline[8]]).1.simd_lt(-1.0)
    }

    #[inline(always)]
    fn covers<S: Simd, F: Lanes<S>>(outline: &[F; PLANE], beam: &Beam<'_>) -> F::Mask {
        beam.range([outline[6], outline[7], outline[8]]).0.simd_gt(1.0)
    }

    #[inline(always)]
    fn nearest<S: Simd, F: Lanes<S>>(outline: &[F; PLANE]) -> [F; 3] {
        [outline[0], outline[1], outline[2]]
    }

    fn farthest(outline: &[f32; PLANE], _beam: &Beam<'_>) -> [f32; 3] {
        [outline[3], outline[4], outline[5]]
    }
}
