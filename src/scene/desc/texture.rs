//! `{ "image": "bricks.png", "size": 2 }` or `{ "checker": [[0.9, 0.9, 0.9], [0.15, 0.15, 0.15]], "size": 1 }`

use super::map::Map;
use super::node::Node;
use super::problem::{At, Outcome, Problem};
use super::value::{array, color, positive, text};
use super::{Context, NameRef};
use crate::scene::texture::Sampler;
use glam::Vec3;
use std::sync::Arc;

/// A texture as the file gives it.
#[derive(Clone, Debug)]
pub struct TextureDesc {
    /// Its name, and where the entry stands.
    pub name: NameRef,
    /// What it shows.
    pub kind: TextureKind,
    /// Size of one repetition (of one square of a checker) in units of u and v.
    pub size: f32,
}

/// What a texture shows.
#[derive(Clone, Debug)]
pub enum TextureKind {
    /// An image.
    Image(ImageDesc),
    /// Squares of two linear colours.
    Checker([Vec3; 2]),
}

/// An image as the file gives it.
#[derive(Clone, Debug)]
pub struct ImageDesc {
    /// Where its bytes are.
    pub source: ImageSource,
    /// How it is looked up.
    pub sampler: Sampler,
    /// A file that is missing or damaged is a warning rather than an error: a placeholder is shown for a colour, any other map
    /// is left out.
    pub optional: bool,
}

/// Where the bytes of an image are.
#[derive(Clone, Debug)]
pub enum ImageSource {
    /// In a file, relative to the scene's folder.
    File(NameRef),
    /// In a file, but for the opacity, which another file holds: in its alpha channel, else in its brightness. If it is the
    /// same file, the opacity is its own.
    Masked {
        /// The file of the colours.
        name: NameRef,
        /// The file of the opacity, relative to the scene's folder, too.
        opacity: NameRef,
    },
    /// In a file that holds opacity alone, likewise, of white.
    Opacity(NameRef),
    /// Nowhere to be had, as was told.
    Lost(NameRef),
    /// Within the scene's own file.
    Embedded {
        /// Encoded as in an image file.
        bytes: Arc<[u8]>,
        /// What messages call it.
        name: NameRef,
    },
}

/// Reads a texture.
pub fn read<'t>(node: impl Node<'t>, name: String, at: At, context: &mut Context) -> Outcome<TextureDesc> {
    let mut map = Map::open(node)?;
    let image = map.optional("image", |node| Ok(NameRef { name: text(node)?, at: node.at() }))?;
    let checker = map.optional("checker", |node| array(node, color))?;
    let size = map.or("size", 1.0, positive)? as f32;
    let kind = match (image, checker) {
        (Some(file), None) => {
            let (source, sampler) = (ImageSource::File(file), Sampler::default());
            TextureKind::Image(ImageDesc { source, sampler, optional: false })
        }
        (None, Some(colors)) => TextureKind::Checker(colors),
        _ => return Err(Problem::new(map.at(), "a texture needs either an image or a checker")),
    };
    map.finish(&mut context.warnings);
    Ok(TextureDesc { name: NameRef { name, at }, kind, size })
}
