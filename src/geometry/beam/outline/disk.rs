//! Disks: the balls around them to be missed, their planes to cover.

use super::{CERTAIN, Outline, ball_outside, no_nearer_than};
use crate::geometry::beam::projection::Beam;
use crate::geometry::primitive::Disk;
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Numbers of a disk's outline: those of the ball around it, and what makes its plane: normal x, y, z, height of the
/// apex, and the share of nearness by which it is off.
const DISK: usize = 11;

impl Outline<7, DISK> for Disk {
    #[inline(always)]
    fn outline<S: Simd, F: Lanes<S>>(fields: &[F; 7], beam: &Beam<'_>) -> [F; DISK] {
        let simd = fields[0].token();
        let projection = beam.projection;
        let slack = F::splat(simd, projection.slack);
        let center = projection.view(V3::new(fields[0], fields[1], fields[2]));
        let normal = projection.turn(V3::new(fields[3], fields[4], fields[5]));
        let height = normal.dot(center);
        let larger = fields[6] + slack * 2.0;
        let certain = height.abs().simd_gt(slack * CERTAIN);
        let smaller = certain.select((fields[6] - slack * CERTAIN).max(0.0), F::splat(simd, 0.0));
        let [_, _, nearest] = no_nearer_than(center.z - larger, beam);
        let off = slack * 2.0 / height.abs();
        [center.x, center.y, center.z, larger, smaller, nearest, normal.x, normal.y, normal.z, height, off]
    }

    #[inline(always)]
    fn misses<S: Simd, F: Lanes<S>>(outline: &[F; DISK], beam: &Beam<'_>) -> F::Mask {
        let [x, y, z, larger, ..] = *outline;
        let w = if beam.projection.parallel { F::splat(x.token(), 1.0) } else { z };
        ball_outside([x, y, w, larger], beam)
    }

    #[inline(always)]
    fn covers<S: Simd, F: Lanes<S>>(outline: &[F; DISK], beam: &Beam<'_>) -> F::Mask {
        /// Flatter rays reach the plane too far from where they should.
        const LEAST_COSINE: f32 = 1.0 / 16.0;
        let [x, y, z, _, smaller, _, normal_x, normal_y, normal_z, height, _] = *outline;
        let (center, normal) = (V3::new(x, y, z), V3::new(normal_x, normal_y, normal_z));
        if beam.projection.parallel {
            // Seldom lit straight: not worth a formula of its own.
            return F::Mask::splat(x.token(), false);
        }
        let mut covered = smaller.simd_gt(0.0);
        for corner in beam.corners() {
            let corner = V3::splat(x.token(), corner);
            let t = height / normal.dot(corner);
            let aside = corner.scale(t) - center;
            let steep = normal.dot(corner).abs().simd_gt(LEAST_COSINE);
            covered &= steep & t.simd_gt(0.0) & aside.dot(aside).simd_lt(smaller * smaller);
        }
        covered
    }

    #[inline(always)]
    fn nearest<S: Simd, F: Lanes<S>>(outline: &[F; DISK]) -> [F; 3] {
        let zero = F::splat(outline[0].token(), 0.0);
        [zero, zero, outline[5]]
    }

    fn farthest(outline: &[f32; DISK], _beam: &Beam<'_>) -> [f32; 3] {
        let [_, _, _, _, _, _, x, y, z, height, off] = *outline;
        [x, y, z].map(|component| component * (1.0 - off) / height)
    }
}
