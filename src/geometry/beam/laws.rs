//! What must hold of beams, tried on random scenes of every type of primitive and at every scale.

use super::{Beam, Blocking, Candidates, Cover, Points, Projection};
use crate::geometry::{
    AnyHit, ClosestHit, Geometry, NO_PRIMITIVE, Opaque, Packet, Part, PrimitiveId, PrimitiveKind, Search, Shape, Stack,
};
use crate::math::random::SplitMix64;
use crate::math::{SimdToken, V3, dispatch};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;

/// Random numbers and what tests make of them.
struct Random(SplitMix64);

impl Random {
    fn within(&mut self, min: f32, max: f32) -> f32 {
        self.0.within(min.into(), max.into()) as f32
    }

    fn point(&mut self) -> Vec3 {
        Vec3::new(self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0))
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let point = self.point();
            if (0.01..1.0).contains(&point.length()) {
                return point.normalize();
            }
        }
    }

    fn shape(&mut self, kind: PrimitiveKind, place: Vec3, scale: f32) -> Shape {
        let center = place + self.point() * scale;
        let size = scale * 10_f32.powf(self.within(-2.0, 0.0));
        match kind {
            PrimitiveKind::Sphere => Shape::Sphere { center, radius: size },
            PrimitiveKind::Plane => Shape::Plane { point: center, normal: self.direction() },
            PrimitiveKind::Disk => Shape::Disk { center, normal: self.direction(), radius: size },
            PrimitiveKind::Triangle | PrimitiveKind::Cutout => {
                Shape::Triangle { vertices: [(); 3].map(|()| center + self.point() * (size * 2.0)) }
            }
            PrimitiveKind::Cone => Shape::Cone {
                base: center,
                top: center + self.direction() * size,
                radius_base: size * self.within(0.1, 1.0),
                radius_top: size * self.within(0.0, 1.0),
            },
        }
    }
}

/// A scene of one type of primitive, and a view of it.
struct Case {
    geometry: Geometry,
    projection: Projection,
    x: [f32; 2],
    y: [f32; 2],
}

/// The types of primitives to try, and whether half of them are seen from one side only.
fn kinds() -> impl Iterator<Item = (PrimitiveKind, bool)> {
    let all = PrimitiveKind::ALL.iter().map(|&kind| (kind, false));
    all.chain([(PrimitiveKind::Triangle, true)])
}

fn case(random: &mut Random, (kind, one_sided): (PrimitiveKind, bool), parallel: bool) -> Case {
    let scale = 10_f32.powf(random.within(-4.0, 4.0));
    let place = random.point() * scale * 10_f32.powf(random.within(-1.0, 2.0));
    let count = if kind == PrimitiveKind::Plane { 5 } else { 60 };
    let parts = (0..count).map(|object| {
        let part = Part::new(random.shape(kind, place, scale), PrimitiveId { object, primitive: 0 });
        Part { one_sided: one_sided && object % 2 == 0, ..part }
    });
    let geometry = Geometry::build(parts.collect());
    let apex = place + random.point() * scale * 2.0;
    let forward = (place + random.point() * (scale * 0.7) - apex).normalize_or(Vec3::Z);
    let right = forward.any_orthonormal_vector();
    let reach = geometry.reach().max(place.abs().max_element() + scale);
    let projection = Projection::new(apex, [right, right.cross(forward), forward], parallel, reach, 1.0);
    let unit = if parallel { scale } else { 1.0 };
    let size = 10_f32.powf(random.within(-3.0, -0.3)) * unit;
    let [x, y] = [(); 2].map(|()| random.within(-0.3, 0.3) * unit);
    Case { geometry, projection, x: [x, x + size], y: [y, y + size] }
}

