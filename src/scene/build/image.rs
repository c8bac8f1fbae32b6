//! Images: decoded once each, side by side, within a budget for all of them together.

use super::dds::{Dds, DdsError};
use super::refused::Refused;
use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::{Outcome, Problem, Warnings};
use crate::scene::desc::{ImageDesc, ImageSource, NameRef};
use crate::scene::files::{CANCELLED, FileError, Files};
use crate::scene::guard;
use crate::scene::limits::Limits;
use crate::scene::material::Encoding;
use crate::scene::texels::Texels;
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::io::Cursor;
use std::ops::Deref;
use std::path::PathBuf;
use std::sync::Arc;

/// Why an image could not be decoded.
#[derive(Debug, thiserror::Error)]
enum DecodeError {
    #[error("{0}")]
    Image(#[from] ImageError),
    #[error("{0}")]
    Dds(#[from] DdsError),
    #[error("it has too many pixels")]
    Size,
    #[error("{0}")]
    Refused(#[from] Refused),
}

/// What an image is known by: images of one source and encoding share their texels.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Key {
    File(PathBuf, Encoding),
    /// Colours and opacity.
    Masked(PathBuf, PathBuf, Encoding),
    /// Opacity alone.
    Opacity(PathBuf, Encoding),
    /// By the address of the bytes, which stay where they are until the scene is built.
    Embedded(usize, Encoding),
}

/// The bytes of an image as they are stored.
enum Encoded {
    File(Cow<'static, [u8]>),
    Embedded(Arc<[u8]>),
}

impl Deref for Encoded {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::File(bytes) => bytes,
            Self::Embedded(bytes) => bytes,
        }
    }
}

/// An image that waits to be decoded.
struct Waiting {
    key: Key,
    bytes: Encoded,
    /// The image that holds its opacity.
    opacity: Option<Cow<'static, [u8]>>,
    /// It is nothing but opacity, of white.
    is_bare: bool,
    encoding: Encoding,
}

/// An image that a scene asks for.
#[derive(Clone, Copy)]
pub struct Wanted<'a> {
    /// Where it is.
    pub image: &'a ImageDesc,
    /// What its numbers are.
    pub encoding: Encoding,
    /// Whether it is the colour of a surface, for which something else is shown where it is missing.
    pub is_base: bool,
}

/// The images that wait to be decoded.
#[derive(Default)]
struct Queue {
    images: Vec<Waiting>,
    keys: HashSet<Key>,
}

/// The images of a scene by where they come from, and how many bytes more they may take.
pub struct ImageStore {
    files: Files,
    decoded: HashMap<Key, Result<Arc<Texels>, String>>,
    /// Keeps the addresses in `decoded` from being used again.
    embedded: Vec<Arc<[u8]>>,
    bytes_left: u64,
    limits: Limits,
}

impl ImageStore {
    /// No images yet; they will be read from `files`.
    pub fn new(files: Files, limits: &Limits) -> Self {
        let (decoded, embedded) = (HashMap::new(), Vec::new());
        Self { files, decoded, embedded, bytes_left: limits.texture_bytes, limits: limits.clone() }
    }

    /// The files that the scene may read.
    pub fn files(&mut self) -> &mut Files {
        &mut self.files
    }

    /// How many bytes more images may take.
    pub fn bytes_left(&self) -> u64 {
        self.bytes_left
    }

    /// Counts an image of so many bytes that is kept elsewhere.
    pub fn take(&mut self, bytes: u64) {
        self.bytes_left = self.bytes_left.saturating_sub(bytes);
    }

