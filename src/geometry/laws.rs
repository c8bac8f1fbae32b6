//! Laws that every type of primitive keeps, whatever its size and place; they walk the list of types.

use super::primitive::{Cone, Cutout, Disk, HIT_PADDING, Kernel, Plane, Sphere, Triangle, for_each_primitive};
use super::*;
use crate::math::random::SplitMix64;
use crate::math::{SimdToken, V3, dispatch};
use crate::settings::SimdLevel;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::{DVec3, Vec3};

/// Random numbers and what tests make of them.
struct Random(SplitMix64);

impl Random {
    /// Uniform in [min, max).
    fn within(&mut self, min: f64, max: f64) -> f64 {
        self.0.within(min, max)
    }

    /// A unit vector; one in four all but along an axis.
    fn direction(&mut self) -> DVec3 {
        let v = DVec3::new(self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0));
        if self.within(0.0, 1.0) < 0.25 { DVec3::Y + v * self.magnitude(-6.0, -1.0) } else { v }.normalize()
    }

    /// Log-uniform between two powers of ten.
    fn magnitude(&mut self, min: f64, max: f64) -> f64 {
        10_f64.powf(self.within(min, max))
    }
}

/// A shape of a type around `center`, about `size` large, and one part of it `thin` times as large.
fn shape(kind: PrimitiveKind, random: &mut Random, center: DVec3, size: f64, thin: f64) -> Shape {
    let (a, b) = (random.direction(), random.direction());
    let point = |p: DVec3| p.as_vec3();
    let normal = point(a);
    match kind {
        PrimitiveKind::Sphere => Shape::Sphere { center: point(center), radius: size as f32 },
        PrimitiveKind::Plane => Shape::Plane { point: point(center), normal },
        PrimitiveKind::Disk => Shape::Disk { center: point(center), normal, radius: size as f32 },
        PrimitiveKind::Triangle | PrimitiveKind::Cutout => {
            let (from, to) = (center - a * size, center + a * size);
            Shape::Triangle {
                vertices: [from, to, from.lerp(to, random.within(0.0, 1.0)) + b * size * thin].map(point),
            }
        }
        PrimitiveKind::Cone => {
            let flat = random.within(0.0, 1.0) < 0.5;
            let (height, radius) = if flat { (size * thin, size) } else { (size, size * thin) };
            let [base, top] = [center - a * height, center + a * height].map(point);
            Shape::Cone { base, top, radius_base: radius as f32, radius_top: (radius * random.within(0.0, 1.0)) as f32 }
        }
    }
}

fn geometry(shapes: impl IntoIterator<Item = Shape>) -> Geometry {
    let part = |(i, shape): (usize, Shape)| {
        let id = PrimitiveId { object: i as u32, primitive: 0 };
        Part::new(shape, id)
    };
    Geometry::build(shapes.into_iter().enumerate().map(part).collect())
}

#[derive(Clone, Copy, Debug)]
struct Ray {
    origin: Vec3,
    direction: Vec3,
}

impl Ray {
    fn towards(origin: DVec3, target: DVec3) -> Self {
        let origin = origin.as_vec3();
        Self { origin, direction: (target - origin.as_dvec3()).normalize().as_vec3() }
    }
}

/// Closest hits, packet by packet; a distance and an index each.
fn closest<S: Simd>(simd: S, geometry: &Geometry, use_bvh: bool, rays: &[Ray]) -> Vec<(u32, PrimitiveIndex)> {
    let search = Search::new(geometry, use_bvh);
    let mut stack = Stack::default();
    let mut found = Vec::new();
    for rays in rays.chunks(S::f32s::LEN) {
        let of = |lane: usize| rays[lane.min(rays.len() - 1)];
        let lanes = |value: &dyn Fn(Ray) -> f32| S::f32s::from_fn(simd, |lane| value(of(lane)));
        let origin = V3::new(lanes(&|r| r.origin.x), lanes(&|r| r.origin.y), lanes(&|r| r.origin.z));
        let direction = V3::new(lanes(&|r| r.direction.x), lanes(&|r| r.direction.y), lanes(&|r| r.direction.z));
        let packet = Packet::new(geometry, origin, direction);
        let (zero, far) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, f32::INFINITY));
        let mut visitor = ClosestHit::new(simd, zero, far);
        search.traverse(simd, &packet, &mut stack, &mut visitor);
        found.extend((0..rays.len()).map(|lane| (visitor.t[lane].to_bits(), visitor.primitive[lane])));
    }
    found
}

