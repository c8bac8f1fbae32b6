//! Angles by our own arctangent: the system's differ between machines.

use super::Lanes;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// The angle of (x, y) from the x axis, in [-π, π]; absolute error below 3e-7. 0 for (0, 0).
///
/// The smaller of |x| and |y| divided by the larger is an angle of at most 45°, brought below 22.5° by turning it by 45°
/// where it is larger; there the polynomial of Cephes' `atanf` (Moshier, 1989) holds.
#[inline(always)]
pub fn atan2<S: Simd, F: Lanes<S>>(y: F, x: F) -> F {
    let simd = x.token();
    let zero = F::splat(simd, 0.0);
    let (wide, high) = (x.abs(), y.abs());
    let larger = wide.max(high);
    let ratio = wide.min(high) / larger;
    let ratio = larger.simd_gt(zero).select(ratio, zero);

    let turned = ratio.simd_gt(F::splat(simd, std::f32::consts::SQRT_2 - 1.0));
    let a = turned.select((ratio - 1.0) / (ratio + 1.0), ratio);
    let a2 = a * a;
    let series = a2 * 8.053_744_5e-2 - 1.387_768_6e-1;
    let series = series * a2 + 1.997_771_1e-1;
    let series = series * a2 - 3.333_295e-1;
    let angle = series * a2 * a + a;
    let angle = turned.select(angle + FRAC_PI_4, angle);

    let angle = high.simd_gt(wide).select(F::splat(simd, FRAC_PI_2) - angle, angle);
    let angle = x.simd_lt(zero).select(F::splat(simd, PI) - angle, angle);
    angle.copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{SimdToken, dispatch};

    fn lanes<S: Simd>(simd: S, y: f32, x: f32) -> f32 {
        atan2(S::f32s::splat(simd, y), S::f32s::splat(simd, x))[0]
    }

    #[test]
    fn angles_are_near_the_double_precision_ones() {
        let angle = |y: f32, x: f32| dispatch!(SimdToken::best(), simd => lanes(simd, y, x));
        for step in 0..=100_000 {
            let exact = (f64::from(step) / 50_000.0 - 1.0) * std::f64::consts::PI;
            let radius = 10_f64.powi(step % 13 - 6);
            let (y, x) = ((exact.sin() * radius) as f32, (exact.cos() * radius) as f32);
            let error = f64::from(angle(y, x)) - f64::from(y).atan2(f64::from(x));
            assert!(error.abs() < 3e-7, "{y}, {x}: off by {error}");
        }
        assert_eq!([angle(0.0, 0.0), angle(0.0, 1.0), angle(1.0, 0.0)], [0.0, 0.0, FRAC_PI_2]);
        assert_eq!(angle(0.0, -1.0), PI);
    }
}
