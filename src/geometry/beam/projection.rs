//! The space in which a beam is a rectangle, and the beam in it.

use super::SLACK;
use crate::geometry::bvh::Node;
use crate::geometry::{NO_PRIMITIVE, Opaque, PrimitiveIndex};
use crate::math::{Lanes, V3};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::Vec3;

/// How points are mapped to the plane in which a bundle of rays is a set of points.
///
/// A point's view coordinates are (x, y, z) along `right`, `up` and `forward` from the apex. A ray is the point
/// q = (x, y, 1): in perspective all points with view coordinates z q, in parallel projection all with the same (x, y).
///
/// *Nearness* orders what lies on a ray: 1/z in perspective, -z in parallel projection; both are linear in q on a plane.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// Where all rays start, or any point where they are parallel.
    pub apex: Vec3,
    /// Unit vectors, across each other.
    pub right: Vec3,
    /// See `right`.
    pub up: Vec3,
    /// See `right`: the middle of the rays.
    pub forward: Vec3,
    /// Whether rays are parallel to `forward` rather than start at the apex.
    pub parallel: bool,
    /// How far surfaces may seem to be from where they are, in world units.
    pub slack: f32,
    /// The same as a share of the coordinates in play.
    pub slack_share: f32,
}

impl Projection {
    /// A projection for rays that stay within `reach` of the world's origin along every axis, apart from what they hit
    /// of planes. `margin` is the share of the proven margins to keep: 1, but for tests of what catches a lack of them.
    pub fn new(apex: Vec3, [right, up, forward]: [Vec3; 3], parallel: bool, reach: f32, margin: f32) -> Self {
        let slack_share = SLACK * margin;
        let slack = slack_share * (reach + apex.abs().max_element());
        Self { apex, right, up, forward, parallel, slack, slack_share }
    }

    /// View coordinates of a vector.
    #[inline(always)]
    pub fn turn<S: Simd, F: Lanes<S>>(&self, v: V3<F>) -> V3<F> {
        let simd = v.x.token();
        V3::new(
            v.dot(V3::splat(simd, self.right)),
            v.dot(V3::splat(simd, self.up)),
            v.dot(V3::splat(simd, self.forward)),
        )
    }

    /// View coordinates of a point.
    #[inline(always)]
    pub fn view<S: Simd, F: Lanes<S>>(&self, point: V3<F>) -> V3<F> {
        let simd = point.x.token();
        self.turn(point - V3::splat(simd, self.apex))
    }

    /// 1 where the axes are right-handed, else -1.
    pub(super) fn handedness(&self) -> f32 {
        self.right.cross(self.up).dot(self.forward).signum()
    }

    /// A range with as much more as directions may be off.
    #[inline]
    fn widen(&self, range: [f32; 2]) -> [f32; 2] {
        let by = if self.parallel { self.slack } else { self.slack_share * (1.0 + largest_magnitude(range)) };
        [range[0] - by, range[1] + by]
    }

    /// The world vector whose product with a vector is `form`'s with its view coordinates.
    fn normal_of(&self, form: [f32; 3]) -> Vec3 {
        self.right * form[0] + self.up * form[1] + self.forward * form[2]
    }
}

/// The larger magnitude of a range's ends.
fn largest_magnitude([from, to]: [f32; 2]) -> f32 {
    from.abs().max(to.abs())
}

/// The points p with normal·p >= offset.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    normal: Vec3,
    offset: f32,
}

impl HalfSpace {
    /// The half-space through `point`, larger by `slack`.
    fn through(normal: Vec3, point: Vec3, slack: f32) -> Self {
        Self { normal, offset: normal.dot(point) - 2.0 * slack * normal.length() }
    }

    /// Which of a node's boxes lie outside.
    #[inline(always)]
    pub(super) fn excludes<S: Simd>(&self, simd: S, node: &Node) -> u32 {
        let mut farthest = f32x8::splat(simd, 0.0);
        for axis in 0..3 {
            let component = self.normal[axis];
            let faces = if component > 0.0 { &node.max[axis] } else { &node.min[axis] };
            farthest = f32x8::from_slice(simd, faces).mul_add(f32x8::splat(simd, component), farthest);
        }
        farthest.simd_lt(f32x8::splat(simd, self.offset)).to_bitmask() as u32
    }
}

