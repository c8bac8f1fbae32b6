//! Images: decoded once each, side by side, within a budget for all of them together.

use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::{Outcome, Problem, Warnings};
use crate::scene::desc::{ImageDesc, ImageSource, NameRef};
use crate::scene::files::{CANCELLED, FileError, Files};
use crate::scene::guard;
use crate::scene::limits::{Limits, exceeded};
use crate::scene::material::Encoding;
use crate::scene::texels::Texels;
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader};
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
    #[error("width or height is {}", exceeded("texture-edge", *.0))]
    Edge(u64),
    #[error("the scene's textures have {}", exceeded("texture-bytes", *.0))]
    Budget(u64),
    #[error("bytes that it takes to decode it: {}", exceeded("texture-bytes", *.0))]
    Effort(u64),
    #[error("{CANCELLED}")]
    Cancelled,
    #[error("the decoder gave up; the file is damaged")]
    Panicked,
    #[error("it has no pixels")]
    Empty,
    #[error("it has too many pixels")]
    Size,
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

    /// The texels of images, in the same order.
    ///
    /// # Errors
    /// An image that cannot be read or decoded and may not be missing; one that may be is a warning, and a placeholder.
    pub fn load(&mut self, images: &[(ImageDesc, Encoding)], warnings: &mut Warnings) -> Outcome<Vec<Arc<Texels>>> {
        let mut waiting = Queue::default();
        let mut keys = Vec::with_capacity(images.len());
        for (image, encoding) in images {
            keys.push(self.read(image, *encoding, &mut waiting));
        }
        self.decode(waiting.images);
        images.iter().zip(keys).map(|((image, _), key)| self.finished(image, key, warnings)).collect()
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
                let key = Key::Masked(path.clone(), mask.clone(), encoding);
                if self.is_known(&key, waiting) {
                    return Ok(key);
                }
                (key, Encoded::File(self.files.read(&path)?), Some(self.files.read(&mask)?))
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
                let needed = |bytes: &[u8]| guarded(|| Needs::of(bytes, &self.limits));
                let opacity = image.opacity.as_deref().map_or(Ok(Needs::default()), needed)?;
                let needs = needed(&image.bytes)?.and(opacity);
                if needs.meanwhile > self.limits.texture_bytes {
                    return Err(DecodeError::Effort(self.limits.texture_bytes));
                }
                let left = self.bytes_left.checked_sub(needs.kept);
                self.bytes_left = left.ok_or(DecodeError::Budget(self.limits.texture_bytes))?;
                Ok(needs)
            })
            .collect();
        let decode = |(image, budget): (Waiting, Result<Needs, DecodeError>)| {
            let allowed = if progress.is_cancelled() { Err(DecodeError::Cancelled) } else { budget };
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

    /// The texels of an image that was decoded.
    fn finished(
        &self,
        image: &ImageDesc,
        key: Result<Key, FileError>,
        warnings: &mut Warnings,
    ) -> Outcome<Arc<Texels>> {
        let (ImageSource::File(name)
        | ImageSource::Masked { name, .. }
        | ImageSource::Opacity(name)
        | ImageSource::Embedded { name, .. }) = &image.source;
        let shown = shortened(&name.name);
        let (problem, kind) = match key {
            Err(error) => (format!("cannot read image \"{shown}\": {error}"), "textures missing"),
            Ok(key) => match &self.decoded[&key] {
                Ok(texels) => return Ok(Arc::clone(texels)),
                Err(error) => (
                    format!("cannot decode image \"{shown}\" (PNG, JPEG, BMP and WebP are known): {error}"),
                    "textures that cannot be decoded",
                ),
            },
        };
        if !image.optional {
            return Err(Problem::new(name.at, problem));
        }
        let first = format!("{shown}; placeholders are shown");
        warnings.push_kind(name.at, kind, first, format!("{problem}; a placeholder is shown"));
        Texels::placeholder().map(Arc::new).ok_or_else(|| Problem::new(name.at, "no placeholder"))
    }
}

/// The decoders are meant never to panic on damaged files; should one do so, only its image is lost.
fn guarded<T>(decode: impl FnOnce() -> Result<T, DecodeError>) -> Result<T, DecodeError> {
    guard::guarded(decode).unwrap_or(Err(DecodeError::Panicked))
}

/// A decoder that has read an image's header.
fn open(bytes: &[u8]) -> Result<impl ImageDecoder, DecodeError> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(ImageError::IoError)?;
    Ok(reader.into_decoder()?)
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
    fn of(bytes: &[u8], limits: &Limits) -> Result<Self, DecodeError> {
        let decoder = open(bytes)?;
        let (width, height) = decoder.dimensions();
        if u64::from(width.max(height)) > limits.texture_edge {
            return Err(DecodeError::Edge(limits.texture_edge));
        }
        if width == 0 || height == 0 {
            return Err(DecodeError::Empty);
        }
        let pixels = u64::from(width) * u64::from(height);
        // Four bytes a texel, and a third more for the smaller sizes.
        let kept = pixels.saturating_mul(16) / 3;
        let as_bytes = pixels.saturating_mul(4);
        // The coefficients of a progressive JPEG: two bytes for each channel.
        let coefficients = if bytes.starts_with(&[0xFF, 0xD8]) { pixels.saturating_mul(6) } else { 0 };
        let stages = [coefficients, as_bytes].map(|beside| decoder.total_bytes().saturating_add(beside));
        let meanwhile = stages.into_iter().fold(as_bytes.saturating_add(kept), u64::max);
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

/// An image of whatever kind; 16-bit channels are reduced to 8 later.
fn decoded(bytes: &[u8], budget: u64) -> Result<DynamicImage, DecodeError> {
    let mut decoder = open(bytes)?;
    let mut limits = image::Limits::no_limits();
    limits.max_alloc = Some(budget);
    decoder.set_limits(limits)?;
    Ok(DynamicImage::from_decoder(decoder)?)
}
