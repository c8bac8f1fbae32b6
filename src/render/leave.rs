//! Where rays start that leave a surface. The one definition: every path takes its margin from here.

use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Rays start this far off the surface that they leave, as a share of the largest coordinate that made the hit point:
/// sixteen units in the last place, so that it holds at any scale of a scene.
const MARGIN: f32 = 1.0 / (1 << 19) as f32;

/// Least cosine at which a ray moves along itself only. Flatter ones would have to go too far.
const FLATTEST: f32 = 1.0 / 16.0;

/// The margin at a hit point of a given scale.
#[inline(always)]
pub fn margin<S: Simd>(scale: S::f32s) -> S::f32s {
    scale * MARGIN
}

/// How far shadow rays may go that start at [`start`]: what lies at the light itself does not shadow it, and the
/// start has already moved towards it.
#[inline(always)]
pub fn reach<S: Simd>(distance: S::f32s, margin: S::f32s) -> S::f32s {
    distance - margin * (2.0 / FLATTEST)
}

/// The start of rays along `direction` from `position`, on the side of `normal`, `margin` off the surface.
///
/// The ray moves along itself, so that its line stays the same: mirrors that mirror each other would multiply any
/// sideways step. Only what a flat ray lacks of the margin is added along the normal.
#[inline(always)]
pub fn start<S: Simd>(
    position: V3<S::f32s>,
    normal: V3<S::f32s>,
    margin: S::f32s,
    direction: V3<S::f32s>,
) -> V3<S::f32s> {
    let cosine = normal.dot(direction);
    let ahead = margin / cosine.max(FLATTEST);
    let lacking = (margin - ahead * cosine).max(0.0);
    position + direction.scale(ahead) + normal.scale(lacking)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::primitive::{Cone, Cutout, Disk, Kernel, Plane, Sphere, Triangle, for_each_primitive};
    use crate::geometry::{
        ClosestHit, Geometry, NO_PRIMITIVE, Packet, Part, PrimitiveId, PrimitiveKind, Search, Shape, Stack,
    };
    use crate::math::random::SplitMix64;
    use crate::math::{SimdToken, dispatch};
    use glam::Vec3;

    /// Random numbers and what tests make of them.
    struct Random(SplitMix64);

    impl Random {
        fn within(&mut self, min: f64, max: f64) -> f64 {
            self.0.within(min, max)
        }

        fn direction(&mut self) -> Vec3 {
            let v = [(); 3].map(|()| self.within(-1.0, 1.0) as f32);
            Vec3::from(v).normalize()
        }

        fn magnitude(&mut self, min: f64, max: f64) -> f32 {
            10_f64.powf(self.within(min, max)) as f32
        }
    }

    fn shape(kind: PrimitiveKind, random: &mut Random, center: Vec3, size: f32) -> Shape {
        let (a, b) = (random.direction(), random.direction());
        match kind {
            PrimitiveKind::Sphere => Shape::Sphere { center, radius: size },
            PrimitiveKind::Plane => Shape::Plane { point: center, normal: a },
            PrimitiveKind::Disk => Shape::Disk { center, normal: a, radius: size },
            PrimitiveKind::Triangle | PrimitiveKind::Cutout => {
                Shape::Triangle { vertices: [center - a * size, center + a * size, center + b * size] }
            }
            PrimitiveKind::Cone => {
                let (base, top) = (center - a * size, center + a * size);
                Shape::Cone { base, top, radius_base: size, radius_top: size * random.within(0.0, 1.0) as f32 }
            }
        }
    }

    /// The first hit of a ray.
    fn closest<S: Simd>(simd: S, geometry: &Geometry, origin: Vec3, direction: Vec3) -> Option<f32> {
        let packet = Packet::new(geometry, V3::splat(simd, origin), V3::splat(simd, direction));
        let (zero, far) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, f32::INFINITY));
        let mut visitor = ClosestHit::new(simd, zero, far);
        Search::new(geometry, false).traverse(simd, &packet, &mut Stack::default(), &mut visitor);
        (visitor.primitive[0] != NO_PRIMITIVE).then(|| visitor.t[0])
    }

    /// [`start`] of a single ray.
    fn start_one<S: Simd>(simd: S, position: Vec3, normal: Vec3, margin: f32, direction: Vec3) -> Vec3 {
        let [position, normal, direction] = [position, normal, direction].map(|v| V3::splat(simd, v));
        start::<S>(position, normal, S::f32s::splat(simd, margin), direction).lane(0)
    }

    macro_rules! define_surface {
        ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
            /// Position, normal and margin at a hit of the only primitive.
            fn surface<S: Simd>(simd: S, geometry: &Geometry, origin: Vec3, direction: Vec3, t: f32) -> (Vec3, Vec3, f32) {
                let (origin, direction) = (V3::splat(simd, origin), V3::splat(simd, direction));
                let t = S::f32s::splat(simd, t);
                match geometry.slot(0).kind {
                    $(PrimitiveKind::$kernel => {
                        let fields: [S::f32s; $fields] = geometry.$blocks[0].splat(simd, 0);
                        let point = $kernel::surface(&fields, origin, direction, t);
                        (point.position.lane(0), point.normal.lane(0), margin::<S>(point.scale)[0])
                    })+
                }
            }
        };
    }
    for_each_primitive!(define_surface);

    /// A ray that leaves the outside of something convex never meets it again, at any scale and place.
    #[test]
    fn what_was_left_is_not_met_again() {
        let mut random = Random(SplitMix64(1));
        let token = SimdToken::best();
        for &kind in PrimitiveKind::ALL {
            let (mut left, mut met) = (0, Vec::new());
            for _ in 0..30_000 {
                let center = random.direction() * random.magnitude(-6.0, 6.0);
                // Smaller things are lost in the rounding of their own coordinates.
                let size = random.magnitude(-6.0, 6.0).max(center.length() * 1e-3);
                let shape = shape(kind, &mut random, center, size);
                let part = Part::new(shape, PrimitiveId { object: 0, primitive: 0 });
                let geometry = Geometry::build(vec![part]);
                let origin = center + random.direction() * size * random.magnitude(0.0, 2.0);
                let target = center + random.direction() * size * random.within(0.0, 1.0) as f32;
                let direction = (target - origin).normalize();
                let Some(t) = dispatch!(token, simd => closest(simd, &geometry, origin, direction)) else { continue };
                let (position, normal, margin) =
                    dispatch!(token, simd => surface(simd, &geometry, origin, direction, t));
                let from_behind = direction.dot(normal) > 0.0;
                if from_behind && matches!(kind, PrimitiveKind::Sphere | PrimitiveKind::Cone) {
                    continue;
                }
                let facing = if from_behind { -normal } else { normal };
                // Any direction off the surface, some of them flat.
                let off = random.direction();
                let flatness = random.magnitude(-4.0, 0.0);
                let across = (off - facing * off.dot(facing)).normalize();
                let away = (across + facing * flatness).normalize();
                left += 1;
                let start = dispatch!(token, simd => start_one(simd, position, facing, margin, away));
                if let Some(t) = dispatch!(token, simd => closest(simd, &geometry, start, away)) {
                    met.push(format!("{shape:?} from {origin} along {direction}, then {away}, at {t}"));
                }
            }
            assert!(left > 5000, "{kind:?}: only {left} rays were tried");
            assert!(met.is_empty(), "{kind:?}: {} of {left}, such as {}", met.len(), met[0]);
        }
    }
}
