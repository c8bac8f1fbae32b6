//! Triangles: bounds, bounds of nearness, and three sides.

use super::{CERTAIN, NEAREST, Outline, choose, times};
use crate::geometry::beam::projection::{Beam, Points};
use crate::geometry::primitive::Triangle;
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Numbers of a triangle's outline: bounds (least x, greatest x, least y, greatest y), upper and lower bound of the
/// nearness, three sides.
const TRIANGLE: usize = 19;

impl Outline<10, TRIANGLE> for Triangle {
    #[inline(always)]
    fn outline<S: Simd, F: Lanes<S>>(fields: &[F; 10], beam: &Beam<'_>) -> [F; TRIANGLE] {
        let simd = fields[0].token();
        let projection = beam.projection;
        let (zero, one) = (F::splat(simd, 0.0), F::splat(simd, 1.0));
        let slack = F::splat(simd, projection.slack);
        let corner = V3::new(fields[0], fields[1], fields[2]);
        // Edges before they are turned: their rounding errors are then in proportion to them.
        let to_b = projection.turn(V3::new(fields[3], fields[4], fields[5]) - corner);
        let to_c = projection.turn(V3::new(fields[6], fields[7], fields[8]) - corner);
        let b_to_c = to_c - to_b;
        let a = projection.view(corner);
        let (b, c) = (a + to_b, a + to_c);

        let (nearest_z, farthest_z) = (a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z));
        let mut bounds = if projection.parallel {
            let by = slack * 2.0;
            [
                a.x.min(b.x).min(c.x) - by,
                a.x.max(b.x).max(c.x) + by,
                a.y.min(b.y).min(c.y) - by,
                a.y.max(b.y).max(c.y) + by,
            ]
        } else {
            let [ax, ay] = extents(a, slack);
            let [bx, by] = extents(b, slack);
            let [cx, cy] = extents(c, slack);
            let far = F::splat(simd, NEAREST);
            let in_front = nearest_z.simd_gt(slack * 4.0);
            let behind = farthest_z.simd_lt(-slack);
            // Across the apex's own plane anything may be seen; behind it nothing.
            let least = behind.select(far, -far);
            [
                in_front.select(ax[0].min(bx[0]).min(cx[0]), least),
                in_front.select(ax[1].max(bx[1]).max(cx[1]), -least),
                in_front.select(ay[0].min(by[0]).min(cy[0]), least),
                in_front.select(ay[1].max(by[1]).max(cy[1]), -least),
            ]
        };

