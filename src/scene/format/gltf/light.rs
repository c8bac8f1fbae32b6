//! `KHR_lights_punctual`: lights at their nodes, in candela and lux.

use super::document::{Document, get};
use super::fault::{Read, Report};
use super::nodes::Nodes;
use crate::scene::Light;
use crate::scene::light::{Falloff, LightKind};
use glam::{DVec3, Vec3};
use gltf::json::extensions::scene::khr_lights_punctual::{Light as Punctual, Type};
use gltf::json::validation::Checked;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

/// Above this, sums of a few lights would not be finite.
const BRIGHTEST: f32 = 1e30;
/// Half-angles of a spot that says nothing of them.
const USUAL: [f32; 2] = [0.0, FRAC_PI_4];

/// The lights of the scene, in the order of its nodes. Their `range` is left out: the square of the distance is enough.
pub fn lights(document: &Document, nodes: &Nodes, report: &mut Report) -> Read<Vec<Light<DVec3>>> {
    let mut lights = Vec::new();
    for &node in &nodes.order {
        let Some(own) = &document.root.nodes[node] else { continue };
        let named = own.extensions.as_ref().and_then(|all| all.khr_lights_punctual.as_ref());
        let (Some(named), Some(world)) = (named, &nodes.worlds[node]) else { continue };
        let by = format_args!("/nodes/{node}/extensions/KHR_lights_punctual/light");
        let light = get(&document.root.lights, named.light, "light", by);
        let Some(light) = report.attempt(light, "lights left out")? else { continue };
        let pointer = format!("/extensions/KHR_lights_punctual/lights/{}", named.light.value());
        let position = world.translation;
        let direction = (-world.matrix3.z_axis).normalize_or_zero().as_vec3();
        if !position.as_vec3().is_finite() || (direction == Vec3::ZERO && light.type_ != Checked::Valid(Type::Point)) {
            report.warn(format!("/nodes/{node}"), "the node of a light flattens it; the light is left out");
            continue;
        }
        let asked = Vec3::from_array(light.color) * light.intensity;
        let color = asked.clamp(Vec3::ZERO, Vec3::splat(BRIGHTEST));
        if color != asked {
            report.warn(&*pointer, "color times intensity is below 0 or above 1e30; clamped");
        }
        let kind = match light.type_ {
            Checked::Valid(Type::Point) => LightKind::Point { position },
            Checked::Valid(Type::Directional) => LightKind::Directional { direction },
            Checked::Valid(Type::Spot) => {
                let [cos_inner, cos_outer] = spot(light, &pointer, report);
                LightKind::Spot { position, direction, cos_inner, cos_outer }
            }
            Checked::Invalid => {
                let message = "unknown type of light; expected directional, point or spot; the light is left out";
                report.warn(format!("{pointer}/type"), message);
                continue;
            }
        };
        let name = light.name.clone().or_else(|| own.name.clone());
        lights.push(Light { name, kind, color, falloff: Falloff::InverseSquare });
    }
    Ok(lights)
}

/// Cosines of a spot's two half-angles.
fn spot(light: &Punctual, pointer: &str, report: &mut Report) -> [f32; 2] {
    let [inner, outer] = light.spot.as_ref().map_or(USUAL, |spot| [spot.inner_cone_angle, spot.outer_cone_angle]);
    let widest = outer.clamp(0.0, FRAC_PI_2);
    let angles = [inner.clamp(0.0, widest), widest];
    if light.spot.is_none() {
        report.warn(pointer, "a light of type spot without the entry spot; the usual angles are taken");
    } else if angles[0] != inner || !(0.0..=FRAC_PI_2 + 1e-3).contains(&outer) {
        let message = "expected 0 <= innerConeAngle <= outerConeAngle <= pi/2; clamped";
        report.warn(format!("{pointer}/spot"), message);
    }
    angles.map(|angle| libm::cos(f64::from(angle)) as f32)
}
