//! How a scene is lit whose file does not say it, and how bright it is to be shown.

use super::brightness::{self, Point};
use super::probe::{Probe, around};
use super::{AMBIENT_SHARE, MOST_STOPS, WHITE};
use crate::geometry::Aabb;
use crate::scene::environment::{Environment, Sky};
use crate::scene::light::{Falloff, LightKind};
use crate::scene::material::{Lookup, Model};
use crate::scene::sky::{Irradiance, SkyLight, luminance};
use crate::scene::texture::linear_to_srgb;
use crate::scene::{Camera, Light, Material, Object, Texture};
use glam::{DVec2, Vec3};
use std::f64::consts::PI;

/// Directions upwards that tell whether there is a ceiling, and the least share of them that meet something below one.
const LOOKS: usize = 128;
const ROOFED: f32 = 0.8;
/// Towards the key light, for somebody who looks along -Z: from the left above, somewhat behind them.
const TOWARDS_KEY: Vec3 = Vec3::new(-0.5, 0.85, 0.62);
/// How far it is from the middle of what is seen from outside, in radii of that.
const KEY_DISTANCE: f32 = 1.7;
/// What the key light gives a white surface that faces it, as a share of full brightness; the studio gives it the rest.
const KEY: f32 = 0.62;
/// What is lit by the key light and the studio is as bright as its colour is.
const KEY_STOPS: f64 = 0.0;
/// Mean brightness of what is seen, as displays show it, that exposure aims at, and how far it may go for it.
const SHOWN: [f64; 2] = [0.35, 0.62];
const MOST_ADJUSTMENT: f64 = 5.0;
/// Mean luminance that it aims at least at, unless the greatest channel is full on the whole.
const LEAST_LUMINANCE: f64 = 0.22;
const FULL_PEAK: f64 = 0.96;

/// How a scene is lit.
pub struct Lighting {
    pub lights: Vec<Light>,
    /// A light at the eye is added.
    pub headlight: bool,
    /// In place of the scene's own, where it has none.
    pub ambient: Option<Vec3>,
    pub environment: Option<Environment>,
    /// Of automatic exposure.
    pub stops: f32,
}

/// What is there to be lit.
pub struct Lit<'a> {
    pub probe: Probe<'a>,
    /// Where it is seen from first.
    pub camera: Camera,
    pub objects: &'a [Object],
    pub materials: &'a [Material],
    pub textures: &'a [Texture],
    /// The bounds of what the camera shows from outside, if it does.
    pub framed: Option<Aabb>,
    /// The file leaves exposure to the viewer: its lights may be in any unit.
    pub is_exposed: bool,
}

