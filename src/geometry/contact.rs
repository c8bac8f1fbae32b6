//! Surfaces that touch: pairs of primitives that lie in the same place, at least one of which lets light through.
//!
//! A ray starts a little off the surface that it leaves, and so beyond whatever touches that surface. Contacts are found
//! once, when a scene is loaded: only rays that hit one of these primitives have to look for others in the same place.

use super::{Aabb, Geometry, PrimitiveIndex, PrimitiveKind};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Primitives closer than this share of their largest coordinate touch: a little more than the distance by which rays start
/// off a surface of that scale.
const TOLERANCE: f64 = 1.25 / (1 << 19) as f64;

/// Sine of the angle up to which flat primitives are parallel: others meet in a strip that is thinner than a pixel.
const PARALLEL: f64 = 1e-2;

/// More places of one primitive are taken together.
const MOST_PLACES: usize = 8;

/// Candidates that are looked at for one transparent primitive, and at most for all of them together where that is more. More
/// lie close together only in heaps of large transparent triangles.
const CANDIDATES: usize = 1 << 10;
const ALL_CANDIDATES: usize = 1 << 24;

/// Where a primitive touches another.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// A box around it.
    pub bounds: Aabb,
    /// How far apart surfaces may be there.
    pub tolerance: f32,
}

/// The primitives that touch another one, where either of the two is transparent, and where they do.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Ascending.
    primitives: Vec<PrimitiveIndex>,
    /// Where the places of each begin, and where the last ones end.
    starts: Vec<u32>,
    places: Vec<Place>,
}

impl Contacts {
    /// Finds them; `is_transparent` tells of an object whether light passes through it. `None` once `wanted` says no.
    pub fn new(
        geometry: &Geometry,
        objects: u32,
        is_transparent: impl Fn(u32) -> bool + Sync,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Option<Self> {
        let transparent: Vec<u32> = (0..objects).filter(|&object| is_transparent(object)).collect();
        let count: usize = transparent.iter().map(|&object| geometry.indices_of(object).len()).sum();
        let candidates = CANDIDATES.max(ALL_CANDIDATES / count.max(1));
        let largest = f64::from(geometry.reach()) * TOLERANCE;
        let touching = |primitive: PrimitiveIndex| {
            let mut found = Vec::new();
            if !wanted() {
                return found;
            }
            let surface = Surface::new(geometry, primitive);
            let mut left = candidates;
            geometry.overlapping(&surface.bounds.padded(largest as f32), &mut |other| {
                // Of two transparent primitives, the first finds the pair.
                if other == primitive || left == 0 || other < primitive && is_transparent(geometry.object_of(other)) {
                    return;
                }
                left -= 1;
                if let Some(place) = surface.contact(&Surface::new(geometry, other), largest) {
                    found.extend([(primitive, place), (other, place)]);
                }
            });
            found
        };
        let mut found: Vec<(PrimitiveIndex, Place)> = transparent
            .into_par_iter()
            .flat_map(|object| geometry.indices_of(object).into_par_iter())
            .flat_map_iter(touching)
            .collect();
        if !wanted() {
            return None;
        }
        found.par_sort_by_key(|(primitive, _)| *primitive);
        let mut contacts = Self::default();
        for own in found.chunk_by(|a, b| a.0 == b.0) {
            contacts.primitives.push(own[0].0);
            contacts.starts.push(contacts.places.len() as u32);
            let places = own.iter().map(|(_, place)| *place);
            if own.len() > MOST_PLACES {
                contacts.places.extend(places.reduce(Place::union));
            } else {
                contacts.places.extend(places);
            }
        }
        contacts.starts.push(contacts.places.len() as u32);
        Some(contacts)
    }

    /// Whether nothing touches.
    pub fn is_empty(&self) -> bool {
        self.primitives.is_empty()
    }

    /// Where a primitive touches others. None for most.
    pub fn places_of(&self, primitive: PrimitiveIndex) -> &[Place] {
        let Ok(at) = self.primitives.binary_search(&primitive) else { return &[] };
        &self.places[self.starts[at] as usize..self.starts[at + 1] as usize]
    }
}

impl Place {
    fn union(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), tolerance: self.tolerance.max(other.tolerance) }
    }
}

/// What decides whether a primitive touches another.
struct Surface {
    object: u32,
    bounds: Aabb,
    form: Form,
}

enum Form {
    /// In a plane.
    Flat {
        /// Unit normal.
        normal: DVec3,
        point: DVec3,
    },
    Sphere {
        center: DVec3,
        radius: f64,
    },
    /// Anything else that is curved.
    Curved,
}

