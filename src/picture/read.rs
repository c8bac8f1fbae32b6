//! Pictures read back to be compared: PNG and its kind, and OpenEXR.

use super::PictureError;
use super::transfer::{srgb_decode, srgb_encode};
use crate::scene::limits::{self, Limits};
use exr::prelude::{MetaData, ReadChannels, ReadLayers};
use image::ColorType;
use std::fs::{self, File};
use std::io::{BufReader, Read};
use std::path::Path;

/// The first bytes of every OpenEXR file.
const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// What a picture's numbers mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// sRGB-encoded, in [0, 1].
    Srgb,
    /// Linear light, unbounded.
    Linear,
}

/// A picture in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1.
    pub height: u32,
    /// Red, green, blue, row by row from the top. All finite.
    pub pixels: Vec<[f32; 3]>,
    /// What the numbers mean.
    pub encoding: Encoding,
}

impl Picture {
    /// The same picture in `encoding`; on the way to sRGB it is clamped to [0, 1].
    pub fn encoded_as(mut self, encoding: Encoding) -> Self {
        let convert: fn(f32) -> f32 = match (self.encoding, encoding) {
            (Encoding::Linear, Encoding::Srgb) => |v| srgb_encode(v.clamp(0.0, 1.0)),
            (Encoding::Srgb, Encoding::Linear) => srgb_decode,
            _ => return self,
        };
        self.pixels.iter_mut().flatten().for_each(|v| *v = convert(*v));
        self.encoding = encoding;
        self
    }
}

/// Reads a PNG, JPEG or BMP of 8 or 16 bits (grey is spread, alpha left out), or the `R G B` of an OpenEXR file.
///
/// # Errors
/// [`PictureError::Io`] when the file cannot be read; [`PictureError::Decode`] when it is no such picture, is
/// damaged, has more pixels than the limit `picture-pixels`, or holds infinities or values that are not numbers.
pub fn read(path: &Path, limits: &Limits) -> Result<Picture, PictureError> {
    let metadata = fs::metadata(path).map_err(PictureError::io(path, "read"))?;
    if !metadata.is_file() {
        return Err(PictureError::decode(path, "not a regular file"));
    }
    let mut magic = [0; 4];
    let mut file = File::open(path).map_err(PictureError::io(path, "read"))?;
    let is_exr = file.read_exact(&mut magic).is_ok() && magic == EXR_MAGIC;
    let most = limits.picture_pixels;
    let picture = if is_exr { read_exr(path, most)? } else { read_eight_or_sixteen_bit(path, most)? };
    let not_finite = picture.pixels.iter().filter(|p| p.iter().any(|v| !v.is_finite())).count();
    if not_finite > 0 {
        return Err(PictureError::decode(path, format!("{not_finite} pixels are infinite or not a number")));
    }
    Ok(picture)
}

fn open(path: &Path) -> Result<BufReader<File>, PictureError> {
    File::open(path).map(BufReader::new).map_err(PictureError::io(path, "read"))
}

/// A damaged or hostile header must not make us ask the system for terabytes.
fn check_size(path: &Path, width: u64, height: u64, most: u64) -> Result<(), PictureError> {
    let message = match width.checked_mul(height) {
        Some(0) => "no pixels".to_owned(),
        Some(pixels) if pixels <= most => return Ok(()),
        _ => limits::exceeded("picture-pixels", most),
    };
    Err(PictureError::decode(path, format!("{width}x{height}: {message}")))
}

fn read_eight_or_sixteen_bit(path: &Path, most: u64) -> Result<Picture, PictureError> {
    let decoded = |error: image::ImageError| PictureError::decode(path, error);
    let reader = || {
        let guessed = image::ImageReader::new(open(path)?).with_guessed_format();
        guessed.map_err(PictureError::io(path, "read"))
    };
    let (width, height) = reader()?.into_dimensions().map_err(decoded)?;
    check_size(path, u64::from(width), u64::from(height), most)?;
    let mut reader = reader()?;
    // The size was checked; 16 bytes a pixel is the most that a decoder holds.
    let mut limits = image::Limits::no_limits();
    limits.max_alloc = Some(most.saturating_mul(16));
    reader.limits(limits);
    let image = reader.decode().map_err(decoded)?;
    // Grey is spread before it is divided, so that it is the same as its three channels written out.
    let pixels = match image.color() {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            image.into_rgb8().pixels().map(|pixel| pixel.0.map(|v| f32::from(v) / 255.0)).collect()
        }
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            image.into_rgb16().pixels().map(|pixel| pixel.0.map(|v| f32::from(v) / 65_535.0)).collect()
        }
        _ => image.into_rgb32f().pixels().map(|pixel| pixel.0).collect(),
    };
    Ok(Picture { width, height, pixels, encoding: Encoding::Srgb })
}

