//! Shading one level of a tile's paths: local light at each hit, shadow rays for it, and the rays that follow.

use super::absorption::absorb;
use super::brdf::Reflectance;
use super::contact::{self, Touching};
use super::direct::{Lit, light_gain};
use super::frame::Frame;
use super::gather::{Hits, Surfaces, surfaces, surfaces_of_one, surfaces_of_several};
use super::leave;
use super::materials::{Materials, MixedMaterials, OneMaterial};
use super::queue::{RayQueue, ShadowPacket};
use super::resolve::undo_neutral;
use super::samples::CELL;
use super::secondary::{self, Incident};
use super::skin::Skin;
use super::sky;
use super::tables::{MIRROR_ROUGHNESS, Row};
use super::texture_place::Sight;
use super::tile::{Seen, Worker};
use crate::geometry::{NO_PRIMITIVE, PrimitiveIndex};
use crate::math::V3;
use crate::settings::ToneMap;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use std::ops::Range;

/// The colour in which surfaces are shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Paint {
    /// Their own.
    #[default]
    Own,
    /// White instead, for light that a texture is to be multiplied by.
    White,
    /// Black instead, for light that does not depend on the colour.
    Black,
}

impl Paint {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Own, Self::White, Self::Black];
}

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// Makes ready for shading the hits in `worker.rays`.
pub(super) fn begin<S: Simd>(simd: S, frame: &Frame<'_>, worker: &mut Worker) {
    for queue in [&mut worker.mirrored, &mut worker.refracted] {
        queue.clear();
        queue.reserve(worker.rays.len());
    }
    if frame.plan.absorption {
        absorb(simd, frame, worker);
    }
}

/// Shades a run of the hits in `worker.rays`, which begins with a packet; leaves shadow rays in `worker.shadows`, and
/// appends rays of the next level to `worker.mirrored` and `worker.refracted`.
pub(super) fn shade<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, run: Range<usize>, worker: &mut Worker) {
    for queue in &mut worker.shadows {
        queue.clear();
        queue.reserve(run.len());
        queue.mark_run();
    }
    simd.vectorize(
        #[inline(always)]
        || {
            for at in run.step_by(S::f32s::LEN) {
                shade_packet(simd, frame, level, at, worker);
            }
        },
    );
    for queue in &mut worker.shadows {
        queue.mark_run();
    }
}

/// Bit set of the lanes of the packet at `at` that are rays and not padding.
#[inline(always)]
pub(super) fn present<S: Simd>(rays: &RayQueue, at: usize) -> u64 {
    (1 << (rays.len() - at).min(S::f32s::LEN)) - 1
}

#[inline(always)]
fn shade_packet<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, at: usize, worker: &mut Worker) {
    let lanes = at..at + S::f32s::LEN;
    let hits = Hits::new(simd, &worker.rays.primitive[lanes.clone()]);
    if hits.active == 0 {
        let Worker { rays, color, .. } = worker;
        let background = rays.weights(simd, at) * sky::beyond(simd, frame, level, rays, at);
        color.deposit(simd, level == 1, &rays.sample[lanes], present::<S>(rays, at), background);
    } else if level == 1 && is_lit(worker, at) {
        if let Some(primitive) = hits.common.filter(|_| frame.plan.reflections || frame.plan.refractions) {
            simd.vectorize(
                #[inline(always)]
                || follow_one(simd, frame, at, primitive, worker),
            );
        }
    } else if let Some(primitive) = hits.common.filter(|_| !contact::touches(simd, frame, &worker.rays, at)) {
        // Nearly all packets are such: apart from the others they need no masks, no loops over what else was hit and no look
        // at what touches them.
        simd.vectorize(
            #[inline(always)]
            || shade_one(simd, frame, level, at, primitive, worker),
        );
    } else {
        simd.vectorize(
            #[inline(always)]
            || shade_several(simd, frame, level, at, worker),
        );
    }
}

/// Shades the packet at `at`, whose hits are all of one primitive.
#[inline(always)]
fn shade_one<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    level: u32,
    at: usize,
    primitive: PrimitiveIndex,
    worker: &mut Worker,
) {
    let primitives = S::u32s::from_slice(simd, &worker.rays.primitive[at..at + S::f32s::LEN]);
    let hits = Hits::new(simd, primitives.as_slice());
    let rays = Incoming::load(simd, &worker.rays, at);
    let surfaces = surfaces_of_one(simd, frame, &hits, primitive, rays.origin, rays.direction, rays.t);
    shade_surfaces(simd, frame, level, at, &hits, &rays, &surfaces, &OneMaterial::of(frame, primitive), worker);
}

