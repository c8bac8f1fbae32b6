//! Eight bits a channel, sRGB-encoded: PNG, JPEG, BMP.

use super::PictureError;
use super::format::{Sink, WriteOptions};
use crate::render::Film;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::codecs::{bmp::BmpEncoder, jpeg::JpegEncoder};
use image::{ExtendedColorType, ImageEncoder};

/// JPEG quality: no visible loss on rendered edges, a third of the PNG's size.
const JPEG_QUALITY: u8 = 95;
/// The same where few bytes count: half of that again.
const COMPACT_QUALITY: u8 = 85;

/// An 8-bit sRGB picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EightBit {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Red, green, blue, row by row from the top: 3 · width · height bytes.
    pub rgb: Vec<u8>,
}

impl EightBit {
    /// The film's 8-bit picture; its alpha is always opaque and is left out.
    pub fn of_film(film: &Film) -> Self {
        let rgb = film.rgba().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        Self { width: film.width(), height: film.height(), rgb }
    }

    /// The picture in few bytes, with their media type: a JPEG that loses a little, or a PNG where that is smaller.
    ///
    /// # Errors
    /// [`PictureError::Encode`] for sides that a JPEG cannot have, above 65535.
    pub fn compact(&self) -> Result<(&'static str, Vec<u8>), PictureError> {
        let (mut jpeg, mut png) = (Vec::new(), Vec::new());
        self.encode_with(JpegEncoder::new_with_quality(&mut jpeg, COMPACT_QUALITY))?;
        self.encode_with(PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive))?;
        Ok(if jpeg.len() < png.len() { ("image/jpeg", jpeg) } else { ("image/png", png) })
    }

    fn encode_with(&self, encoder: impl ImageEncoder) -> Result<(), PictureError> {
        Ok(encoder.write_image(&self.rgb, self.width, self.height, ExtendedColorType::Rgb8)?)
    }
}

pub(super) fn png(picture: &EightBit, _: WriteOptions, sink: &mut dyn Sink) -> Result<(), PictureError> {
    picture.encode_with(PngEncoder::new(sink))
}

pub(super) fn jpeg(picture: &EightBit, _: WriteOptions, sink: &mut dyn Sink) -> Result<(), PictureError> {
    picture.encode_with(JpegEncoder::new_with_quality(sink, JPEG_QUALITY))
}

pub(super) fn bmp(picture: &EightBit, _: WriteOptions, mut sink: &mut dyn Sink) -> Result<(), PictureError> {
    picture.encode_with(BmpEncoder::new(&mut sink))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::SplitMix64;
    use std::io::Cursor;

    fn gradient() -> EightBit {
        EightBit {
            width: 16,
            height: 8,
            rgb: (0..16 * 8).flat_map(|i| [i as u8, 255 - i as u8, 2 * i as u8]).collect(),
        }
    }

    #[test]
    fn png_and_bmp_keep_every_byte() {
        for (encode, format) in
            [(png as fn(&_, _, &mut dyn Sink) -> _, image::ImageFormat::Png), (bmp, image::ImageFormat::Bmp)]
        {
            let mut bytes = Cursor::new(Vec::new());
            encode(&gradient(), WriteOptions::default(), &mut bytes).expect("memory takes it");
            let back = image::load_from_memory_with_format(bytes.get_ref(), format).expect("it is a picture").to_rgb8();
            assert_eq!((back.width(), back.height()), (16, 8));
            assert_eq!(back.into_raw(), gradient().rgb);
        }
    }

    #[test]
    fn few_bytes_are_a_png_of_plain_pictures_and_a_jpeg_of_noise() {
        let plain = EightBit { width: 32, height: 32, rgb: vec![70; 3 * 32 * 32] };
        assert_eq!(plain.compact().expect("small sides").0, "image/png");
        let mut random = SplitMix64(1);
        let noise = (0..3 * 32 * 32).map(|_| random.within(0.0, 256.0) as u8).collect();
        let (kind, bytes) = EightBit { width: 32, height: 32, rgb: noise }.compact().expect("small sides");
        assert_eq!(kind, "image/jpeg");
        assert!(image::load_from_memory_with_format(&bytes, image::ImageFormat::Jpeg).is_ok());
    }

    #[test]
    fn jpeg_stays_close() {
        let flat = EightBit { width: 16, height: 16, rgb: [200, 100, 50].repeat(256) };
        let mut bytes = Cursor::new(Vec::new());
        jpeg(&flat, WriteOptions::default(), &mut bytes).expect("memory takes it");
        let back = image::load_from_memory(bytes.get_ref()).expect("it is a picture").to_rgb8().into_raw();
        assert!(back.iter().zip(&flat.rgb).all(|(a, b)| a.abs_diff(*b) <= 2));
    }
}
