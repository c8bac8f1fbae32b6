//! Textures: images and checkers, looked up by surface coordinates.

use glam::{Vec2, Vec3, Vec3A};
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
    /// The linear colour at surface coordinates `uv`.
    pub fn sample(&self, uv: Vec2) -> Vec3 {
        match self {
            Self::Checker { colors, size } => {
                let sum = floor(uv.x / size) + floor(uv.y / size);
                let odd = sum - 2.0 * floor(sum * 0.5) != 0.0;
                colors[usize::from(odd)]
            }
            Self::Image(image) => image.sample(uv),
        }
    }
}

impl ImageTexture {
    /// Bilinear lookup with repetition, in linear light.
    pub fn sample(&self, uv: Vec2) -> Vec3 {
        let (left, right, across) = neighbours(uv.x / self.size, self.width);
        let (bottom, top, up) = neighbours(uv.y / self.size, self.height);
        // Rows are counted from the top, v from the bottom.
        let row = |from_bottom: u32| (self.height - 1 - from_bottom) as usize * self.width as usize;
        let decode = srgb_table();
        let texel = |row: usize, column: u32| {
            let [r, g, b] = self.texels[row + column as usize];
            Vec3A::new(decode[usize::from(r)], decode[usize::from(g)], decode[usize::from(b)])
        };
        let along = |row: usize| texel(row, left) * (1.0 - across) + texel(row, right) * across;
        Vec3::from(along(row(bottom)) * (1.0 - up) + along(row(top)) * up)
    }
}

/// The two texels around coordinate `t` of a repeating row of `size` texels, and the share of the second.
fn neighbours(t: f32, size: u32) -> (u32, u32, f32) {
    let t = if t.is_finite() { t } else { 0.0 };
    let position = (t - floor(t)) * size as f32 - 0.5;
    let before = floor(position);
    let wrap = |texel: f32| if texel < 0.0 { size - 1 } else { (texel as u32) % size };
    (wrap(before), wrap(before + 1.0), position - before)
}

/// Rounds down. Inline on every processor, where `f32::floor` may be a call; numbers too large to have a fraction stay.
fn floor(t: f32) -> f32 {
    if t.abs() >= 8_388_608.0 {
        return t;
    }
    let truncated = t as i32 as f32;
    if truncated > t { truncated - 1.0 } else { truncated }
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