/// Whether the samples of the packet at `at` have their local light.
#[inline(always)]
fn is_lit(worker: &Worker, at: usize) -> bool {
    worker.lit_cells != 0
        && worker.paint.is_none()
        && worker.lit_cells >> (worker.rays.sample[at] as usize / (CELL * CELL)) & 1 == 1
}

/// Appends what follows from the packet at `at`, whose hits are all of one primitive, without local light.
#[inline(always)]
fn follow_one<S: Simd>(simd: S, frame: &Frame<'_>, at: usize, primitive: PrimitiveIndex, worker: &mut Worker) {
    let materials = OneMaterial::of(frame, primitive);
    if !Materials::<S>::any(&materials, |material| material.secondary) {
        return;
    }
    let primitives = S::u32s::from_slice(simd, &worker.rays.primitive[at..at + S::f32s::LEN]);
    let hits = Hits::new(simd, primitives.as_slice());
    let rays = Incoming::load(simd, &worker.rays, at);
    let surfaces = surfaces_of_one(simd, frame, &hits, primitive, rays.origin, rays.direction, rays.t);
    let skin = Skin::of(simd, frame, &hits, &surfaces, &materials, &rays.sight(frame, &surfaces));
    let view = View::new(simd, &surfaces, skin.normal(frame, &surfaces), rays.direction);
    // A patch of local light touches nothing.
    follow(simd, frame, 1, at, &hits, &rays, &surfaces, &view, &materials, &skin, None, worker);
}

/// Shades the packet at `at`, whose hits are of several primitives.
#[inline(always)]
fn shade_several<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, at: usize, worker: &mut Worker) {
    let primitives = S::u32s::from_slice(simd, &worker.rays.primitive[at..at + S::f32s::LEN]);
    let hits = Hits::new(simd, primitives.as_slice());
    let rays = Incoming::load(simd, &worker.rays, at);
    let surfaces = surfaces_of_several(simd, frame, &hits, rays.origin, rays.direction, rays.t);
    let materials = MixedMaterials::new(simd, frame, &hits);
    shade_surfaces(simd, frame, level, at, &hits, &rays, &surfaces, &materials, worker);
}

/// A packet of rays that have hit something.
struct Incoming<S: Simd> {
    origin: V3<S::f32s>,
    direction: V3<S::f32s>,
    t: S::f32s,
    weight: V3<S::f32s>,
    /// How long the way from the eye to the hit is.
    way: S::f32s,
}

impl<S: Simd> Incoming<S> {
    #[inline(always)]
    fn load(simd: S, rays: &RayQueue, at: usize) -> Self {
        let t = S::f32s::from_slice(simd, &rays.t[at..at + S::f32s::LEN]);
        Self {
            origin: rays.origins(simd, at),
            direction: rays.direction.load(simd, at),
            t,
            weight: rays.weights(simd, at),
            way: rays.ways(simd, at) + t,
        }
    }

    /// How they see what they hit.
    #[inline(always)]
    fn sight(&self, frame: &Frame<'_>, surfaces: &Surfaces<S>) -> Sight<S> {
        Sight::new(frame, surfaces, self.direction, self.way)
    }
}

