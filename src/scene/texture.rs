//! Textures: images and checkers, looked up by surface coordinates.

use super::texels::{Texel, Texels};
pub use crate::geometry::Wrap;
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use std::sync::Arc;
use std::sync::LazyLock;

/// How values are taken from those around.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Blending {
    /// The nearest alone.
    Nearest,
    /// Those on both sides, in proportion.
    Linear,
}

/// How a picture is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sampler {
    /// What lies beyond its edges, along u and v.
    pub wrap: [Wrap; 2],
    /// Between texels that are larger than the distance between rays.
    pub magnification: Blending,
    /// Between texels that are smaller.
    pub minification: Blending,
    /// Between the sizes of the picture; `None` to use the full size alone.
    pub between_levels: Option<Blending>,
}

impl Default for Sampler {
    /// Repeated, and trilinear.
    fn default() -> Self {
        Self {
            wrap: [Wrap::Repeat; 2],
            magnification: Blending::Linear,
            minification: Blending::Linear,
            between_levels: Some(Blending::Linear),
        }
    }
}

/// A picture on a surface; v = 0 is its bottom row.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTexture {
    /// The picture; textures of one file share it.
    pub texels: Arc<Texels>,
    /// How it is looked up.
    pub sampler: Sampler,
    /// Width and height of the picture in units of u and v.
    pub size: f32,
}

/// What a property of a surface may be looked up in.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// A picture.
    Image(ImageTexture),
    /// Squares of two colours: the first where floor(u/size) + floor(v/size) is even.
    Checker {
        /// The two linear colours.
        colors: [Vec3; 2],
        /// Edge of a square in units of u and v.
        size: f32,
    },
}

/// Coordinates of a packet's lookups.
#[derive(Clone, Copy)]
pub struct Coordinates<S: Simd> {
    /// u and v.
    pub uv: [S::f32s; 2],
    /// Squares of how far apart neighbouring rays are along u and v; `None` where nobody asks.
    pub spread2: Option<[S::f32s; 2]>,
}

impl Texture {
    /// The linear values at surface coordinates of the lanes in the bit set `lanes`; others get anything. Opacities only
    /// if `OPACITY`.
    #[inline(always)]
    pub fn sample<S: Simd, const OPACITY: bool>(&self, simd: S, coordinates: &Coordinates<S>, lanes: u64) -> Texel<S> {
        let [u, v] = coordinates.uv;
        match self {
            Self::Checker { colors: [even, odd], size } => {
                let squares = 1.0 / size;
                let sum = (u * squares).floor() + (v * squares).floor();
                let is_even = sum.simd_eq((sum * 0.5).floor() * 2.0);
                let color = V3::select(is_even, V3::splat(simd, *even), V3::splat(simd, *odd));
                Texel { color, opacity: S::f32s::splat(simd, 1.0) }
            }
            Self::Image(ImageTexture { texels, sampler, size }) => {
                let repetitions = 1.0 / size;
                let mut footprint2 = None;
                if let Some([across, up]) = coordinates.spread2 {
                    let [width, height] = [texels.width(), texels.height()].map(|edge| edge as f32 * repetitions);
                    footprint2 = Some((across * (width * width)).max(up * (height * height)));
                }
                texels.sample::<S, OPACITY>(simd, [u * repetitions, v * repetitions], footprint2, sampler, lanes)
            }
        }
    }

    /// Whether a lookup depends on how far apart rays are.
    pub fn is_filtered(&self) -> bool {
        match self {
            Self::Checker { .. } => false,
            Self::Image(ImageTexture { texels, sampler, .. }) => {
                texels.levels() > 1 && sampler.between_levels.is_some() || sampler.minification != sampler.magnification
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
    static TABLE: LazyLock<[f32; 256]> =
        LazyLock::new(|| std::array::from_fn(|i| srgb_decoded(i as f64 / 255.0) as f32));
    &TABLE
}

/// Decodes an sRGB value, from 0 to 1, to linear light.
pub fn srgb_value_to_linear(encoded: f32) -> f32 {
    srgb_decoded(f64::from(encoded)) as f32
}

fn srgb_decoded(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
}

/// Encodes linear light, from 0 to 1, to the nearest sRGB byte but for the rounding of light to 16 bits; by a table made
/// at first use.
pub fn linear_to_srgb(value: f32) -> u8 {
    static TABLE: LazyLock<Box<[u8]>> = LazyLock::new(|| {
        let encode = |i: u32| {
            let linear = f64::from(i) / 65535.0;
            let encoded =
                if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 };
            (encoded * 255.0 + 0.5) as u8
        };
        (0..=65535).map(encode).collect()
    });
    TABLE[(value.clamp(0.0, 1.0) * 65535.0 + 0.5) as usize]
}