fn levels() -> impl Iterator<Item = SimdToken> {
    let all = [SimdLevel::Off, SimdLevel::Sse4, SimdLevel::Avx2, SimdLevel::Avx512];
    all.into_iter().filter_map(SimdToken::new)
}

fn hits(geometry: &Geometry, rays: &[Ray]) -> Vec<(f32, PrimitiveIndex)> {
    let found = dispatch!(SimdToken::best(), simd => closest(simd, geometry, false, rays));
    found.into_iter().map(|(t, primitive)| (f32::from_bits(t), primitive)).collect()
}

macro_rules! define_surface_of {
    ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
        /// Position and normal of a geometry's only primitive at a hit.
        fn surface<S: Simd>(simd: S, geometry: &Geometry, ray: Ray, t: f32) -> (Vec3, Vec3) {
            let slot = geometry.slot(0);
            let (origin, direction) = (V3::splat(simd, ray.origin), V3::splat(simd, ray.direction));
            let t = S::f32s::splat(simd, t);
            match slot.kind {
                $(PrimitiveKind::$kernel => {
                    let fields: [S::f32s; $fields] = geometry.$blocks[0].splat(simd, 0);
                    let point = $kernel::surface(&fields, origin, direction, t);
                    (point.position.lane(0), point.normal.lane(0))
                })+
            }
        }
    };
}
for_each_primitive!(define_surface_of);

/// Rays from all around that pass near the middle of something `size` large.
fn rays_around(random: &mut Random, center: DVec3, size: f64, count: usize) -> Vec<Ray> {
    (0..count)
        .map(|_| {
            let origin = center + random.direction() * size * random.magnitude(0.3, 1.5);
            let target = center + random.direction() * size * random.within(0.0, 1.2);
            Ray::towards(origin, target)
        })
        .collect()
}

/// Centres and sizes over twelve powers of ten. What is smaller than its coordinates' rounding allows is left out.
fn place(random: &mut Random) -> (DVec3, f64) {
    let center = random.direction() * random.magnitude(-6.0, 6.0);
    let size = random.magnitude(-6.0, 6.0).max(center.length() * 1e-3);
    (center, size)
}

#[test]
fn bounds_contain_hits() {
    let mut random = Random(SplitMix64(1));
    for &kind in PrimitiveKind::ALL {
        let mut outside = Vec::new();
        let mut count = 0;
        for _ in 0..4000 {
            let (center, size) = place(&mut random);
            let thin = random.magnitude(-6.0, 0.0);
            let geometry = geometry([shape(kind, &mut random, center, size, thin)]);
            if geometry.is_empty() {
                continue;
            }
            let bounds = geometry.bounds_of(0);
            let rays = rays_around(&mut random, center, size, 16);
            for (ray, (t, primitive)) in rays.iter().zip(hits(&geometry, &rays)) {
                if primitive == NO_PRIMITIVE || !bounds.is_finite() {
                    continue;
                }
                count += 1;
                let point = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t);
                // A fifth more, for the roundings of both.
                let padding = f64::from((ray.origin.abs().max_element() + geometry.reach()) * HIT_PADDING) * 1.2;
                let (below, above) = (bounds.min.as_dvec3() - point, point - bounds.max.as_dvec3());
                let by = below.max(above).max_element() / padding;
                if by > 1.0 {
                    outside.push(format!(
                        "{by:.1} paddings: {ray:?} {:?} thin {thin:e} {:?}",
                        t,
                        geometry.bounds_of(0)
                    ));
                }
            }
        }
        assert!(kind == PrimitiveKind::Plane || count > 2000, "{kind:?}: only {count} rays hit");
        assert!(outside.is_empty(), "{kind:?}: {} of {count} hits, such as {}", outside.len(), outside[0]);
    }
}

#[test]
fn surfaces_lie_where_rays_hit_and_have_unit_normals() {
    let mut random = Random(SplitMix64(2));
    for &kind in PrimitiveKind::ALL {
        for _ in 0..2000 {
            let (center, size) = place(&mut random);
            let thin = random.magnitude(-2.0, 0.0);
            let geometry = geometry([shape(kind, &mut random, center, size, thin)]);
            let rays = rays_around(&mut random, center, size, 8);
            for (&ray, (t, primitive)) in rays.iter().zip(hits(&geometry, &rays)) {
                // A plane may be met far away, where one rounding is large.
                if primitive == NO_PRIMITIVE || f64::from(t) > 100.0 * (size + center.length()) {
                    continue;
                }
                let (position, normal) = dispatch!(SimdToken::best(), simd => surface(simd, &geometry, ray, t));
                let other = geometry.normal_at(0, position).expect("it has one");
                assert!(normal.dot(other).abs() > 0.999, "{normal} {other}");
                let unit = (normal.as_dvec3().length() - 1.0).abs();
                assert!(unit < 1e-5, "{kind:?} {ray:?}: the normal {normal} is not a unit vector");
                let point = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t);
                let scale = f64::from(
                    ray.origin.abs().max_element() + geometry.reach().max(center.as_vec3().abs().max_element()),
                ) + f64::from(t);
                let apart = (position.as_dvec3() - point).length() / scale;
                assert!(apart < 2e-5, "{kind:?} {ray:?} at {t}: {position} is {apart:e} from {point}");
            }
        }
    }
}