    /// The texels of images, in the same order; `None` for one that is missing and may be, which is warned of.
    ///
    /// # Errors
    /// An image that cannot be read or decoded and may not be missing.
    pub fn load(&mut self, images: &[Wanted], warnings: &mut Warnings) -> Outcome<Vec<Option<Arc<Texels>>>> {
        let mut waiting = Queue::default();
        let mut keys = Vec::with_capacity(images.len());
        for Wanted { image, encoding, .. } in images {
            keys.push(self.read(image, *encoding, &mut waiting));
        }
        self.decode(waiting.images);
        // A colour whose opacity cannot be had is shown without.
        let mut whole = Queue::default();
        for (Wanted { image, encoding, .. }, key) in images.iter().zip(&mut keys) {
            if let ImageSource::Masked { name, opacity } = &image.source
                && image.optional
                && let Err(error) = self.found(key)
            {
                let plain = ImageDesc { source: ImageSource::File(name.clone()), ..(*image).clone() };
                if let Ok(plain) = self.read(&plain, *encoding, &mut whole) {
                    let shown = shortened(&opacity.name);
                    let message = format!("cannot read opacities of image \"{shown}\": {error}; they are left out");
                    warnings.push(opacity.at, message);
                    *key = Ok(plain);
                }
            }
        }
        self.decode(whole.images);
        images.iter().zip(keys).map(|(wanted, key)| self.finished(wanted, &key, warnings)).collect()
    }

    /// Reads an image that is not known yet, for it to be decoded.
    fn read(&mut self, image: &ImageDesc, encoding: Encoding, waiting: &mut Queue) -> Result<Key, FileError> {
        // People who write names by hand want to be told of wrong ones; those in models are what a program wrote.
        let locate = |files: &Files, name: &NameRef| match image.optional {
            true => files.find(&name.name),
            false => files.locate(&name.name),
        };
        let mut is_bare = false;
        let (key, bytes, opacity) = match &image.source {
            ImageSource::File(name) => {
                let path = locate(&self.files, name)?;
                let key = Key::File(path.clone(), encoding);
                if self.is_known(&key, waiting) {
                    return Ok(key);
                }
                (key, Encoded::File(self.files.read(&path)?), None)
            }
            ImageSource::Masked { name, opacity } => {
                let (path, mask) = (locate(&self.files, name)?, locate(&self.files, opacity)?);
                // An image that is its own mask has opacities of its own.
                let is_own = path == mask;
                let key = if is_own {
                    Key::File(path.clone(), encoding)
                } else {
                    Key::Masked(path.clone(), mask.clone(), encoding)
                };
                if self.is_known(&key, waiting) {
                    return Ok(key);
                }
                let opacity = if is_own { None } else { Some(self.files.read(&mask)?) };
                (key, Encoded::File(self.files.read(&path)?), opacity)
            }
            ImageSource::Opacity(name) => {
                let path = locate(&self.files, name)?;
                let key = Key::Opacity(path.clone(), encoding);
                if self.is_known(&key, waiting) {
                    return Ok(key);
                }
                is_bare = true;
                (key, Encoded::File(self.files.read(&path)?), None)
            }
            ImageSource::Lost(_) => return Err(FileError::Outside),
            ImageSource::Embedded { bytes, .. } => {
                let key = Key::Embedded(bytes.as_ptr() as usize, encoding);
                if self.is_known(&key, waiting) {
                    return Ok(key);
                }
                self.embedded.push(Arc::clone(bytes));
                (key, Encoded::Embedded(Arc::clone(bytes)), None)
            }
        };
        waiting.keys.insert(key.clone());
        waiting.images.push(Waiting { key: key.clone(), bytes, opacity, is_bare, encoding });
        Ok(key)
    }

    fn is_known(&self, key: &Key, waiting: &Queue) -> bool {
        self.decoded.contains_key(key) || waiting.keys.contains(key)
    }

    /// Decodes images side by side, large ones one after the other. What they may take is shared out beforehand, by what their
    /// headers say.
    fn decode(&mut self, waiting: Vec<Waiting>) {
        let progress = self.files.progress();
        progress.begin("decoding textures", waiting.len());
        let budgets: Vec<Result<Needs, DecodeError>> = waiting
            .iter()
            .map(|image| {
                let needed = |bytes: &[u8]| guarded(|| Needs::of(bytes, image.encoding, &self.limits));
                let opacity = image.opacity.as_deref().map_or(Ok(Needs::default()), needed)?;
                let needs = needed(&image.bytes)?.and(opacity);
                if needs.meanwhile > self.limits.texture_bytes {
                    return Err(Refused::Effort(self.limits.texture_bytes).into());
                }
                let left = self.bytes_left.checked_sub(needs.kept);
                self.bytes_left = left.ok_or(Refused::Budget(self.limits.texture_bytes))?;
                Ok(needs)
            })
            .collect();
        let decode = |(image, budget): (Waiting, Result<Needs, DecodeError>)| {
            let allowed = if progress.is_cancelled() { Err(Refused::Cancelled.into()) } else { budget };
            let texels = allowed.and_then(|needs| guarded(|| decode(&image, needs.meanwhile)));
            progress.advance();
            (image.key, texels.map(Arc::new).map_err(|error| one_line(&error.to_string())))
        };
        let is_large = |needs: &Result<Needs, DecodeError>| needs.as_ref().is_ok_and(|needs| needs.meanwhile > LARGE);
        let (large, small): (Vec<_>, Vec<_>) = waiting.into_iter().zip(budgets).partition(|(_, needs)| is_large(needs));
        let decoded: Vec<_> = small.into_par_iter().map(decode).collect();
        self.decoded.extend(decoded);
        self.decoded.extend(large.into_iter().map(decode));
    }