impl Lit<'_> {
    /// Light by the file's lights alone, or a light at the eye where it has none.
    pub fn as_it_is(&mut self, lights: Vec<Light>) -> Lighting {
        let irradiance = brightness::usual_irradiance(&mut self.probe, &self.camera, &lights).unwrap_or(1.0);
        let headlight = lights.is_empty();
        let ambient = match headlight {
            true => Some(Vec3::splat(AMBIENT_SHARE)),
            false if self.is_exposed => Some(Vec3::splat(AMBIENT_SHARE * irradiance as f32)),
            false => None,
        };
        Lighting { lights, headlight, ambient, environment: None, stops: self.stops(irradiance) as f32 }
    }

    /// Light by a sky, and by the lights that the file has.
    pub fn by_sky(&mut self, lights: Vec<Light>, environment: Environment) -> Lighting {
        let sky = SkyLight::new(&environment).irradiance;
        // The mean of what it gives surfaces that face up and down.
        let by_sky = f64::from(luminance(sky.over_pi(Vec3::Y) + sky.over_pi(Vec3::NEG_Y))) / 2.0;
        let by_lights = match lights.is_empty() {
            true => 0.0,
            false => brightness::usual_irradiance(&mut self.probe, &self.camera, &lights).unwrap_or(0.0),
        };
        let scattered = if self.is_physical() { PI } else { 1.0 };
        let irradiance = by_lights + scattered * by_sky;
        let stops = self.stops(if irradiance > 0.0 { irradiance } else { 1.0 });
        let stops = self.adjusted(stops, &lights, &sky);
        let ambient = self.is_exposed.then_some(Vec3::ZERO);
        Lighting { lights, headlight: false, ambient, environment: Some(environment), stops: stops as f32 }
    }

    /// Light by a studio, which is the only one, or fills the shadows of what the file has.
    pub fn in_studio(&mut self, lights: Vec<Light>) -> Lighting {
        let view = self.view();
        let rotation = libm::atan2(f64::from(-view.x), f64::from(-view.z)).to_degrees() as f32;
        let studio = |intensity| Environment { rotation, intensity, ..Environment::new(Sky::Studio) };
        let towards_key = self.turned(TOWARDS_KEY.normalize(), view);
        let full = luminance(SkyLight::new(&studio(1.0)).irradiance.over_pi(towards_key));
        let is_key_lit = lights.is_empty() && !self.is_roofed();
        if is_key_lit {
            let white = KEY * if self.is_physical() { std::f32::consts::PI } else { 1.0 };
            let sun = (LightKind::Directional { direction: -towards_key }, white, Falloff::None);
            // Near what is small, it lights flat things unevenly, too.
            let near = self.framed.map(|subject| {
                let distance = subject.size().length() / 2.0 * KEY_DISTANCE;
                let position = subject.center() + towards_key * distance;
                (LightKind::Point { position }, white * distance * distance, Falloff::InverseSquare)
            });
            let (kind, strength, falloff) = near.filter(|(_, strength, _)| strength.is_normal()).unwrap_or(sun);
            let key = Light { name: Some("key".to_owned()), kind, color: Vec3::splat(strength), falloff };
            let environment = studio((1.0 - KEY) / full);
            let sky = SkyLight::new(&environment).irradiance;
            let stops = self.adjusted(KEY_STOPS, std::slice::from_ref(&key), &sky);
            return Lighting {
                lights: vec![key],
                headlight: false,
                ambient: Some(Vec3::ZERO),
                environment: Some(environment),
                stops: stops as f32,
            };
        }
        let usual = brightness::usual_irradiance(&mut self.probe, &self.camera, &lights).unwrap_or(1.0);
        let scattered = if self.is_physical() { usual / PI } else { usual };
        let environment = studio(AMBIENT_SHARE * scattered as f32 / full);
        let headlight = lights.is_empty();
        let at_eye = [brightness::at_eye(&self.camera)];
        let sky = SkyLight::new(&environment).irradiance;
        let stops = self.adjusted(self.stops(usual), if headlight { &at_eye } else { &lights }, &sky);
        let environment = Some(environment);
        Lighting { lights, headlight, ambient: Some(Vec3::ZERO), environment, stops: stops as f32 }
    }

    /// Whether some surface scatters light by glTF's model, in which π of it make full brightness.
    fn is_physical(&self) -> bool {
        self.materials.iter().any(|m| matches!(m.model, Model::MetallicRoughness { .. }))
    }

    /// The stops that show white at half of full brightness in usual light.
    fn stops(&self, irradiance: f64) -> f64 {
        let white = if self.is_physical() { irradiance / PI } else { irradiance };
        libm::log2(WHITE / white).clamp(-MOST_STOPS, MOST_STOPS)
    }

    /// Where the first view looks, level.
    fn view(&self) -> Vec3 {
        let frame = self.camera.frame(1, 1);
        let level = |v: Vec3| Vec3::new(v.x, 0.0, v.z).try_normalize();
        // Straight up or down, what is up in the picture is ahead.
        level(frame.forward).filter(|_| frame.forward.y.abs() < 0.999).or(level(frame.up)).unwrap_or(Vec3::NEG_Z)
    }

    /// A direction of somebody who looks along -Z, for one who looks along `view`.
    fn turned(&self, direction: Vec3, view: Vec3) -> Vec3 {
        let right = Vec3::new(-view.z, 0.0, view.x);
        (right * direction.x + Vec3::Y * direction.y - view * direction.z).normalize()
    }

    /// Whether the eye is below a ceiling.
    fn is_roofed(&mut self) -> bool {
        let up: Vec<Vec3> = around(2 * LOOKS).into_iter().filter(|direction| direction.y > 0.0).collect();
        let met = self.probe.look(self.camera.eye, &up, 0.0);
        met.iter().flatten().count() as f32 >= ROOFED * up.len() as f32
    }

    /// `stops`, but more or less of them where what is seen would be too dark or bright on the whole.
    fn adjusted(&mut self, stops: f64, lights: &[Light], sky: &Irradiance) -> f64 {
        let points = brightness::points(&mut self.probe, &self.camera, lights);
        let physical = self.is_physical();
        let colors: Vec<Colors> = self.materials.iter().map(|material| self.colors_of(material)).collect();
        let light_of = |point: &Point| {
            let geometry = self.probe.geometry();
            let object = geometry.id(point.primitive)?.object;
            let number = self.objects[object as usize].material as usize;
            let material = &self.materials[number];
            if material.unlit || material.is_transparent() {
                return None;
            }
            let Colors { color, metal } = colors[number];
            let corners = geometry.corner_colors(point.primitive);
            let own = corners.map_or(Vec3::ONE, |[a, b, c]| (a + b + c).truncate() / 3.0);
            // Metals show little but what they mirror.
            let direct = point.irradiance / if physical { PI } else { 1.0 } * f64::from(1.0 - metal);
            let arriving = Vec3::splat(direct as f32) + sky.over_pi(point.normal);
            Some(color * own * arriving + material.emission.factor)
        };
        let light: Vec<Vec3> = points.iter().filter_map(light_of).collect();
        if light.is_empty() || self.probe.is_spent() {
            return stops;
        }
        // Mean luminance and mean greatest channel, as displays show them.
        let shown = |stops: f64| {
            let gain = libm::exp2(stops) as f32;
            let display = |light: &Vec3| {
                let encoded = (*light * gain).to_array().map(|channel| f32::from(linear_to_srgb(channel)) / 255.0);
                let encoded = Vec3::from_array(encoded);
                DVec2::new(luminance(encoded).into(), encoded.max_element().into())
            };
            light.iter().map(display).sum::<DVec2>() / light.len() as f64
        };
        // What is of one pure colour cannot be as bright as grey is: there the colour itself counts, too.
        let is_dark = |stops: f64| {
            let DVec2 { x: luminance, y: peak } = shown(stops);
            (luminance + peak) / 2.0 < SHOWN[0] || luminance < LEAST_LUMINANCE && peak < FULL_PEAK
        };
        let is_bright = |stops: f64| shown(stops).element_sum() / 2.0 > SHOWN[1];
        let (too_low, [mut low, mut high]): (&dyn Fn(f64) -> bool, _) = match () {
            () if is_dark(stops) => (&is_dark, [stops, stops + MOST_ADJUSTMENT]),
            () if is_bright(stops) => (&|stops| !is_bright(stops), [stops - MOST_ADJUSTMENT, stops]),
            () => return stops,
        };
        for _ in 0..24 {
            let middle = (low + high) / 2.0;
            *if too_low(middle) { &mut low } else { &mut high } = middle;
        }
        ((low + high) / 2.0).clamp(-MOST_STOPS, MOST_STOPS)
    }

    /// What a material is like on the whole.
    fn colors_of(&self, material: &Material) -> Colors {
        let mean = |lookup: Lookup| match &self.textures[lookup.texture as usize] {
            Texture::Image(image) => image.texels.mean_color(),
            Texture::Checker { colors: [a, b], .. } => (*a + *b) / 2.0,
        };
        let color = material.color.factor * material.color.texture.map_or(Vec3::ONE, mean);
        match material.model {
            Model::Phong { diffuse, .. } => Colors { color: color * diffuse, metal: 0.0 },
            Model::MetallicRoughness { metallic, .. } => {
                Colors { color, metal: metallic * material.metallic_roughness.map_or(1.0, |map| mean(map).z) }
            }
        }
    }
}

