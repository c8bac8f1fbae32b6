//! The sRGB transfer curve (IEC 61966-2-1) on values, not bytes.

/// Encodes linear light in [0, 1] for display.
pub fn srgb_encode(linear: f32) -> f32 {
    let linear = f64::from(linear);
    let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 };
    encoded as f32
}

/// Decodes a displayed value in [0, 1] to linear light.
pub fn srgb_decode(encoded: f32) -> f32 {
    let encoded = f64::from(encoded);
    let linear = if encoded <= 0.040_45 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) };
    linear as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values_and_the_way_back() {
        assert_eq!(srgb_encode(0.0), 0.0);
        assert!((srgb_encode(1.0) - 1.0).abs() < 1e-6);
        assert!((srgb_encode(0.214_041_14) - 0.5).abs() < 1e-6);
        for i in 0..=100 {
            let x = i as f32 / 100.0;
            assert!((srgb_decode(srgb_encode(x)) - x).abs() < 1e-6, "{x}");
        }
    }
}
