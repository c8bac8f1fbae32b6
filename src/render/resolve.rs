//! From linear light to bytes: exposure, tone curve, sRGB.

use super::queue::MOST_LANES;
use crate::math::V3;
use crate::scene::Scene;
use crate::settings::{Settings, ToneMap};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::sync::LazyLock;

/// Turns linear colours into sRGB bytes.
#[derive(Clone, Copy)]
pub struct Encoder {
    table: &'static SrgbTable,
    /// What exposure multiplies light by.
    pub gain: f32,
    /// The tone curve.
    pub tone_map: ToneMap,
}

impl Encoder {
    /// The encoder that the settings ask for, what they leave to the scene filled in.
    pub fn new(scene: &Scene, settings: &Settings) -> Self {
        // What is unlit has the colours of the picture already: where nothing else is seen, there is no range to compress.
        let tone_map = match scene.is_all_unlit() {
            true => ToneMap::None,
            false => settings.tone_map.unwrap_or(scene.render.tone_map),
        };
        Self::with(scene.stops(settings.exposure), tone_map)
    }

    fn with(stops: f32, tone_map: ToneMap) -> Self {
        Self { table: &SRGB, gain: libm::exp2f(stops), tone_map }
    }

    /// Encodes linear colours as RGBA.
    #[inline(always)]
    pub fn encode<S: Simd>(&self, simd: S, color: V3<S::f32s>) -> [[u8; 4]; MOST_LANES] {
        let exposed = if self.gain == 1.0 { color } else { color.scale(S::f32s::splat(simd, self.gain)) };
        let mapped = match self.tone_map {
            ToneMap::None => exposed,
            ToneMap::Neutral => neutral(simd, exposed),
        };
        let mut bits = [S::u32s::splat(simd, 0); 3];
        let mut flat = true;
        for (bits, lanes) in bits.iter_mut().zip([mapped.x, mapped.y, mapped.z]) {
            *bits = SrgbTable::clamp(simd, lanes);
            flat &= bits.simd_eq(bits[0]).all_true();
        }
        let mut entries = [[0; MOST_LANES]; 3];
        for (entries, &bits) in entries.iter_mut().zip(&bits) {
            if flat {
                // As backgrounds are.
                *entries = [self.table.entry(SrgbTable::buckets::<S>(bits)[0]); MOST_LANES];
                continue;
            }
            let mut buckets = [0; MOST_LANES];
            SrgbTable::buckets::<S>(bits).store_slice(&mut buckets[..S::f32s::LEN]);
            for (entry, bucket) in entries.iter_mut().zip(buckets).take(S::f32s::LEN) {
                *entry = self.table.entry(bucket);
            }
        }
        let mut rgba = S::u32s::splat(simd, u32::from_le_bytes([0, 0, 0, 255]));
        for (channel, (bits, entries)) in bits.into_iter().zip(&entries).enumerate() {
            let entries = S::u32s::from_slice(simd, &entries[..S::f32s::LEN]);
            rgba |= SrgbTable::bytes::<S>(entries, bits) << (8 * channel as u32);
        }
        let mut pixels = [[0; 4]; MOST_LANES];
        for (pixel, rgba) in pixels.iter_mut().zip(rgba.as_slice()) {
            *pixel = rgba.to_le_bytes();
        }
        pixels
    }
}

/// Where the tone curve starts to compress.
const START: f32 = 0.8 - 0.04;
/// How fast what is brighter loses its colour.
const DESATURATION: f32 = 0.15;
const ROOM: f32 = 1.0 - START;