impl Surface {
    fn new(geometry: &Geometry, primitive: PrimitiveIndex) -> Self {
        let (object, bounds) = (geometry.object_of(primitive), geometry.bounds_of(primitive));
        Self { object, bounds, form: Form::new(geometry, primitive) }
    }

    /// How far from it others touch it. Planes have no size of their own: with them the other's counts.
    fn tolerance(&self) -> f64 {
        if !self.bounds.is_finite() {
            return 0.0;
        }
        f64::from(self.bounds.min.abs().max(self.bounds.max.abs()).max_element()) * TOLERANCE
    }

    /// Where two surfaces touch, if they do; `largest` is the tolerance of two that have no size.
    fn contact(&self, other: &Self, largest: f64) -> Option<Place> {
        let both_infinite = !self.bounds.is_finite() && !other.bounds.is_finite();
        let tolerance = if both_infinite { largest } else { self.tolerance().max(other.tolerance()) };
        let [own, others] = [self.bounds, other.bounds].map(|bounds| bounds.padded(tolerance as f32));
        let both = Aabb { min: own.min.max(others.min), max: own.max.min(others.max) };
        if both.is_empty() || !self.touches(other, &both, tolerance) {
            return None;
        }
        let ((&Form::Sphere { center, radius }, &Form::Flat { normal, point })
        | (&Form::Flat { normal, point }, &Form::Sphere { center, radius })) = (&self.form, &other.form)
        else {
            return Some(Place { bounds: both, tolerance: tolerance as f32 });
        };
        // A sphere leaves the plane that it touches at once.
        let touched = center - normal * normal.dot(center - point);
        let reach = (8.0 * radius * tolerance).sqrt() + tolerance;
        let near = Aabb::from_points([touched - reach, touched + reach].map(|corner| corner.as_vec3()));
        let bounds = Aabb { min: near.min.max(both.min), max: near.max.min(both.max) };
        Some(Place { bounds, tolerance: tolerance as f32 })
    }

    /// Whether surfaces touch whose bounds overlap in `both`.
    fn touches(&self, other: &Self, both: &Aabb, tolerance: f64) -> bool {
        let same_object = self.object == other.object;
        match (&self.form, &other.form) {
            (&Form::Flat { normal, point }, &Form::Flat { normal: other_normal, point: other_point }) => {
                // Without area there is nothing to touch.
                if normal == DVec3::ZERO || other_normal == DVec3::ZERO {
                    return false;
                }
                // Neighbours in a mesh touch along their edge; only its back may lie on its front.
                if same_object && normal.dot(other_normal) > 0.0 || normal.cross(other_normal).length() > PARALLEL {
                    return false;
                }
                let min = both.min.max(Vec3::splat(-f32::MAX)).as_dvec3();
                let max = both.max.min(Vec3::splat(f32::MAX)).as_dvec3();
                let middle = (min + max) * 0.5;
                let tilt = normal.cross(other_normal).length() * (max - min).length();
                let height = |normal: DVec3, point: DVec3| normal.dot(middle - point);
                let gap = height(normal, point) - height(other_normal, other_point) * normal.dot(other_normal).signum();
                gap.abs() <= tolerance + tilt
            }
            _ if same_object => false,
            (&Form::Flat { normal, point }, &Form::Sphere { center, radius })
            | (&Form::Sphere { center, radius }, &Form::Flat { normal, point }) => {
                (normal.dot(center - point).abs() - radius).abs() <= tolerance
            }
            (&Form::Sphere { center, radius }, &Form::Sphere { center: other_center, radius: other_radius }) => {
                let distance = center.distance(other_center);
                (distance - radius - other_radius).abs() <= tolerance
                    || (distance - (radius - other_radius).abs()).abs() <= tolerance
            }
            (Form::Curved, _) | (_, Form::Curved) => true,
        }
    }
}

