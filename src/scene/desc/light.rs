//! `{ "type": "point", "position": [-7, 10, -10], "color": [1, 1, 1], "intensity": 1, "temperature": 6500, "falloff": "none" }`,
//! `{ "type": "directional", "direction": [0, -1, 0] }`,
//! `{ "type": "spot", "position": [0, 3, 0], "direction": [0, -1, 0], "inner_angle": 20, "outer_angle": 30 }`

use super::map::{Map, shortened};
use super::node::Node;
use super::problem::{Outcome, Problem};
use super::value::{color, direction, not_negative, number_in, text, vector};
use super::{Context, hint};
use crate::scene::Light;
use crate::scene::black_body::{self, TEMPERATURES};
use crate::scene::light::{Falloff, LightKind};
use glam::{DVec3, Vec3};

/// glTF's default half-angle where the darkness around a spot starts.
const OUTER_ANGLE: f32 = 45.0;

/// Reads a light.
pub fn read<'t, N: Node<'t>>(node: N, context: &mut Context) -> Outcome<Light<DVec3>> {
    let mut map = Map::open(node)?;
    let kind = map.required("type", Ok)?;
    let kind = match &*kind.text()? {
        "point" => LightKind::Point { position: map.required("position", vector)? },
        "directional" => LightKind::Directional { direction: map.required("direction", direction)?.as_vec3() },
        "spot" => spot(&mut map)?,
        other => {
            let hint = hint(other, ["point", "directional", "spot"]);
            return Err(Problem::new(kind.at(), format!("unknown light type \"{}\"; {hint}", shortened(other))));
        }
    };
    let color = map.or("color", Vec3::ONE, color)?;
    let intensity = map.or("intensity", 1.0, not_negative)?;
    let temperature = map.optional("temperature", number_in(TEMPERATURES))?;
    let light = Light {
        name: map.optional("name", text)?,
        kind,
        color: color * intensity * temperature.map_or(Vec3::ONE, |t| black_body::color(f64::from(t))),
        falloff: map.or("falloff", Falloff::None, falloff)?,
    };
    if !light.color.is_finite() {
        return Err(Problem::new(map.at(), "color times intensity is too large; the greatest is 3.4e38"));
    }
    map.finish(&mut context.warnings);
    Ok(light)
}

fn spot<'t, N: Node<'t>>(map: &mut Map<'t, N>) -> Outcome<LightKind<DVec3>> {
    let position = map.required("position", vector)?;
    let direction = map.required("direction", direction)?.as_vec3();
    let half_angle = number_in(0.0..=90.0);
    let inner = map.optional("inner_angle", |node| Ok((node.at(), half_angle(node)?)))?;
    let outer = map.or("outer_angle", OUTER_ANGLE, &half_angle)?;
    if let Some((at, inner)) = inner.filter(|(_, inner)| *inner > outer) {
        return Err(Problem::new(at, format!("inner_angle {inner} must not exceed outer_angle {outer}")));
    }
    let cosine = |degrees: f32| libm::cos(f64::from(degrees).to_radians()) as f32;
    let inner = inner.map_or(0.0, |(_, inner)| inner);
    Ok(LightKind::Spot { position, direction, cos_inner: cosine(inner), cos_outer: cosine(outer) })
}

fn falloff<'t>(node: impl Node<'t>) -> Outcome<Falloff> {
    match &*node.text()? {
        "none" => Ok(Falloff::None),
        "inverse_square" => Ok(Falloff::InverseSquare),
        other => {
            let hint = hint(other, ["none", "inverse_square"]);
            Err(Problem::new(node.at(), format!("unknown falloff \"{}\"; {hint}", shortened(other))))
        }
    }
}
