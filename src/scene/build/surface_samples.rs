//! A sample of a scene's surfaces: what its size and its middle are judged by.

use crate::geometry::{Aabb, Geometry, PrimitiveIndex, PrimitiveKind};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// Most primitives that are looked at, apart from one of each object.
const SAMPLES: usize = 1 << 15;
/// Points on each end of a cone, and around a disk.
const RING: usize = 16;

/// A primitive that stands for some of its object.
#[derive(Clone, Debug)]
pub struct Sample {
    /// The object that it belongs to.
    pub object: u32,
    /// Its bounds.
    pub bounds: Aabb,
    /// The area that it stands for.
    pub area: f64,
    /// How many primitives it stands for.
    pub count: f64,
    /// Radius of a sphere, 0 of everything else.
    pub radius: f64,
    /// Where its points are among all points.
    points: std::ops::Range<u32>,
}

/// A sample of all finite surfaces.
#[derive(Debug, Default)]
pub struct SurfaceSamples {
    /// The primitives.
    pub samples: Vec<Sample>,
    points: Vec<Vec3>,
}

impl SurfaceSamples {
    /// Samples the first `objects` objects of `geometry`: the same primitives on every run.
    pub fn of(geometry: &Geometry, objects: usize) -> Self {
        let mut all = Self::default();
        let each = objects.div_ceil(SAMPLES).max(1);
        // With many objects few primitives of each are looked at, but one at least.
        let share = (SAMPLES as f64 / geometry.indices().max(1) as f64).min(1.0);
        for object in (0..objects as u32).step_by(each) {
            let indices = geometry.indices_of(object);
            let least = (SAMPLES / (objects / each).max(1)).clamp(1, 64);
            let wanted = ((indices.len() as f64 * share).ceil() as usize).max(least);
            let step = indices.len().div_ceil(wanted).max(1);
            let stands_for = step.min(indices.len()).max(1) as f64 * each as f64;
            for primitive in indices.step_by(step) {
                all.add(geometry, primitive, object, stands_for);
            }
        }
        all
    }

    /// The points that hold a sample within them, each with the sample's radius around it: of a triangle, its corners,
    /// counter-clockwise seen from outside.
    pub fn points_of(&self, sample: &Sample) -> &[Vec3] {
        &self.points[sample.points.start as usize..sample.points.end as usize]
    }

    fn add(&mut self, geometry: &Geometry, primitive: PrimitiveIndex, object: u32, count: f64) {
        let first = self.points.len() as u32;
        let slot = geometry.slot(primitive);
        let (block, place) = (slot.block as usize, usize::from(slot.place));
        let mut radius = 0.0;
        let area = match slot.kind {
            PrimitiveKind::Plane => return,
            PrimitiveKind::Triangle | PrimitiveKind::Cutout => {
                let Some(fields) = geometry.triangle(primitive) else { return };
                let [a, b, c] = [0, 3, 6].map(|i| Vec3::from_slice(&fields[i..i + 3]));
                // Stored corners may be turned around.
                let corners = if fields[9] < 0.0 { [a, c, b] } else { [a, b, c] };
                self.points.extend(corners);
                let [a, b, c] = corners.map(|corner| corner.as_dvec3());
                (b - a).cross(c - a).length() / 2.0
            }
            PrimitiveKind::Sphere => {
                let [x, y, z, r] = geometry.spheres[block].get(place);
                self.points.push(Vec3::new(x, y, z));
                radius = f64::from(r);
                4.0 * PI * radius * radius
            }
            PrimitiveKind::Disk => {
                let [x, y, z, nx, ny, nz, r] = geometry.disks[block].get(place);
                self.add_ring(Vec3::new(x, y, z), Vec3::new(nx, ny, nz), r);
                PI * f64::from(r) * f64::from(r)
            }
            PrimitiveKind::Cone => {
                let [x, y, z, ax, ay, az, half_height, middle, slope] = geometry.cones[block].get(place);
                let axis = Vec3::new(ax, ay, az);
                for height in [-half_height, half_height] {
                    self.add_ring(Vec3::new(x, y, z) + axis * height, axis, middle + slope * height);
                }
                TAU * f64::from(middle) * 2.0 * f64::from(half_height)
            }
        };
        let points = first..self.points.len() as u32;
        let bounds = geometry.bounds_of(primitive);
        if area > 0.0 && bounds.is_finite() {
            self.samples.push(Sample { object, bounds, area: area * count, count, radius, points });
        } else {
            self.points.truncate(first as usize);
        }
    }

    fn add_ring(&mut self, center: Vec3, normal: Vec3, radius: f32) {
        let (across, along) = normal.any_orthonormal_pair();
        let point = |i: usize| {
            let angle = TAU * i as f64 / RING as f64;
            center + (across * libm::cos(angle) as f32 + along * libm::sin(angle) as f32) * radius
        };
        self.points.extend((0..RING).map(point));
    }
}

impl Sample {
    /// The middle of its bounds.
    pub fn middle(&self) -> DVec3 {
        self.bounds.center().as_dvec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Part, PrimitiveId, Shape};

    fn parts(shapes: impl IntoIterator<Item = (u32, Shape)>) -> Geometry {
        let id = |object, primitive| PrimitiveId { object, primitive };
        let parts = shapes.into_iter().enumerate();
        Geometry::build(parts.map(|(i, (object, shape))| Part::new(shape, id(object, i as u32))).collect())
    }

    #[test]
    fn every_object_is_sampled_and_few_primitives_are_of_large_ones() {
        let triangle = |i: usize| Shape::Triangle { vertices: [Vec3::X, Vec3::Y, Vec3::Z].map(|v| v + i as f32) };
        let many = (0..3 * SAMPLES).map(|i| (0, triangle(i)));
        let few = [(1, Shape::Sphere { center: Vec3::ZERO, radius: 2.0 })];
        let geometry = parts(many.chain(few));
        let samples = SurfaceSamples::of(&geometry, 2).samples;
        assert!((SAMPLES / 2..SAMPLES * 2).contains(&samples.len()), "{}", samples.len());
        let count = samples.iter().map(|sample| sample.count).sum::<f64>();
        assert!((count / (3 * SAMPLES) as f64 - 1.0).abs() < 0.01, "{count}");
        let ball = samples.iter().find(|sample| sample.object == 1).unwrap();
        assert!(ball.radius == 2.0 && (ball.area - 16.0 * PI).abs() < 1e-6);
    }

    #[test]
    fn planes_are_no_part_of_it_and_rings_lie_on_their_ends() {
        let cone = Shape::Cone { base: Vec3::ZERO, top: Vec3::Y * 2.0, radius_base: 1.0, radius_top: 3.0 };
        let geometry = parts([(0, Shape::Plane { point: Vec3::ZERO, normal: Vec3::Y }), (1, cone)]);
        let samples = SurfaceSamples::of(&geometry, 2);
        let [only] = &samples.samples[..] else { panic!("{samples:?}") };
        let points = samples.points_of(only);
        assert_eq!(points.len(), 2 * RING);
        for point in points {
            let radius = point.with_y(0.0).length();
            assert!((radius - (1.0 + point.y)).abs() < 1e-5, "{point}");
        }
    }
}
