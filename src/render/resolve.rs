//! From linear light to bytes: exposure, tone curve, sRGB.

use crate::settings::{Settings, ToneMap};
use std::sync::LazyLock;

/// Turns linear colours into sRGB bytes.
#[derive(Clone, Copy)]
pub struct Encoder {
    table: &'static SrgbTable,
    gain: f32,
    tone_map: ToneMap,
}

impl Encoder {
    /// The encoder that the settings ask for.
    pub fn new(settings: &Settings) -> Self {
        Self { table: &SRGB, gain: libm::exp2f(settings.exposure), tone_map: settings.tone_map }
    }

    /// Encodes a linear colour.
    #[inline]
    pub fn encode(&self, color: [f32; 3]) -> [u8; 3] {
        let exposed = if self.gain == 1.0 { color } else { color.map(|c| c * self.gain) };
        match self.tone_map {
            ToneMap::None => exposed,
            ToneMap::Neutral => neutral(exposed),
        }
        .map(
            #[inline(always)]
            |linear| self.table.encode(linear),
        )
    }
}

/// Khronos PBR Neutral tone mapper (specification, 2024): base colours pass unchanged, highlights are compressed.
fn neutral([r, g, b]: [f32; 3]) -> [f32; 3] {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let least = r.min(g).min(b);
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let shifted = [r - offset, g - offset, b - offset];
    let peak = shifted[0].max(shifted[1]).max(shifted[2]);
    if peak < START {
        return shifted;
    }
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let share = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    shifted.map(|c| c * (new_peak / peak) * (1.0 - share) + new_peak * share)
}

/// Buckets of the first guess of [`SrgbTable::encode`]. Bytes change at most every 1 / (12.92 * 255) = 1 / 3295, so
/// that a bucket holds at most one change.
const BUCKETS: usize = 4096;

/// For each byte the least linear value that encodes to it, and for each bucket of linear values its least byte.
struct SrgbTable {
    least_linear: [f32; 257],
    first_guess: [u8; BUCKETS],
}

static SRGB: LazyLock<SrgbTable> = LazyLock::new(|| {
    let least_linear = std::array::from_fn(|byte| match byte {
        0 => 0.0,
        // Nothing is brighter than the last byte, not even infinity.
        256 => f32::NAN,
        _ => {
            let encoded = (byte as f64 - 0.5) / 255.0;
            let linear = if encoded <= 0.04045 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) };
            linear as f32
        }
    });
    let mut byte = 0_usize;
    let first_guess = std::array::from_fn(|bucket| {
        let linear = bucket as f32 / BUCKETS as f32;
        while least_linear[byte + 1] <= linear {
            byte += 1;
        }
        byte as u8
    });
    SrgbTable { least_linear, first_guess }
});

impl SrgbTable {
    /// Clamps to [0, 1] and encodes to the nearest sRGB byte (IEC 61966-2-1). NaN becomes 0.
    #[inline(always)]
    fn encode(&self, linear: f32) -> u8 {
        // A float to integer cast saturates, and takes NaN to 0.
        let bucket = ((linear * BUCKETS as f32) as usize).min(BUCKETS - 1);
        let byte = self.first_guess[bucket];
        byte + u8::from(linear >= self.least_linear[usize::from(byte) + 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_the_nearest_ones() {
        for step in 0..=100_000 {
            let linear = step as f32 / 100_000.0;
            let exact = f64::from(linear);
            let encoded =
                if exact <= 0.003_130_8 { exact * 12.92 } else { 1.055 * exact.powf(1.0 / 2.4) - 0.055 } * 255.0;
            let byte = f64::from(SRGB.encode(linear));
            assert!((byte - encoded).abs() < 0.5001, "{linear}: {byte} for {encoded}");
        }
        assert_eq!([-1.0, f32::NAN, 0.0, 2.0, f32::INFINITY].map(|linear| SRGB.encode(linear)), [0, 0, 0, 255, 255]);
    }

    #[test]
    fn neutral_keeps_base_colours_and_compresses_highlights() {
        let base = neutral([0.5, 0.3, 0.2]);
        assert!((base[0] - 0.46).abs() < 1e-6 && (base[2] - 0.16).abs() < 1e-6);
        let bright = neutral([20.0, 10.0, 5.0]);
        assert!(bright.iter().all(|c| (0.0..=1.0).contains(c)) && bright[0] > 0.95);
    }
}
