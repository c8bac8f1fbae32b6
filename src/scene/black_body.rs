//! The colour of a glowing body by its temperature.

use glam::{DMat3, DVec3, Vec3};
use std::ops::RangeInclusive;
use std::sync::LazyLock;

/// The temperatures that lights may have, in kelvin.
pub const TEMPERATURES: RangeInclusive<f64> = 1000.0..=40000.0;

/// The temperature whose colour counts as white, in kelvin.
const WHITE: f64 = 6500.0;

/// XYZ to linear sRGB (IEC 61966-2-1).
const XYZ_TO_SRGB: DMat3 = DMat3::from_cols(
    DVec3::new(3.2406, -0.9689, 0.0557),
    DVec3::new(-1.5372, 1.8758, -0.2040),
    DVec3::new(-0.4986, 0.0415, 1.0570),
);

/// Linear sRGB colour of a black body at `kelvin`, relative to the one at 6500 K, scaled so that the
/// largest channel is 1; what lies outside sRGB is clamped to 0.
pub fn color(kelvin: f64) -> Vec3 {
    static AT_WHITE: LazyLock<DVec3> = LazyLock::new(|| linear_srgb(WHITE));
    let relative = (linear_srgb(kelvin) / *AT_WHITE).max(DVec3::ZERO);
    (relative / relative.max_element()).as_vec3()
}

/// Planck's spectrum seen by the CIE 1931 observer, up to a common factor.
fn linear_srgb(kelvin: f64) -> DVec3 {
    let wavelengths = (360..=830).step_by(5).map(f64::from);
    XYZ_TO_SRGB * wavelengths.map(|nm| observer(nm) * planck(nm, kelvin)).sum::<DVec3>()
}

/// Spectral radiance of a black body, up to a common factor.
fn planck(nm: f64, kelvin: f64) -> f64 {
    /// hc / k in nanometre kelvin.
    const SECOND_RADIATION: f64 = 1.438_776_877e7;
    let relative = nm / 560.0;
    1.0 / (libm::pow(relative, 5.0) * libm::expm1(SECOND_RADIATION / (nm * kelvin)))
}

/// The CIE 1931 colour matching functions, by the multi-lobe fit of Wyman, Sloan and Shirley,
/// "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", JCGT 2013.
fn observer(nm: f64) -> DVec3 {
    let lobe = |height: f64, center: f64, left: f64, right: f64| {
        let t = (nm - center) / if nm < center { left } else { right };
        height * libm::exp(-0.5 * t * t)
    };
    DVec3::new(
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_white_warm_is_red_and_cold_is_blue() {
        assert!(color(6500.0).abs_diff_eq(Vec3::ONE, 1e-6));
        let warm = color(2700.0);
        assert!(warm.x == 1.0 && warm.x > warm.y && warm.y > warm.z && warm.z > 0.05, "{warm}");
        let cold = color(12000.0);
        assert!(cold.z == 1.0 && cold.z > cold.y && cold.y > cold.x && cold.x > 0.3, "{cold}");
    }

    #[test]
    fn every_allowed_temperature_has_a_colour() {
        for kelvin in (1000..=40000).step_by(500) {
            let color = color(f64::from(kelvin));
            assert!(color.is_finite() && color.min_element() >= 0.0 && color.max_element() == 1.0, "{kelvin}: {color}");
        }
    }
}
