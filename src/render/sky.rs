//! Light of the sky: what rays see that hit nothing, and what surfaces reflect of it without a ray.
//!
//! It depends on the ray and the hit alone, so that pixels are the same whatever found the hits; nothing is in its way.

use super::frame::Frame;
use super::materials::Materials;
use super::queue::{MOST_LANES, RayQueue};
use super::skin::Skin;
use super::tables::{FlatMaterial, MIRROR_ROUGHNESS, Row};
use crate::math::V3;
use crate::math::arctangent::atan2;
use crate::scene::sky::{
    BRIGHTEST, Blurred, GlossyLevel, Irradiance, LEAST_ROUGHNESS, Lobe, Radiance, SkyLight, SkyMap, Smooth,
};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::f32::consts::{FRAC_1_PI, TAU};

/// A sky as the rays of one frame see it.
pub(super) struct Sky<'a> {
    light: &'a SkyLight,
    /// What is seen of it behind things, where that is not its radiance.
    backdrop: Option<Smooth>,
}

/// Square of the sine of the angle that rays may be off the line from the eye and still have passed everything straight: far
/// more than what their origins are moved by.
const STRAIGHT: f32 = 1e-6;

impl<'a> Sky<'a> {
    /// `gain` makes colours as bright as they are to be shown.
    pub fn new(light: &'a SkyLight, gain: f32) -> Self {
        Self { light, backdrop: light.backdrop_as_shown.as_ref().map(|shown| shown.scaled(gain)) }
    }
}

/// What the rays of the packet at `at` see if they hit nothing.
#[inline(always)]
pub(super) fn beyond<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, rays: &RayQueue, at: usize) -> V3<S::f32s> {
    let background = V3::splat(simd, frame.scene.render.background);
    let Some(sky) = &frame.sky else { return background };
    let direction = rays.direction.load(simd, at);
    let behind = match &sky.backdrop {
        _ if !sky.light.backdrop => background,
        Some(shown) => in_steps(simd, shown, direction),
        None => return radiance(simd, sky.light, direction),
    };
    if level == 1 {
        return behind;
    }
    let way = rays.origins(simd, at) - V3::splat(simd, frame.camera.eye);
    let off = way.cross(direction);
    let straight = off.dot(off).simd_le(way.dot(way) * STRAIGHT) & way.dot(direction).simd_gt(0.0);
    if straight.all_true() {
        return behind;
    }
    V3::select(straight, behind, radiance(simd, sky.light, direction))
}

/// The sky's radiance in unit directions.
#[inline(always)]
fn radiance<S: Simd>(simd: S, sky: &SkyLight, direction: V3<S::f32s>) -> V3<S::f32s> {
    match &sky.radiance {
        Radiance::Smooth(sky) => smooth(simd, sky, direction),
        Radiance::Image { image, turn, intensity } => {
            let place = Place::of(simd, direction, *turn);
            let found = gathered(
                simd,
                #[inline(always)]
                |lane| interpolated(image.map(), place.lane(lane)),
            );
            bounded::<S>(found.scale(S::f32s::splat(simd, *intensity)))
        }
    }
}

/// Steps from the horizon up, and down: fewer than displays have shades, so that they are not seen.
const STEPS: f32 = 64.0;

/// The gradient of a sky in steps. Packets within one of them are encoded as one colour, as plain backgrounds are.
#[inline(always)]
fn in_steps<S: Simd>(simd: S, sky: &Smooth, direction: V3<S::f32s>) -> V3<S::f32s> {
    let y = (direction.y * STEPS).floor() * (1.0 / STEPS);
    gradient(simd, sky, y, y.abs())
}

/// The radiance of a sky without its lobes, given y, the sine of the elevation, and |y|: or what is left of both.
#[inline(always)]
fn gradient<S: Simd>(simd: S, sky: &Smooth, y: S::f32s, bend: S::f32s) -> V3<S::f32s> {
    V3::splat(simd, sky.base) + V3::splat(simd, sky.slope).scale(y) + V3::splat(simd, sky.bend).scale(bend)
}

#[inline(always)]
fn smooth<S: Simd>(simd: S, sky: &Smooth, direction: V3<S::f32s>) -> V3<S::f32s> {
    let mut light = S::f32s::splat(simd, 0.0);
    for lobe in &sky.lobes {
        let off = S::f32s::splat(simd, 1.0) - V3::splat(simd, lobe.axis).dot(direction);
        let spread = off * lobe.focus + 1.0;
        light += S::f32s::splat(simd, lobe.peak) / (spread * spread);
    }
    gradient(simd, sky, direction.y, direction.y.abs()) + V3::all(light)
}

