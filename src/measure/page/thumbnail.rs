//! Pictures as the page holds them: no wider than it shows them, so that it stays small. The folder keeps them whole.

use crate::picture::{self, EightBit, Encoding};
use crate::scene::Limits;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use std::path::Path;

/// The greatest width; the page shows two pictures side by side within 1200 pixels.
const WIDTH: u32 = 640;

/// What becomes of pixels that share one of the smaller picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reduce {
    /// Their mean.
    Picture,
    /// The greatest error among them: a single wrong pixel must stay visible.
    Map,
}

/// A file of `folder/pictures` as an address that holds it; `None` where it cannot be read, or lies elsewhere.
pub fn of(folder: &Path, name: &str, kind: Reduce) -> Option<String> {
    let inside = name.strip_prefix("pictures/").filter(|rest| !rest.contains(['/', '\\']))?;
    let picture =
        picture::read(&folder.join("pictures").join(inside), &Limits::default()).ok()?.encoded_as(Encoding::Srgb);
    let rgb = picture.pixels.iter().flatten().map(|value| (255.0 * value).round() as u8).collect();
    let reduced = reduced(&EightBit { width: picture.width, height: picture.height, rgb }, kind);
    let (media_type, bytes) = reduced.compact().ok()?;
    Some(format!("data:{media_type};base64,{}", BASE64_STANDARD.encode(bytes)))
}

/// The picture, divided by the least whole number that brings it within [`WIDTH`].
fn reduced(picture: &EightBit, kind: Reduce) -> EightBit {
    let by = picture.width.div_ceil(WIDTH).max(1);
    let (width, height) = (picture.width.div_ceil(by), picture.height.div_ceil(by));
    let pixels = picture.rgb.as_chunks::<3>().0;
    let cell = |left: u32, top: u32| {
        let rows = top * by..((top + 1) * by).min(picture.height);
        let columns = left * by..((left + 1) * by).min(picture.width);
        let row = move |y: u32| columns.clone().map(move |x| pixels[(y * picture.width + x) as usize]);
        rows.flat_map(row)
    };
    let rgb = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| match kind {
        Reduce::Picture => mean(cell(x, y)),
        // In viridis, green rises with the error.
        Reduce::Map => cell(x, y).max_by_key(|pixel| pixel[1]).unwrap_or_default(),
    });
    EightBit { width, height, rgb: rgb.collect() }
}

fn mean(pixels: impl Iterator<Item = [u8; 3]>) -> [u8; 3] {
    let (mut sum, mut count) = ([0_u32; 3], 0);
    for pixel in pixels {
        sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += u32::from(value));
        count += 1;
    }
    sum.map(|sum| ((sum + count / 2) / count.max(1)) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_pictures_shrink_and_single_errors_stay() {
        let (width, height) = (1281, 5);
        let mut rgb = vec![0; 3 * width as usize * height as usize];
        rgb[3 * 700..3 * 701].copy_from_slice(&[253, 231, 36]);
        let whole = EightBit { width, height, rgb };
        let (map, picture) = (reduced(&whole, Reduce::Map), reduced(&whole, Reduce::Picture));
        assert_eq!((map.width, map.height, map.rgb.len()), (427, 2, 3 * 427 * 2));
        assert_eq!(map.rgb[3 * 233..3 * 234], [253, 231, 36]);
        assert_eq!(picture.rgb[3 * 233..3 * 234], [28, 26, 4]);
    }

    #[test]
    fn narrow_pictures_stay_as_they_are() {
        let small = EightBit { width: 2, height: 1, rgb: vec![1, 2, 3, 4, 5, 6] };
        assert_eq!(reduced(&small, Reduce::Picture), small);
        assert_eq!(reduced(&small, Reduce::Map), small);
    }
}