    /// The texels of an image that was decoded, or why there are none.
    fn found(&self, key: &Result<Key, FileError>) -> Result<&Arc<Texels>, String> {
        match key {
            Err(error) => Err(error.to_string()),
            Ok(key) => match self.decoded.get(key) {
                Some(decoded) => decoded.as_ref().map_err(Clone::clone),
                None => Err(CANCELLED.to_owned()),
            },
        }
    }

    /// The texels of an image that was decoded.
    fn finished(
        &self,
        Wanted { image, is_base, .. }: &Wanted,
        key: &Result<Key, FileError>,
        warnings: &mut Warnings,
    ) -> Outcome<Option<Arc<Texels>>> {
        let error = match self.found(key) {
            Ok(texels) => return Ok(Some(Arc::clone(texels))),
            Err(error) => error,
        };
        let (ImageSource::File(name)
        | ImageSource::Masked { name, .. }
        | ImageSource::Opacity(name)
        | ImageSource::Embedded { name, .. }) = &image.source
        else {
            return Ok(None);
        };
        let shown = shortened(&name.name);
        let (problem, kind) = match key {
            Err(_) => (format!("cannot read image \"{shown}\": {error}"), "missing"),
            Ok(_) => (format!("cannot decode image \"{shown}\" ({KNOWN}): {error}"), "cannot be decoded"),
        };
        if !image.optional {
            return Err(Problem::new(name.at, problem));
        }
        let (textures, done) = match is_base {
            true => ("textures", "a placeholder is shown"),
            false => ("maps other than colours", "it is left out"),
        };
        warnings.push_kind(name.at, &format!("{textures} {kind}"), shown, format!("{problem}; {done}"));
        Ok(None)
    }
}

/// The kinds of image that can be decoded, for messages.
const KNOWN: &str = "PNG, JPEG, BMP, WebP, TGA, TIFF, GIF and DDS are known";

/// The decoders are meant never to panic on damaged files; should one do so, only its image is lost.
fn guarded<T>(decode: impl FnOnce() -> Result<T, DecodeError>) -> Result<T, DecodeError> {
    guard::guarded(decode).unwrap_or(Err(Refused::Panicked.into()))
}

/// A decoder that has read an image's header.
fn open(bytes: &[u8]) -> Result<impl ImageDecoder, DecodeError> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(ImageError::IoError)?;
    if reader.format().is_none() && may_be_tga(bytes) {
        reader.set_format(ImageFormat::Tga);
    }
    Ok(reader.into_decoder()?)
}

/// Whether a file may be a TGA: it has no mark, but few values fit its header's second and third byte.
fn may_be_tga(bytes: &[u8]) -> bool {
    matches!(bytes, [_, 0 | 1, 1..=3 | 9..=11, ..])
}

/// Images that take more bytes than this while they are decoded are decoded alone.
const LARGE: u64 = 128 << 20;

/// How many bytes an image takes, by its header.
#[derive(Clone, Copy, Debug, Default)]
struct Needs {
    /// As long as the scene is there.
    kept: u64,
    /// At most, while it is decoded.
    meanwhile: u64,
}

