//! `"studio"`, `{ "zenith": [0.3, 0.5, 0.9], "horizon": 1, "ground": 0.2, "intensity": 1 }` or
//! `{ "image": "sky.hdr", "rotation": 90, "intensity": 1, "backdrop": true }`

use super::map::{Map, shortened};
use super::node::{Kind, Node};
use super::problem::{Outcome, Problem};
use super::value::{boolean, color, not_negative, number, text};
use super::{Context, NameRef};
use crate::scene::environment::Gradient;

/// An environment as the file gives it.
#[derive(Clone, Debug)]
pub struct EnvironmentDesc {
    /// What it looks like.
    pub sky: SkyDesc,
    /// Degrees by which it is turned to the left.
    pub rotation: f32,
    /// Multiplies its radiance.
    pub intensity: f32,
    /// Whether it is seen behind the scene.
    pub backdrop: bool,
}

/// What an environment looks like.
#[derive(Clone, Debug)]
pub enum SkyDesc {
    /// Three colours.
    Gradient(Gradient),
    /// The built-in studio.
    Studio,
    /// An image file, relative to the scene's folder.
    Image(NameRef),
}

/// Reads an environment.
pub fn read<'t>(node: impl Node<'t>, context: &mut Context) -> Outcome<EnvironmentDesc> {
    if node.kind() == Kind::Text {
        let name = node.text()?;
        if name != "studio" {
            let known = "expected \"studio\", or an object with an image or a horizon";
            let message = format!("unknown environment \"{}\"; {known}", shortened(&name));
            return Err(Problem::new(node.at(), message));
        }
        return Ok(EnvironmentDesc { sky: SkyDesc::Studio, rotation: 0.0, intensity: 1.0, backdrop: true });
    }
    let mut map = Map::open(node)?;
    let image = map.optional("image", |node| Ok(NameRef { name: text(node)?, at: node.at() }))?;
    let zenith = map.optional("zenith", color)?;
    let horizon = map.optional("horizon", color)?;
    let ground = map.optional("ground", color)?;
    let sky = match (image, horizon) {
        (Some(image), None) if zenith.is_none() && ground.is_none() => SkyDesc::Image(image),
        (Some(_), _) => {
            return Err(Problem::new(map.at(), "an environment has either an image or the colours of a gradient"));
        }
        (None, Some(horizon)) => SkyDesc::Gradient(Gradient {
            zenith: zenith.unwrap_or(horizon),
            horizon,
            ground: ground.unwrap_or(horizon),
        }),
        (None, None) => {
            return Err(Problem::new(map.at(), "an environment needs an image or, for a gradient, a horizon"));
        }
    };
    // A gradient looks the same however it is turned.
    let rotation = match sky {
        SkyDesc::Image(_) => map.or("rotation", 0.0, number)? as f32,
        _ => 0.0,
    };
    let intensity = map.or("intensity", 1.0, not_negative)?;
    let backdrop = map.or("backdrop", true, boolean)?;
    map.finish(&mut context.warnings);
    Ok(EnvironmentDesc { sky, rotation, intensity, backdrop })
}
