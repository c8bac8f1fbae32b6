//! Shading one level of a tile's paths: local light at each hit, shadow rays for it, and the rays that follow.

use super::brdf::Reflectance;
use super::frame::Frame;
use super::gather::{Hits, Surfaces, surfaces};
use super::leave;
use super::materials::Materials;
use super::media::OUTSIDE;
use super::queue::{RUN, RayQueue, ShadowQueue};
use super::secondary::{self, Incident};
use super::tables::{FlatMaterial, Row};
use super::tile::{Seen, Worker};
use crate::geometry::NO_PRIMITIVE;
use crate::math::V3;
use crate::math::power::exp;
use crate::scene::light::{Falloff, LightKind};
use crate::scene::{Light, Scene};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// A packet's surfaces seen from where its rays came.
struct Lit<S: Simd> {
    active: Mask<S>,
    position: V3<S::f32s>,
    /// Geometric normal on the viewer's side.
    facing: V3<S::f32s>,
    /// How far off the surface rays start.
    margin: S::f32s,
    /// Shading normal on the viewer's side.
    normal: V3<S::f32s>,
    to_viewer: V3<S::f32s>,
    weight: V3<S::f32s>,
}

/// Shades the hits in `worker.rays`; leaves shadow rays in `worker.shadows`, and rays of the next level in
/// `worker.mirrored` and `worker.refracted`.
pub(super) fn shade<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, worker: &mut Worker) {
    worker.make_room();
    simd.vectorize(
        #[inline(always)]
        || {
            if frame.plan.absorption {
                absorb(simd, frame, worker);
            }
            for at in (0..worker.rays.len()).step_by(S::f32s::LEN) {
                if at % RUN == 0 {
                    mark_runs(&mut worker.shadows);
                }
                shade_packet(simd, frame, level, at, worker);
            }
            mark_runs(&mut worker.shadows);
        },
    );
}

impl Worker {
    /// Makes room for all that the hits in `rays` may be followed by.
    fn make_room(&mut self) {
        for queue in &mut self.shadows {
            queue.reserve(self.rays.len());
        }
        for queue in [&mut self.mirrored, &mut self.refracted] {
            queue.clear();
            queue.reserve(self.rays.len());
        }
    }
}

/// Begins the next run of shadow rays towards every light.
fn mark_runs(shadows: &mut [ShadowQueue]) {
    for queue in shadows {
        queue.mark_run();
    }
}

/// Weakens rays by what they crossed inside of bodies (Beer and Lambert): exp(-absorption · length).
#[inline(always)]
fn absorb<S: Simd>(simd: S, frame: &Frame<'_>, worker: &mut Worker) {
    let Worker { rays, media, .. } = worker;
    for at in (0..rays.len()).step_by(S::f32s::LEN) {
        let lists = &rays.media[at..at + S::f32s::LEN];
        let lanes = S::u32s::from_slice(simd, lists);
        let mut left = lanes.simd_ne(OUTSIDE).to_bitmask() & present::<S>(rays, at);
        while left != 0 {
            let list = lists[left.trailing_zeros() as usize];
            let same = lanes.simd_eq(list);
            left &= !same.to_bitmask();
            let absorption = media.current(list).map_or(Vec3::ZERO, |body| absorption_of(frame.scene, body));
            if absorption != Vec3::ZERO {
                let missed = S::u32s::from_slice(simd, &rays.primitive[at..at + S::f32s::LEN]).simd_eq(NO_PRIMITIVE);
                let t = S::f32s::from_slice(simd, &rays.t[at..at + S::f32s::LEN]);
                let length = missed.select(S::f32s::splat(simd, f32::INFINITY), t);
                let left = transmittance(simd, absorption, length);
                let weight: V3<S::f32s> = rays.weight.load(simd, at);
                rays.weight.store::<S>(at, V3::select(same, weight * left, weight));
            }
        }
    }
}

/// Bit set of the lanes of the packet at `at` that are rays and not padding.
#[inline(always)]
fn present<S: Simd>(rays: &RayQueue, at: usize) -> u64 {
    (1 << (rays.len() - at).min(S::f32s::LEN)) - 1
}

/// What is left after a way through a body.
#[inline(always)]
fn transmittance<S: Simd>(simd: S, absorption: Vec3, length: S::f32s) -> V3<S::f32s> {
    let mut left = [S::f32s::splat(simd, 1.0); 3];
    for (left, a) in left.iter_mut().zip(absorption.to_array()) {
        // An infinite way without absorption takes nothing.
        if a != 0.0 {
            *left = exp::<S, S::f32s>(length * -a);
        }
    }
    V3::new(left[0], left[1], left[2])
}

fn absorption_of(scene: &Scene, object: u32) -> Vec3 {
    scene.materials[scene.objects[object as usize].material as usize].absorption
}