impl Form {
    fn new(geometry: &Geometry, primitive: PrimitiveIndex) -> Self {
        let slot = geometry.slot(primitive);
        let (block, place) = (slot.block as usize, usize::from(slot.place));
        let vector = |x: f32, y: f32, z: f32| DVec3::new(x.into(), y.into(), z.into());
        match slot.kind {
            PrimitiveKind::Triangle | PrimitiveKind::Cutout => {
                let [ax, ay, az, bx, by, bz, cx, cy, cz, winding] = geometry.triangle(primitive).unwrap_or_default();
                let (a, b, c) = (vector(ax, ay, az), vector(bx, by, bz), vector(cx, cy, cz));
                let normal = (b - a).cross(c - a).normalize_or_zero() * f64::from(winding).signum();
                Self::Flat { normal, point: a }
            }
            PrimitiveKind::Disk => {
                let [x, y, z, nx, ny, nz, _] = geometry.disks[block].get(place);
                Self::Flat { normal: vector(nx, ny, nz).normalize_or_zero(), point: vector(x, y, z) }
            }
            PrimitiveKind::Plane => {
                let [x, y, z, distance] = geometry.planes[block].get(place);
                let normal = vector(x, y, z).normalize_or_zero();
                Self::Flat { normal, point: normal * f64::from(distance) }
            }
            PrimitiveKind::Sphere => {
                let [x, y, z, radius] = geometry.spheres[block].get(place);
                Self::Sphere { center: vector(x, y, z), radius: radius.into() }
            }
            PrimitiveKind::Cone => Self::Curved,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Part, PrimitiveId, Shape};

    /// The contacts of shapes, each an object of its own; the first is transparent.
    fn contacts(shapes: &[Shape]) -> Vec<PrimitiveIndex> {
        let part = |(object, &shape): (u32, &Shape)| Part::new(shape, PrimitiveId { object, primitive: 0 });
        let geometry = Geometry::build((0..).zip(shapes).map(part).collect());
        Contacts::new(&geometry, shapes.len() as u32, |object| object == 0, &|| true).unwrap().primitives
    }

    const BALL: Shape = Shape::Sphere { center: Vec3::new(0.0, 1.0, 0.0), radius: 1.0 };
    const FLOOR: Shape = Shape::Plane { point: Vec3::ZERO, normal: Vec3::Y };

    fn triangle(height: f32, tilt: f32) -> Shape {
        let vertices =
            [Vec3::new(-5.0, height, -5.0), Vec3::new(5.0, height + tilt, -5.0), Vec3::new(0.0, height, 5.0)];
        Shape::Triangle { vertices }
    }

    #[test]
    fn what_touches_is_found_and_what_is_near_is_not() {
        let sphere = |x: f32, radius: f32| Shape::Sphere { center: Vec3::new(x, 1.0, 0.0), radius };
        for (other, touches) in [
            (FLOOR, true),
            (Shape::Plane { point: Vec3::NEG_Y * 1e-3, normal: Vec3::Y }, false),
            (Shape::Plane { point: Vec3::Y, normal: Vec3::Y }, false),
            (triangle(0.0, 0.0), true),
            (triangle(0.1, 0.0), false),
            (sphere(2.0, 1.0), true),
            (sphere(0.5, 0.5), true),
            (sphere(0.0, 1.0), true),
            (sphere(0.0, 0.9), false),
            (sphere(1.5, 1.0), false),
        ] {
            assert_eq!(contacts(&[BALL, other]), if touches { vec![0, 1] } else { vec![] }, "{other:?}");
        }
    }

    #[test]
    fn flat_things_touch_where_they_are_parallel() {
        for (other, touches) in [
            (triangle(1.0, 0.0), true),
            (triangle(1.0 + 1e-5, 0.0), true),
            (triangle(1.0 + 3e-5, 0.0), false),
            (triangle(1.01, 0.0), false),
            (triangle(1.0, 1.0), false),
            (Shape::Plane { point: Vec3::Y, normal: Vec3::NEG_Y }, true),
            (Shape::Disk { center: Vec3::Y, normal: Vec3::Y, radius: 1.0 }, true),
            (Shape::Disk { center: Vec3::new(9.0, 1.0, 0.0), normal: Vec3::Y, radius: 1.0 }, false),
        ] {
            assert_eq!(contacts(&[triangle(1.0, 0.0), other]), if touches { vec![0, 1] } else { vec![] }, "{other:?}");
        }
    }

    #[test]
    fn of_one_object_only_a_back_touches_a_front() {
        let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 0.0, 1.0), Vec3::Z];
        let contacts = |corners: [[Vec3; 3]; 2]| {
            let part = |(primitive, vertices): (u32, [Vec3; 3])| {
                Part::new(Shape::Triangle { vertices }, PrimitiveId { object: 0, primitive })
            };
            let geometry = Geometry::build((0..).zip(corners).map(part).collect());
            Contacts::new(&geometry, 1, |_| true, &|| true).unwrap().primitives.len()
        };
        assert_eq!(contacts([[a, b, c], [a, c, d]]), 0);
        assert_eq!(contacts([[a, b, c], [a, c, b]]), 2);
    }
}
