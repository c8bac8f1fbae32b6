//! Textures: images and checkers, looked up by surface coordinates.

use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use std::sync::Arc;
use std::sync::LazyLock;

/// A picture wrapped around by repetition, one texel per byte triple.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTexture {
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// sRGB-encoded texels, row by row from the top; textures of one file share them.
    pub texels: Arc<[[u8; 3]]>,
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
            Self::Image(image) => image.sample(simd, u, v, lanes),
        }
    }
}

impl ImageTexture {
    /// Bilinear lookup with repetition, in linear light.
    #[inline(always)]
    fn sample<S: Simd>(&self, simd: S, u: S::f32s, v: S::f32s, lanes: u64) -> V3<S::f32s> {
        let one = S::f32s::splat(simd, 1.0);
        let repetitions = 1.0 / self.size;
        let (left, right, across) = neighbours(simd, u * repetitions, self.width);
        let (bottom, top, up) = neighbours(simd, v * repetitions, self.height);
        // Rows are counted from the top, v from the bottom.
        let (width, last) = (S::u32s::splat(simd, self.width), S::u32s::splat(simd, self.height - 1));
        let [bottom, top] = [(last - bottom) * width, (last - top) * width];
        let low = self.texels(simd, bottom + left, lanes).scale(one - across)
            + self.texels(simd, bottom + right, lanes).scale(across);
        let high = self.texels(simd, top + left, lanes).scale(one - across)
            + self.texels(simd, top + right, lanes).scale(across);
        low.scale(one - up) + high.scale(up)
    }

    /// The texels of the lanes in the bit set `lanes`, in linear light.
    #[inline(always)]
    fn texels<S: Simd>(&self, simd: S, indices: S::u32s, lanes: u64) -> V3<S::f32s> {
        let decode = srgb_table();
        let indices = indices.as_slice();
        let mut found = V3::<S::f32s>::zero(simd);
        let (x, y, z) = (found.x.as_mut_slice(), found.y.as_mut_slice(), found.z.as_mut_slice());
        let mut left = lanes;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let [r, g, b] = self.texels[indices[lane] as usize];
            (x[lane], y[lane], z[lane]) = (decode[usize::from(r)], decode[usize::from(g)], decode[usize::from(b)]);
        }
        found
    }
}

/// The two texels around coordinate `t` of a repeating row of `size` texels, and the share of the second.
#[inline(always)]
fn neighbours<S: Simd>(simd: S, t: S::f32s, size: u32) -> (S::u32s, S::u32s, S::f32s) {
    let zero = S::f32s::splat(simd, 0.0);
    let finite = (t - t).simd_eq(zero);
    let t = finite.select(t, zero);
    let texels = size as f32;
    let position = (t - t.floor()) * texels - 0.5;
    let before = position.floor();
    let after = before + 1.0;
    let share = position - before;
    let before = before.simd_lt(zero).select(S::f32s::splat(simd, texels - 1.0), before);
    let after = after.simd_ge(S::f32s::splat(simd, texels)).select(zero, after);
    (before.to_int(), after.to_int(), share)
}

/// Decodes one sRGB byte to linear light (IEC 61966-2-1), by a table made at first use.
pub fn srgb_to_linear(byte: u8) -> f32 {
    srgb_table()[usize::from(byte)]
}

fn srgb_table() -> &'static [f32; 256] {
    static TABLE: LazyLock<[f32; 256]> = LazyLock::new(|| {
        std::array::from_fn(|i| {
            let encoded = i as f64 / 255.0;
            let linear = if encoded <= 0.04045 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) };
            linear as f32
        })
    });
    &TABLE
}