#[inline(always)]
fn shade_packet<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, at: usize, worker: &mut Worker) {
    let lanes = at..at + S::f32s::LEN;
    let Worker { rays, mirrored, refracted, shadows, media, color: colors, seen, stats, .. } = worker;
    let hits = Hits::new(simd, &rays.primitive[lanes.clone()]);
    let (samples, present) = (&rays.sample[lanes.clone()], present::<S>(rays, at));
    let weight: V3<S::f32s> = rays.weight.load(simd, at);
    let background = weight * V3::splat(simd, frame.scene.render.background);
    if hits.active == 0 {
        colors.deposit(simd, level == 1, samples, present, background);
        return;
    }
    let (origin, direction) = (rays.origin.load::<S>(simd, at), rays.direction.load::<S>(simd, at));
    let t = S::f32s::from_slice(simd, &rays.t[lanes.clone()]);
    let surfaces = surfaces(simd, frame, &hits, origin, direction, t);
    let view = View::new(simd, &surfaces, direction);
    if level == 1 && frame.keeps_normals {
        for lane in hits.lanes() {
            seen[samples[lane] as usize].normal = view.normal.lane(lane).into();
        }
    }

    let materials = Materials::new(simd, frame, &hits);
    let mut color = materials.triple(simd, Row::Color);
    let mut emission = if frame.plan.emission { materials.triple(simd, Row::Emission) } else { V3::zero(simd) };
    if frame.plan.textures && materials.any(FlatMaterial::is_textured) {
        materials.look_up(simd, frame, &hits, &surfaces, &mut color, &mut emission);
    }
    let opacity = materials.triple(simd, Row::Opacity);
    let active = Mask::<S>::from_bitmask(simd, hits.active);
    let ambient = V3::splat(simd, frame.ambient) * materials.triple(simd, Row::Ambient);
    let own = weight * (opacity * ambient * color + emission);
    colors.deposit(simd, level == 1, samples, present, V3::select(active, own, background));

    let lit = Lit::<S> {
        active,
        position: surfaces.point.position,
        facing: view.facing,
        margin: leave::margin::<S>(surfaces.point.scale),
        normal: view.normal,
        to_viewer: -direction,
        weight,
    };
    let reflectance = Reflectance::gather(simd, frame, &materials, color, opacity);
    let samples = S::u32s::from_slice(simd, samples);
    let primitives = S::u32s::from_slice(simd, hits.primitives);
    // All shapes are flat or, from outside, convex: a ray that leaves their outside does not come back.
    let convex = Mask::<S>::from_bitmask(simd, surfaces.flat) | !view.from_behind;
    for (light, queue) in frame.lights.iter().zip(shadows) {
        let Some((reaching, to_light, distance, gain)) = light_gain(simd, light, &lit, &reflectance) else {
            continue;
        };
        let gone = convex & lit.facing.dot(to_light).simd_gt(S::f32s::splat(simd, 0.0));
        let source = gone.select(primitives, S::u32s::splat(simd, NO_PRIMITIVE));
        let start = leave::start::<S>(lit.position, lit.facing, lit.margin, to_light);
        let reach = leave::reach::<S>(distance, lit.margin);
        queue.push_lanes::<S>(reaching, start, to_light, reach, gain, samples, source);
    }

    if level < frame.plan.depth
        && (frame.plan.reflections || frame.plan.refractions)
        && materials.any(|material| material.secondary)
    {
        let incident = Incident {
            spawning: active & materials.lanes(simd, |material| material.secondary),
            direction,
            position: lit.position,
            facing: lit.facing,
            margin: lit.margin,
            normal: lit.normal,
            from_behind: view.from_behind,
            color,
            weight,
            samples,
            media: S::u32s::from_slice(simd, &rays.media[lanes]),
        };
        simd.vectorize(
            #[inline(always)]
            || {
                secondary::follow(
                    simd,
                    frame,
                    &hits,
                    &materials,
                    &incident,
                    media,
                    [mirrored, refracted],
                    &mut stats.rays,
                )
            },
        );
    }
}

/// How surfaces lie towards the rays that hit them.
struct View<S: Simd> {
    /// The geometric normal points away from the viewer.
    from_behind: Mask<S>,
    /// Shading normal on the viewer's side.
    normal: V3<S::f32s>,
    /// Geometric normal on the viewer's side.
    facing: V3<S::f32s>,
}

impl<S: Simd> View<S> {
    #[inline(always)]
    fn new(simd: S, surfaces: &Surfaces<S>, direction: V3<S::f32s>) -> Self {
        let geometric = surfaces.point.normal;
        let from_behind = direction.dot(geometric).simd_gt(S::f32s::splat(simd, 0.0));
        Self {
            from_behind,
            normal: V3::select(from_behind, -surfaces.shading_normal, surfaces.shading_normal),
            facing: V3::select(from_behind, -geometric, geometric),
        }
    }
}

