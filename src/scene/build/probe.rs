//! Rays into a scene that was just built, to find out what there is to see and how bright it is.

use super::allowance::{Allowance, Allowed};
use crate::geometry::{ClosestHit, Geometry, NO_PRIMITIVE, Packet, PrimitiveIndex, PrimitiveKind, Search, Stack};
use crate::math::{SimdToken, V3, dispatch};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;

/// What a ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met {
    /// How far away.
    pub distance: f32,
    /// Unit geometric normal, on the outer side of what has one; where the primitive is not flat, against the ray that
    /// comes from outside and along the one that comes from inside.
    pub normal: Vec3,
    /// Which primitive it is of.
    pub primitive: PrimitiveIndex,
}

/// A way to ask for closest hits. The answers are the same at every SIMD level.
pub struct Probe<'a> {
    geometry: &'a Geometry,
    stack: Stack,
    allowance: Allowance<'a>,
}

impl<'a> Probe<'a> {
    /// A probe of `geometry`.
    pub fn new(geometry: &'a Geometry) -> Self {
        Self::within(geometry, Allowance::unlimited())
    }

    /// A probe that may look at no more of `geometry` than is allowed.
    pub fn within(geometry: &'a Geometry, allowance: Allowance<'a>) -> Self {
        Self { geometry, stack: Stack::default(), allowance }
    }

    /// What it looks at.
    pub fn geometry(&self) -> &'a Geometry {
        self.geometry
    }

    /// Whether it has looked at all that it may: the last answers mean nothing.
    pub fn is_spent(&self) -> bool {
        self.allowance.is_spent()
    }

    /// Whether some surfaces are seen from one side only.
    pub fn knows_backs(&self) -> bool {
        self.geometry.one_sided
    }

    /// What rays from `origin` meet, farther away than `t_min`: one-sided surfaces from either side.
    pub fn look(&mut self, origin: Vec3, directions: &[Vec3], t_min: f32) -> Vec<Option<Met>> {
        self.met(origin, directions, t_min, false)
    }

    /// What is seen along rays from `origin`, farther away than `t_min`: one-sided surfaces from their front only.
    pub fn see(&mut self, origin: Vec3, directions: &[Vec3], t_min: f32) -> Vec<Option<Met>> {
        self.met(origin, directions, t_min, true)
    }

    fn met(&mut self, origin: Vec3, directions: &[Vec3], t_min: f32, seen_only: bool) -> Vec<Option<Met>> {
        let hits = dispatch!(SimdToken::best(), simd => self.trace(simd, origin, directions, t_min, seen_only));
        let met = |(&(distance, primitive), &direction): (&(f32, PrimitiveIndex), &Vec3)| {
            let flat = (primitive != NO_PRIMITIVE).then(|| self.normal(primitive))?;
            let normal = flat.unwrap_or_else(|| {
                let middle = self.geometry.bounds_of(primitive).center();
                let from_inside = (origin + direction * distance - middle).dot(direction) > 0.0;
                if from_inside { direction } else { -direction }
            });
            Some(Met { distance, normal, primitive })
        };
        hits.iter().zip(directions).map(met).collect()
    }

    /// Unit geometric normal of a primitive at a point on it, on its outer side.
    pub fn normal_at(&self, primitive: PrimitiveIndex, point: Vec3) -> Option<Vec3> {
        self.normal(primitive).or_else(|| self.geometry.normal_at(primitive, point))
    }

    /// What one ray meets.
    pub fn look_along(&mut self, origin: Vec3, direction: Vec3, t_min: f32) -> Option<Met> {
        self.look(origin, &[direction], t_min)[0]
    }

    /// How far away the first primitive is that is seen along one ray, and which it is; [`NO_PRIMITIVE`] for none.
    pub fn seen(&mut self, origin: Vec3, direction: Vec3, t_min: f32) -> (f32, PrimitiveIndex) {
        dispatch!(SimdToken::best(), simd => self.trace(simd, origin, &[direction], t_min, true))[0]
    }

    /// How far away the first primitive is along one ray, seen or not, and which it is; [`NO_PRIMITIVE`] for none.
    pub fn closest(&mut self, origin: Vec3, direction: Vec3, t_min: f32) -> (f32, PrimitiveIndex) {
        dispatch!(SimdToken::best(), simd => self.trace(simd, origin, &[direction], t_min, false))[0]
    }

    fn trace<S: Simd>(
        &mut self,
        simd: S,
        origin: Vec3,
        directions: &[Vec3],
        t_min: f32,
        seen_only: bool,
    ) -> Vec<(f32, PrimitiveIndex)> {
        let search = Search::new(self.geometry, true);
        let always = search.always_tested() as u64;
        let mut hits = Vec::with_capacity(directions.len());
        for own in directions.chunks(S::f32s::LEN) {
            if !self.allowance.take(always.saturating_mul(own.len() as u64)) {
                hits.extend(own.iter().map(|_| (f32::MAX, NO_PRIMITIVE)));
                continue;
            }
            simd.vectorize(
                #[inline(always)]
                || {
                    // Lanes to spare repeat the first ray, and go nowhere.
                    let mut lanes: V3<S::f32s> = V3::splat(simd, own[0]);
                    for (lane, direction) in own.iter().enumerate() {
                        lanes.x.as_mut_slice()[lane] = direction.x;
                        lanes.y.as_mut_slice()[lane] = direction.y;
                        lanes.z.as_mut_slice()[lane] = direction.z;
                    }
                    let packet = Packet::new(self.geometry, V3::splat(simd, origin), lanes);
                    let near = S::f32s::splat(simd, t_min);
                    let mut far = S::f32s::splat(simd, f32::INFINITY);
                    far.as_mut_slice()[own.len()..].fill(-1.0);
                    let closest = ClosestHit::new(simd, near, far);
                    let mut visitor = Allowed { closest, allowance: &self.allowance, seen_only };
                    search.traverse_alone(simd, &packet, &mut self.stack, &mut visitor);
                    let ClosestHit { t, primitive, .. } = visitor.closest;
                    hits.extend((0..own.len()).map(|lane| (t[lane], primitive[lane])));
                },
            );
        }
        hits
    }

    fn normal(&self, primitive: PrimitiveIndex) -> Option<Vec3> {
        let (normal, _) = self.geometry.plane_of(primitive)?;
        // The corners of triangles are stored in another order, and whether that turns them around.
        let is_whole = self.geometry.slot(primitive).kind == PrimitiveKind::Triangle;
        let turned = is_whole && self.geometry.triangle(primitive).is_some_and(|fields| fields[9] < 0.0);
        Some(if turned { -normal } else { normal })
    }
}