#[test]
fn no_hit_is_nearer_than_the_nearest_point() {
    let mut random = Random(SplitMix64(8));
    for &kind in PrimitiveKind::ALL {
        let mut count = 0;
        for _ in 0..2000 {
            let (center, size) = place(&mut random);
            let thin = random.magnitude(-2.0, 0.0);
            let geometry = geometry([shape(kind, &mut random, center, size, thin)]);
            let rays = rays_around(&mut random, center, size, 8);
            for (ray, (t, primitive)) in rays.iter().zip(hits(&geometry, &rays)) {
                if primitive == NO_PRIMITIVE || f64::from(t) > 100.0 * (size + center.length()) {
                    continue;
                }
                count += 1;
                let origin = ray.origin.as_dvec3();
                let rounding = 2e-5 * (origin.length() + center.length() + size + f64::from(t));
                let nearest = geometry.nearest(origin, f64::INFINITY).expect("there is something");
                let distance = nearest.distance(origin);
                assert!(distance <= f64::from(t) + rounding, "{kind:?} {ray:?}: {distance} but hit at {t}");
                assert_eq!(geometry.nearest(origin, distance * 0.999), None);
                // It lies on the surface: nothing is nearer to it than itself.
                let own = geometry.nearest(nearest, f64::INFINITY).expect("there is something");
                assert!(own.distance(nearest) <= rounding, "{kind:?} {ray:?}: {nearest} is off the surface");
                let hit = origin + ray.direction.as_dvec3() * f64::from(t);
                let near_hit = geometry.nearest(hit, f64::INFINITY).expect("there is something");
                assert!(near_hit.distance(hit) <= rounding, "{kind:?} {ray:?}: {near_hit} is not at {hit}");
            }
        }
        assert!(count > 1000, "{kind:?}: only {count} rays hit");
    }
}

#[test]
fn the_tree_finds_the_same_nearest_point() {
    let mut random = Random(SplitMix64(9));
    for _ in 0..40 {
        let shapes = (0..200).map(|i| {
            let kind = PrimitiveKind::ALL[i % PrimitiveKind::ALL.len()];
            let at = random.direction() * random.within(0.0, 8.0);
            shape(kind, &mut random, at, 0.3, 0.5)
        });
        let mut with_tree = geometry(shapes.filter(|shape| !matches!(shape, Shape::Plane { .. })).collect::<Vec<_>>());
        let points: Vec<DVec3> = (0..100).map(|_| random.direction() * random.within(0.0, 10.0)).collect();
        let within = |i: usize| if i.is_multiple_of(2) { f64::INFINITY } else { 0.5 };
        let find = |geometry: &Geometry| -> Vec<Option<f64>> {
            let found = points.iter().enumerate().map(|(i, &p)| Some(geometry.nearest(p, within(i))?.distance(p)));
            found.collect()
        };
        let found = find(&with_tree);
        assert!(with_tree.bvh.take().is_some());
        assert_eq!(found, find(&with_tree));
    }
}

#[test]
fn every_path_gives_the_same_bits() {
    let mut random = Random(SplitMix64(3));
    for round in 0..40 {
        let scale = random.magnitude(-4.0, 5.0);
        let center = random.direction() * if round % 2 == 0 { 0.0 } else { 300.0 * scale };
        let shapes = (0..150).map(|i| {
            let kind = PrimitiveKind::ALL[i % PrimitiveKind::ALL.len()];
            let at = center + random.direction() * scale * random.within(0.0, 5.0);
            let thin = random.magnitude(-3.0, 0.0);
            shape(kind, &mut random, at, scale, thin)
        });
        // Each twice: which one is hit is decided by order alone.
        let shapes: Vec<Shape> = shapes.flat_map(|s| [s, s]).collect();
        let geometry = geometry(shapes);
        assert!(geometry.bvh.is_some());
        let mut rays = rays_around(&mut random, center, 3.0 * scale, 64);
        let eye = rays[0].origin.as_dvec3();
        // Packets that keep together take another way than those that do not.
        rays.extend((0..64).map(|i| Ray::towards(eye, center + random.direction() * scale * f64::from(i) * 0.01)));
        let expected =
            dispatch!(SimdToken::new(SimdLevel::Off).unwrap(), simd => closest(simd, &geometry, false, &rays));
        assert!(expected.iter().filter(|(_, primitive)| *primitive != NO_PRIMITIVE).count() > 64);
        assert!(expected.iter().all(|(_, primitive)| *primitive == NO_PRIMITIVE || primitive % 2 == 0), "ties");
        for token in levels() {
            for use_bvh in [false, true] {
                let found = dispatch!(token, simd => closest(simd, &geometry, use_bvh, &rays));
                for ((a, b), ray) in expected.iter().zip(&found).zip(&rays) {
                    assert_eq!(a, b, "{} with bvh {use_bvh}: {ray:?}", token.name());
                }
            }
        }
    }
}

