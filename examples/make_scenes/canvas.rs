//! A square canvas and the few strokes that the pictures share. Colours are sRGB, 0 to 1.

use glam::DVec3;
use image::{Rgb, RgbImage};

/// A picture as a function of u (left to right) and v (bottom to top), both in 0..1.
pub type Paint = fn(u: f64, v: f64) -> DVec3;

/// Sub-pixels along an edge of a pixel.
const SUBPIXELS: u32 = 4;

/// Levels per channel: fewer than 256 make noise, which PNG cannot predict, a good deal smaller.
const LEVELS: f64 = 64.0;

/// Paints a picture of `edge` x `edge` pixels, each the mean of a regular grid of sub-pixels.
pub fn picture(edge: u32, paint: Paint) -> RgbImage {
    let fine = f64::from(edge * SUBPIXELS);
    RgbImage::from_fn(edge, edge, |x, y| {
        let mut sum = DVec3::ZERO;
        for sub_y in 0..SUBPIXELS {
            for sub_x in 0..SUBPIXELS {
                let u = (f64::from(x * SUBPIXELS + sub_x) + 0.5) / fine;
                let v = 1.0 - (f64::from(y * SUBPIXELS + sub_y) + 0.5) / fine;
                sum += paint(u, v);
            }
        }
        let mean = sum / f64::from(SUBPIXELS * SUBPIXELS);
        Rgb(mean.to_array().map(|channel| {
            let level = (channel.clamp(0.0, 1.0) * (LEVELS - 1.0)).round();
            (level * 255.0 / (LEVELS - 1.0)).round() as u8
        }))
    })
}

/// A colour written as 0xRRGGBB.
pub fn rgb(hex: u32) -> DVec3 {
    let channel = |shift: u32| f64::from((hex >> shift) & 0xff) / 255.0;
    DVec3::new(channel(16), channel(8), channel(0))
}

/// 0 below `from`, 1 above `to`, smooth between.
pub fn smoothstep(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The colour at `x` on a ramp of evenly spaced colours.
pub fn ramp(colors: &[DVec3], x: f64) -> DVec3 {
    let last = colors.len() - 1;
    let position = x.clamp(0.0, 1.0) * last as f64;
    let left = (position as usize).min(last.saturating_sub(1));
    colors[left].lerp(colors[(left + 1).min(last)], position - left as f64)
}