/// `count` directions all around, evenly (a Fibonacci lattice; Swinbank and Purser, 2006).
pub fn around(count: usize) -> Vec<Vec3> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let direction = |i: usize| {
        let y = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let (across, angle) = ((1.0 - y * y).sqrt(), golden * i as f64);
        glam::DVec3::new(across * libm::cos(angle), y, across * libm::sin(angle)).as_vec3().normalize()
    };
    (0..count).map(direction).collect()
}

/// How many horizontal directions tell of walls and are tried for the view.
pub const VIEWS: usize = 32;

/// [`VIEWS`] horizontal directions, in order.
pub fn horizontal() -> Vec<Vec3> {
    let direction = |i: usize| {
        let angle = std::f64::consts::TAU * i as f64 / VIEWS as f64;
        Vec3::new(libm::cos(angle) as f32, 0.0, libm::sin(angle) as f32).normalize()
    };
    (0..VIEWS).map(direction).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Part, PrimitiveId, Shape};

    #[test]
    fn tells_the_outer_side_of_triangles_and_what_is_missed() {
        let vertices = [Vec3::ZERO, Vec3::X, Vec3::Y];
        for (corners, normal) in [(vertices, Vec3::Z), ([Vec3::ZERO, Vec3::Y, Vec3::X], Vec3::NEG_Z)] {
            let id = PrimitiveId { object: 0, primitive: 0 };
            let shape = Shape::Triangle { vertices: corners };
            let part = Part::new(shape, id);
            let geometry = Geometry::build(vec![part]);
            let mut probe = Probe::new(&geometry);
            let origin = Vec3::new(0.2, 0.2, 2.0);
            let directions = [Vec3::NEG_Z, Vec3::Z, Vec3::X];
            assert_eq!(
                probe.look(origin, &directions, 0.0),
                [Some(Met { distance: 2.0, normal, primitive: 0 }), None, None]
            );
        }
    }

    #[test]
    fn backs_of_one_sided_triangles_are_met_but_not_seen() {
        let id = PrimitiveId { object: 0, primitive: 0 };
        let part = Part::new(Shape::Triangle { vertices: [Vec3::ZERO, Vec3::X, Vec3::Y] }, id);
        let geometry = Geometry::build(vec![Part { one_sided: true, ..part }]);
        let mut probe = Probe::new(&geometry);
        for (z, is_seen) in [(2.0, true), (-2.0, false)] {
            let (origin, direction) = (Vec3::new(0.2, 0.2, z), Vec3::NEG_Z * z.signum());
            let met = Some(Met { distance: 2.0, normal: Vec3::Z, primitive: 0 });
            assert_eq!(probe.look_along(origin, direction, 0.0), met);
            assert_eq!(probe.see(origin, &[direction], 0.0), [met.filter(|_| is_seen)]);
            assert_eq!(probe.seen(origin, direction, 0.0).1 == 0, is_seen);
        }
    }

    #[test]
    fn round_things_have_an_inside() {
        let id = PrimitiveId { object: 0, primitive: 0 };
        let shape = Shape::Sphere { center: Vec3::ONE, radius: 1.0 };
        let geometry = Geometry::build(vec![Part::new(shape, id)]);
        let mut probe = Probe::new(&geometry);
        for origin in [Vec3::ONE, Vec3::new(1.0, 1.0, 1.9), Vec3::new(1.0, 1.0, 0.1)] {
            assert_eq!(probe.look_along(origin, Vec3::Z, 0.0).map(|met| met.normal), Some(Vec3::Z), "{origin}");
        }
        let outside = probe.look_along(Vec3::new(1.0, 1.0, -3.0), Vec3::Z, 0.0);
        assert_eq!(outside.map(|met| met.normal), Some(Vec3::NEG_Z));
    }

    #[test]
    fn directions_lie_all_around() {
        let all = around(200);
        assert!(all.iter().sum::<Vec3>().length() < 0.5);
        for axis in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
            assert!(all.iter().any(|d| d.dot(axis) > 0.97));
        }
    }
}
