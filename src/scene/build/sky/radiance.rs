//! Radiance pictures: a header of text lines, then scanlines of pixels that share an exponent.
//!
//! After G. Ward, "Real Pixels", Graphics Gems II, 1991, and the Radiance reference manual. The header is read here, and not by
//! the `image` crate, since that refuses all orientations but one, CIE XYZ, line ends of other systems and `#?RGBE`.

use super::canvas::Canvas;
use super::{Allowed, SkyError};
use crate::scene::desc::map::shortened;

/// Why a picture could not be decoded.
#[derive(Debug, thiserror::Error)]
pub enum RadianceError {
    #[error("its header has no line such as \"-Y 512 +X 1024\", which gives its size")]
    NoSize,
    #[error("its size is given as \"{0}\"; expected a line such as \"-Y 512 +X 1024\"")]
    Size(String),
    #[error("FORMAT={0} is unknown; expected 32-bit_rle_rgbe or 32-bit_rle_xyze")]
    Format(String),
    #[error("it ends in scanline {line} of {of}; the file is damaged")]
    Truncated { line: u32, of: u32 },
    #[error("scanline {line} of {of} holds {found} pixels in place of {expected}; the file is damaged")]
    Length { line: u32, of: u32, found: u64, expected: u32 },
    #[error("scanline {line} of {of} repeats a pixel before there is one; the file is damaged")]
    NothingToRepeat { line: u32, of: u32 },
}

/// Most bytes of a header.
const LONGEST_HEADER: usize = 1 << 20;
/// Scanlines of these lengths may be stored component by component.
const RUN_LENGTH_CODED: std::ops::RangeInclusive<u32> = 8..=32767;

/// Linear RGB of CIE XYZ, for the primaries of Radiance and white of equal energy.
const RGB_OF_XYZ: [[f32; 3]; 3] = [
    [2.565_312_8, -1.166_849_6, -0.398_463_23],
    [-1.022_108_2, 1.978_286_6, 0.043_821_556],
    [0.074_724_38, -0.251_939_57, 1.177_215_2],
];

/// A pixel as it is stored: three mantissas and their exponent.
type Pixel = [u8; 4];

/// What the header says.
struct Header {
    /// What values are to be divided by.
    exposure: [f64; 3],
    is_xyz: bool,
    /// What mantissas are multiplied by, for each exponent.
    scales: [f64; 256],
    size: Size,
    odd: Vec<String>,
}

/// The size of a picture, and how its scanlines run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Size {
    /// How many scanlines there are.
    lines: u32,
    /// Pixels in each.
    length: u32,
    /// Scanlines are columns.
    is_transposed: bool,
    /// The first scanline is the lowest or the rightmost.
    lines_are_reversed: bool,
    /// The first pixel of a scanline is its lowest or its rightmost.
    pixels_are_reversed: bool,
}

/// Decodes a picture. Infinite values become `stand_in`.
pub fn decode(bytes: &[u8], stand_in: f32, allowed: Allowed) -> Result<(Canvas, Vec<String>), SkyError> {
    let (header, mut rest) = Header::read(bytes)?;
    let size = header.size;
    let (width, height) = size.picture();
    allowed.check_size(width.into(), height.into())?;
    // No scanline takes less: what was cut short need not be given memory.
    if (rest.len() as u64) < 4 * u64::from(size.lines) {
        return Err(RadianceError::Truncated { line: rest.len() as u32 / 4, of: size.lines }.into());
    }
    let mut canvas = Canvas::new(width, height, stand_in);
    let mut scanline = vec![Pixel::default(); size.length as usize];
    let mut last = None;
    for line in 0..size.lines {
        if line % 64 == 0 {
            allowed.check_cancelled()?;
        }
        rest = read_scanline(rest, &mut scanline, last).map_err(|broken| broken.at(line, size))?;
        last = scanline.last().copied();
        for (i, pixel) in (0..).zip(&scanline) {
            let (x, y) = size.place(line, i);
            canvas.paint(x, y, header.radiance(*pixel));
        }
    }
    Ok((canvas, header.odd))
}

