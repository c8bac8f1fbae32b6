//! `KHR_lights_punctual`: lights at their nodes, in candela and lux.

use super::document::{Document, get};
use super::fault::{Fault, Read, Report};
use super::nodes::Nodes;
use crate::scene::Light;
use crate::scene::light::{Falloff, LightKind};
use glam::{DVec3, Vec3};
use gltf::json::extensions::scene::khr_lights_punctual::{Light as Punctual, Type};
use gltf::json::validation::Checked;
use std::f32::consts::FRAC_PI_2;

/// The lights of the scene, in the order of its nodes. Their `range` is left out: the square of the distance is enough.
pub fn lights(document: &Document, nodes: &Nodes, report: &mut Report) -> Read<Vec<Light<DVec3>>> {
    let extension = document.root.extensions.khr_lights_punctual.as_ref();
    let all: &[Punctual] = extension.map_or(&[], |extension| &extension.lights);
    let mut lights = Vec::new();
    for &node in &nodes.order {
        let own = &document.root.nodes[node];
        let named = own.extensions.as_ref().and_then(|all| all.khr_lights_punctual.as_ref());
        let (Some(named), Some(world)) = (named, &nodes.worlds[node]) else { continue };
        let by = format_args!("/nodes/{node}/extensions/KHR_lights_punctual/light");
        let light = get(all, named.light, "light", by)?;
        let pointer = format!("/extensions/KHR_lights_punctual/lights/{}", named.light.value());
        let position = world.translation;
        let direction = (-world.matrix3.z_axis).normalize_or_zero().as_vec3();
        if !position.as_vec3().is_finite() || (direction == Vec3::ZERO && light.type_ != Checked::Valid(Type::Point)) {
            report.warn(format!("/nodes/{node}"), "the node of a light flattens it; the light is left out");
            continue;
        }
        let color = Vec3::from_array(light.color) * light.intensity;
        if !color.is_finite() || color.min_element() < 0.0 {
            return Err(Fault::new(pointer, "color times intensity must be finite and not negative"));
        }
        let kind = match light.type_ {
            Checked::Valid(Type::Point) => LightKind::Point { position },
            Checked::Valid(Type::Directional) => LightKind::Directional { direction },
            Checked::Valid(Type::Spot) => {
                let [cos_inner, cos_outer] = spot(light, &pointer)?;
                LightKind::Spot { position, direction, cos_inner, cos_outer }
            }
            Checked::Invalid => {
                let message = "unknown type of light; expected directional, point or spot";
                return Err(Fault::new(format!("{pointer}/type"), message));
            }
        };
        let name = light.name.clone().or_else(|| own.name.clone());
        lights.push(Light { name, kind, color, falloff: Falloff::InverseSquare });
    }
    Ok(lights)
}

/// Cosines of a spot's two half-angles.
fn spot(light: &Punctual, pointer: &str) -> Read<[f32; 2]> {
    let fault = |message: &str| Fault::new(format!("{pointer}/spot"), message);
    let spot = light.spot.as_ref().ok_or_else(|| fault("a light of type spot needs the entry spot"))?;
    let (inner, outer) = (spot.inner_cone_angle, spot.outer_cone_angle);
    if !(0.0 <= inner && inner <= outer && outer <= FRAC_PI_2 + 1e-3) {
        return Err(fault("expected 0 <= innerConeAngle <= outerConeAngle <= pi/2"));
    }
    Ok([inner, outer].map(|angle| libm::cos(f64::from(angle.min(FRAC_PI_2))) as f32))
}
