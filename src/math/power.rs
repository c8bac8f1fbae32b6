//! Powers by our own exponential and logarithm: the system's differ between machines.

use super::Lanes;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// 2^23: adding it to a small whole number leaves that number in the mantissa's bits, and back.
const TWO_23: f32 = 8_388_608.0;

/// `base` to the power of `exponent`, for base in [0, 1e30] and exponent in [0, 1e6]; relative error below 2e-6 for
/// results that matter in a picture (above 1e-3). 0 to any power is 0, and results below 2^-126 are 0.
#[inline(always)]
pub fn pow<S: Simd, F: Lanes<S>>(base: F, exponent: F) -> F {
    let simd = base.token();
    let zero = F::splat(simd, 0.0);
    let positive = base.simd_gt(F::splat(simd, f32::MIN_POSITIVE));
    let safe = positive.select(base, F::splat(simd, 1.0));
    positive.select(exp2(log2(safe) * exponent), zero)
}

/// e to the power of `x`, for x <= 88; 0 where the result is below 2^-126. Relative error below 1e-5 for x > -64.
#[inline(always)]
pub fn exp<S: Simd, F: Lanes<S>>(x: F) -> F {
    exp2(x * std::f32::consts::LOG2_E)
}

/// Binary logarithm of a positive normal number.
///
/// The mantissa is brought into [√½, √2), where ln(m) = 2 artanh((m-1)/(m+1)) converges fast (Abramowitz and Stegun 4.1.27).
#[inline(always)]
pub fn log2<S: Simd, F: Lanes<S>>(x: F) -> F {
    let simd = x.token();
    let bits = x.to_bits();
    // 0x3f3504f3 is √½: adding what is missing to 1.0 makes the exponent round to the nearest power.
    let shifted = bits + (0x3f80_0000_u32 - 0x3f35_04f3);
    let exponent = F::from_bits((shifted >> 23) | TWO_23.to_bits()) - (TWO_23 + 127.0);
    let mantissa = F::from_bits((shifted & 0x007f_ffff) + 0x3f35_04f3);
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    let series = F::splat(simd, 2.0 / 9.0);
    let series = series * s2 + 2.0 / 7.0;
    let series = series * s2 + 2.0 / 5.0;
    let series = series * s2 + 2.0 / 3.0;
    let ln = s * 2.0 + s * (s2 * series);
    exponent + ln * std::f32::consts::LOG2_E
}

/// 2 to the power of `x`, for x <= 127; 0 below -126.
///
/// Split into an integer and a fraction in [-½, ½], whose exponential is its Taylor series to the 7th power.
#[inline(always)]
fn exp2<S: Simd, F: Lanes<S>>(x: F) -> F {
    let simd = x.token();
    let tiny = x.simd_lt(F::splat(simd, -126.0));
    let x = tiny.select(F::splat(simd, -126.0), x);
    let whole = (x + 0.5).floor();
    let f = (x - whole) * std::f32::consts::LN_2;
    let p = F::splat(simd, 1.0 / 5040.0);
    let p = p * f + 1.0 / 720.0;
    let p = p * f + 1.0 / 120.0;
    let p = p * f + 1.0 / 24.0;
    let p = p * f + 1.0 / 6.0;
    let p = p * f + 0.5;
    let p = p * f + 1.0;
    let p = p * f + 1.0;
    let power = F::from_bits((whole + (TWO_23 + 127.0)).to_bits() << 23);
    tiny.select(F::splat(simd, 0.0), p * power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{SimdToken, dispatch};
    use crate::settings::SimdLevel;

    fn pow_lanes<S: Simd>(simd: S, base: f32, exponent: f32) -> f32 {
        pow(S::f32s::splat(simd, base), S::f32s::splat(simd, exponent))[0]
    }

    #[test]
    fn pow_is_near_the_double_precision_one_and_the_same_on_every_level() {
        let off = SimdToken::new(SimdLevel::Off).expect("scalar code runs everywhere");
        for step in 1..=400 {
            let base = step as f32 / 400.0;
            for exponent in [0.5_f32, 1.0, 2.4, 5.0, 45.2776, 50.0, 200.0, 1000.0] {
                let value = dispatch!(off, simd => pow_lanes(simd, base, exponent));
                let exact = f64::from(base).powf(f64::from(exponent));
                let tolerance = 2e-6 * exact + 1e-9;
                assert!((f64::from(value) - exact).abs() < tolerance, "{base}^{exponent}: {value} for {exact}");
                for level in [SimdLevel::Sse4, SimdLevel::Avx2, SimdLevel::Avx512] {
                    let Some(token) = SimdToken::new(level) else { continue };
                    let other = dispatch!(token, simd => pow_lanes(simd, base, exponent));
                    assert_eq!(value.to_bits(), other.to_bits(), "{base}^{exponent} on {}", token.name());
                }
            }
        }
        assert_eq!(dispatch!(off, simd => pow_lanes(simd, 0.0, 50.0)), 0.0);
        assert_eq!(dispatch!(off, simd => pow_lanes(simd, 1.0, 50.0)), 1.0);
    }
}