/// Khronos PBR Neutral tone mapper (specification, 2024): base colours pass unchanged, highlights are compressed.
///
/// No light is negative; for [`undo_neutral`] the curve goes on below 0 so that every colour is reached.
#[inline(always)]
fn neutral<S: Simd>(simd: S, color: V3<S::f32s>) -> V3<S::f32s> {
    let one = S::f32s::splat(simd, 1.0);
    let least = color.x.min(color.y).min(color.z).max(0.0);
    let dark = least.simd_lt(S::f32s::splat(simd, 0.08));
    let offset = dark.select(least - least * least * 6.25, S::f32s::splat(simd, 0.04));
    let shifted = color - V3::all(offset);
    let peak = shifted.x.max(shifted.y).max(shifted.z);
    let bright = peak.simd_ge(S::f32s::splat(simd, START));
    if !bright.any_true() {
        return shifted;
    }
    let new_peak = one - S::f32s::splat(simd, ROOM * ROOM) / (peak + (ROOM - START));
    let share = one - one / ((peak - new_peak) * DESATURATION + one);
    let compressed = shifted.scale(new_peak / peak).scale(one - share) + V3::all(new_peak * share);
    V3::select(bright, compressed, shifted)
}

/// The light that [`neutral`] shows as a colour from 0 to 1. That of full brightness would be infinite: what is brighter
/// than [`BRIGHTEST`] is shown as that, which is less than 2/255 darker.
#[inline(always)]
pub fn undo_neutral<S: Simd>(simd: S, color: V3<S::f32s>) -> V3<S::f32s> {
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    let brightest = S::f32s::splat(simd, BRIGHTEST);
    let color = V3::new(color.x.max(zero), color.y.max(zero), color.z.max(zero));
    let shown = color.x.max(color.y).max(color.z);
    let too_bright = shown.simd_gt(brightest);
    let color = color.scale(too_bright.select(brightest / shown, one));
    let shown = shown.min(brightest);
    let bright = shown.simd_ge(START);
    let peak = bright.select(S::f32s::splat(simd, ROOM * ROOM) / (one - shown) - (ROOM - START), shown);
    let share = one - one / ((peak - shown) * DESATURATION + one);
    let saturated = (color - V3::all(shown * share)).scale(peak / (shown * (one - share)).max(f32::MIN_POSITIVE));
    let shifted = V3::select(bright, saturated, color);
    let least = shifted.x.min(shifted.y).min(shifted.z).max(zero);
    let offset = least.simd_lt(0.04).select((least * (1.0 / 6.25)).sqrt() - least, S::f32s::splat(simd, 0.04));
    shifted + V3::all(offset)
}

/// The brightest colour whose light [`undo_neutral`] gives: 254 of 255 in sRGB.
const BRIGHTEST: f32 = 0.992;

/// For each bucket of linear values its least byte, and the linear value at which the next byte starts.
///
/// Buckets are as wide as 2^-7 of their octave: then none holds more than one change (after Giesen, "Float->sRGB8
/// conversions", 2012). Value and byte lie in one number, so that one addition compares with the one and carries into
/// the other: the upper half is the byte, the lower one 2^16 less the lower half of the bits of the next byte's least
/// value, or 0 where the bucket does not hold that value.
struct SrgbTable([u32; Self::ROOM]);

static SRGB: LazyLock<SrgbTable> = LazyLock::new(|| {
    let mut byte = 0;
    SrgbTable(std::array::from_fn(|bucket| {
        let start = SrgbTable::LEAST + ((bucket as u32) << SrgbTable::SHIFT);
        while least_linear(byte + 1).to_bits() <= start {
            byte += 1;
        }
        let missing = least_linear(byte + 1).to_bits() - start;
        (byte << SrgbTable::SHIFT) + (1_u32 << SrgbTable::SHIFT).saturating_sub(missing)
    }))
});

/// The least linear value that encodes to a byte; infinity where there is no such byte.
fn least_linear(byte: u32) -> f32 {
    if byte > 255 {
        return f32::INFINITY;
    }
    let encoded = (f64::from(byte) - 0.5) / 255.0;
    let linear = if encoded <= 0.04045 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) };
    linear as f32
}

impl SrgbTable {
    /// Bits of 2^-13: below it everything is 0.
    const LEAST: u32 = 0x3900_0000;
    /// How far the bits of a value are shifted to leave its bucket.
    const SHIFT: u32 = 16;
    /// Buckets, a power of two: 13 octaves of 128, and 1.
    const ROOM: usize = 2048;