/// Rays of a beam, one a lane.
#[derive(Clone, Copy, Debug)]
pub struct Points<F> {
    /// The ray's q = (x, y, 1).
    pub x: F,
    /// See `x`.
    pub y: F,
    /// View coordinate z of where the ray ends, for rays that come from elsewhere to the apex; else how much it grows
    /// along the ray.
    depth: F,
    /// View coordinate z of where the ray begins, for rays that come from the apex; 0 where that is the apex.
    begin: F,
    /// Whether rays come from the apex.
    from_apex: bool,
    /// What x and y can be off by.
    off: F,
    /// As the projection's.
    parallel: bool,
}

impl<F> Points<F> {
    /// Rays from the apex along unit directions, in perspective.
    #[inline(always)]
    pub fn along<S: Simd>(projection: &Projection, direction: V3<F>) -> Self
    where
        F: Lanes<S>,
    {
        let V3 { x, y, z } = projection.turn(direction);
        let inverse = F::splat(z.token(), 1.0) / z;
        let (x, y) = (x * inverse, y * inverse);
        let off = (x.abs() + y.abs() + 1.0) * projection.slack_share;
        Self { x, y, depth: z, begin: F::splat(z.token(), 0.0), from_apex: true, off, parallel: false }
    }

    /// Rays that begin in front of the apex, in perspective, and whose lines pass it at a distance of at most `beside`.
    #[inline(always)]
    pub fn past<S: Simd>(projection: &Projection, start: V3<F>, direction: V3<F>, beside: f32) -> Self
    where
        F: Lanes<S>,
    {
        let simd = start.x.token();
        let from_apex = start - V3::splat(simd, projection.apex);
        let z = from_apex.dot(V3::splat(simd, projection.forward));
        let along = Self::along(projection, direction);
        Self { begin: z + 2.0 * projection.slack, off: along.off + F::splat(simd, beside) / z, ..along }
    }

    /// Rays that end (or start) at points, and of which what lies beyond is of no interest.
    #[inline(always)]
    pub fn to<S: Simd>(projection: &Projection, end: V3<F>) -> Self
    where
        F: Lanes<S>,
    {
        let V3 { x, y, z } = projection.view(end);
        let depth = z + 2.0 * projection.slack;
        if projection.parallel {
            let off = F::splat(z.token(), projection.slack);
            return Self { x, y, depth, begin: depth, from_apex: false, off, parallel: true };
        }
        let inverse = F::splat(z.token(), 1.0) / z;
        let (x, y) = (x * inverse, y * inverse);
        let off = (x.abs() + y.abs() + 1.0) * projection.slack_share;
        Self { x, y, depth, begin: depth, from_apex: false, off, parallel: false }
    }

    /// A form's value on each ray.
    #[inline(always)]
    pub(super) fn value<S: Simd>(&self, a: F, b: F, c: F) -> F
    where
        F: Lanes<S>,
    {
        a.mul_add(self.x, b.mul_add(self.y, c))
    }

    /// Where something with the given upper bound of nearness lies deeper than where the ray ends, `limit` along it if it
    /// comes from the apex.
    #[inline(always)]
    pub(super) fn is_too_deep<S: Simd>(&self, [a, b, c]: [F; 3], limit: F) -> F::Mask
    where
        F: Lanes<S>,
    {
        let nearness = (a.abs() + b.abs()).mul_add(self.off, self.value(a, b, c));
        if self.parallel {
            return (nearness + self.depth).simd_lt(0.0);
        }
        let end = if self.from_apex { self.depth.mul_add(limit, self.begin) } else { self.depth };
        (nearness * end).simd_lt(1.0 - 1e-5)
    }
}

/// What hides everything behind it, all over a beam.
#[derive(Clone, Copy, Debug)]
pub struct Cover {
    /// A lower bound of its nearness on ray q, as a product with q.
    pub nearness: [f32; 3],
    /// Whether there is one.
    pub hides: bool,
    /// What is not entirely behind it.
    pub(super) not_behind: HalfSpace,
}