/// The corners and faces of a sphere of triangles around the origin, each face of an icosahedron cut in 4^`levels`.
fn icosphere(levels: u32) -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let golden = (1.0 + 5_f64.sqrt()) / 2.0;
    let mut points = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        points.extend([DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)].map(|p| p.normalize()));
    }
    let n = points.len();
    let near = |i: usize, j: usize| points[i].distance(points[j]) < 1.1;
    let triples = (0..n).flat_map(|i| (i + 1..n).flat_map(move |j| (j + 1..n).map(move |k| [i, j, k])));
    let mut faces: Vec<[usize; 3]> = triples.filter(|&[i, j, k]| near(i, j) && near(j, k) && near(i, k)).collect();
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |i: usize, j: usize| {
            *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                points.push((points[i] + points[j]).normalize());
                points.len() - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    (points, faces)
}

#[test]
fn closed_meshes_do_not_leak() {
    let (points, faces) = icosphere(3);
    assert_eq!((points.len(), faces.len()), (642, 1280));
    let mut random = Random(SplitMix64(4));
    for (center, radius) in [
        (DVec3::ZERO, 1.0),
        (DVec3::ZERO, 1e-5),
        (DVec3::ZERO, 1e5),
        (DVec3::new(0.3, -0.7, 0.1), 1.7),
        (DVec3::new(148_376.0, 1234.0, -223_423.0), 1000.0),
        (DVec3::new(148_376.0, 1234.0, -223_423.0), 10.0),
    ] {
        let corner = |i: usize| (center + points[i] * radius).as_vec3();
        let geometry = geometry(faces.iter().map(|face| Shape::Triangle { vertices: face.map(corner) }));
        assert_eq!(geometry.dropped, 0);
        let mut rays = Vec::new();
        for round in 0..3 {
            let eye = center + if round == 0 { DVec3::ZERO } else { random.direction() * radius * 0.7 };
            rays.extend((0..points.len()).map(|i| Ray::towards(eye, corner(i).as_dvec3())));
            for &[i, j, _] in &faces {
                let along = random.within(0.0, 1.0);
                rays.push(Ray::towards(eye, corner(i).as_dvec3().lerp(corner(j).as_dvec3(), along)));
            }
        }
        for use_bvh in [false, true] {
            let found = dispatch!(SimdToken::best(), simd => closest(simd, &geometry, use_bvh, &rays));
            let leaks: Vec<&Ray> =
                rays.iter().zip(&found).filter(|(_, hit)| hit.1 == NO_PRIMITIVE).map(|(ray, _)| ray).collect();
            assert!(
                leaks.is_empty(),
                "{} of {} rays leak at {center} x {radius}: {:?}",
                leaks.len(),
                rays.len(),
                leaks[0]
            );
        }
    }
}

#[test]
fn a_heap_of_equal_primitives_is_searched_to_the_end() {
    for &kind in PrimitiveKind::ALL {
        let shapes = vec![shape(kind, &mut Random(SplitMix64(6)), DVec3::ZERO, 1.0, 0.9); 2000];
        let geometry = geometry(shapes);
        let mut random = Random(SplitMix64(7));
        let rays = rays_around(&mut random, DVec3::ZERO, 1.0, 64);
        for use_bvh in [false, true] {
            let found = dispatch!(SimdToken::best(), simd => closest(simd, &geometry, use_bvh, &rays));
            assert!(found.iter().any(|hit| hit.1 == 0), "{kind:?}: nothing was hit");
            assert!(found.iter().all(|hit| hit.1 == 0 || hit.1 == NO_PRIMITIVE), "{kind:?}: a later one was hit");
        }
    }
}
