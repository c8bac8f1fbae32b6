//! Textures: images and checkers, looked up by surface coordinates.

use super::texels::Texels;
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use std::sync::Arc;
use std::sync::LazyLock;

/// A picture wrapped around by repetition.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTexture {
    /// The picture; textures of one file share it.
    pub texels: Arc<Texels>,
    /// Size of one repetition in units of u and v.
    pub size: f32,
}

/// What a colour may be looked up in.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// A picture, bilinearly filtered; v = 0 is its bottom row.
    Image(ImageTexture),
    /// Squares of two colours: the first where floor(u/size) + floor(v/size) is even.
    Checker {
        /// The two linear colours.
        colors: [Vec3; 2],
        /// Edge of a square in units of u and v.
        size: f32,
    },
}

impl Texture {
    /// The linear colours at surface coordinates `u`, `v` of the lanes in the bit set `lanes`; others get anything.
    #[inline(always)]
    pub fn sample<S: Simd>(&self, simd: S, [u, v]: [S::f32s; 2], lanes: u64) -> V3<S::f32s> {
        match self {
            Self::Checker { colors: [even, odd], size } => {
                let squares = 1.0 / size;
                let sum = (u * squares).floor() + (v * squares).floor();
                let is_even = sum.simd_eq((sum * 0.5).floor() * 2.0);
                V3::select(is_even, V3::splat(simd, *even), V3::splat(simd, *odd))
            }
            Self::Image(ImageTexture { texels, size }) => {
                let repetitions = 1.0 / size;
                texels.sample(simd, [u * repetitions, v * repetitions], lanes)
            }
        }
    }
}

/// Decodes one sRGB byte to linear light (IEC 61966-2-1), by a table made at first use.
pub fn srgb_to_linear(byte: u8) -> f32 {
    srgb_table()[usize::from(byte)]
}

/// The linear light of each sRGB byte.
pub(super) fn srgb_table() -> &'static [f32; 256] {
    static TABLE: LazyLock<[f32; 256]> = LazyLock::new(|| {
        std::array::from_fn(|i| {
            let encoded = i as f64 / 255.0;
            let linear = if encoded <= 0.04045 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) };
            linear as f32
        })
    });
    &TABLE
}