/// Origins and directions of a packet of rays of the case's beam; some along its borders.
fn packet<S: Simd>(simd: S, case: &Case, random: &mut Random) -> [V3<S::f32s>; 2] {
    let (mut origins, mut directions) = (V3::zero(simd), V3::zero(simd));
    for lane in 0..S::f32s::LEN {
        let mut between = |[from, to]: [f32; 2]| from + (to - from) * random.within(-0.2, 1.2).clamp(0.0, 1.0);
        let (x, y) = (between(case.x), between(case.y));
        let Projection { apex, right, up, forward, parallel, .. } = case.projection;
        let aside = right * x + up * y;
        let (origin, direction) =
            if parallel { (apex + aside, forward) } else { (apex, (forward + aside).normalize()) };
        let put = |v: &mut V3<S::f32s>, value: Vec3| (v.x[lane], v.y[lane], v.z[lane]) = value.into();
        put(&mut origins, origin);
        put(&mut directions, direction);
    }
    [origins, directions]
}

/// How many rays hit something, and how many were found otherwise through a beam than on their own.
fn closest<S: Simd>(simd: S, case: &Case, random: &mut Random) -> (usize, usize) {
    let beam = Beam::new(&case.projection, case.x, case.y);
    let (search, mut stack) = (Search::new(&case.geometry, true), Stack::default());
    let (mut whole, mut part) = (Candidates::default(), Candidates::default());
    assert!(search.collect(simd, &beam, Cover::nothing(&case.projection), &mut whole, &mut stack));
    part.filter(simd, &whole, &beam);
    let (mut hits, mut wrong) = (0, 0);
    for _ in 0..4 {
        let [origin, direction] = packet(simd, case, random);
        let (zero, far) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, f32::INFINITY));
        let mut alone = ClosestHit::new(simd, zero, far);
        Search::new(&case.geometry, false).traverse(
            simd,
            &Packet::new(&case.geometry, origin, direction),
            &mut stack,
            &mut alone,
        );
        for candidates in [&whole, &part] {
            let points = Points::along(&case.projection, direction);
            let mut found = ClosestHit::new(simd, zero, far);
            search.resolve(simd, candidates, &points, origin, direction, &mut found);
            for lane in 0..S::f32s::LEN {
                hits += usize::from(alone.primitive[lane] != NO_PRIMITIVE);
                let same = alone.primitive[lane] == found.primitive[lane] && alone.t[lane] == found.t[lane];
                wrong += usize::from(!same);
            }
        }
    }
    (hits, wrong)
}

/// A beam's rays see through its candidates what they see on their own, bit for bit.
#[test]
fn candidates_are_all_that_rays_can_see() {
    let mut random = Random(SplitMix64(7));
    for kind in kinds() {
        let mut hits = 0;
        for number in 0..400 {
            let case = case(&mut random, kind, false);
            let (hit, wrong) = dispatch!(SimdToken::best(), simd => closest(simd, &case, &mut random));
            assert_eq!(wrong, 0, "{kind:?}, case {number}");
            hits += hit;
        }
        assert!(hits > 2000, "{kind:?}: only {hits} rays hit anything");
    }
}

/// How many rays are blocked, and how many were judged otherwise by a beam than on their own.
fn shadows<S: Simd>(simd: S, case: &Case, random: &mut Random) -> (usize, usize) {
    let projection = &case.projection;
    let depth = projection.slack * 2e5;
    let nearness = |z: f32| if projection.parallel { -z } else { 1.0 / z };
    let far = [0.0, 0.0, nearness(depth * 4.0)];
    let least_distance = if projection.parallel { 0.0 } else { 32.0 * projection.slack };
    let blocking = Blocking { opaque: Opaque::All, least_nearness: nearness(depth) };
    let beam = Beam::new(projection, case.x, case.y).beyond(least_distance).asking(NO_PRIMITIVE, blocking, usize::MAX);
    let (search, mut stack, mut candidates) =
        (Search::new(&case.geometry, true), Stack::default(), Candidates::default());
    assert!(search.collect(simd, &beam, Cover::new(projection, far), &mut candidates, &mut stack));
    let (mut blocked, mut wrong) = (0, 0);
    for _ in 0..4 {
        // Rays the other way: from a depth between the two towards the light.
        let [origin, direction] = packet(simd, case, random);
        let length = S::f32s::splat(simd, depth * random.within(1.5, 2.5));
        let start = origin + direction.scale(length);
        let limit = if projection.parallel { S::f32s::splat(simd, f32::INFINITY) } else { length - least_distance };
        let nobody = S::u32s::splat(simd, NO_PRIMITIVE);
        let mut alone = AnyHit::new(simd, limit, nobody, Opaque::All);
        let packet = Packet::new(&case.geometry, start, -direction);
        Search::new(&case.geometry, false).traverse(simd, &packet, &mut stack, &mut alone);
        let mut found = AnyHit::new(simd, limit, nobody, Opaque::All);
        let points = Points::to(projection, start);
        if !candidates.blocked && !candidates.are_passed_by(simd, &points, &found) {
            search.resolve(simd, &candidates, &points, start, -direction, &mut found);
        }
        for lane in 0..S::f32s::LEN {
            blocked += usize::from(alone.blocked.test(lane));
            wrong += usize::from(alone.blocked.test(lane) != (candidates.blocked || found.blocked.test(lane)));
        }
    }
    (blocked, wrong)
}