fn read_exr(path: &Path, most: u64) -> Result<Picture, PictureError> {
    let decoded = |error: exr::error::Error| PictureError::decode(path, error);
    let meta = MetaData::read_from_buffered(open(path)?, false).map_err(decoded)?;
    for header in &meta.headers {
        check_size(path, header.layer_size.width() as u64, header.layer_size.height() as u64, most)?;
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.width(), vec![[0.0_f32; 3]; size.area()]),
            |(width, pixels), position, (r, g, b): (f32, f32, f32)| {
                pixels[position.y() * *width + position.x()] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(open(path)?)
        .map_err(decoded)?;
    let size = image.layer_data.size;
    let (_, pixels) = image.layer_data.channel_data.pixels;
    Ok(Picture { width: size.width() as u32, height: size.height() as u32, pixels, encoding: Encoding::Linear })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::temporary::Folder;

    /// The picture in a file, within the usual limits.
    fn of(file: &Path) -> Result<Picture, PictureError> {
        read(file, &Limits::default())
    }

    #[test]
    fn sixteen_bits_keep_their_precision() {
        let image = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(2, 1, vec![1_u16, 65_535]).expect("two pixels");
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, image::ImageFormat::Png).expect("memory takes it");
        let folder = Folder::new();
        let picture = of(&folder.write("deep.png", bytes.get_ref())).expect("it is a picture");
        assert_eq!((picture.width, picture.height, picture.encoding), (2, 1, Encoding::Srgb));
        assert_eq!(picture.pixels, [[1.0 / 65_535.0; 3], [1.0; 3]]);
    }

    #[test]
    fn grey_is_the_same_as_its_three_channels_written_out() {
        let folder = Folder::new();
        let grey = image::GrayImage::from_fn(256, 1, |x, _| image::Luma([x as u8]));
        let deep = image::ImageBuffer::<image::Luma<u16>, _>::from_fn(4096, 1, |x, _| image::Luma([16 * x as u16 + 5]));
        let read_back = |name: &str, image: image::DynamicImage| {
            let mut bytes = std::io::Cursor::new(Vec::new());
            image.write_to(&mut bytes, image::ImageFormat::Png).expect("memory takes it");
            of(&folder.write(name, bytes.get_ref())).expect("it is a picture")
        };
        for image in [image::DynamicImage::from(grey), image::DynamicImage::from(deep)] {
            let spread = if image.color() == ColorType::L8 {
                image::DynamicImage::from(image.to_rgb8())
            } else {
                image::DynamicImage::from(image.to_rgb16())
            };
            assert_eq!(read_back("grey.png", image), read_back("rgb.png", spread));
        }
    }

    #[test]
    fn an_exr_is_linear_until_it_is_encoded() {
        let folder = Folder::new();
        let file = folder.write("linear.exr", b"");
        exr::prelude::write_rgb_file(&file, 2, 1, |x, _| if x == 0 { (-1.0_f32, 0.5, 7.0) } else { (0.0, 0.0, 1.0) })
            .expect("writable");
        let picture = of(&file).expect("it is an EXR");
        assert_eq!(picture.encoding, Encoding::Linear);
        assert_eq!(picture.pixels[0], [-1.0, 0.5, 7.0]);
        let shown = picture.encoded_as(Encoding::Srgb);
        assert_eq!((shown.pixels[0][0], shown.pixels[0][2]), (0.0, 1.0));
        assert!((shown.pixels[0][1] - 0.735_357).abs() < 1e-5);
    }

    #[test]
    fn what_is_no_picture_is_told_in_one_line() {
        let folder = Folder::new();
        let mut hostile = Vec::new();
        // A PNG that claims 65000 x 65000 pixels: signature, then an IHDR chunk.
        hostile.extend(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\xfd\xe8\0\0\xfd\xe8\x08\x02\0\0\0");
        hostile.extend([0; 4]);
        let not_a_number = {
            let file = folder.write("nan.exr", b"");
            exr::prelude::write_rgb_file(&file, 1, 1, |_, _| (f32::NAN, 0.0_f32, 0.0_f32)).expect("writable");
            fs::read(&file).expect("there")
        };
        let cases: [(&str, &[u8]); 6] = [
            ("empty.png", b""),
            ("text.png", b"no picture at all"),
            ("hostile.png", &hostile),
            ("magic.exr", &EXR_MAGIC),
            ("cut.exr", &not_a_number[..not_a_number.len() - 9]),
            ("nan.exr", &not_a_number),
        ];
        for (name, bytes) in cases {
            let message = of(&folder.write(name, bytes)).expect_err(name).to_string();
            assert!(message.contains(name) && !message.contains('\n'), "{message}");
        }
        assert!(of(Path::new("no/such/file.png")).expect_err("missing").to_string().contains("no/such/file.png"));
        assert!(of(folder.path()).is_err());
    }
}