/// What a material is like on the whole.
struct Colors {
    color: Vec3,
    /// Share of metal.
    metal: f32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, Part, PrimitiveId, Shape};
    use crate::scene::object::Mapping;

    /// A ball on the ground, or in a closed box.
    fn ball(in_box: bool) -> Geometry {
        let part = |object, shape| Part::new(shape, PrimitiveId { object, primitive: 0 });
        let mut parts = vec![part(0, Shape::Sphere { center: Vec3::ZERO, radius: 1.0 })];
        if in_box {
            parts.push(part(1, Shape::Sphere { center: Vec3::ZERO, radius: 50.0 }));
        }
        Geometry::build(parts)
    }

    fn lit(geometry: &Geometry, color: f32, lights: Vec<Light>) -> (Lighting, f32) {
        let object = Object {
            name: None,
            kind: "sphere",
            material: 0,
            body: true,
            mapping: Mapping::Vertex,
            world_to_object: None,
            bounds: Aabb::EMPTY,
        };
        let mut material = Material::default_phong();
        material.color.factor = Vec3::splat(color);
        let mut lit = Lit {
            probe: Probe::new(geometry),
            camera: Camera { eye: Vec3::new(0.0, 0.0, 4.0), look_at: Vec3::ZERO, ..Camera::default() },
            objects: &[object.clone(), object],
            materials: &[material],
            textures: &[],
            framed: None,
            is_exposed: true,
        };
        let lighting = lit.in_studio(lights);
        let sky = SkyLight::new(lighting.environment.as_ref().unwrap());
        let card = luminance(sky.irradiance.over_pi(TOWARDS_KEY.normalize()));
        (lighting, card)
    }

    #[test]
    fn a_grey_card_that_faces_the_key_light_is_shown_as_grey_as_it_is() {
        let (Lighting { lights, headlight, stops, .. }, card) = lit(&ball(false), 0.195, Vec::new());
        assert!(lights.len() == 1 && !headlight);
        let white = (lights[0].color.x + card) * libm::exp2f(stops);
        assert!((white - 1.0).abs() < 0.01, "{white}");
    }

    #[test]
    fn in_a_closed_room_the_studio_only_fills() {
        let (Lighting { lights, headlight, .. }, card) = lit(&ball(true), 0.5, Vec::new());
        assert!(lights.is_empty() && headlight);
        assert!((0.02..0.15).contains(&card), "{card}");
    }

    #[test]
    fn what_is_black_or_very_bright_is_exposed_to_be_seen() {
        let sun = Light {
            name: None,
            kind: LightKind::Directional { direction: Vec3::NEG_Z },
            color: Vec3::splat(1e5),
            falloff: Falloff::None,
        };
        let (of_white, _) = lit(&ball(false), 0.8, vec![sun.clone()]);
        let (of_black, _) = lit(&ball(false), 0.01, vec![sun]);
        assert!((-19.0..-15.0).contains(&of_white.stops), "{}", of_white.stops);
        assert!(of_black.stops > of_white.stops + 2.0, "{}", of_black.stops);
        let intensity = of_white.environment.unwrap().intensity;
        assert!(intensity > 1e3, "{intensity}");
    }
}