    /// The bits of linear values, clamped to what the table knows. NaN becomes the least.
    #[inline(always)]
    fn clamp<S: Simd>(simd: S, linear: S::f32s) -> S::u32s {
        let (least, one) = (S::f32s::splat(simd, f32::from_bits(Self::LEAST)), S::f32s::splat(simd, 1.0));
        let linear = linear.simd_gt(least).select(linear, least);
        linear.simd_lt(one).select(linear, one).bitcast()
    }

    /// The buckets of clamped values.
    #[inline(always)]
    fn buckets<S: Simd>(bits: S::u32s) -> S::u32s {
        (bits - Self::LEAST) >> Self::SHIFT
    }

    /// What the table holds for a bucket.
    #[inline(always)]
    fn entry(&self, bucket: u32) -> u32 {
        self.0[bucket as usize % Self::ROOM]
    }

    /// The nearest sRGB bytes (IEC 61966-2-1) of clamped linear values, from their buckets' entries.
    #[inline(always)]
    fn bytes<S: Simd>(entries: S::u32s, bits: S::u32s) -> S::u32s {
        (entries + (bits & ((1 << Self::SHIFT) - 1))) >> Self::SHIFT
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{SimdToken, dispatch};

    fn encode_lanes<S: Simd>(simd: S, tone_map: ToneMap, color: [f32; 3]) -> [u8; 4] {
        Encoder::with(0.0, tone_map).encode(simd, V3::splat(simd, color.into()))[S::f32s::LEN - 1]
    }

    fn encode(tone_map: ToneMap, color: [f32; 3]) -> [u8; 4] {
        dispatch!(SimdToken::best(), simd => encode_lanes(simd, tone_map, color))
    }

    fn byte(linear: f32) -> u8 {
        encode(ToneMap::None, [linear; 3])[1]
    }

    #[test]
    fn bytes_are_the_nearest_ones() {
        for step in 0..=100_000 {
            let linear = step as f32 / 100_000.0;
            let exact = f64::from(linear);
            let encoded =
                if exact <= 0.003_130_8 { exact * 12.92 } else { 1.055 * exact.powf(1.0 / 2.4) - 0.055 } * 255.0;
            let byte = f64::from(byte(linear));
            assert!((byte - encoded).abs() < 0.5001, "{linear}: {byte} for {encoded}");
        }
        assert_eq!([-1.0, f32::NAN, 0.0, 1e-30, 2.0, f32::INFINITY].map(byte), [0, 0, 0, 0, 255, 255]);
    }

    #[test]
    fn bytes_change_at_their_least_values() {
        for next in 1..=255 {
            let least = least_linear(next);
            assert_eq!(u32::from(byte(least)), next);
            assert_eq!(u32::from(byte(least.next_down())), next - 1);
        }
    }

    #[test]
    fn neutral_keeps_base_colours_and_compresses_highlights() {
        let base = encode(ToneMap::Neutral, [0.5, 0.3, 0.2]);
        assert_eq!(base, encode(ToneMap::None, [0.46, 0.26, 0.16]));
        let bright = encode(ToneMap::Neutral, [20.0, 10.0, 5.0]);
        assert!(bright[0] > 240, "{bright:?}");
    }

    #[test]
    fn every_colour_is_shown_as_the_light_that_undoes_the_curve() {
        let undone = |color| dispatch!(SimdToken::best(), simd => undo_neutral(simd, V3::splat(simd, glam::Vec3::from(color))).lane(0));
        for r in (0..=255).step_by(15) {
            for g in (0..=255).step_by(15) {
                for b in (0..=255).step_by(15) {
                    let bytes = [r, g, b].map(|byte| byte as u8);
                    let light = undone(bytes.map(crate::scene::texture::srgb_to_linear));
                    let shown = encode(ToneMap::Neutral, light.into());
                    assert!(light.is_finite());
                    for (shown, byte) in shown.iter().zip(bytes) {
                        assert!(shown.abs_diff(byte) <= 2, "{bytes:?} is shown as {shown:?}");
                    }
                }
            }
        }
    }
}