#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "what is known of one packet, some of it at compile time")]
fn shade_surfaces<S: Simd, M: Materials<S>>(
    simd: S,
    frame: &Frame<'_>,
    level: u32,
    at: usize,
    hits: &Hits<'_>,
    incoming: &Incoming<S>,
    surfaces: &Surfaces<S>,
    materials: &M,
    worker: &mut Worker,
) {
    let lanes = at..at + S::f32s::LEN;
    let Worker { rays, shadows, color: colors, seen, paint, contacts, .. } = worker;
    let paint = *paint;
    let samples = &rays.sample[lanes.clone()];
    let &Incoming { direction, weight, .. } = incoming;
    let skin = match paint.unwrap_or_default() {
        Paint::Own => Skin::of(simd, frame, hits, surfaces, materials, &incoming.sight(frame, surfaces)),
        Paint::White => Skin::plain(simd, frame, surfaces, materials).painted(V3::splat(simd, Vec3::ONE)),
        Paint::Black => Skin::plain(simd, frame, surfaces, materials).painted(V3::zero(simd)),
    };
    let view = View::new(simd, surfaces, skin.normal(frame, surfaces), direction);
    if level == 1 && frame.keeps_normals && paint.is_none() {
        for lane in hits.lanes() {
            seen[samples[lane] as usize].normal = view.normal.lane(lane).into();
        }
    }

    let mut opacity = materials.triple(simd, Row::Opacity);
    if frame.plan.textures && materials.any(|material| material.maps.transmission.is_some()) {
        let one = V3::splat(simd, Vec3::ONE);
        opacity = one - materials.triple(simd, Row::Transparency).scale(skin.transmission);
    }
    if frame.plan.metallic_roughness && frame.plan.coloured_shadows {
        // No ray goes on through what is too rough for it: such a surface scatters all its light, rather than be black.
        let rough = skin.roughness.simd_ge(S::f32s::splat(simd, MIRROR_ROUGHNESS));
        opacity = V3::select(rough, V3::splat(simd, Vec3::ONE), opacity);
    }
    let active = Mask::<S>::from_bitmask(simd, hits.active);
    let mut ambient = V3::splat(simd, frame.ambient) * materials.triple(simd, Row::Ambient);
    if frame.plan.occlusion {
        ambient = ambient.scale(skin.openness);
    }
    if frame.plan.unlit {
        let unlit = materials.lanes(simd, |material| material.unlit);
        ambient = V3::select(unlit, V3::splat(simd, Vec3::ONE), ambient);
    }
    let covered = if frame.plan.blending { weight.scale(skin.coverage) } else { weight };
    let mut given = skin.emission;
    if let Some(sky) = &frame.sky {
        let light = simd.vectorize(
            #[inline(always)]
            || sky::reflected(simd, frame, sky, materials, &skin, opacity, [view.normal, -direction]),
        );
        given = given + light;
    }
    let mut own = covered * (opacity * ambient * skin.color + given);
    if frame.plan.unlit && frame.encoder.tone_map == ToneMap::Neutral {
        own = unmapped(simd, frame, materials, own);
    }
    if !active.all_true() {
        own = V3::select(active, own, weight * sky::beyond(simd, frame, level, rays, at));
    }
    colors.deposit(simd, level == 1, samples, present::<S>(rays, at), own);

    let place = [surfaces.point.position, direction, view.facing];
    let touching = if M::MAY_TOUCH { Touching::of(simd, frame, contacts, (rays, at), place) } else { None };
    let lit = Lit::<S> {
        active,
        position: surfaces.point.position,
        facing: view.facing,
        margin: margin(surfaces, touching.as_ref()),
        normal: view.normal,
        to_viewer: -direction,
        weight: touching.as_ref().map_or(covered, |touching| covered * touching.filter),
    };
    let reflectance = Reflectance::gather(simd, frame, materials, &skin, opacity);
    let sample = S::u32s::from_slice(simd, samples);
    let primitives = S::u32s::from_slice(simd, hits.primitives);
    // All shapes are flat or, from outside, convex: a ray that leaves their outside does not come back.
    let flat = Mask::<S>::from_bitmask(simd, surfaces.flat);
    let convex = flat | !view.from_behind;
    for (light, queue) in frame.lights.iter().zip(shadows) {
        let Some((reaching, direction, distance, gain)) = light_gain(simd, light, &lit, &reflectance) else {
            continue;
        };
        let gone = convex & lit.facing.dot(direction).simd_gt(S::f32s::splat(simd, 0.0));
        let source = gone.select(primitives, S::u32s::splat(simd, NO_PRIMITIVE));
        let origin = leave::start::<S>(lit.position, lit.facing, lit.margin, direction);
        let distance = leave::reach::<S>(distance, lit.margin);
        queue.push_lanes(reaching, &ShadowPacket::<S> { origin, direction, gain, distance, sample, source });
    }

    if paint.is_none() {
        follow(simd, frame, level, at, hits, incoming, surfaces, &view, materials, &skin, touching.as_ref(), worker);
    }
}

/// `own`, but the light of unlit surfaces so that the tone curve shows their colour. Its share of the pixel is part of the
/// colour that is to be shown: half a colour is not half of its light.
#[inline(always)]
fn unmapped<S: Simd>(simd: S, frame: &Frame<'_>, materials: &impl Materials<S>, own: V3<S::f32s>) -> V3<S::f32s> {
    let gain = S::f32s::splat(simd, frame.tables.unlit_gain());
    let light = undo_neutral(simd, own.scale(S::f32s::splat(simd, 1.0) / gain)).scale(gain);
    V3::select(materials.lanes(simd, |material| material.unlit), light, own)
}

