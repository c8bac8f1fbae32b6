//! `"render": { "width": 1280, "height": 720, "max_depth": 5, "background": [0.25, 0.45, 0.75], "ambient": [1, 1, 1],
//! "environment": "studio" }`

use super::Context;
use super::environment::{self, EnvironmentDesc};
use super::map::Map;
use super::node::Node;
use super::problem::Outcome;
use super::value::{color, integer_in};
use crate::scene::RenderDefaults;

/// Rays on a path, at most.
const MAX_DEPTH: u32 = 64;

/// Reads what the file asks of the picture, and what surrounds the scene.
pub fn read<'t>(node: impl Node<'t>, context: &mut Context) -> Outcome<(RenderDefaults, Option<EnvironmentDesc>)> {
    let defaults = RenderDefaults::default();
    let edge = 1..=u32::try_from(context.limits.picture_edge).unwrap_or(u32::MAX);
    let mut map = Map::open(node)?;
    let ambient = map.optional("ambient", color)?;
    let render = RenderDefaults {
        width: map.optional("width", integer_in(edge.clone()))?,
        height: map.optional("height", integer_in(edge))?,
        max_depth: map.or("max_depth", defaults.max_depth, integer_in(1..=MAX_DEPTH))?,
        background: map.or("background", defaults.background, color)?,
        ambient: ambient.unwrap_or(defaults.ambient),
        ambient_is_given: ambient.is_some(),
        ..defaults
    };
    let environment = map.optional("environment", |node| environment::read(node, context))?;
    map.finish(&mut context.warnings);
    Ok((render, environment))
}
