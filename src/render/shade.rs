//! Shading one level of a tile's paths: local light at each hit, shadow rays for it, and the rays that follow.

use super::brdf::Reflectance;
use super::frame::Frame;
use super::gather::{Hits, Materials, Surfaces, surfaces};
use super::leave;
use super::queue::{RUN, RayQueue, ShadowQueue};
use super::secondary::{self, Incident};
use super::tables::Row;
use super::tile::{Seen, Worker};
use crate::geometry::NO_PRIMITIVE;
use crate::math::V3;
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
    opacity: V3<S::f32s>,
}

/// Shades the hits in `worker.rays`; leaves shadow rays in `worker.shadows` and rays of the next level in
/// `worker.next_rays`.
pub(super) fn shade<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, worker: &mut Worker) {
    worker.next_rays.clear();
    if frame.plan.media {
        absorb(frame, worker);
    }
    simd.vectorize(
        #[inline(always)]
        || {
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

/// Begins the next run of shadow rays towards every light.
fn mark_runs(shadows: &mut [ShadowQueue]) {
    for queue in shadows {
        queue.mark_run();
    }
}

/// Weakens rays by what they crossed inside of bodies.
fn absorb(frame: &Frame<'_>, worker: &mut Worker) {
    let Worker { rays, media, .. } = worker;
    for at in 0..rays.len() {
        let Some(body) = media.current(rays.media[at]) else { continue };
        let absorption = absorption_of(frame.scene, body);
        if absorption != Vec3::ZERO {
            let length = if rays.primitive[at] == NO_PRIMITIVE { f32::INFINITY } else { rays.t[at] };
            let left = absorption.to_array().map(|a| if a == 0.0 { 1.0 } else { libm::expf(-a * length) });
            rays.weight.set(at, rays.weight.get(at) * Vec3::from_array(left));
        }
    }
}

fn absorption_of(scene: &Scene, object: u32) -> Vec3 {
    scene.materials[scene.objects[object as usize].material as usize].absorption
}

#[inline(always)]
fn shade_packet<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, at: usize, worker: &mut Worker) {
    let lanes = at..at + S::f32s::LEN;
    let Worker { rays, next_rays, shadows, media, color: pixels, seen, stats, .. } = worker;
    let hits = Hits::new(simd, &rays.primitive[lanes.clone()]);
    let count = (rays.len() - at).min(S::f32s::LEN);
    let missed = |lane: usize| rays.weight.get(at + lane) * frame.scene.render.background;
    if hits.active == 0 {
        for lane in 0..count {
            add(pixels, rays.sample[at + lane], missed(lane));
        }
        return;
    }
    let (origin, direction) = (rays.origin.load::<S>(simd, at), rays.direction.load::<S>(simd, at));
    let t = S::f32s::from_slice(simd, &rays.t[lanes.clone()]);
    let surfaces = surfaces(simd, frame, &hits, origin, direction, t);
    let view = View::new(simd, &surfaces, direction);
    if level == 1 && frame.keeps_normals {
        for lane in hits.lanes() {
            seen[rays.sample[at + lane] as usize].normal = view.normal.lane(lane).into();
        }
    }

    let materials = Materials::new(simd, frame, &hits);
    let (color, emission) = materials.colors(simd, frame, &hits, &surfaces);
    let lit = Lit::<S> {
        active: Mask::<S>::from_bitmask(simd, hits.active),
        position: surfaces.point.position,
        facing: view.facing,
        margin: leave::margin::<S>(surfaces.point.scale),
        normal: view.normal,
        to_viewer: -direction,
        weight: rays.weight.load(simd, at),
        opacity: materials.triple(simd, frame, Row::Opacity),
    };
    let ambient = V3::splat(simd, frame.ambient) * materials.triple(simd, frame, Row::Ambient);
    let own = lit.weight * (lit.opacity * ambient * color + emission);
    // In queue order, hits and misses alike: rays of one sample may lie in one packet or in two, as wide as it is.
    for lane in 0..count {
        let light = if hits.active >> lane & 1 == 0 { missed(lane) } else { own.lane(lane) };
        add(pixels, rays.sample[at + lane], light);
    }

    let reflectance = Reflectance::gather(simd, frame, &materials, color, lit.opacity);
    let samples = S::u32s::from_slice(simd, &rays.sample[lanes.clone()]);
    let primitives = S::u32s::from_slice(simd, &rays.primitive[lanes]);
    let flat = Mask::<S>::from_bitmask(simd, surfaces.flat);
    let source = flat.select(primitives, S::u32s::splat(simd, NO_PRIMITIVE));
    for (light, queue) in frame.lights.iter().zip(shadows) {
        let Some((reaching, to_light, distance, gain)) = light_gain(simd, light, &lit, &reflectance) else {
            continue;
        };
        let start = leave::start::<S>(lit.position, lit.facing, lit.margin, to_light);
        let reach = leave::reach::<S>(distance, lit.margin);
        queue.push_lanes::<S>(reaching, start, to_light, reach, gain, samples, source);
    }

    if level < frame.plan.depth && (frame.plan.reflections || frame.plan.refractions) {
        let spawns = |material: usize| frame.tables.materials[material].secondary;
        if materials.any(spawns) {
            for lane in hits.lanes().filter(|&lane| spawns(materials.of(lane))) {
                let incident = Incident {
                    direction: direction.lane(lane),
                    position: surfaces.point.position.lane(lane),
                    facing: view.facing.lane(lane),
                    margin: lit.margin[lane],
                    normal: view.normal.lane(lane),
                    entering: !view.from_behind.test(lane),
                    object: frame.scene.geometry.ids[hits.primitives[lane] as usize].object,
                    color: color.lane(lane),
                    weight: rays.weight.get(at + lane),
                    sample: rays.sample[at + lane],
                    media: rays.media[at + lane],
                };
                secondary::follow(frame, &incident, media, next_rays, &mut stats.rays);
            }
        }
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

/// Adds light to a sample.
#[inline(always)]
pub(super) fn add(pixels: &mut [[f32; 3]], sample: u32, light: Vec3) {
    let pixel = &mut pixels[sample as usize];
    *pixel = [pixel[0] + light.x, pixel[1] + light.y, pixel[2] + light.z];
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
    let zero = S::f32s::splat(simd, 0.0);
    let (to_light, distance) = match light.kind {
        LightKind::Point { position } | LightKind::Spot { position, .. } => {
            let to = V3::splat(simd, position) - lit.position;
            let distance = to.dot(to).sqrt();
            (V3::new(to.x / distance, to.y / distance, to.z / distance), distance)
        }
        LightKind::Directional { direction } => (V3::splat(simd, -direction), S::f32s::splat(simd, f32::INFINITY)),
    };
    let n_dot_l = lit.normal.dot(to_light);
    let mut reaching = lit.active & n_dot_l.simd_gt(zero);
    if !reaching.any_true() {
        return None;
    }
    let mut arriving = V3::splat(simd, light.color);
    if let LightKind::Spot { direction, cos_inner, cos_outer, .. } = light.kind {
        let share = spot_share(simd, to_light, direction, cos_inner, cos_outer);
        reaching &= share.simd_gt(zero);
        if !reaching.any_true() {
            return None;
        }
        arriving = arriving.scale(share);
    }
    if light.falloff == Falloff::InverseSquare && !matches!(light.kind, LightKind::Directional { .. }) {
        arriving = arriving.scale(S::f32s::splat(simd, 1.0) / (distance * distance));
    }

    let reflected = reflectance.towards(simd, lit.normal, lit.to_viewer, to_light, n_dot_l);
    Some((reaching, to_light, distance, lit.weight * arriving * reflected))
}

/// glTF's KHR_lights_punctual: the square of a linear ramp between the cosines of the two half-angles.
#[inline(always)]
fn spot_share<S: Simd>(simd: S, to_light: V3<S::f32s>, direction: Vec3, cos_inner: f32, cos_outer: f32) -> S::f32s {
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    let cosine = V3::splat(simd, -direction).dot(to_light);
    let ramp = (cosine - cos_outer) / (cos_inner - cos_outer).max(1e-4);
    let ramp = ramp.max(zero).min(one);
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
