//! Cones and cylinders: the balls around both ends to be missed, a section along the axis to cover.

use super::{CERTAIN, Outline, ball_heights, no_nearer_than};
use crate::geometry::beam::projection::{Beam, Projection};
use crate::geometry::primitive::Cone;
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;

/// Numbers of a cone's outline: the balls around its two ends, each x, y, z and radius; nearness.
const CONE: usize = 9;

impl Outline<9, CONE> for Cone {
    #[inline(always)]
    fn outline<S: Simd, F: Lanes<S>>(fields: &[F; 9], beam: &Beam<'_>) -> [F; CONE] {
        let projection = beam.projection;
        let slack = projection.slack * 2.0;
        let middle = projection.view(V3::new(fields[0], fields[1], fields[2]));
        let half = projection.turn(V3::new(fields[3], fields[4], fields[5])).scale(fields[6]);
        let [_, _, _, _, _, _, half_height, radius, slope] = *fields;
        let growth = slope * half_height;
        let (base, top) = (middle - half, middle + half);
        let (base_radius, top_radius) = ((radius - growth).abs() + slack, (radius + growth).abs() + slack);
        let [_, _, nearest] = no_nearer_than((base.z - base_radius).min(top.z - top_radius), beam);
        [base.x, base.y, base.z, base_radius, top.x, top.y, top.z, top_radius, nearest]
    }

    #[inline(always)]
    fn misses<S: Simd, F: Lanes<S>>(outline: &[F; CONE], beam: &Beam<'_>) -> F::Mask {
        let one = F::splat(outline[0].token(), 1.0);
        let parallel = beam.projection.parallel;
        let [x, y, z, radius, other_x, other_y, other_z, other_radius, _] = *outline;
        let (w, other_w) = if parallel { (one, one) } else { (z, other_z) };
        // Both ends, and so all between them, on the far side of one wall.
        let outside = ball_heights([x, y, w, radius], beam);
        let other_outside = ball_heights([other_x, other_y, other_w, other_radius], beam);
        let mut missed = outside[0].max(other_outside[0]).simd_lt(0.0);
        for wall in 1..4 {
            missed |= outside[wall].max(other_outside[wall]).simd_lt(0.0);
        }
        missed
    }

    #[inline(always)]
    fn covers<S: Simd, F: Lanes<S>>(outline: &[F; CONE], beam: &Beam<'_>) -> F::Mask {
        // A ray that is beside the wall, at a height within the cone's, and then inside it, at such a height, has met the
        // wall in between. Both sets of rays are convex: those through a strip of a plane between apex and cone, and those
        // through the section of the cone by a plane along its axis.
        let simd = outline[0].token();
        let section = Section::new(outline, beam);
        let margin = beam.projection.slack * CERTAIN;
        let (half_height, widest) = (section.half_height - margin, section.radius[0].max(section.radius[1]));
        let beside = widest + margin;
        let middle = (section.radius[0] + section.radius[1]) * 0.5 - margin;
        let slope = (section.radius[1] - section.radius[0]) * 0.5 / section.half_height;
        let mut covered = (section.height - beside).simd_gt(margin);
        for [x, y] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let ray = V3::splat(simd, Vec3::new(beam.x[x], beam.y[y], 1.0));
            let (inside, steep) = section.crossing(ray, F::splat(simd, 0.0), beam);
            let (outside, _) = section.crossing(ray, beside, beam);
            let height = inside.dot(section.axis);
            let across = inside.dot(section.across).abs();
            covered &= steep
                & height.abs().simd_lt(half_height)
                & outside.dot(section.axis).abs().simd_lt(half_height)
                & across.simd_lt(middle + slope * height);
        }
        covered
    }

    #[inline(always)]
    fn nearest<S: Simd, F: Lanes<S>>(outline: &[F; CONE]) -> [F; 3] {
        let zero = F::splat(outline[0].token(), 0.0);
        [zero, zero, outline[8]]
    }

    fn farthest(&[x, y, z, _, other_x, other_y, other_z, ..]: &[f32; CONE], beam: &Beam<'_>) -> [f32; 3] {
        // Rays that are covered meet the wall before its axial section.
        let (base, top) = (Vec3::new(x, y, z), Vec3::new(other_x, other_y, other_z));
        let (middle, axis) = ((base + top) * 0.5, (top - base).normalize());
        let Projection { parallel, slack, .. } = *beam.projection;
        let view = if parallel { Vec3::Z } else { middle };
        let normal = (view - axis * view.dot(axis)).normalize();
        let height = normal.dot(middle);
        if parallel {
            return [normal.x / normal.z, normal.y / normal.z, -(height + 4.0 * slack) / normal.z];
        }
        (normal * ((1.0 - 4.0 * slack / height) / height)).into()
    }
}