/// What the sky, as a mirror reflects it, is blurred to by roughness.
#[inline(always)]
fn glossy<S: Simd>(simd: S, sky: &SkyLight, direction: V3<S::f32s>, roughness: S::f32s) -> V3<S::f32s> {
    match &sky.radiance {
        Radiance::Smooth(sky) => smooth_glossy(simd, sky, direction, roughness),
        Radiance::Image { image, turn, intensity } => {
            let place = Place::of(simd, direction, *turn);
            let found = gathered(
                simd,
                #[inline(always)]
                |lane| between_levels(image.blurred(), place.lane(lane), roughness[lane]),
            );
            bounded::<S>(found.scale(S::f32s::splat(simd, *intensity)))
        }
    }
}

/// Fits to integrals over the kernel of a rough surface that is looked at from straight ahead (Karis, SIGGRAPH 2013 course), within
/// 0.02 of them: what is left of y and of |y| at the zenith; |y| at the horizon; and in between, its corner rounded.
#[inline(always)]
fn smooth_glossy<S: Simd>(simd: S, sky: &Smooth, direction: V3<S::f32s>, roughness: S::f32s) -> V3<S::f32s> {
    let one = S::f32s::splat(simd, 1.0);
    let alpha = roughness * roughness;
    let y = direction.y;
    let top = (alpha * 0.259_9 - 0.593_6) * alpha + 1.0;
    let level = alpha / (alpha * 1.85 + 0.5);
    let corner = alpha * 2.0;
    let rounded = ((y * y + corner * corner).sqrt() - corner) / ((corner * corner + 1.0).sqrt() - corner);
    let bend = level + (top - level) * rounded;
    let mut light = S::f32s::splat(simd, 0.0);
    for Lobe { axis, focus, peak } in &sky.lobes {
        // Blurred, it is focus / (1 + alpha focus) narrow, and of the same sum over all directions.
        let off = one - V3::splat(simd, *axis).dot(direction);
        let wide = alpha * *focus + 1.0;
        let spread = off * *focus + wide;
        light += wide * (wide + 2.0 * focus) * (peak / (1.0 + 2.0 * focus)) / (spread * spread);
    }
    gradient(simd, sky, y * top, bend) + V3::all(light)
}

/// Irradiance over π at unit normals.
#[inline(always)]
fn irradiance<S: Simd>(simd: S, irradiance: &Irradiance, normal: V3<S::f32s>) -> V3<S::f32s> {
    let V3 { x, y, z } = normal;
    let Irradiance { around_y: [one, linear, square], others, grey } = irradiance;
    let mut sum = V3::splat(simd, *one) + V3::splat(simd, *linear).scale(y) + V3::splat(simd, *square).scale(y * y);
    let factors = [x, z, x * x, x * y, y * z, z * x];
    if *grey {
        let mut light = S::f32s::splat(simd, 0.0);
        for (color, factor) in others.iter().zip(factors) {
            light += factor * color.x;
        }
        sum = sum + V3::all(light);
    } else {
        for (color, factor) in others.iter().zip(factors) {
            sum = sum + V3::splat(simd, *color).scale(factor);
        }
    }
    V3::new(sum.x.max(0.0), sum.y.max(0.0), sum.z.max(0.0))
}

/// Of the light of a white sky that a rough surface reflects: what does not change with its reflectance straight ahead, and the
/// rest; fits of the split sum's second factor (Karis, SIGGRAPH 2013 course) for the height-correlated Smith term, within 0.03 on average.
#[inline(always)]
fn split_sum<S: Simd>(simd: S, cosine: S::f32s, roughness: S::f32s) -> [S::f32s; 2] {
    let one = S::f32s::splat(simd, 1.0);
    let alpha = roughness * roughness;
    let smooth_part = (cosine * -1.093_1 + 1.041_9) * cosine + 0.364_1;
    let rough_part = (cosine * 0.450_9 + 0.265_1) * cosine - 0.288_2;
    let total = one - alpha * (smooth_part + alpha * rough_part);
    let x = one - cosine;
    let x2 = x * x;
    let grazing = x2 * x2 * ((roughness * 1.383_4 - 2.399_7) * roughness + 1.086);
    let grazing = grazing.min(total);
    [total - grazing, grazing]
}

