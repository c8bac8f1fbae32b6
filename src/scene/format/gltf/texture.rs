//! Textures, their images and samplers, and how materials look them up.

use super::document::{Document, get};
use super::fault::{Fault, Notes, Read, Report};
use super::uri::{self, Target};
use crate::scene::desc::{ImageDesc, ImageSource, NameRef, TextureDesc, TextureKind};
use crate::scene::texture::{Blending, Sampler, Wrap};
use glam::{Affine2, Mat2, Vec2};
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::texture::{MagFilter, MinFilter, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{self, Index};
use std::collections::HashMap;
use std::sync::Arc;

/// The extension by which a texture names an image in WebP.
const WEBP: &str = "EXT_texture_webp";
/// What textures are called that cannot be shown.
const LOST: &str = "textures left out";

/// The textures that materials use, described once each.
pub struct Textures<'d> {
    document: &'d Document<'d>,
    /// Those described so far.
    pub descs: Vec<TextureDesc>,
    /// The name of each texture of the file that was asked for; `None` where there is nothing to show.
    names: HashMap<usize, Option<NameRef>>,
    /// The images, as textures share them.
    images: HashMap<usize, Option<ImageSource>>,
    /// Bytes of images within buffers, by buffer view, and how many more there may be: no more than the buffers have.
    embedded: HashMap<usize, Arc<[u8]>>,
    bytes_left: usize,
    /// Whether there is a file of a name.
    has_file: &'d mut dyn FnMut(&str) -> bool,
}

/// How a material refers to a texture, whatever the property.
#[derive(Clone, Copy)]
pub struct Reference<'a> {
    /// The texture.
    pub index: Index<json::Texture>,
    /// Which texture coordinates.
    pub set: u32,
    /// What they go through first.
    pub transform: Option<&'a TextureTransform>,
}

impl<'a> Reference<'a> {
    /// The reference that most properties have.
    pub fn of(info: &'a json::texture::Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.as_ref());
        Self { index: info.index, set: info.tex_coord, transform }
    }

    /// Which texture coordinates, the transform's own choice counted.
    pub fn set(&self) -> u32 {
        self.transform.and_then(|transform| transform.tex_coord).unwrap_or(self.set)
    }

    /// What coordinates with v upwards go through first.
    pub fn upwards(&self) -> Affine2 {
        self.transform.map_or(Affine2::IDENTITY, upwards)
    }
}

impl<'d> Textures<'d> {
    /// None yet.
    pub fn new(document: &'d Document<'d>, has_file: &'d mut dyn FnMut(&str) -> bool) -> Self {
        Self {
            document,
            descs: Vec::new(),
            names: HashMap::new(),
            images: HashMap::new(),
            embedded: HashMap::new(),
            bytes_left: document.buffer_bytes(),
            has_file,
        }
    }

    /// The name of a texture; `None` where there is nothing to show, which was told. `pointer` is where the material refers
    /// to it.
    pub fn name(&mut self, index: Index<json::Texture>, pointer: &str, report: &mut Report) -> Read<Option<NameRef>> {
        let i = index.value();
        if let Some(known) = self.names.get(&i) {
            return Ok(known.clone());
        }
        let texture = get(&self.document.root.textures, index, "texture", format_args!("{pointer}/index"));
        let Some(texture) = report.attempt(texture, LOST)? else { return Ok(None) };
        let named = texture.sampler.map(|index| {
            get(&self.document.root.samplers, index, "sampler", format_args!("/textures/{i}/sampler")).map(sampler)
        });
        let sampler = report.attempt(named.transpose(), "samplers left out")?.flatten().unwrap_or_default();
        let source = self.source(texture, i, report)?;
        let name = NameRef { name: format!("texture {i}"), at: report.at(format!("/textures/{i}")) };
        let source = source.unwrap_or_else(|| ImageSource::Lost(name.clone()));
        let kind = TextureKind::Image(ImageDesc { source, sampler, optional: true });
        self.descs.push(TextureDesc { name: name.clone(), kind, size: 1.0 });
        self.names.insert(i, Some(name.clone()));
        Ok(Some(name))
    }

    /// Where the image of a texture is.
    fn source(&mut self, texture: &json::Texture, i: usize, report: &mut Report) -> Read<Option<ImageSource>> {
        let webp = || {
            let source = texture.extensions.as_ref()?.others.get(WEBP)?.get("source")?.as_u64()?;
            u32::try_from(source).ok().map(Index::new)
        };
        // The crate's mark of a texture without a source.
        let plain = (texture.source.value() != u32::MAX as usize).then_some(texture.source);
        let Some(index) = plain.or_else(webp) else {
            report.warn(format!("/textures/{i}"), "the texture has no image of a known kind; it is not shown");
            return Ok(None);
        };
        let image = get(&self.document.root.images, index, "image", format_args!("/textures/{i}/source"));
        let Some(image) = report.attempt(image, LOST)? else { return Ok(None) };
        let number = index.value();
        if let Some(known) = self.images.get(&number) {
            return Ok(known.clone());
        }
        let source = self.image(image, number, report)?;
        self.images.insert(number, source.clone());
        Ok(source)
    }