/// A cone, or a cylinder, with balls beyond it, seen along its axis but for rounding.
fn along_the_axis(random: &mut Random, parallel: bool) -> Case {
    let (axis, length) = (random.direction(), random.within(0.5, 4.0));
    let base = random.point() * 3.0;
    let radius_base = random.within(0.2, 1.0);
    let radius_top = if random.within(0.0, 1.0) < 0.5 { radius_base } else { random.within(0.0, 1.0) };
    let mut shapes = vec![Shape::Cone { base, top: base + axis * length, radius_base, radius_top }];
    for _ in 0..20 {
        let center = base + axis * (length + random.within(0.5, 2.0)) + random.point();
        shapes.push(Shape::Sphere { center, radius: random.within(0.05, 0.3) });
    }
    let parts = (0..).zip(shapes).map(|(object, shape)| Part::new(shape, PrimitiveId { object, primitive: 0 }));
    let geometry = Geometry::build(parts.collect());
    let off = if random.within(0.0, 1.0) < 0.5 { 0.0 } else { 10_f32.powf(random.within(-8.0, -2.0)) };
    let apex = base - axis * random.within(0.5, 10.0) + random.point() * off;
    let right = axis.any_orthonormal_vector();
    let reach = geometry.reach().max(16.0);
    let projection = Projection::new(apex, [right, right.cross(axis), axis], parallel, reach, 1.0);
    let size = 10_f32.powf(random.within(-3.0, -0.5));
    let [x, y] = [(); 2].map(|()| random.within(-0.3, 0.3) - size / 2.0);
    Case { geometry, projection, x: [x, x + size], y: [y, y + size] }
}

/// Nothing is hidden by what lies along the rays.
#[test]
fn cones_seen_along_their_axes_hide_nothing_that_is_seen() {
    let mut random = Random(SplitMix64(13));
    for number in 0..3000 {
        let case = along_the_axis(&mut random, false);
        let (_, wrong) = dispatch!(SimdToken::best(), simd => closest(simd, &case, &mut random));
        assert_eq!(wrong, 0, "case {number}");
        let case = along_the_axis(&mut random, true);
        let (_, wrong) = dispatch!(SimdToken::best(), simd => shadows(simd, &case, &mut random));
        assert_eq!(wrong, 0, "parallel, case {number}");
    }
}

/// What a beam says of shadow rays is what they say themselves, of point lights and of directional ones.
#[test]
fn verdicts_are_those_of_the_rays() {
    let mut random = Random(SplitMix64(11));
    for kind in kinds() {
        for parallel in [false, true] {
            let mut blocked = 0;
            for number in 0..300 {
                let case = case(&mut random, kind, parallel);
                let (hit, wrong) = dispatch!(SimdToken::best(), simd => shadows(simd, &case, &mut random));
                assert_eq!(wrong, 0, "{kind:?}, parallel {parallel}, case {number}");
                blocked += hit;
            }
            assert!(blocked > 500, "{kind:?}: only {blocked} rays were blocked");
        }
    }
}