/// Light of the sky that the surfaces of a packet send to the viewer. `opacity` is what transparency leaves of local light.
#[inline(always)]
pub(super) fn reflected<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    sky: &Sky<'_>,
    materials: &impl Materials<S>,
    skin: &Skin<S>,
    opacity: V3<S::f32s>,
    [normal, to_viewer]: [V3<S::f32s>; 2],
) -> V3<S::f32s> {
    let mut arriving = irradiance(simd, &sky.light.irradiance, normal);
    if frame.plan.occlusion {
        arriving = arriving.scale(skin.openness);
    }
    let some_metallic = frame.plan.metallic_roughness && materials.any(|m| m.metallic_roughness);
    let mut light = V3::zero(simd);
    if !some_metallic || materials.any(|m| !m.metallic_roughness) {
        light = opacity * materials.triple(simd, Row::Diffuse) * skin.color * arriving;
    }
    if some_metallic {
        let one = S::f32s::splat(simd, 1.0);
        let along = normal.dot(to_viewer);
        let cosine = along.max(0.0).min(1.0);
        let [scaled, added] = split_sum(simd, cosine, skin.roughness);
        let lost = one - (scaled + added);
        // What one channel reflects at once, and after several reflections between the bumps (Fdez-Agüera, JCGT 2019).
        let channel = |f0: S::f32s| {
            let once = f0 * scaled + added;
            let again = (f0 * (20.0 / 21.0) + 1.0 / 21.0) * lost;
            [once, once * (again / (one - again))]
        };
        let f0 = skin.f0(simd, materials);
        let ([x, again_x], grey) = (channel(f0.x), !materials.any(FlatMaterial::may_be_metal));
        let (once, again) = if grey {
            (V3::all(x), V3::all(again_x))
        } else {
            let ([y, again_y], [z, again_z]) = (channel(f0.y), channel(f0.z));
            (V3::new(x, y, z), V3::new(again_x, again_y, again_z))
        };
        let reflecting = once + again;
        let diffuse = opacity * skin.color.scale(one - skin.metallic);
        let mut own = (again + diffuse * (V3::all(one) - reflecting)) * arriving;
        let rough = skin.roughness.simd_ge(S::f32s::splat(simd, MIRROR_ROUGHNESS));
        // What is smoother has mirror rays.
        if rough.any_true() {
            let direction = normal.scale(along + along) - to_viewer;
            let mut blurred = glossy(simd, sky.light, direction, skin.roughness) * once;
            if frame.plan.occlusion {
                blurred = blurred.scale(skin.openness);
            }
            own = own + V3::select(rough, blurred, V3::zero(simd));
        }
        light = V3::select(skin.roughness.simd_ge(0.0), own, light);
    }
    light
}

/// Where in an equirectangular picture, both from 0 to 1.
struct Place<S: Simd> {
    across: S::f32s,
    down: S::f32s,
}

impl<S: Simd> Place<S> {
    #[inline(always)]
    fn of(simd: S, direction: V3<S::f32s>, [cos, sin]: [f32; 2]) -> Self {
        let half = S::f32s::splat(simd, 0.5);
        let x = direction.x * cos - direction.z * sin;
        let z = direction.x * sin + direction.z * cos;
        let level = (x * x + z * z).sqrt();
        Self { across: half + atan2(x, -z) * (1.0 / TAU), down: half - atan2(direction.y, level) * FRAC_1_PI }
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> [f32; 2] {
        [self.across[lane], self.down[lane]]
    }
}

/// The same light, but finite.
#[inline(always)]
fn bounded<S: Simd>(light: V3<S::f32s>) -> V3<S::f32s> {
    V3::new(light.x.min(BRIGHTEST), light.y.min(BRIGHTEST), light.z.min(BRIGHTEST))
}

#[inline(always)]
fn gathered<S: Simd>(simd: S, found: impl Fn(usize) -> [f32; 3]) -> V3<S::f32s> {
    let mut lanes = [[0.0; MOST_LANES]; 3];
    for lane in 0..S::f32s::LEN {
        let color = found(lane);
        for (channel, value) in lanes.iter_mut().zip(color) {
            channel[lane] = value;
        }
    }
    V3::load(simd, &lanes[0][..S::f32s::LEN], &lanes[1][..S::f32s::LEN], &lanes[2][..S::f32s::LEN])
}

/// The mean of the four texels around a place, by their distance. Left and right edge meet; beyond a pole is its other side.
fn interpolated(map: SkyMap<'_>, [across, down]: [f32; 2]) -> [f32; 3] {
    let (x, y) = (across * map.width as f32 - 0.5, down * map.height as f32 - 0.5);
    // What is not a number is 0.
    let (column, row) = (x.floor() as i64, y.floor() as i64);
    let (right_share, lower_share) = (x - x.floor(), y - y.floor());
    let places = [(column, row), (column + 1, row), (column, row + 1), (column + 1, row + 1)];
    let texels = places.map(|(column, row)| map.texel(column, row));
    std::array::from_fn(|channel| {
        let [a, b, c, d] = texels.map(|texel| texel[channel]);
        let (upper, lower) = (a + (b - a) * right_share, c + (d - c) * right_share);
        upper + (lower - upper) * lower_share
    })
}

fn between_levels(sky: &Blurred, place: [f32; 2], roughness: f32) -> [f32; 3] {
    let roughness = if roughness >= LEAST_ROUGHNESS { roughness.min(1.0) } else { LEAST_ROUGHNESS };
    let next = sky.levels.partition_point(|level| level.roughness < roughness).clamp(1, sky.levels.len() - 1);
    let [a, b]: [&GlossyLevel; 2] = [&sky.levels[next - 1], &sky.levels[next]];
    let share = (roughness - a.roughness) / (b.roughness - a.roughness);
    let [lower, upper] = [a, b].map(|level| interpolated(level.map(), place));
    std::array::from_fn(|channel| lower[channel] + (upper[channel] - lower[channel]) * share)
}
