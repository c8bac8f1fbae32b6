//! `{ "position": [0, 0.35, -4], "look_at": [0, 0, 0], "up": [0, 1, 0], "fov": 45 }`, or
//! `{ "position": [1, 1.6, 3], "yaw": 0, "pitch": -5 }`

use super::map::Map;
use super::node::Node;
use super::problem::{Outcome, Problem};
use super::value::{direction, not_negative, number, number_in, positive, vector};
use super::{CameraDesc, Context};
use crate::scene::Camera;

/// Reads a camera. Without `look_at`, `yaw` and `pitch` (0 each) say where it looks.
pub fn read<'t>(node: impl Node<'t>, name: String, context: &mut Context) -> Outcome<CameraDesc> {
    let defaults = Camera::default();
    let mut map = Map::open(node)?;
    let eye = map.required("position", vector)?;
    let look_at = map.optional("look_at", |node| Ok((node.at(), vector(node)?)))?;
    let turned = map.has("yaw") || map.has("pitch");
    let yaw = map.or("yaw", 0.0, number)? as f32;
    let pitch = map.or("pitch", 0.0, number_in(-90.0..=90.0))?;
    let up = map.optional("up", |node| Ok((node.at(), direction(node)?.as_vec3())))?;
    let fov = map.or("fov", defaults.fov, field_of_view)?;
    let near = map.or("near", defaults.near, not_negative)?;
    let far = map.optional("far", |node| Ok((node.at(), positive(node)? as f32)))?;
    let aimed = match look_at {
        Some((at, _)) if turned => {
            return Err(Problem::new(at, "both look_at and yaw or pitch; give one of them"));
        }
        Some((at, point)) if point == eye => {
            return Err(Problem::new(at, "look_at equals position; it must be another point"));
        }
        Some((_, look_at)) => Camera { eye: eye.as_vec3(), look_at: look_at.as_vec3(), ..defaults },
        None => Camera::from_yaw_pitch(eye.as_vec3(), yaw, pitch, fov),
    };
    let camera = Camera {
        up: up.map_or(aimed.up, |(_, up)| up),
        fov,
        near,
        far: far.map_or(f32::INFINITY, |(_, far)| far),
        ..aimed
    };
    if let Some((at, far)) = far.filter(|(_, far)| *far <= near) {
        return Err(Problem::new(at, format!("far {far} must be greater than near {near}")));
    }
    let ahead = camera.look_at.as_dvec3() - camera.eye.as_dvec3();
    let look_at = look_at.map_or(eye + ahead, |(_, point)| point);
    let camera = CameraDesc { at: node.at(), name, eye, look_at, camera };
    if !camera.is_valid() {
        let at = up.map_or(map.at(), |(at, _)| at);
        return Err(Problem::new(at, "up is parallel to the view; give an up that is across it"));
    }
    map.finish(&mut context.warnings);
    Ok(camera)
}

fn field_of_view<'t>(node: impl Node<'t>) -> Outcome<f32> {
    let degrees = number(node)? as f32;
    match degrees > 0.0 && degrees < 180.0 {
        true => Ok(degrees),
        false => {
            Err(Problem::new(node.at(), format!("fov {degrees} is out of range; expected degrees between 0 and 180")))
        }
    }
}