impl Default for Cover {
    fn default() -> Self {
        let not_behind = HalfSpace { normal: Vec3::ZERO, offset: -1.0 };
        Self { nearness: [0.0; 3], hides: false, not_behind }
    }
}

impl Cover {
    /// Nothing: it hides what lies behind the eye.
    pub fn nothing(projection: &Projection) -> Self {
        let farthest = if projection.parallel { -Self::FAR } else { 0.0 };
        Self { hides: false, ..Self::new(projection, [0.0, 0.0, farthest]) }
    }

    /// A nearness that nothing has.
    pub(super) const FAR: f32 = 1e30;

    /// A cover of at least the given nearness.
    pub fn new(projection: &Projection, nearness: [f32; 3]) -> Self {
        // A point z q lies behind where nearness·(z q) > 1, or in parallel projection z + nearness·q > 0.
        let [x, y, z] = nearness;
        let (form, least) = if projection.parallel { ([x, y, 1.0], -z) } else { ([x, y, z], 1.0) };
        let normal = -projection.normal_of(form);
        let offset = normal.dot(projection.apex) - least - 2.0 * projection.slack * normal.length();
        Self { nearness, hides: true, not_behind: HalfSpace { normal, offset } }
    }

    /// Takes a covering primitive's bounds of nearness instead, if it hides more.
    pub(super) fn move_up(&mut self, nearest: [f32; 3], farthest: [f32; 3], beam: &Beam<'_>) {
        let hides_more = beam.middle_of(farthest) > beam.middle_of(self.nearness);
        if hides_more && beam.range_of(nearest).1 < beam.greatest_nearness {
            *self = Self::new(beam.projection, farthest);
        }
    }
}

/// Which covers block all rays of a beam.
#[derive(Clone, Copy, Debug)]
pub struct Blocking<'a> {
    /// What blocks light altogether.
    pub opaque: Opaque<'a>,
    /// Covers must be nearer than this all over: the rays end there.
    pub least_nearness: f32,
}

/// The rays q = (x, y, 1) of a rectangle, borders included.
#[derive(Clone, Copy, Debug)]
pub struct Beam<'a> {
    /// The space that it lies in.
    pub projection: &'a Projection,
    /// Least and greatest x.
    pub x: [f32; 2],
    /// Least and greatest y.
    pub y: [f32; 2],
    /// Covers must be less near than this: rays do not see what is nearer.
    pub greatest_nearness: f32,
    /// A primitive that the rays do not see.
    pub ignored: PrimitiveIndex,
    /// More candidates than this are not listed.
    pub most: usize,
    /// For rays that only ask whether anything is in the way: what blocks them all.
    pub blocking: Option<Blocking<'a>>,
    /// What rays never leave, where they start at a mirror.
    pub(super) front: Option<HalfSpace>,
    /// Whether rays pass through the backs of what is seen from one side only.
    pub(super) passes_backs: bool,
}

impl<'a> Beam<'a> {
    /// The beam of a rectangle; it is widened a little, as much as directions may be rounded.
    #[inline]
    pub fn new(projection: &'a Projection, x: [f32; 2], y: [f32; 2]) -> Self {
        Self {
            projection,
            x: projection.widen(x),
            y: projection.widen(y),
            greatest_nearness: f32::INFINITY,
            ignored: NO_PRIMITIVE,
            most: usize::MAX,
            blocking: None,
            front: None,
            passes_backs: false,
        }
    }

    /// Half-spaces between which the beam lies.
    pub(super) fn walls(&self) -> [HalfSpace; 4] {
        let Projection { apex, right, up, forward, parallel, slack, .. } = *self.projection;
        let wall = |axis: Vec3, sign: f32, at: f32| {
            if parallel {
                let normal = axis * sign;
                HalfSpace { normal, offset: normal.dot(apex) + sign * at - 2.0 * slack }
            } else {
                HalfSpace::through((axis - forward * at) * sign, apex, slack)
            }
        };
        [wall(right, 1.0, self.x[0]), wall(right, -1.0, self.x[1]), wall(up, 1.0, self.y[0]), wall(up, -1.0, self.y[1])]
    }

