//! Which transparent bodies hold the eye.

use super::tables::Tables;
use crate::geometry::{Geometry, PrimitiveIndex, PrimitiveKind};
use crate::scene::{Object, Scene};
use glam::{DVec3, Vec3};

/// Appends the transparent bodies around `eye`, outermost first: half-spaces, then by falling size of their bounds,
/// then in file order.
pub fn bodies_around(scene: &Scene, tables: &Tables, eye: Vec3, bodies: &mut Vec<u32>) {
    for &object in &tables.transparent_bodies {
        if holds(&scene.geometry, object, &scene.objects[object as usize], eye) {
            bodies.push(object);
        }
    }
    let size = |&object: &u32| scene.objects[object as usize].bounds.size().max_element();
    // The stable sort would need memory.
    bodies.sort_unstable_by(|a, b| size(b).total_cmp(&size(a)).then(a.cmp(b)));
}

/// Whether a closed body holds a point, by how often a ray from it leaves the body more than it enters.
///
/// In f64 and one primitive after another: once a frame, for the few bodies that bend light.
fn holds(geometry: &Geometry, object: u32, body: &Object, point: Vec3) -> bool {
    let bounds = body.bounds;
    if point.cmplt(bounds.min).any() || point.cmpgt(bounds.max).any() {
        return false;
    }
    // No special direction: it meets no edge of an axis-aligned box.
    let (origin, direction) = (point.as_dvec3(), DVec3::new(0.569_802_9, 0.601_137_4, 0.560_318_6).normalize());
    let leaving: i32 =
        geometry.indices_of(object).map(|primitive| leavings(geometry, primitive, origin, direction)).sum();
    leaving > 0
}

/// How often a ray leaves a primitive's inside minus how often it enters it.
fn leavings(geometry: &Geometry, primitive: PrimitiveIndex, origin: DVec3, direction: DVec3) -> i32 {
    let slot = geometry.slot(primitive);
    let (block, place) = (slot.block as usize, usize::from(slot.place));
    let vector =
        |fields: &[f32], at: usize| DVec3::new(fields[at].into(), fields[at + 1].into(), fields[at + 2].into());
    let side = |hit: bool, normal: DVec3| match (hit, direction.dot(normal) > 0.0) {
        (false, _) => 0,
        (true, true) => 1,
        (true, false) => -1,
    };
    match slot.kind {
        PrimitiveKind::Sphere => {
            let fields = geometry.spheres[block].get(place);
            let radius = f64::from(fields[3]);
            i32::from((origin - vector(&fields, 0)).length_squared() < radius * radius)
        }
        PrimitiveKind::Plane => {
            let fields = geometry.planes[block].get(place);
            i32::from(vector(&fields, 0).dot(origin) < f64::from(fields[3]))
        }
        PrimitiveKind::Triangle | PrimitiveKind::Cutout => {
            let Some(fields) = geometry.triangle(primitive) else { return 0 };
            let [a, b, c] = [0, 3, 6].map(|at| vector(&fields, at));
            let normal = (b - a).cross(c - a) * f64::from(fields[9]);
            let weights = [
                direction.dot((b - origin).cross(c - b)),
                direction.dot((c - origin).cross(a - c)),
                direction.dot((a - origin).cross(b - a)),
            ];
            let inside = weights.iter().all(|&w| w > 0.0) || weights.iter().all(|&w| w < 0.0);
            side(inside && (a - origin).dot(normal) / direction.dot(normal) > 0.0, normal)
        }
        PrimitiveKind::Disk => {
            let fields = geometry.disks[block].get(place);
            let (to_center, normal) = (vector(&fields, 0) - origin, vector(&fields, 3));
            let t = to_center.dot(normal) / direction.dot(normal);
            let radius = f64::from(fields[6]);
            side(t > 0.0 && (direction * t - to_center).length_squared() <= radius * radius, normal)
        }
        PrimitiveKind::Cone => {
            let fields = geometry.cones[block].get(place);
            let (axis, [half_height, radius, slope]) =
                (vector(&fields, 3), [fields[6], fields[7], fields[8]].map(f64::from));
            let from_middle = origin - vector(&fields, 0);
            let (height, climb) = (from_middle.dot(axis), direction.dot(axis));
            let (across, step) = (from_middle - axis * height, direction - axis * climb);
            let (wall, wall_step) = (radius + slope * height, slope * climb);
            let a = step.length_squared() - wall_step * wall_step;
            let b = across.dot(step) - wall * wall_step;
            let c = across.length_squared() - wall * wall;
            let root = (b * b - a * c).sqrt();
            [(-b - root) / a, (-b + root) / a]
                .into_iter()
                .map(|t| {
                    let on_side = t > 0.0 && (height + climb * t).abs() <= half_height;
                    let outward = (across + step * t).normalize() - axis * slope;
                    side(on_side, outward)
                })
                .sum()
        }
    }
}
