//! What a beam needs to know of each type of primitive: an outline in its view, larger than the kernel's by the
//! margins where it is to be missed, smaller where it is to cover.

use super::projection::{Beam, Cover, Points, Projection};
use crate::geometry::primitive::{Cone, Disk, Kernel, Plane, Sphere, Triangle};
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;

/// A primitive type with `N` fields as beams see it: `M` numbers, all relative to the beam's projection.
pub trait Outline<const N: usize, const M: usize>: Kernel<N> {
    /// The numbers of primitives that are given by their fields.
    fn outline<S: Simd, F: Lanes<S>>(fields: &[F; N], beam: &Beam<'_>) -> [F; M];

    /// Where no ray of the beam can hit.
    fn misses<S: Simd, F: Lanes<S>>(outline: &[F; M], beam: &Beam<'_>) -> F::Mask;

    /// Where every ray of the beam hits.
    fn covers<S: Simd, F: Lanes<S>>(outline: &[F; M], beam: &Beam<'_>) -> F::Mask;

    /// Whether [`is_passed_by`](Self::is_passed_by) tells something, and more quickly than the kernel.
    const LOOK_FIRST: bool = false;

    /// Where rays of the beam surely do not hit within `limit`.
    #[inline(always)]
    fn is_passed_by<S: Simd, F: Lanes<S>>(_outline: &[F; M], rays: &Points<F>, _limit: F) -> F::Mask {
        F::Mask::splat(rays.x.token(), false)
    }

    /// Whether surely none of the rays hits, nor any between them: any whose q is a mean of theirs. All must end, or
    /// begin, on one plane.
    #[inline(always)]
    fn lies_beside<S: Simd, F: Lanes<S>>(_outline: &[F; M], _rays: &Points<F>) -> bool {
        false
    }

    /// An upper bound of the nearness of hits, as a product with q.
    fn nearest<S: Simd, F: Lanes<S>>(outline: &[F; M]) -> [F; 3];

    /// A lower bound of the nearness of hits, as a product with q; for what [`covers`](Self::covers).
    fn farthest(outline: &[f32; M], beam: &Beam<'_>) -> [f32; 3];
}

/// Where everything that can be hit lies behind a cover.
#[inline(always)]
pub(super) fn is_behind<S: Simd, F: Lanes<S>>([a, b, c]: [F; 3], beam: &Beam<'_>, cover: &Cover) -> F::Mask {
    let [x, y, z] = cover.nearness;
    beam.range([a - x, b - y, c - z]).1.simd_lt(0.0)
}

/// A nearness that is beaten by nothing.
const NEAREST: f32 = 1e30;

/// A plane is taken for one only if the apex is farther off it than this many times what it may be off by.
const CERTAIN: f32 = 16.0;

/// The nearness of what lies no nearer than view coordinate z, as a product with q.
#[inline(always)]
fn no_nearer_than<S: Simd, F: Lanes<S>>(z: F, beam: &Beam<'_>) -> [F; 3] {
    let simd = z.token();
    let zero = F::splat(simd, 0.0);
    let nearness = if beam.projection.parallel {
        -z
    } else {
        z.simd_gt(zero).select(F::splat(simd, 1.0) / z, F::splat(simd, NEAREST))
    };
    [zero, zero, nearness]
}

/// `a` where the mask is set, else `b`.
#[inline(always)]
fn choose<S: Simd, F: Lanes<S>>(mask: F::Mask, a: [F; 3], b: [F; 3]) -> [F; 3] {
    [mask.select(a[0], b[0]), mask.select(a[1], b[1]), mask.select(a[2], b[2])]
}

/// A form times a number.
#[inline(always)]
fn times<S: Simd, F: Lanes<S>>([a, b, c]: [F; 3], factor: F) -> [F; 3] {
    [a * factor, b * factor, c * factor]
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
        let bounds = if projection.parallel {
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

/// How far inside of each of the beam's sides a ball reaches. `w` is z in perspective, 1 in parallel projection.
#[inline(always)]
fn ball_heights<S: Simd, F: Lanes<S>>([x, y, w, radius]: [F; 4], beam: &Beam<'_>) -> [F; 4] {
    let [left, right, bottom, top] = beam.side_lengths();
    [
        x - w * beam.x[0] + radius * left,
        w * beam.x[1] - x + radius * right,
        y - w * beam.y[0] + radius * bottom,
        w * beam.y[1] - y + radius * top,
    ]
}

/// Where a ball lies outside of one of the beam's sides.
#[inline(always)]
fn ball_outside<S: Simd, F: Lanes<S>>(ball: [F; 4], beam: &Beam<'_>) -> F::Mask {
    let [left, right, bottom, top] = ball_heights(ball, beam);
    left.min(right).min(bottom.min(top)).simd_lt(0.0)
}

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