    /// The length of q is at most this.
    pub(super) fn longest(&self) -> f32 {
        if self.projection.parallel { 1.0 } else { 1.0 + largest_magnitude(self.x) + largest_magnitude(self.y) }
    }

    /// Unit directions of the corners in view coordinates, in perspective.
    pub(super) fn corners(&self) -> [Vec3; 4] {
        let ([left, right], [bottom, top]) = (self.x, self.y);
        [[left, bottom], [right, bottom], [left, top], [right, top]].map(|[x, y]| Vec3::new(x, y, 1.0).normalize())
    }

    /// For each side (x least, x greatest, y least, y greatest) the length of its plane's normal in view coordinates.
    pub(super) fn side_lengths(&self) -> [f32; 4] {
        let length = |at: f32| if self.projection.parallel { 1.0 } else { (1.0 + at * at).sqrt() };
        [self.x[0], self.x[1], self.y[0], self.y[1]].map(length)
    }

    /// The beam of rays that see nothing nearer than `near` along them.
    pub fn beyond(self, near: f32) -> Self {
        // What lies at depth z is seen at a distance of z or more.
        let greatest_nearness = if near > 0.0 { (1.0 - 1e-4) / near } else { f32::INFINITY };
        Self { greatest_nearness, ..self }
    }

    /// The beam of rays that do not see `ignored` and only ask whether anything is in their way, if that is one of at
    /// most `most` things.
    pub fn asking(self, ignored: PrimitiveIndex, blocking: Blocking<'a>, most: usize) -> Self {
        Self { ignored, blocking: Some(blocking), most, ..self }
    }

    /// The beam of rays that stay where normal·p is at least `lowest`, and may see at most `most` things.
    pub fn in_front(self, lowest: Option<(Vec3, f32)>, most: usize) -> Self {
        let slack = 2.0 * self.projection.slack;
        Self { front: lowest.map(|(normal, lowest)| HalfSpace { normal, offset: lowest - slack }), most, ..self }
    }

    /// How deep along `forward` a node's boxes begin.
    #[inline(always)]
    pub(super) fn depths<S: Simd>(&self, simd: S, node: &Node) -> f32x8<S> {
        let mut nearest = f32x8::splat(simd, 0.0);
        for axis in 0..3 {
            let component = self.projection.forward[axis];
            let faces = if component > 0.0 { &node.min[axis] } else { &node.max[axis] };
            nearest = f32x8::from_slice(simd, faces).mul_add(f32x8::splat(simd, component), nearest);
        }
        nearest
    }

    /// Whether a covering primitive with the given bounds of nearness blocks all rays.
    pub(super) fn is_blocked_by(&self, primitive: PrimitiveIndex, nearest: [f32; 3], farthest: [f32; 3]) -> bool {
        self.blocking.is_some_and(|blocking| {
            blocking.opaque.contains(primitive)
                && self.range_of(nearest).1 < self.greatest_nearness
                && self.range_of(farthest).0 > blocking.least_nearness
        })
    }

    /// The least and the greatest value of a linear form over the rectangle.
    #[inline(always)]
    pub(super) fn range<S: Simd, F: Lanes<S>>(&self, [a, b, c]: [F; 3]) -> (F, F) {
        let (left, right) = (a * self.x[0], a * self.x[1]);
        let (bottom, top) = (b * self.y[0], b * self.y[1]);
        (left.min(right) + bottom.min(top) + c, left.max(right) + bottom.max(top) + c)
    }

    /// As [`range`](Self::range), of one form.
    pub(super) fn range_of(&self, [a, b, c]: [f32; 3]) -> (f32, f32) {
        let (left, right) = (a * self.x[0], a * self.x[1]);
        let (bottom, top) = (b * self.y[0], b * self.y[1]);
        (left.min(right) + bottom.min(top) + c, left.max(right) + bottom.max(top) + c)
    }

    /// A linear form's value in the middle.
    pub(super) fn middle_of(&self, [a, b, c]: [f32; 3]) -> f32 {
        a * 0.5 * (self.x[0] + self.x[1]) + b * 0.5 * (self.y[0] + self.y[1]) + c
    }
}