/// What a light adds if nothing is in its way, for the lanes that it can reach at all, with the direction and distance
/// to it. `None` if it reaches none.
#[inline(always)]
#[allow(clippy::type_complexity, reason = "four lane vectors that are taken apart at once")]
fn light_gain<S: Simd>(
    simd: S,
    light: &Light,
    lit: &Lit<S>,
    reflectance: &Reflectance<S>,
) -> Option<(Mask<S>, V3<S::f32s>, S::f32s, V3<S::f32s>)> {
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    let mut arriving = V3::splat(simd, light.color);
    let (reaching, to_light, n_dot_l, distance) = match light.kind {
        LightKind::Directional { direction } => {
            let to_light = V3::splat(simd, -direction);
            let n_dot_l = lit.normal.dot(to_light);
            let reaching = lit.active & n_dot_l.simd_gt(zero);
            if !reaching.any_true() {
                return None;
            }
            (reaching, to_light, n_dot_l, S::f32s::splat(simd, f32::INFINITY))
        }
        LightKind::Point { position } | LightKind::Spot { position, .. } => {
            let to = V3::splat(simd, position) - lit.position;
            let above = lit.normal.dot(to);
            let mut reaching = lit.active & above.simd_gt(zero);
            if !reaching.any_true() {
                return None;
            }
            let distance = to.dot(to).sqrt();
            let inverse = one / distance;
            if let LightKind::Spot { direction, cos_inner, cos_outer, .. } = light.kind {
                let cosine = V3::splat(simd, -direction).dot(to) * inverse;
                let share = spot_share::<S>(cosine, cos_inner, cos_outer);
                reaching &= share.simd_gt(zero);
                if !reaching.any_true() {
                    return None;
                }
                arriving = arriving.scale(share);
            }
            if light.falloff == Falloff::InverseSquare {
                arriving = arriving.scale(inverse * inverse);
            }
            (reaching, to.scale(inverse), above * inverse, distance)
        }
    };
    let reflected = reflectance.towards(simd, lit.normal, lit.to_viewer, to_light, n_dot_l);
    Some((reaching, to_light, distance, lit.weight * arriving * reflected))
}

/// How much of a spot's light goes along a direction: the square of a linear ramp between the cosines of its two
/// half-angles, as in glTF's KHR_lights_punctual, which keeps the ramp at least 0.001 wide.
///
/// A cone of less than 2.6° is narrower than that, and would be dim even along its axis: there the ramp is as wide as
/// the cone, so that every spot reaches full brightness at its centre.
#[inline(always)]
fn spot_share<S: Simd>(cosine: S::f32s, cos_inner: f32, cos_outer: f32) -> S::f32s {
    const LEAST_WIDTH: f32 = 1e-3;
    let width = (cos_inner - cos_outer).max(LEAST_WIDTH.min(1.0 - cos_outer)).max(f32::EPSILON);
    let ramp = ((cosine - cos_outer) / width).max(0.0).min(1.0);
    ramp * ramp
}

/// Records what the rays in `worker.rays` see, with normals if they are kept.
pub(super) fn store_seen<S: Simd>(simd: S, frame: &Frame<'_>, worker: &mut Worker) {
    let Worker { rays, seen, .. } = worker;
    simd.vectorize(
        #[inline(always)]
        || {
            for at in (0..rays.len()).step_by(S::f32s::LEN) {
                store_seen_packet(simd, frame, at, rays, seen);
            }
        },
    );
}

#[inline(always)]
fn store_seen_packet<S: Simd>(simd: S, frame: &Frame<'_>, at: usize, rays: &RayQueue, seen: &mut [Seen]) {
    let lanes = at..at + S::f32s::LEN;
    let hits = Hits::new(simd, &rays.primitive[lanes.clone()]);
    for lane in 0..(rays.len() - at).min(S::f32s::LEN) {
        seen[rays.sample[at + lane] as usize] = Seen::NOTHING;
    }
    if hits.active == 0 {
        return;
    }
    let direction = rays.direction.load::<S>(simd, at);
    let t = S::f32s::from_slice(simd, &rays.t[lanes]);
    let surfaces = surfaces(simd, frame, &hits, rays.origin.load(simd, at), direction, t);
    let normal = View::new(simd, &surfaces, direction).normal;
    for lane in hits.lanes() {
        let normal = normal.lane(lane).into();
        seen[rays.sample[at + lane] as usize] =
            Seen { primitive: rays.primitive[at + lane], t: rays.t[at + lane], normal };
    }
}
