//! What holds of triangles that are seen from one side only.

use super::primitive::{Kernel, Triangle};
use super::*;
use crate::math::random::SplitMix64;
use crate::math::{SimdToken, V3, dispatch};
use crate::settings::SimdLevel;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::{DAffine3, DVec3, Vec3};
use std::sync::Arc;

struct Random(SplitMix64);

impl Random {
    fn point(&mut self) -> DVec3 {
        DVec3::new(self.0.within(-1.0, 1.0), self.0.within(-1.0, 1.0), self.0.within(-1.0, 1.0))
    }

    fn triangle(&mut self) -> [Vec3; 3] {
        [(); 3].map(|()| self.point().as_vec3())
    }

    /// A ray from about the origin's neighbourhood into it.
    fn ray(&mut self) -> [Vec3; 2] {
        let (origin, target) = (self.point() * 2.0, self.point() * 0.7);
        [origin.as_vec3(), (target - origin).normalize().as_vec3()]
    }
}

fn part(vertices: [Vec3; 3], object: u32, one_sided: bool) -> Part {
    Part { one_sided, ..Part::new(Shape::Triangle { vertices }, PrimitiveId { object, primitive: 0 }) }
}

/// What a way of searching finds of each ray: distance and primitive.
type Found = Vec<(u32, PrimitiveIndex)>;

/// What rays see, and whether anything stops light along them, packet by packet and ray by ray.
fn search<S: Simd>(simd: S, geometry: &Geometry, use_bvh: bool, rays: &[[Vec3; 2]]) -> [(Found, Vec<bool>); 2] {
    let search = Search::new(geometry, use_bvh);
    let mut stack = Stack::default();
    let mut all = [(Vec::new(), Vec::new()), (Vec::new(), Vec::new())];
    for rays in rays.chunks(S::f32s::LEN) {
        let lanes =
            |part: usize, axis: usize| S::f32s::from_fn(simd, |lane| rays[lane.min(rays.len() - 1)][part][axis]);
        let vectors = |part: usize| V3::new(lanes(part, 0), lanes(part, 1), lanes(part, 2));
        let packet = Packet::new(geometry, vectors(0), vectors(1));
        let (zero, far) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, f32::INFINITY));
        for (alone, (seen, stopped)) in [false, true].into_iter().zip(&mut all) {
            let mut closest = ClosestHit::new(simd, zero, far);
            let mut any = AnyHit::new(simd, far, S::u32s::splat(simd, NO_PRIMITIVE), Opaque::All);
            if alone {
                search.traverse_alone(simd, &packet, &mut stack, &mut closest);
                search.traverse_alone(simd, &packet, &mut stack, &mut any);
            } else {
                search.traverse(simd, &packet, &mut stack, &mut closest);
                search.traverse(simd, &packet, &mut stack, &mut any);
            }
            seen.extend((0..rays.len()).map(|lane| (closest.t[lane].to_bits(), closest.primitive[lane])));
            stopped.extend((0..rays.len()).map(|lane| any.blocked.test(lane)));
        }
    }
    all
}

fn levels() -> impl Iterator<Item = SimdToken> {
    let all = [SimdLevel::Off, SimdLevel::Sse4, SimdLevel::Avx2, SimdLevel::Avx512];
    all.into_iter().filter_map(SimdToken::new)
}

/// The cosine, times some length, under which a ray meets the front of a triangle, in double precision.
fn frontness([a, b, c]: [Vec3; 3], direction: Vec3) -> f64 {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    -(b - a).cross(c - a).dot(direction.as_dvec3())
}

#[test]
fn fronts_are_seen_backs_are_not_and_both_stop_light() {
    let mut random = Random(SplitMix64(1));
    let (mut fronts, mut backs) = (0, 0);
    for _ in 0..3000 {
        let vertices = random.triangle();
        let [one, two] = [true, false].map(|one_sided| Geometry::build(vec![part(vertices, 0, one_sided)]));
        let rays: Vec<_> = (0..4).map(|_| random.ray()).collect();
        let [(own, stopped), _] = dispatch!(SimdToken::best(), simd => search(simd, &one, false, &rays));
        let [(either, stopped_by_either), _] = dispatch!(SimdToken::best(), simd => search(simd, &two, false, &rays));
        assert_eq!(stopped, stopped_by_either);
        for ((&[origin, direction], own), either) in rays.iter().zip(own).zip(either) {
            let frontness = frontness(vertices, direction);
            if frontness.abs() < 1e-4 {
                continue;
            }
            let is_hit = either.1 == 0;
            assert_eq!(own.1 == 0, is_hit && frontness > 0.0, "{origin} along {direction}: {vertices:?}");
            assert!(own.1 != 0 || own.0 == either.0);
            fronts += usize::from(is_hit && frontness > 0.0);
            backs += usize::from(is_hit && frontness < 0.0);
        }
    }
    assert!(fronts > 500 && backs > 500, "{fronts} {backs}");
}