    fn image(&mut self, image: &json::Image, i: usize, report: &mut Report) -> Read<Option<ImageSource>> {
        let pointer = format!("/images/{i}");
        let is_ktx = |name: &str| name.to_ascii_lowercase().ends_with("ktx2");
        if image.mime_type.as_ref().is_some_and(|kind| is_ktx(&kind.0)) || image.uri.as_deref().is_some_and(is_ktx) {
            report.warn(pointer, "an image of type KTX2, which is not decoded; it is not shown");
            return Ok(None);
        }
        let embedded = |bytes: Arc<[u8]>, report: &mut Report| {
            let name = image.name.clone().unwrap_or_else(|| format!("image {i}"));
            ImageSource::Embedded { bytes, name: NameRef { name, at: report.at(&*pointer) } }
        };
        if let Some(view) = image.buffer_view {
            let mut notes = Notes::default();
            let bytes = self.bytes_of(view, i, &mut notes);
            report.take(notes);
            return Ok(report.attempt(bytes, LOST)?.map(|bytes| embedded(bytes, report)));
        }
        let Some(uri) = &image.uri else {
            report.warn(pointer, "the image has neither uri nor bufferView; it is not shown");
            return Ok(None);
        };
        Ok(match uri::read(uri) {
            Ok(Target::Bytes(bytes)) => Some(embedded(bytes.into(), report)),
            Ok(Target::File(mut names)) => {
                let found = names.iter().position(|name| (self.has_file)(name)).unwrap_or(0);
                Some(ImageSource::File(NameRef { name: names.swap_remove(found), at: report.at(pointer) }))
            }
            Err(message) => report.attempt(Err(Fault::new(pointer, message)), LOST)?,
        })
    }
}

impl Textures<'_> {
    /// The bytes of image `i` in a buffer view.
    fn bytes_of(&mut self, view: Index<json::buffer::View>, i: usize, notes: &mut Notes) -> Read<Arc<[u8]>> {
        if let Some(bytes) = self.embedded.get(&view.value()) {
            return Ok(Arc::clone(bytes));
        }
        let bytes = self.document.view(view, format_args!("/images/{i}/bufferView"), notes)?.bytes;
        self.bytes_left = self.bytes_left.checked_sub(bytes.len()).ok_or_else(|| {
            Fault::new(
                format!("/images/{i}/bufferView"),
                "the images overlap: together they are larger than all buffers",
            )
        })?;
        let bytes: Arc<[u8]> = bytes.into();
        self.embedded.insert(view.value(), Arc::clone(&bytes));
        Ok(bytes)
    }
}

/// What coordinates with v upwards go through: the file's transform, which is of coordinates with v downwards.
fn upwards(transform: &TextureTransform) -> Affine2 {
    let finite = |value: f32, default: f32| if value.is_finite() { value } else { default };
    let [sx, sy] = transform.scale.0.map(|scale| finite(scale, 1.0));
    let angle = f64::from(finite(transform.rotation.0, 0.0));
    let (sin, cos) = (libm::sin(angle) as f32, libm::cos(angle) as f32);
    // Counter-clockwise where v points down.
    let turned = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
    let matrix2 = turned * Mat2::from_diagonal(Vec2::new(sx, sy));
    let down = Affine2 { matrix2, translation: Vec2::from_array(transform.offset.0.map(|offset| finite(offset, 0.0))) };
    let flip = Affine2 { matrix2: Mat2::from_diagonal(Vec2::new(1.0, -1.0)), translation: Vec2::Y };
    flip * down * flip
}

fn sampler(sampler: &json::texture::Sampler) -> Sampler {
    use Blending::{Linear, Nearest};
    let wrap = |mode: &Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    };
    let magnification = match sampler.mag_filter {
        Some(Checked::Valid(MagFilter::Nearest)) => Nearest,
        _ => Linear,
    };
    let (minification, between_levels) = match sampler.min_filter {
        Some(Checked::Valid(MinFilter::Nearest)) => (Nearest, None),
        Some(Checked::Valid(MinFilter::Linear)) => (Linear, None),
        Some(Checked::Valid(MinFilter::NearestMipmapNearest)) => (Nearest, Some(Nearest)),
        Some(Checked::Valid(MinFilter::LinearMipmapNearest)) => (Linear, Some(Nearest)),
        Some(Checked::Valid(MinFilter::NearestMipmapLinear)) => (Nearest, Some(Linear)),
        _ => (Linear, Some(Linear)),
    };
    Sampler { wrap: [wrap(&sampler.wrap_s), wrap(&sampler.wrap_t)], magnification, minification, between_levels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gltf::json::extensions::texture::{TextureTransformOffset, TextureTransformRotation, TextureTransformScale};
    use std::f32::consts::FRAC_PI_2;

    #[test]
    fn a_transform_does_upwards_what_it_does_downwards() {
        let transform = TextureTransform {
            offset: TextureTransformOffset([0.25, 0.5]),
            rotation: TextureTransformRotation(FRAC_PI_2),
            scale: TextureTransformScale([2.0, 3.0]),
            ..TextureTransform::default()
        };
        let ours = upwards(&transform);
        let (u, v) = (0.3, 0.2);
        // Scaled, turned by a quarter, moved, with v downwards.
        let (down_u, down_v) = (3.0 * v + 0.25, -2.0 * u + 0.5);
        let up = ours.transform_point2(Vec2::new(u, 1.0 - v));
        assert!(up.abs_diff_eq(Vec2::new(down_u, 1.0 - down_v), 1e-6), "{up}");
        assert_eq!(upwards(&TextureTransform::default()), Affine2::IDENTITY);
    }
}