/// The plane through a cone's axis that lies across the way from the apex, in view coordinates.
struct Section<F> {
    /// The middle of the axis.
    middle: V3<F>,
    /// Along the axis.
    axis: V3<F>,
    half_height: F,
    /// Half-widths of the section at the base and at the top.
    radius: [F; 2],
    /// The plane's normal, away from the apex.
    normal: V3<F>,
    /// In the plane, across the axis.
    across: V3<F>,
    /// How far in front of the plane the apex lies; infinite in parallel projection, 0 where rays come along the axis.
    height: F,
}

/// Nearer to the axis (sine of the angle between it and the way from the apex), what lies across is lost in rounding.
const LEAST_SINE: f32 = 1.0 / 16.0;

impl<F> Section<F> {
    #[inline(always)]
    fn new<S: Simd>(outline: &[F; CONE], beam: &Beam<'_>) -> Self
    where
        F: Lanes<S>,
    {
        let [x, y, z, radius, other_x, other_y, other_z, other_radius, _] = *outline;
        let simd = x.token();
        let (base, top) = (V3::new(x, y, z), V3::new(other_x, other_y, other_z));
        let half = F::splat(simd, 0.5);
        let (middle, along) = ((base + top).scale(half), (top - base).scale(half));
        let half_height = along.dot(along).sqrt();
        let axis = along.scale(F::splat(simd, 1.0) / half_height);
        let parallel = beam.projection.parallel;
        let view = if parallel { V3::splat(simd, Vec3::Z) } else { middle };
        let aside = view - axis.scale(view.dot(axis));
        let is_aside = aside.dot(aside).simd_gt(view.dot(view) * (LEAST_SINE * LEAST_SINE));
        let normal = aside.normalize();
        let height = if parallel { F::splat(simd, f32::INFINITY) } else { normal.dot(middle) };
        let height = is_aside.select(height, F::splat(simd, 0.0));
        // As the outline has them, ends are larger than they are.
        let slack = beam.projection.slack * 2.0;
        let radius = [radius - slack, other_radius - slack];
        Self { middle, axis, half_height, radius, normal, across: axis.cross(normal), height }
    }

    /// Where a ray q crosses the plane that lies `before` nearer to the apex, relative to the middle, and whether it does
    /// so steeply enough to tell where.
    #[inline(always)]
    fn crossing<S: Simd>(&self, ray: V3<F>, before: F, beam: &Beam<'_>) -> (V3<F>, F::Mask)
    where
        F: Lanes<S>,
    {
        /// Flatter rays reach the plane too far from where they should.
        const LEAST_COSINE: f32 = 1.0 / 8.0;
        let simd = before.token();
        if beam.projection.parallel {
            let start = ray - V3::splat(simd, Vec3::Z) - self.middle;
            let z = -(before + self.normal.dot(start)) / self.normal.z;
            return (start + V3::splat(simd, Vec3::Z).scale(z), self.normal.z.simd_gt(LEAST_COSINE));
        }
        let fall = self.normal.dot(ray);
        let steep = fall.simd_gt(ray.dot(ray).sqrt() * LEAST_COSINE);
        (ray.scale((self.height - before) / fall) - self.middle, steep)
    }
}
