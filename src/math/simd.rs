//! The SIMD level: chosen once at the edge of a frame, then carried as a token by every kernel.

use crate::settings::SimdLevel;
use fearless_simd::{Level, Simd, SimdFloat};

/// A vector of f32 lanes: native width, or a fixed width where the data has one.
///
/// Kernels are generic over it, so that the reference, the packets and the 8-wide leaf tests are one text.
pub trait Lanes<S: Simd>: SimdFloat<S, Element = f32> {}
impl<S: Simd, F: SimdFloat<S, Element = f32>> Lanes<S> for F {}

/// The level that [`dispatch!`](crate::math::dispatch) branches on.
#[derive(Clone, Copy, Debug)]
pub struct SimdToken(pub Level);

impl SimdToken {
    /// The token of a level; `None` when this machine lacks it.
    pub fn new(level: SimdLevel) -> Option<Self> {
        let best = Level::new();
        match level {
            SimdLevel::Auto => Some(best),
            SimdLevel::Off => Some(Level::Fallback(fearless_simd::Fallback::new())),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            SimdLevel::Sse4 => best.as_sse4_2().map(Level::Sse4_2),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            SimdLevel::Avx2 => best.as_avx2().map(Level::Avx2),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            SimdLevel::Avx512 => best.as_avx512().map(Level::Avx512),
            #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
            SimdLevel::Sse4 | SimdLevel::Avx2 | SimdLevel::Avx512 => None,
        }
        .map(Self)
    }

    /// The best level of this machine.
    pub fn best() -> Self {
        Self(Level::new())
    }

    /// The level's name, as `--simd` spells it where it can be asked for.
    pub fn name(self) -> &'static str {
        match self.0 {
            Level::Fallback(_) => "off",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Sse4_2(_) => "sse4",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx2(_) => "avx2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx512(_) => "avx512",
            #[cfg(target_arch = "aarch64")]
            Level::Neon(_) => "neon",
            _ => "baseline",
        }
    }
}

/// Whether this machine can run a level.
pub fn is_available(level: SimdLevel) -> bool {
    SimdToken::new(level).is_some()
}

/// Runs an expression with `$simd` bound to the token of a [`SimdToken`]'s level.
///
/// Each level compiles the expression once more, so it should be one call. Levels without a name of their own
/// (bare SSE2) run the scalar code: no machine of the last fifteen years is left with them.
#[macro_export]
#[doc(hidden)]
macro_rules! __raywalk_dispatch {
    ($token:expr, $simd:ident => $body:expr) => {
        match $token.0 {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            ::fearless_simd::Level::Avx512($simd) => $body,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            ::fearless_simd::Level::Avx2($simd) => $body,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            ::fearless_simd::Level::Sse4_2($simd) => $body,
            #[cfg(target_arch = "aarch64")]
            ::fearless_simd::Level::Neon($simd) => $body,
            _ => {
                let $simd = ::fearless_simd::Fallback::new();
                $body
            }
        }
    };
}
pub use crate::__raywalk_dispatch as dispatch;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chosen_level_is_the_one_that_runs() {
        for level in [SimdLevel::Off, SimdLevel::Sse4, SimdLevel::Avx2, SimdLevel::Avx512] {
            let Some(token) = SimdToken::new(level) else { continue };
            let lanes = dispatch!(token, simd => lanes_of(simd));
            match level {
                SimdLevel::Off | SimdLevel::Sse4 => assert_eq!(lanes, 4),
                SimdLevel::Avx2 => assert_eq!(lanes, 8),
                _ => assert_eq!(lanes, 16),
            }
        }
    }

    fn lanes_of<S: Simd>(_: S) -> usize {
        use fearless_simd::SimdBase;
        S::f32s::LEN
    }
}
