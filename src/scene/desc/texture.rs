//! `{ "image": "bricks.png", "size": 2 }` or `{ "checker": [[0.9, 0.9, 0.9], [0.15, 0.15, 0.15]], "size": 1 }`

use super::map::Map;
use super::node::Node;
use super::problem::{At, Outcome, Problem};
use super::value::{array, color, positive, text};
use super::{Context, NameRef};
use glam::Vec3;

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
    /// An image file, relative to the scene's folder.
    Image(NameRef),
    /// Squares of two linear colours.
    Checker([Vec3; 2]),
}

/// Reads a texture.
pub fn read<'t>(node: impl Node<'t>, name: String, at: At, context: &mut Context) -> Outcome<TextureDesc> {
    let mut map = Map::open(node)?;
    let image = map.optional("image", |node| Ok(NameRef { name: text(node)?, at: node.at() }))?;
    let checker = map.optional("checker", |node| array(node, color))?;
    let size = map.or("size", 1.0, positive)? as f32;
    let kind = match (image, checker) {
        (Some(image), None) => TextureKind::Image(image),
        (None, Some(colors)) => TextureKind::Checker(colors),
        _ => return Err(Problem::new(map.at(), "a texture needs either an image or a checker")),
    };
    map.finish(&mut context.warnings);
    Ok(TextureDesc { name: NameRef { name, at }, kind, size })
}