#[test]
fn every_path_sees_and_stops_the_same() {
    let mut random = Random(SplitMix64(2));
    for _ in 0..20 {
        let parts = (0..300).map(|object| {
            let middle = random.point();
            let vertices = random.triangle().map(|v| (middle + v.as_dvec3() * 0.4).as_vec3());
            part(vertices, object / 2, object % 3 > 0)
        });
        let geometry = Geometry::build(parts.collect());
        assert!(geometry.bvh.is_some() && geometry.one_sided);
        assert_eq!(geometry.count_one_sided(), 200);
        let mut rays: Vec<_> = (0..64).map(|_| random.ray()).collect();
        // Packets that keep together take another way than those that do not.
        let [eye, ahead] = rays[0];
        rays.extend((0..64).map(|_| [eye, (ahead + random.point().as_vec3() * 0.05).normalize()]));
        let off = SimdToken::new(SimdLevel::Off).unwrap();
        let [expected, alone] = dispatch!(off, simd => search(simd, &geometry, false, &rays));
        assert_eq!(expected, alone);
        assert!(expected.0.iter().filter(|(_, primitive)| *primitive != NO_PRIMITIVE).count() > 30);
        for token in levels() {
            for use_bvh in [false, true] {
                for found in dispatch!(token, simd => search(simd, &geometry, use_bvh, &rays)) {
                    assert!(found == expected, "{} with bvh {use_bvh}", token.name());
                }
            }
        }
    }
}

#[test]
fn instances_have_sides_of_their_own() {
    let mut random = Random(SplitMix64(3));
    let vertices: Vec<DVec3> = (0..60).map(|_| random.point()).collect();
    let triangles: Vec<[u32; 3]> = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = Arc::new(Mesh { vertices, triangles, ..Mesh::default() });
    let shared = SharedMesh::new(Arc::clone(&mesh), &|| true).unwrap();
    let scales = [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(0.5, -2.0, -1.0), DVec3::new(-1.0, -0.7, -1.0)];
    let (mut parts, mut placed) = (Vec::new(), Vec::new());
    for (object, scale) in (0..).zip(scales) {
        let matrix = DAffine3::from_scale(scale) * DAffine3::from_translation(random.point() * 0.3);
        let to_world = Transform::new(matrix).unwrap();
        let one_sided = object != 2;
        let mut bounds = Aabb::EMPTY;
        for (primitive, corners) in (0..).zip(&mesh.triangles) {
            let [a, b, c] = corners.map(|i| to_world.point(mesh.vertices[i as usize]).as_vec3());
            let vertices = if scale.element_product() < 0.0 { [a, c, b] } else { [a, b, c] };
            bounds = bounds.union(Aabb::from_points(vertices));
            let id = PrimitiveId { object, primitive };
            parts.push(Part { one_sided, ..Part::new(Shape::Triangle { vertices }, id) });
        }
        let with_area = mesh.triangles.len() as u32;
        let mut instance = Instance::new((0, &shared), object, to_world, bounds, with_area).unwrap();
        instance.one_sided = one_sided;
        placed.push(instance);
    }
    let flat = Geometry::build(parts);
    let instanced = Geometry::build_with(Vec::new(), Instances { meshes: vec![shared], placed });
    assert_eq!((flat.count_one_sided(), instanced.count_one_sided()), (60, 60));
    let mut rays: Vec<_> = (0..400).map(|_| random.ray()).collect();
    let [eye, ahead] = rays[0];
    rays.extend((0..64).map(|_| [eye, (ahead + random.point().as_vec3() * 0.05).normalize()]));
    let [expected, _] = dispatch!(SimdToken::best(), simd => search(simd, &flat, false, &rays));
    assert!(expected.0.iter().filter(|(_, primitive)| *primitive != NO_PRIMITIVE).count() > 100);
    for token in levels() {
        for use_bvh in [false, true] {
            for found in dispatch!(token, simd => search(simd, &instanced, use_bvh, &rays)) {
                assert!(found == expected, "{} with bvh {use_bvh}", token.name());
            }
        }
    }
}

fn normal_bits<S: Simd>(simd: S, vertices: [Vec3; 3], one_sided: bool) -> [u32; 3] {
    let fields = Triangle::fields_of(vertices, one_sided).map(|field| S::f32s::splat(simd, field));
    let zero = V3::zero(simd);
    let direction = V3::splat(simd, Vec3::Z);
    let surface = Triangle::surface(&fields, zero, direction, S::f32s::splat(simd, 1.0));
    surface.normal.lane(0).to_array().map(f32::to_bits)
}

#[test]
fn normals_have_the_same_bits_with_one_side() {
    let mut random = Random(SplitMix64(4));
    for round in 0..3000 {
        let scale = 10_f32.powi(round % 13 - 6);
        let vertices = random.triangle().map(|v| v * scale);
        let [one, two] =
            [true, false].map(|one_sided| dispatch!(SimdToken::best(), simd => normal_bits(simd, vertices, one_sided)));
        assert_eq!(one, two, "{vertices:?}");
    }
}
