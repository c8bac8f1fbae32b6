//! Textures: images and checkers, looked up by surface coordinates.

use glam::{Vec2, Vec3};
use std::sync::Arc;

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
                let odd = ((uv.x / size).floor() + (uv.y / size).floor()).rem_euclid(2.0) != 0.0;
                colors[usize::from(odd)]
            }
            Self::Image(image) => image.sample(uv),
        }
    }
}

impl ImageTexture {
    /// Bilinear lookup with repetition, in linear light.
    pub fn sample(&self, uv: Vec2) -> Vec3 {
        let (width, height) = (self.width as f32, self.height as f32);
        let wrap = |t: f32| if t.is_finite() { t - t.floor() } else { 0.0 };
        let x = wrap(uv.x / self.size) * width - 0.5;
        let y = (1.0 - wrap(uv.y / self.size)) * height - 0.5;
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let column = |offset: i64| (x0 as i64 + offset).rem_euclid(i64::from(self.width)) as usize;
        let row = |offset: i64| (y0 as i64 + offset).rem_euclid(i64::from(self.height)) as usize;
        let texel = |column: usize, row: usize| {
            let [r, g, b] = self.texels[row * self.width as usize + column];
            Vec3::new(srgb_to_linear(r), srgb_to_linear(g), srgb_to_linear(b))
        };
        let top = texel(column(0), row(0)) * (1.0 - fx) + texel(column(1), row(0)) * fx;
        let bottom = texel(column(0), row(1)) * (1.0 - fx) + texel(column(1), row(1)) * fx;
        top * (1.0 - fy) + bottom * fy
    }
}

/// Decodes one sRGB byte to linear light (IEC 61966-2-1), by a table made at first use.
pub fn srgb_to_linear(byte: u8) -> f32 {
    use std::sync::LazyLock;
    static TABLE: LazyLock<[f32; 256]> = LazyLock::new(|| {
        std::array::from_fn(|i| {
            let encoded = i as f64 / 255.0;
            let linear = if encoded <= 0.04045 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) };
            linear as f32
        })
    });
    TABLE[usize::from(byte)]
}