        let normal = to_b.cross(to_c);
        let longest_squared = to_b.dot(to_b).max(to_c.dot(to_c)).max(b_to_c.dot(b_to_c));
        let longest = longest_squared.sqrt();
        // The kernel's edge functions are off by the rounding of projected corners times their distance from the ray, and
        // beyond the triangle's own box it sees no hit: that is at most 80 rounding errors, of the 100 that slack is.
        let side_margin = (longest + slack) * slack * beam.longest();
        let (sides, turned, certain, nearest, farthest);
        if projection.parallel {
            sides = [side(to_b, a), side(b_to_c, b), side(-to_c, c)];
            turned = normal.z;
            certain = is_between(turned.abs(), (slack * longest * CERTAIN).max(side_margin * 3.0));
            let (slope_x, slope_y) = (normal.x / normal.z, normal.y / normal.z);
            let off = slack * longest_squared * 2.0 / turned.abs();
            let level = -(a.z + slope_x * a.x + slope_y * a.y);
            nearest = [slope_x, slope_y, level + off];
            farthest = [slope_x, slope_y, level - off];
        } else {
            sides = [form(a.cross(to_b)), form(b.cross(b_to_c)), form(to_c.cross(a))];
            turned = normal.dot(a);
            // The sides' sum is at least three margins: where one is outside for sure, another is inside for sure.
            let least_sum = side_margin * farthest_z * 3.0;
            certain = is_between(turned.abs(), (slack * longest_squared * CERTAIN).max(least_sum));
            let off = slack * longest_squared * 2.0 / turned.abs();
            let plane = times([normal.x, normal.y, normal.z], one / turned);
            nearest = times(plane, one + off);
            farthest = times(plane, one - off);
        }
        if beam.passes_backs {
            // Where the triangle is seen from behind for sure, no ray of the beam hits it. In view coordinates, left-handed
            // axes turn the normal around.
            let along_normal = (turned * fields[9] * projection.handedness()).simd_gt(zero);
            let unseen = certain & along_normal & Triangle::is_one_sided(fields[9]);
            bounds[0] = unseen.select(F::splat(simd, NEAREST), bounds[0]);
        }
        // Seen from nearly within its plane the triangle has no sides: its bounds alone decide.
        let scale = certain.select(one.copysign(turned) / side_margin, zero);
        let [p, q, r] = [times(sides[0], scale), times(sides[1], scale), times(sides[2], scale)];
        // Nor does its kernel then find more of the distance than that it lies within the triangle's box.
        let nearest = choose(certain, nearest, [zero, zero, F::splat(simd, NEAREST)]);
        [
            bounds[0],
            bounds[1],
            bounds[2],
            bounds[3],
            nearest[0],
            nearest[1],
            nearest[2],
            farthest[0],
            farthest[1],
            farthest[2],
            p[0],
            p[1],
            p[2],
            q[0],
            q[1],
            q[2],
            r[0],
            r[1],
            r[2],
        ]
    }

    #[inline(always)]
    fn misses<S: Simd, F: Lanes<S>>(outline: &[F; TRIANGLE], beam: &Beam<'_>) -> F::Mask {
        let apart = outline[0].simd_gt(beam.x[1])
            | outline[1].simd_lt(beam.x[0])
            | outline[2].simd_gt(beam.y[1])
            | outline[3].simd_lt(beam.y[0]);
        apart | outside_sides(&outline[10..], beam)
    }

    #[inline(always)]
    fn covers<S: Simd, F: Lanes<S>>(outline: &[F; TRIANGLE], beam: &Beam<'_>) -> F::Mask {
        inside_sides(&outline[10..], beam)
    }

    const LOOK_FIRST: bool = true;

    #[inline(always)]
    fn is_passed_by<S: Simd, F: Lanes<S>>(outline: &[F; TRIANGLE], rays: &Points<F>, limit: F) -> F::Mask {
        // Twice the margin: a shadow ray starts a little beside the line from its surface to the light.
        let [_, _, _, _, nx, ny, nz, _, _, _, px, py, pz, qx, qy, qz, rx, ry, rz] = *outline;
        let least = rays.value(px, py, pz).min(rays.value(qx, qy, qz)).min(rays.value(rx, ry, rz));
        least.simd_lt(-2.0) | rays.is_too_deep([nx, ny, nz], limit)
    }

    #[inline(always)]
    fn lies_beside<S: Simd, F: Lanes<S>>(outline: &[F; TRIANGLE], rays: &Points<F>) -> bool {
        // One side has all rays outside, and then all between them: sides are linear in q, and so is what 1 / depth is on
        // a plane.
        let [_, _, _, _, nx, ny, nz, _, _, _, px, py, pz, qx, qy, qz, rx, ry, rz] = *outline;
        let is_outside = [
            rays.value(px, py, pz).simd_lt(-2.0),
            rays.value(qx, qy, qz).simd_lt(-2.0),
            rays.value(rx, ry, rz).simd_lt(-2.0),
            rays.is_too_deep([nx, ny, nz], F::splat(nx.token(), f32::INFINITY)),
        ];
        is_outside[0].all_true() || is_outside[1].all_true() || is_outside[2].all_true() || is_outside[3].all_true()
    }

    #[inline(always)]
    fn nearest<S: Simd, F: Lanes<S>>(outline: &[F; TRIANGLE]) -> [F; 3] {
        [outline[4], outline[5], outline[6]]
    }

    fn farthest(outline: &[f32; TRIANGLE], _beam: &Beam<'_>) -> [f32; 3] {
        [outline[7], outline[8], outline[9]]
    }
}

/// The form whose product with q is a vector's with (x, y, 1).
#[inline(always)]
fn form<F>(v: V3<F>) -> [F; 3] {
    [v.x, v.y, v.z]
}

/// Across parallel rays, the form that is the cross product of an edge with the way to q from one of its ends.
#[inline(always)]
fn side<S: Simd, F: Lanes<S>>(edge: V3<F>, end: V3<F>) -> [F; 3] {
    [-edge.y, edge.x, edge.y * end.x - edge.x * end.y]
}

/// Least and greatest x and y under which a point in front of the apex is seen, if it may be off by `slack`.
#[inline(always)]
fn extents<S: Simd, F: Lanes<S>>(point: V3<F>, slack: F) -> [[F; 2]; 2] {
    let one = F::splat(slack.token(), 1.0);
    let inverse = one / point.z;
    let (x, y) = (point.x * inverse, point.y * inverse);
    let off = slack * inverse * 2.0;
    let (off_x, off_y) = (off * (x.abs() + one), off * (y.abs() + one));
    [[x - off_x, x + off_x], [y - off_y, y + off_y]]
}

/// Whether a value is above `least`, and not so large that it may have left the range of f32.
#[inline(always)]
fn is_between<S: Simd, F: Lanes<S>>(value: F, least: F) -> F::Mask {
    value.simd_gt(least) & value.simd_lt(1e36)
}

/// Sides: three forms, at least 1 all over what is certainly inside, below -1 somewhere in a beam that is outside.
#[inline(always)]
fn outside_sides<S: Simd, F: Lanes<S>>(sides: &[F], beam: &Beam<'_>) -> F::Mask {
    let least = F::splat(sides[0].token(), -1.0);
    beam.range([sides[0], sides[1], sides[2]]).1.simd_lt(least)
        | beam.range([sides[3], sides[4], sides[5]]).1.simd_lt(least)
        | beam.range([sides[6], sides[7], sides[8]]).1.simd_lt(least)
}

/// See [`outside_sides`].
#[inline(always)]
fn inside_sides<S: Simd, F: Lanes<S>>(sides: &[F], beam: &Beam<'_>) -> F::Mask {
    let one = F::splat(sides[0].token(), 1.0);
    beam.range([sides[0], sides[1], sides[2]]).0.simd_gt(one)
        & beam.range([sides[3], sides[4], sides[5]]).0.simd_gt(one)
        & beam.range([sides[6], sides[7], sides[8]]).0.simd_gt(one)
}