impl Needs {
    fn of(bytes: &[u8], encoding: Encoding, limits: &Limits) -> Result<Self, DecodeError> {
        let (width, height, total, is_wide) = if Dds::is(bytes) {
            let Dds { width, height, .. } = Dds::open(bytes)?;
            (width, height, 4 * u64::from(width) * u64::from(height), false)
        } else {
            let decoder = open(bytes)?;
            let (width, height) = decoder.dimensions();
            let channels = u16::from(decoder.color_type().channel_count());
            let is_wide = encoding == Encoding::Data && decoder.color_type().bits_per_pixel() > 8 * channels;
            (width, height, decoder.total_bytes(), is_wide)
        };
        if u64::from(width.max(height)) > limits.texture_edge {
            return Err(Refused::Edge(limits.texture_edge).into());
        }
        if width == 0 || height == 0 {
            return Err(Refused::Empty.into());
        }
        let pixels = u64::from(width) * u64::from(height);
        // Four or eight bytes a texel, and a third more for the smaller sizes.
        let texel = if is_wide { 8 } else { 4 };
        let kept = pixels.saturating_mul(4 * texel) / 3;
        let as_texels = pixels.saturating_mul(texel);
        // The coefficients of a progressive JPEG: two bytes for each channel.
        let coefficients = if bytes.starts_with(&[0xFF, 0xD8]) { pixels.saturating_mul(6) } else { 0 };
        let stages = [coefficients, as_texels].map(|beside| total.saturating_add(beside));
        let meanwhile = stages.into_iter().fold(as_texels.saturating_add(kept), u64::max);
        Ok(Self { kept, meanwhile })
    }

    /// With another image that is decoded for this one, and not kept.
    fn and(self, other: Self) -> Self {
        Self { kept: self.kept, meanwhile: self.meanwhile.saturating_add(other.meanwhile) }
    }
}

/// What a decoder says may be of several lines.
fn one_line(message: &str) -> String {
    message.split_ascii_whitespace().collect::<Vec<_>>().join(" ")
}

fn decode(image: &Waiting, budget: u64) -> Result<Texels, DecodeError> {
    let own = decoded(&image.bytes, budget)?;
    if image.encoding == Encoding::Data && is_wide(&own) {
        let pixels = own.into_rgba16();
        let (width, height) = pixels.dimensions();
        return Texels::of_words(width, height, pixels.into_raw().as_chunks().0, true).ok_or(DecodeError::Size);
    }
    let channel = opacity_channel(&own);
    let mut pixels = own.into_rgba8();
    if image.is_bare {
        pixels.pixels_mut().for_each(|pixel| pixel.0 = [u8::MAX, u8::MAX, u8::MAX, pixel.0[channel]]);
    }
    if let Some(opacity) = &image.opacity {
        let opacity = decoded(opacity, budget)?;
        let channel = opacity_channel(&opacity);
        let opacity = opacity.into_rgba8();
        let [across, up] = [(opacity.width(), pixels.width()), (opacity.height(), pixels.height())]
            .map(|(from, to)| move |i: u32| (u64::from(i) * u64::from(from) / u64::from(to)) as u32);
        for (x, y, pixel) in pixels.enumerate_pixels_mut() {
            pixel.0[3] = opacity.get_pixel(across(x), up(y)).0[channel];
        }
    }
    let (width, height) = pixels.dimensions();
    Texels::new(width, height, pixels.into_raw().as_chunks().0, image.encoding, true).ok_or(DecodeError::Size)
}

/// Which channel of an image, with four of them, says how opaque it is.
fn opacity_channel(image: &DynamicImage) -> usize {
    if image.color().has_alpha() { 3 } else { 0 }
}

/// Whether an image has more than 8 bits a channel: data keep 16 of them, colours are reduced to 8.
fn is_wide(image: &DynamicImage) -> bool {
    let color = image.color();
    color.bytes_per_pixel() > color.channel_count()
}

/// An image of whatever kind.
fn decoded(bytes: &[u8], budget: u64) -> Result<DynamicImage, DecodeError> {
    if Dds::is(bytes) {
        return Ok(Dds::open(bytes)?.decode()?);
    }
    let mut decoder = open(bytes)?;
    let mut limits = image::Limits::no_limits();
    limits.max_alloc = Some(budget);
    decoder.set_limits(limits)?;
    Ok(DynamicImage::from_decoder(decoder)?)
}
