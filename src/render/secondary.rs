//! The rays that follow from a hit: mirrored, and refracted by Snell's law with exact Fresnel terms.

use super::frame::Frame;
use super::leave;
use super::media::{Media, MediaList};
use super::queue::RayQueue;
use super::stats::RayCounts;
use crate::scene::Material;
use crate::scene::material::Model;
use glam::Vec3;

/// A ray at the surface that it hit.
#[derive(Clone, Copy, Debug)]
pub struct Incident {
    pub direction: Vec3,
    pub position: Vec3,
    /// Unit geometric normal on the side where the ray came from.
    pub facing: Vec3,
    /// How far off the surface rays start.
    pub margin: f32,
    /// Unit shading normal on that side.
    pub normal: Vec3,
    /// The ray came from outside of the object.
    pub entering: bool,
    pub object: u32,
    /// Surface colour.
    pub color: Vec3,
    pub weight: Vec3,
    pub sample: u32,
    pub media: MediaList,
}

/// What share of the light is mirrored and refracted, and where to.
struct Split {
    reflected: Vec3,
    refracted: Vec3,
    /// Direction of the refracted ray; meaningless where its share is 0.
    inward: Vec3,
}

/// Queues the mirrored ray, then the refracted one, each if it is wanted and weighs enough.
pub(super) fn follow(
    frame: &Frame<'_>,
    incident: &Incident,
    media: &mut Media,
    rays: &mut RayQueue,
    counts: &mut RayCounts,
) {
    let object = &frame.scene.objects[incident.object as usize];
    let material = &frame.scene.materials[object.material as usize];
    // With a shading normal that leans away, the ray may graze it from behind.
    let cosine = (-incident.direction.dot(incident.normal)).max(0.0);
    let split = if material.is_transparent() {
        let eta = relative_index(frame, incident, material, object.body, media);
        refract(material, incident, cosine, eta, object.body)
    } else {
        Split { reflected: mirror_share(material, incident.color, cosine), refracted: Vec3::ZERO, inward: Vec3::ZERO }
    };

    let mirrored = incident.weight * split.reflected;
    if frame.plan.reflections && is_heavy(mirrored, frame.settings.min_weight) {
        let direction = normalize(incident.direction + incident.normal * (2.0 * cosine));
        let start = leave::start_one(incident.position, incident.facing, incident.margin, direction);
        rays.push(start, direction, mirrored, incident.sample, incident.media);
        counts.reflection += 1;
    }
    let passed = incident.weight * (split.refracted * incident.color);
    if frame.plan.refractions && is_heavy(passed, frame.settings.min_weight) {
        let inside = match (frame.plan.media && object.body, incident.entering) {
            (false, _) => incident.media,
            (true, true) => media.enter(incident.media, incident.object),
            (true, false) => media.leave(incident.media, incident.object),
        };
        let start = leave::start_one(incident.position, -incident.facing, incident.margin, split.inward);
        rays.push(start, split.inward, passed, incident.sample, inside);
        counts.refraction += 1;
    }
}

/// Whether a ray is worth tracing: rays without weight never are.
fn is_heavy(weight: Vec3, min_weight: f32) -> bool {
    let largest = weight.max_element();
    largest > 0.0 && largest >= min_weight
}

/// Index of refraction on the side where the ray comes from, divided by that on the other side.
fn relative_index(frame: &Frame<'_>, incident: &Incident, material: &Material, body: bool, media: &Media) -> f32 {
    let around = media.around(incident.media, incident.object);
    let outside =
        around.map_or(1.0, |object| frame.scene.materials[frame.scene.objects[object as usize].material as usize].ior);
    if incident.entering || !body { outside / material.ior } else { material.ior / outside }
}

/// Shares and direction at a transparent surface. Thin things do not bend the ray.
fn refract(material: &Material, incident: &Incident, cosine: f32, eta: f32, bends: bool) -> Split {
    let passing = 1.0 - eta * eta * (1.0 - cosine * cosine);
    if passing < 0.0 && bends {
        let reflected = material.reflectivity + material.transparency;
        return Split { reflected, refracted: Vec3::ZERO, inward: Vec3::ZERO };
    }
    let cosine_inward = passing.max(0.0).sqrt();
    let fresnel = if material.fresnel { dielectric_fresnel(cosine, cosine_inward, eta) } else { 0.0 };
    let inward = if bends {
        normalize(incident.direction * eta + incident.normal * (eta * cosine - cosine_inward))
    } else {
        incident.direction
    };
    Split {
        reflected: material.reflectivity + material.transparency * fresnel,
        refracted: material.transparency * (1.0 - fresnel),
        inward,
    }
}

/// Exact reflectance of unpolarised light between dielectrics; `eta` is the index in front divided by that behind.
fn dielectric_fresnel(cosine_in: f32, cosine_out: f32, eta: f32) -> f32 {
    if cosine_in + cosine_out == 0.0 {
        // Along a surface with the same index on both sides: there is nothing to reflect from.
        return 0.0;
    }
    let across = (eta * cosine_in - cosine_out) / (eta * cosine_in + cosine_out);
    let along = (cosine_in - eta * cosine_out) / (cosine_in + eta * cosine_out);
    (across * across + along * along) * 0.5
}

/// What an opaque surface mirrors: its reflectivity, or Schlick's term for metallic-roughness.
fn mirror_share(material: &Material, color: Vec3, cosine: f32) -> Vec3 {
    match material.model {
        Model::Phong { .. } => material.reflectivity,
        Model::MetallicRoughness { metallic, .. } => {
            let f0 = Vec3::splat(0.04 * (1.0 - metallic)) + color * metallic;
            let x = 1.0 - cosine;
            let x2 = x * x;
            f0 + (Vec3::ONE - f0) * (x2 * x2 * x)
        }
    }
}

/// Divided by its length.
fn normalize(v: Vec3) -> Vec3 {
    v / v.dot(v).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fresnel_at_normal_incidence_and_at_grazing() {
        assert!((dielectric_fresnel(1.0, 1.0, 1.0 / 1.5) - 0.04).abs() < 1e-6);
        assert!((dielectric_fresnel(1.0, 1.0, 1.5) - 0.04).abs() < 1e-6);
        let grazing = (1.0_f32 - 1.0 / 2.25).sqrt();
        assert!(dielectric_fresnel(1e-4, grazing, 1.0 / 1.5) > 0.999);
        assert_eq!(dielectric_fresnel(0.5, 0.5, 1.0), 0.0);
        assert_eq!(dielectric_fresnel(0.0, 0.0, 1.0), 0.0);
    }
}
