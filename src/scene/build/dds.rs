//! DirectDraw surfaces (DDS): plain pixels, or blocks of BC1 to BC5.
//!
//! Only the first and largest picture of a file is read: no smaller sizes, no further sides of a cube.

use image::{DynamicImage, RgbaImage};

/// What a file starts with.
const MAGIC: &[u8] = b"DDS ";
/// Bytes of the header, the magic included, and of the one that may follow.
const HEADER: usize = 128;
const HEADER_DX10: usize = 20;
/// Flags of a pixel format.
const HAS_ALPHA: u32 = 0x1;
const IS_ALPHA: u32 = 0x2;
const IS_FOUR_CC: u32 = 0x4;
const IS_RGB: u32 = 0x40;
const IS_LUMINANCE: u32 = 0x2_0000;

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DdsError {
    /// The file ends before its header or its picture do.
    #[error("the file is cut off")]
    CutOff,
    /// Pixels of a kind that is not read.
    #[error("pixels of a kind that is not read; save the image as BC1 to BC5 or as plain pixels")]
    Unknown,
}

/// How the pixels are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pixels {
    /// Blocks of 4 x 4.
    Blocks(Block),
    /// Of so many bits each, with masks of red, green, blue and opacity.
    Plain { bits: u32, masks: [u32; 4] },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Block {
    /// Two colours and those between, perhaps holes (DXT1).
    Bc1,
    /// 4-bit opacities, then colours (DXT2, DXT3).
    Bc2,
    /// Two opacities and those between, then colours (DXT4, DXT5).
    Bc3,
    /// One channel (ATI1).
    Bc4,
    /// Two channels (ATI2), most often x and y of normals.
    Bc5,
}

impl Block {
    fn bytes(self) -> usize {
        match self {
            Self::Bc1 | Self::Bc4 => 8,
            Self::Bc2 | Self::Bc3 | Self::Bc5 => 16,
        }
    }
}

/// A file whose header was read.
#[derive(Debug)]
pub struct Dds<'a> {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    pixels: Pixels,
    data: &'a [u8],
}

impl<'a> Dds<'a> {
    /// Whether a file is one.
    pub fn is(bytes: &[u8]) -> bool {
        bytes.starts_with(MAGIC)
    }

    /// Reads the header.
    pub fn open(bytes: &'a [u8]) -> Result<Self, DdsError> {
        let (header, mut data) = bytes.split_at_checked(HEADER).ok_or(DdsError::CutOff)?;
        let (words, _) = header.as_chunks::<4>();
        let word = |i: usize| u32::from_le_bytes(words[i]);
        let (height, width, flags, four_cc) = (word(3), word(4), word(20), words[21]);
        let pixels = if flags & IS_FOUR_CC == 0 {
            plain(flags, word(22), [word(23), word(24), word(25), word(26)])?
        } else if four_cc == *b"DX10" {
            let (more, rest) = data.split_at_checked(HEADER_DX10).ok_or(DdsError::CutOff)?;
            data = rest;
            dxgi(u32::from(more[0]) | u32::from(more[1]) << 8)?
        } else {
            Pixels::Blocks(match &four_cc {
                b"DXT1" => Block::Bc1,
                b"DXT2" | b"DXT3" => Block::Bc2,
                b"DXT4" | b"DXT5" => Block::Bc3,
                b"ATI1" | b"BC4U" => Block::Bc4,
                b"ATI2" | b"BC5U" => Block::Bc5,
                _ => return Err(DdsError::Unknown),
            })
        };
        let (w, h) = (u64::from(width), u64::from(height));
        let needed = match pixels {
            Pixels::Blocks(block) => (w.div_ceil(4) * h.div_ceil(4)).saturating_mul(block.bytes() as u64),
            Pixels::Plain { bits, .. } => (w * h).saturating_mul(u64::from(bits / 8)),
        };
        match (data.len() as u64) < needed {
            true => Err(DdsError::CutOff),
            false => Ok(Self { width, height, pixels, data }),
        }
    }