impl Header {
    /// Reads the header, and gives what comes after it.
    fn read(bytes: &[u8]) -> Result<(Self, &[u8]), SkyError> {
        let is_signed = bytes.starts_with(b"#?");
        let (mut exposure, mut is_xyz, mut odd) = ([1.0; 3], false, Vec::new());
        let mut rest = &bytes[..bytes.len().min(LONGEST_HEADER)];
        let mut is_past_blank = false;
        while let Some(end) = rest.iter().position(|&byte| byte == b'\n') {
            let line = String::from_utf8_lossy(&rest[..end]);
            let line = line.strip_suffix('\r').unwrap_or(&line);
            rest = &rest[end + 1..];
            // Some writers leave out the blank line before the size.
            if let Some(size) = Size::parse(line) {
                let after = &bytes[bytes.len().min(LONGEST_HEADER) - rest.len()..];
                return Ok((Self { exposure, is_xyz, scales: scales(), size, odd }, after));
            }
            if is_past_blank {
                let line = shortened(line);
                return Err(if is_signed { RadianceError::Size(line).into() } else { SkyError::Unknown });
            }
            is_past_blank = line.trim().is_empty();
            // What is indented says how a picture was made that went into this one.
            match line.split_once('=') {
                Some(("FORMAT", format)) => match format.trim() {
                    "32-bit_rle_rgbe" => is_xyz = false,
                    "32-bit_rle_xyze" => is_xyz = true,
                    other => return Err(RadianceError::Format(shortened(other)).into()),
                },
                Some(("EXPOSURE", text)) => match factor(text) {
                    Some(factor) => exposure = exposure.map(|before| before * factor),
                    None => odd.push(format!("EXPOSURE={} is no number above 0; it is ignored", shortened(text))),
                },
                Some(("COLORCORR", text)) => {
                    let factors: Vec<f64> = text.split_ascii_whitespace().filter_map(factor).collect();
                    match <[f64; 3]>::try_from(factors) {
                        Ok(factors) => exposure = [0, 1, 2].map(|channel| exposure[channel] * factors[channel]),
                        Err(_) => odd.push(format!("COLORCORR={} is ignored; expected 3 numbers", shortened(text))),
                    }
                }
                _ => {}
            }
        }
        Err(if is_signed { RadianceError::NoSize.into() } else { SkyError::Unknown })
    }

    /// What a pixel means.
    fn radiance(&self, [red, green, blue, exponent]: Pixel) -> [f32; 3] {
        let scale = self.scales[usize::from(exponent)];
        let mut color = [red, green, blue].map(|mantissa| f64::from(mantissa) * scale);
        if self.is_xyz {
            let dot = |row: [f32; 3]| row.iter().zip(color).map(|(a, b)| f64::from(*a) * b).sum::<f64>();
            // Colours that RGB has not are the nearest that it has.
            color = RGB_OF_XYZ.map(|row| dot(row).max(0.0));
        }
        [0, 1, 2].map(|channel| (color[channel] / self.exposure[channel]) as f32)
    }
}

/// What mantissas are multiplied by, for each exponent; 0 means black.
fn scales() -> [f64; 256] {
    let mut scales = [0.0; 256];
    for (exponent, scale) in (1..).zip(&mut scales[1..]) {
        *scale = libm::ldexp(1.0, exponent - (128 + 8));
    }
    scales
}

/// A factor that values were multiplied by.
fn factor(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|factor: &f64| factor.is_normal() && *factor > 0.0)
}

impl Size {
    /// The meaning of a line such as `-Y 512 +X 1024`; blanks may be missing.
    fn parse(line: &str) -> Option<Self> {
        let (first, rest) = axis(line)?;
        let (second, rest) = axis(rest)?;
        if !rest.trim().is_empty() || first.is_x == second.is_x {
            return None;
        }
        Some(Self {
            lines: first.count,
            length: second.count,
            is_transposed: first.is_x,
            lines_are_reversed: first.is_reversed(),
            pixels_are_reversed: second.is_reversed(),
        })
    }

    /// Width and height of the picture.
    fn picture(self) -> (u32, u32) {
        if self.is_transposed { (self.lines, self.length) } else { (self.length, self.lines) }
    }

    /// Where in the picture the pixel `i` of a scanline is, counted from its upper left corner.
    fn place(self, line: u32, i: u32) -> (u32, u32) {
        let line = if self.lines_are_reversed { self.lines - 1 - line } else { line };
        let i = if self.pixels_are_reversed { self.length - 1 - i } else { i };
        if self.is_transposed { (line, i) } else { (i, line) }
    }
}