/// How far off surfaces rays start: beyond all that touches them.
#[inline(always)]
fn margin<S: Simd>(surfaces: &Surfaces<S>, touching: Option<&Touching<S>>) -> S::f32s {
    let margin = leave::margin::<S>(surfaces.point.scale);
    touching.map_or(margin, |touching| margin + touching.depth)
}

/// Appends the rays that follow from a packet's hits.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "what is known of one packet, some of it at compile time")]
fn follow<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    level: u32,
    at: usize,
    hits: &Hits<'_>,
    incoming: &Incoming<S>,
    surfaces: &Surfaces<S>,
    view: &View<S>,
    materials: &impl Materials<S>,
    skin: &Skin<S>,
    touching: Option<&Touching<S>>,
    worker: &mut Worker,
) {
    if level < frame.plan.depth
        && (frame.plan.reflections || frame.plan.refractions)
        && materials.any(|material| material.secondary)
    {
        let lanes = at..at + S::f32s::LEN;
        let Worker { rays, mirrored, refracted, media, contacts, stats, .. } = worker;
        let primitives = S::u32s::from_slice(simd, hits.primitives);
        let flat = Mask::<S>::from_bitmask(simd, surfaces.flat);
        let active = Mask::<S>::from_bitmask(simd, hits.active);
        let mut spawning = active & materials.lanes(simd, |material| material.secondary);
        if frame.plan.metallic_roughness {
            // Where it is too rough for that, it neither mirrors nor refracts; what it does not cover is seen all the same.
            let smooth = skin.roughness.simd_lt(S::f32s::splat(simd, MIRROR_ROUGHNESS));
            spawning &= smooth | materials.lanes(simd, |material| material.blended);
        }
        let incident = Incident {
            spawning,
            direction: incoming.direction,
            position: surfaces.point.position,
            facing: view.facing,
            margin: margin(surfaces, touching),
            normal: view.normal,
            from_behind: view.from_behind,
            skin,
            weight: incoming.weight,
            sample: S::u32s::from_slice(simd, &rays.sample[lanes.clone()]),
            media: S::u32s::from_slice(simd, &rays.media[lanes]),
            touching,
            flat: flat.select(primitives, S::u32s::splat(simd, NO_PRIMITIVE)),
            way: incoming.way,
        };
        simd.vectorize(
            #[inline(always)]
            || {
                secondary::follow(
                    simd,
                    frame,
                    hits,
                    materials,
                    &incident,
                    media,
                    contacts,
                    [mirrored, refracted],
                    &mut stats.rays,
                );
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
    fn new(simd: S, surfaces: &Surfaces<S>, normal: V3<S::f32s>, direction: V3<S::f32s>) -> Self {
        let geometric = surfaces.point.normal;
        let from_behind = direction.dot(geometric).simd_gt(S::f32s::splat(simd, 0.0));
        Self {
            from_behind,
            normal: V3::select(from_behind, -normal, normal),
            facing: V3::select(from_behind, -geometric, geometric),
        }
    }
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
    let surfaces = surfaces(simd, frame, &hits, rays.origins(simd, at), direction, t);
    let normal = seen_normal(simd, frame, &hits, &surfaces, direction, t);
    for lane in hits.lanes() {
        let normal = normal.lane(lane).into();
        seen[rays.sample[at + lane] as usize] =
            Seen { primitive: rays.primitive[at + lane], t: rays.t[at + lane], normal };
    }
}

/// Shading normals on the viewer's side, of rays from the eye.
#[inline(always)]
fn seen_normal<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    hits: &Hits<'_>,
    surfaces: &Surfaces<S>,
    direction: V3<S::f32s>,
    t: S::f32s,
) -> V3<S::f32s> {
    let mut normal = surfaces.shading_normal;
    if frame.plan.relief {
        let materials = MixedMaterials::new(simd, frame, hits);
        let sight = Sight::new(frame, surfaces, direction, t);
        normal = Skin::of(simd, frame, hits, surfaces, &materials, &sight).normal(frame, surfaces);
    }
    View::new(simd, surfaces, normal, direction).normal
}