    /// Decodes the picture; its size is what the caller allows.
    pub fn decode(&self) -> Result<DynamicImage, DdsError> {
        let mut image = RgbaImage::new(self.width, self.height);
        match self.pixels {
            Pixels::Plain { bits, masks } => self.decode_plain(bits, masks, &mut image)?,
            Pixels::Blocks(block) => self.decode_blocks(block, &mut image)?,
        }
        Ok(DynamicImage::ImageRgba8(image))
    }

    fn decode_plain(&self, bits: u32, masks: [u32; 4], image: &mut RgbaImage) -> Result<(), DdsError> {
        let mut pixels = self.data.chunks_exact(bits as usize / 8);
        for pixel in image.pixels_mut() {
            let bytes = pixels.next().ok_or(DdsError::CutOff)?;
            let value = bytes.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte));
            pixel.0 = masks.map(|mask| channel(value, mask));
            if masks[3] == 0 {
                pixel.0[3] = u8::MAX;
            }
        }
        Ok(())
    }

    fn decode_blocks(&self, block: Block, image: &mut RgbaImage) -> Result<(), DdsError> {
        let mut blocks = self.data.chunks_exact(block.bytes());
        for y in (0..self.height).step_by(4) {
            for x in (0..self.width).step_by(4) {
                let pixels = decoded(block, blocks.next().ok_or(DdsError::CutOff)?);
                for (i, pixel) in (0..).zip(pixels) {
                    let (x, y) = (x + i % 4, y + i / 4);
                    if x < self.width && y < self.height {
                        image.get_pixel_mut(x, y).0 = pixel;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Pixels that are not in blocks.
fn plain(flags: u32, bits: u32, [r, g, b, a]: [u32; 4]) -> Result<Pixels, DdsError> {
    let a = if flags & (HAS_ALPHA | IS_ALPHA) == 0 { 0 } else { a };
    let masks = match flags {
        _ if flags & IS_RGB != 0 => [r, g, b, a],
        _ if flags & IS_LUMINANCE != 0 => [r, r, r, a],
        _ if flags & IS_ALPHA != 0 => [a; 4],
        _ => return Err(DdsError::Unknown),
    };
    match bits {
        8 | 16 | 24 | 32 => Ok(Pixels::Plain { bits, masks }),
        _ => Err(DdsError::Unknown),
    }
}

/// Pixels by the number that DXGI gives their format; the sRGB ones follow the others.
fn dxgi(format: u32) -> Result<Pixels, DdsError> {
    let plain = |masks| Ok(Pixels::Plain { bits: 32, masks });
    match format {
        28 | 29 => plain([0xFF, 0xFF00, 0xFF_0000, 0xFF00_0000]),
        87 | 91 => plain([0xFF_0000, 0xFF00, 0xFF, 0xFF00_0000]),
        88 | 93 => plain([0xFF_0000, 0xFF00, 0xFF, 0]),
        61 => Ok(Pixels::Plain { bits: 8, masks: [0xFF, 0xFF, 0xFF, 0] }),
        71 | 72 => Ok(Pixels::Blocks(Block::Bc1)),
        74 | 75 => Ok(Pixels::Blocks(Block::Bc2)),
        77 | 78 => Ok(Pixels::Blocks(Block::Bc3)),
        80 => Ok(Pixels::Blocks(Block::Bc4)),
        83 => Ok(Pixels::Blocks(Block::Bc5)),
        _ => Err(DdsError::Unknown),
    }
}

/// The bits of a value under a mask, as 8 bits.
fn channel(value: u32, mask: u32) -> u8 {
    if mask == 0 {
        return 0;
    }
    let shift = mask.trailing_zeros();
    let (value, most) = (u64::from((value & mask) >> shift), u64::from(mask >> shift));
    ((value * 255 + most / 2) / most) as u8
}

/// The pixels of a block, row by row.
fn decoded(block: Block, bytes: &[u8]) -> [[u8; 4]; 16] {
    let (first, second) = bytes.split_at(bytes.len() / 2);
    match block {
        Block::Bc1 => colors(bytes, true),
        Block::Bc2 => {
            let mut pixels = colors(second, false);
            for (i, pixel) in pixels.iter_mut().enumerate() {
                pixel[3] = (first[i / 2] >> (i % 2 * 4) & 0xF) * 17;
            }
            pixels
        }
        Block::Bc3 => {
            let mut pixels = colors(second, false);
            for (pixel, opacity) in pixels.iter_mut().zip(levels(first)) {
                pixel[3] = opacity;
            }
            pixels
        }
        Block::Bc4 => levels(bytes).map(|level| [level, level, level, u8::MAX]),
        Block::Bc5 => {
            let (x, y) = (levels(first), levels(second));
            std::array::from_fn(|i| [x[i], y[i], upward(x[i], y[i]), u8::MAX])
        }
    }
}

/// Sixteen colours of four: two of 5, 6 and 5 bits and two between, or one between and a hole.
fn colors(bytes: &[u8], may_have_holes: bool) -> [[u8; 4]; 16] {
    let ends = [0, 2].map(|i| u16::from_le_bytes([bytes[i], bytes[i + 1]]));
    let masks = [0xF800, 0x07E0, 0x001F];
    let [a, b] = ends.map(|end| masks.map(|mask| channel(end.into(), mask)));
    let mixed = |of_a: u16, of_b: u16| {
        let mix = |i: usize| ((of_a * u16::from(a[i]) + of_b * u16::from(b[i])) / (of_a + of_b)) as u8;
        [mix(0), mix(1), mix(2), u8::MAX]
    };
    let between = match ends[0] > ends[1] || !may_have_holes {
        true => [mixed(2, 1), mixed(1, 2)],
        false => [mixed(1, 1), [0; 4]],
    };
    let palette = [mixed(1, 0), mixed(0, 1), between[0], between[1]];
    std::array::from_fn(|i| palette[usize::from(bytes[4 + i / 4] >> (i % 4 * 2) & 3)])
}

/// Sixteen values of eight: two and six between, or four between, 0 and 255.
fn levels(bytes: &[u8]) -> [u8; 16] {
    let (a, b) = (u16::from(bytes[0]), u16::from(bytes[1]));
    let steps = if a > b { 7 } else { 5 };
    let palette: [u8; 8] = std::array::from_fn(|i| match i as u16 {
        0 => bytes[0],
        1 => bytes[1],
        6 if steps == 5 => 0,
        7 if steps == 5 => u8::MAX,
        i => ((a * (steps + 1 - i) + b * (i - 1)) / steps) as u8,
    });
    let bits = bytes[2..8].iter().rev().fold(0_u64, |bits, byte| bits << 8 | u64::from(*byte));
    std::array::from_fn(|i| palette[(bits >> (3 * i) & 7) as usize])
}

/// The third coordinate of a unit normal, which two channels leave out.
fn upward(x: u8, y: u8) -> u8 {
    let [x, y] = [x, y].map(|byte| f32::from(byte) / 127.5 - 1.0);
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    (z * 127.5 + 128.0).min(255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of a size, a pixel format's flags, code, bits and masks, and data.
    fn file(size: [u32; 2], flags: u32, four_cc: &[u8; 4], bits: u32, masks: [u32; 4], data: &[u8]) -> Vec<u8> {
        let mut words = [0_u32; HEADER / 4];
        words[0] = u32::from_le_bytes(*b"DDS ");
        (words[3], words[4], words[20], words[22]) = (size[1], size[0], flags, bits);
        words[21] = u32::from_le_bytes(*four_cc);
        words[23..27].copy_from_slice(&masks);
        words.iter().flat_map(|word| word.to_le_bytes()).chain(data.iter().copied()).collect()
    }

    fn pixels(file: &[u8]) -> Result<Vec<[u8; 4]>, DdsError> {
        Ok(Dds::open(file)?.decode()?.into_rgba8().pixels().map(|pixel| pixel.0).collect())
    }

    fn blocks(four_cc: &[u8; 4], data: &[u8]) -> Vec<[u8; 4]> {
        pixels(&file([4, 4], IS_FOUR_CC, four_cc, 0, [0; 4], data)).unwrap()
    }

    /// Red, then blue, then two between, in each row.
    const COLORS: [u8; 8] = [0x00, 0xF8, 0x1F, 0x00, 0xE4, 0xE4, 0xE4, 0xE4];
    /// The same with blue first, which leaves holes.
    const HOLES: [u8; 8] = [0x1F, 0x00, 0x00, 0xF8, 0xE4, 0xE4, 0xE4, 0xE4];

    #[test]
    fn blocks_hold_colours_and_opacities() {
        let row = [[255, 0, 0, 255], [0, 0, 255, 255], [170, 0, 85, 255], [85, 0, 170, 255]];
        assert_eq!(blocks(b"DXT1", &COLORS), row.repeat(4));
        assert_eq!(blocks(b"DXT1", &HOLES)[..4], [[0, 0, 255, 255], [255, 0, 0, 255], [127, 0, 127, 255], [0; 4]]);
        let dxt3 = blocks(b"DXT3", &[&[0x10, 0x32, 0x54, 0x76, 0x98, 0xBA, 0xDC, 0xFE], &HOLES[..]].concat());
        assert_eq!(dxt3.iter().map(|pixel| pixel[3]).collect::<Vec<_>>(), (0..16).map(|i| i * 17).collect::<Vec<u8>>());
        assert_eq!(dxt3[3][..3], [170, 0, 85], "no holes beside opacities");
        // The eight values in turn.
        let indices = [0x88, 0xC6, 0xFA, 0x88, 0xC6, 0xFA];
        let falling = [&[210, 0], &indices[..]].concat();
        let levels = [210, 0, 180, 150, 120, 90, 60, 30];
        let dxt5 = blocks(b"DXT5", &[&falling, &COLORS[..]].concat());
        assert_eq!(dxt5.iter().map(|pixel| pixel[3]).collect::<Vec<_>>(), levels.repeat(2));
        let rising = [&[0, 50], &indices[..]].concat();
        let grey = blocks(b"ATI1", &rising);
        assert_eq!(grey.iter().map(|pixel| pixel[0]).collect::<Vec<_>>(), [0, 50, 10, 20, 30, 40, 0, 255].repeat(2));
        let flat = [128, 128, 0, 0, 0, 0, 0, 0].repeat(2);
        assert_eq!(blocks(b"ATI2", &flat)[0], [128, 128, 255, 255]);
    }

    #[test]
    fn plain_pixels_are_found_by_their_masks() {
        let bgr = file([2, 1], IS_RGB, &[0; 4], 24, [0xFF_0000, 0xFF00, 0xFF, 0xFF00_0000], &[1, 2, 3, 4, 5, 6]);
        assert_eq!(pixels(&bgr).unwrap(), [[3, 2, 1, 255], [6, 5, 4, 255]]);
        let short = file([1, 1], IS_RGB | HAS_ALPHA, &[0; 4], 16, [0x7C00, 0x3E0, 0x1F, 0x8000], &[0x1F, 0x7C]);
        assert_eq!(pixels(&short).unwrap(), [[255, 0, 255, 0]]);
        let grey = file([1, 1], IS_LUMINANCE, &[0; 4], 8, [0xFF, 0, 0, 0], &[77]);
        assert_eq!(pixels(&grey).unwrap(), [[77, 77, 77, 255]]);
        let more = [&[71, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0], &COLORS[..]].concat();
        assert_eq!(pixels(&file([1, 1], IS_FOUR_CC, b"DX10", 0, [0; 4], &more)).unwrap(), [[255, 0, 0, 255]]);
    }

    #[test]
    fn damaged_files_are_refused() {
        let whole = file([5, 4], IS_FOUR_CC, b"DXT1", 0, [0; 4], &COLORS.repeat(2));
        assert_eq!(pixels(&whole).unwrap().len(), 20);
        for length in 0..whole.len() {
            assert_eq!(pixels(&whole[..length]), Err(DdsError::CutOff), "{length}");
        }
        for (flags, four_cc, bits) in
            [(IS_FOUR_CC, b"BC7U", 0), (0, &[0; 4], 32), (IS_RGB, &[0; 4], 0), (IS_RGB, &[0; 4], 9)]
        {
            assert_eq!(pixels(&file([1, 1], flags, four_cc, bits, [1; 4], &[0; 64])), Err(DdsError::Unknown));
        }
    }
}