/// One axis of a size.
struct Axis {
    is_x: bool,
    grows: bool,
    count: u32,
}

impl Axis {
    /// Whether it runs to the left or up; in the file, Y grows upwards.
    fn is_reversed(&self) -> bool {
        self.is_x != self.grows
    }
}

fn axis(text: &str) -> Option<(Axis, &str)> {
    let text = text.trim_start();
    let grows = text.starts_with('+');
    let text = text.strip_prefix(['+', '-'])?;
    let is_x = text.starts_with('X');
    let text = text.strip_prefix(['X', 'Y'])?.trim_start();
    let digits = text.find(|character: char| !character.is_ascii_digit()).unwrap_or(text.len());
    // What does not fit is larger than any limit.
    let count = if digits == 0 { return None } else { text[..digits].parse().unwrap_or(u32::MAX) };
    Some((Axis { is_x, grows, count }, &text[digits..]))
}

/// What is wrong in a scanline.
enum Broken {
    Truncated,
    Length(u64),
    NothingToRepeat,
}

impl Broken {
    /// The error about the scanline of this index.
    fn at(&self, line: u32, size: Size) -> RadianceError {
        let (line, of) = (line + 1, size.lines);
        match *self {
            Self::Truncated => RadianceError::Truncated { line, of },
            Self::Length(found) => RadianceError::Length { line, of, found, expected: size.length },
            Self::NothingToRepeat => RadianceError::NothingToRepeat { line, of },
        }
    }
}

/// Reads a scanline and gives what comes after it; `last` is the pixel before it.
fn read_scanline<'b>(bytes: &'b [u8], scanline: &mut [Pixel], last: Option<Pixel>) -> Result<&'b [u8], Broken> {
    match bytes {
        [2, 2, high @ 0..128, low, rest @ ..] if RUN_LENGTH_CODED.contains(&(scanline.len() as u32)) => {
            let found = u16::from_be_bytes([*high, *low]);
            if usize::from(found) != scanline.len() {
                return Err(Broken::Length(found.into()));
            }
            (0..4).try_fold(rest, |rest, component| read_component(rest, scanline, component))
        }
        _ => read_pixels(bytes, scanline, last),
    }
}

/// Reads one component of all pixels of a scanline.
fn read_component<'b>(mut bytes: &'b [u8], scanline: &mut [Pixel], component: usize) -> Result<&'b [u8], Broken> {
    let mut at = 0;
    while at < scanline.len() {
        let (&code, rest) = bytes.split_first().ok_or(Broken::Truncated)?;
        let is_run = code > 128;
        let count = usize::from(if is_run { code & 127 } else { code });
        let values = if is_run { 1 } else { count };
        let (values, rest) = rest.split_at_checked(values).ok_or(Broken::Truncated)?;
        let end = at + count;
        let pixels = scanline.get_mut(at..end).ok_or(Broken::Length(end as u64))?;
        for (pixel, value) in pixels.iter_mut().zip(values.iter().cycle()) {
            pixel[component] = *value;
        }
        (bytes, at) = (rest, end);
    }
    Ok(bytes)
}

/// Reads a scanline of whole pixels, among which some stand for repetitions of the one before.
fn read_pixels<'b>(mut bytes: &'b [u8], scanline: &mut [Pixel], mut last: Option<Pixel>) -> Result<&'b [u8], Broken> {
    let (mut at, mut shift) = (0, 0);
    while at < scanline.len() {
        let (&pixel, rest) = bytes.split_first_chunk().ok_or(Broken::Truncated)?;
        bytes = rest;
        let [1, 1, 1, count] = pixel else {
            scanline[at] = pixel;
            (at, shift, last) = (at + 1, 0, Some(pixel));
            continue;
        };
        // Of several in a row, each counts 256 times as much as the one before.
        let count = if shift < 32 { u64::from(count) << shift } else { u64::MAX };
        let end = (at as u64).saturating_add(count);
        let places = usize::try_from(end).ok().and_then(|end| scanline.get_mut(at..end));
        places.ok_or(Broken::Length(end))?.fill(last.ok_or(Broken::NothingToRepeat)?);
        (at, shift) = (end as usize, shift + 8);
    }
    Ok(bytes)
}
