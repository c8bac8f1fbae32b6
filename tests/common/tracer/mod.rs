//! Whitted's tracer (CACM 23(6), 1980) as the contract words it: recursive, scalar, in double precision, with no
//! acceleration. Slow and plain, so that it can be read beside the words.

mod shapes;
mod surface_color;

use glam::{DVec2, DVec3};
use raywalk::scene::light::{Falloff, LightKind};
use raywalk::scene::material::Model;
use raywalk::scene::{Camera, Light, Material, Scene};
use raywalk::settings::Settings;
use shapes::{Primitive, Surface, primitives};
use surface_color::look_up;

/// Rays start this far off the surface that they leave, in parts of the scene's size: on the viewer's side, or on the
/// other one if they are refracted. Towards a light behind it, the surface itself is in the way, even where its shading
/// normal leans towards the light.
const MARGIN: f64 = 1e-9;

pub struct Tracer<'a> {
    scene: &'a Scene,
    camera: Camera,
    lights: Vec<Light>,
    primitives: Vec<Primitive>,
    depth: u32,
    margin: f64,
}

/// What a pixel shows, and a number that changes wherever its path meets something else.
#[derive(Clone, Copy)]
pub struct Seen {
    pub color: DVec3,
    pub path: u64,
    pub depth: f64,
}

#[derive(Clone, Copy)]
struct Ray {
    origin: DVec3,
    direction: DVec3,
    range: (f64, f64),
    /// How long the way from the eye to the origin is.
    way: f64,
    /// How much wider it grows per unit of length.
    spread: f64,
}

impl Ray {
    /// A ray that leaves a surface.
    fn leaving(&self, origin: DVec3, direction: DVec3, way: f64) -> Self {
        Self { origin, direction: direction.normalize(), range: (0.0, f64::INFINITY), way, spread: self.spread }
    }
}

/// Mixes a value into a path's number.
fn note(path: &mut u64, value: u64) {
    *path = (*path ^ value).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23);
}

impl<'a> Tracer<'a> {
    pub fn new(scene: &'a Scene, camera: Camera, settings: &Settings) -> Self {
        let mut lights = scene.lights.clone();
        if lights.is_empty() {
            let kind = LightKind::Point { position: camera.eye };
            lights.push(Light { name: None, kind, color: glam::Vec3::ONE, falloff: Falloff::None });
        }
        let depth = settings.depth.unwrap_or(scene.render.max_depth);
        let bounds = scene.bounds();
        let size = if bounds.is_empty() { 10.0 } else { bounds.size().max_element().into() };
        Self { scene, camera, lights, primitives: primitives(&scene.geometry), depth, margin: MARGIN * size }
    }

    /// What is seen at a point of a picture, in pixels from its upper left corner.
    pub fn look(&self, at: DVec2, (width, height): (u32, u32)) -> Seen {
        let Camera { eye, look_at, up, fov, near, far } = self.camera;
        let (width, height) = (f64::from(width), f64::from(height));
        let f = (look_at.as_dvec3() - eye.as_dvec3()).normalize();
        let r = f.cross(up.as_dvec3()).normalize();
        let u = r.cross(f);
        let tangent = (f64::from(fov).to_radians() / 2.0).tan();
        let direction = f
            + r * ((2.0 * at.x / width - 1.0) * tangent * width / height)
            + u * ((1.0 - 2.0 * at.y / height) * tangent);
        let (direction, range) = (direction.normalize(), (near.into(), far.into()));
        let ray = Ray { origin: eye.as_dvec3(), direction, range, way: 0.0, spread: 2.0 * tangent / height };
        let mut path = 0;
        let color = self.trace(ray, self.depth, &self.around_eye(), &mut path);
        Seen { color, path, depth: self.closest(&ray).map_or(f64::INFINITY, |(t, _)| t) }
    }

    /// The transparent bodies that hold the eye, outermost first.
    fn around_eye(&self) -> Vec<u32> {
        let (eye, direction) = (self.camera.eye.as_dvec3(), DVec3::new(-0.31, 0.87, 0.38).normalize());
        let mut around: Vec<u32> = (0..self.scene.objects.len() as u32)
            .filter(|&object| self.scene.objects[object as usize].body && self.material(object).is_transparent())
            .filter(|&object| {
                let own = self.primitives.iter().filter(|p| p.object == object);
                let ahead = own.flat_map(|p| p.hits(eye, direction).into_iter().map(move |t| (p, t)));
                let leaves = ahead
                    .filter(|(_, t)| *t > 0.0)
                    .map(|(p, t)| if p.surface(eye, direction, t).geometric.dot(direction) > 0.0 { 1 } else { -1 });
                leaves.sum::<i32>() > 0
            })
            .collect();
        let size = |o: &u32| self.scene.objects[*o as usize].bounds.size().max_element();
        around.sort_by(|a, b| size(b).total_cmp(&size(a)));
        around
    }

    fn material(&self, object: u32) -> &Material {
        &self.scene.materials[self.scene.objects[object as usize].material as usize]
    }

    /// The least (t, object, primitive) within the ray's range of what is seen.
    fn closest(&self, ray: &Ray) -> Option<(f64, &Primitive)> {
        let seen = self.primitives.iter().filter(|p| !p.is_passed(ray.direction));
        let hits = seen.flat_map(|p| p.hits(ray.origin, ray.direction).into_iter().map(move |t| (t, p)));
        hits.filter(|(t, _)| *t > ray.range.0 && *t <= ray.range.1).reduce(|a, b| if b.0 < a.0 { b } else { a })
    }

    /// Light along a ray that starts in the bodies `media`; black when no ray is left.
    fn trace(&self, ray: Ray, rays_left: u32, media: &[u32], path: &mut u64) -> DVec3 {
        if rays_left == 0 {
            return DVec3::ZERO;
        }
        let (t, light) = match self.closest(&ray) {
            None => {
                note(path, 1);
                (f64::INFINITY, self.scene.render.background.as_dvec3())
            }
            Some((t, primitive)) => (t, self.leaving(&ray, primitive, t, rays_left, media, path)),
        };
        let absorption = media.last().map_or(DVec3::ZERO, |&body| self.material(body).absorption.as_dvec3());
        light * absorption.map(|a| if a == 0.0 { 1.0 } else { (-a * t).exp() })
    }

    /// Light that leaves a surface towards where the ray came from.
    fn leaving(&self, ray: &Ray, hit: &Primitive, t: f64, rays_left: u32, media: &[u32], path: &mut u64) -> DVec3 {
        note(path, u64::from(hit.object) << 32 | u64::from(hit.primitive) << 8 | 2);
        let object = &self.scene.objects[hit.object as usize];
        let material = self.material(hit.object);
        let mut surface = hit.surface(ray.origin, ray.direction, t);
        let way = ray.way + t;
        let slant = ray.direction.dot(surface.geometric).abs().max(1e-3);
        let width = way * ray.spread / slant.sqrt();
        let (color, cell) = look_up(self.scene, object, hit.primitive, material.color, &surface, width);
        let (emission, _) = look_up(self.scene, object, hit.primitive, material.emission, &surface, width);
        note(path, cell as u64);
        let entering = ray.direction.dot(surface.geometric) <= 0.0;
        if !entering {
            (surface.geometric, surface.shading) = (-surface.geometric, -surface.shading);
        }
        let local = self.local(&surface, -ray.direction, material, color, path) + emission;
        let cosine = (-ray.direction.dot(surface.shading)).max(0.0);
        let mirrored = ray.direction + surface.shading * (2.0 * cosine);
        let (r, t) = (material.reflectivity.as_dvec3(), material.transparency.as_dvec3());

        let without: Vec<u32> = match media.iter().rposition(|&o| o == hit.object) {
            Some(at) => [&media[..at], &media[at + 1..]].concat(),
            None => media.to_vec(),
        };
        let outside = without.last().map_or(1.0, |&body| f64::from(self.material(body).ior));
        let inside = f64::from(material.ior);
        let (from, to) = if entering || !object.body { (outside, inside) } else { (inside, outside) };
        let (mut reflected, mut refracted, mut bent) = (r, t, Some(ray.direction));
        if material.is_transparent() {
            let refraction = refract(ray.direction, surface.shading, from / to);
            let fresnel = refraction.map_or(1.0, |inward| fresnel(cosine, -inward.dot(surface.shading), from, to));
            note(path, u64::from(refraction.is_none()));
            if material.fresnel {
                (reflected, refracted) = (r + t * fresnel, t * (1.0 - fresnel));
            } else if refraction.is_none() && object.body {
                (reflected, refracted) = (r + t, DVec3::ZERO);
            }
            if object.body {
                bent = refraction;
            }
        } else if let Model::MetallicRoughness { metallic, roughness, .. } = material.model {
            let f0 = DVec3::splat(0.04).lerp(color, metallic.into());
            let fresnel = f0 + (1.0 - f0) * (1.0 - cosine).powi(5);
            reflected = if f64::from(roughness) < 0.1 { fresnel } else { DVec3::ZERO };
        }
        let mut out = local;
        if reflected != DVec3::ZERO {
            let ray = ray.leaving(surface.position + surface.geometric * self.margin, mirrored, way);
            out += reflected * self.trace(ray, rays_left - 1, media, path);
        }
        if let Some(direction) = bent.filter(|_| refracted != DVec3::ZERO) {
            let media = match (object.body, entering) {
                (false, _) => media.to_vec(),
                (true, true) => [media, &[hit.object]].concat(),
                (true, false) => without,
            };
            let ray = ray.leaving(surface.position - surface.geometric * self.margin, direction, way);
            out += refracted * color * self.trace(ray, rays_left - 1, &media, path);
        }
        out
    }

    /// Ambient and direct light, reflected towards `viewer`.
    fn local(&self, surface: &Surface, viewer: DVec3, material: &Material, color: DVec3, path: &mut u64) -> DVec3 {
        let opacity = match material.model {
            // What is too rough for rays to go on through scatters all its light.
            Model::MetallicRoughness { roughness, .. } if roughness >= 0.1 => DVec3::ONE,
            _ => DVec3::ONE - material.transparency.as_dvec3(),
        };
        let n = surface.shading;
        let ambient = match material.model {
            Model::Phong { ambient, .. } | Model::MetallicRoughness { ambient, .. } => ambient.as_dvec3(),
        };
        let scene_ambient =
            if self.scene.lights.is_empty() { DVec3::splat(0.1) } else { self.scene.render.ambient.as_dvec3() };
        let mut out = opacity * scene_ambient * ambient * color;
        for light in &self.lights {
            let (to_light, distance) = match light.kind {
                LightKind::Point { position } | LightKind::Spot { position, .. } => {
                    let to = position.as_dvec3() - surface.position;
                    (to.normalize(), to.length())
                }
                LightKind::Directional { direction } => (-direction.as_dvec3().normalize(), f64::INFINITY),
            };
            let n_l = n.dot(to_light);
            note(path, u64::from(n_l > 0.0));
            if n_l <= 0.0 {
                continue;
            }
            let mut arriving = light.color.as_dvec3();
            if let LightKind::Spot { direction, cos_inner, cos_outer, .. } = light.kind {
                let (inner, outer) = (f64::from(cos_inner), f64::from(cos_outer));
                let share = ((-direction.as_dvec3()).dot(to_light) - outer) / (inner - outer);
                arriving *= share.clamp(0.0, 1.0).powi(2);
            }
            if light.falloff == Falloff::InverseSquare && distance.is_finite() {
                arriving /= distance * distance;
            }
            arriving *= self.visible(surface.position + surface.geometric * self.margin, to_light, distance, path);
            let h = (to_light + viewer).normalize();
            out += arriving
                * match material.model {
                    Model::Phong { diffuse, specular, shininess, .. } => {
                        opacity * diffuse.as_dvec3() * color * n_l
                            + specular.as_dvec3() * n.dot(h).max(0.0).powf(shininess.into())
                    }
                    Model::MetallicRoughness { metallic, roughness, .. } => {
                        let brdf = Brdf { metallic: metallic.into(), roughness: roughness.into(), color, opacity };
                        brdf.reflected(n_l, n.dot(viewer).max(0.0), n.dot(h), viewer.dot(h)) * n_l
                    }
                };
        }
        out
    }

    /// What arrives of a light: nothing behind anything opaque, t·color for each crossing of a transparent surface.
    fn visible(&self, from: DVec3, to_light: DVec3, distance: f64, path: &mut u64) -> DVec3 {
        let mut arriving = DVec3::ONE;
        for primitive in &self.primitives {
            for t in primitive.hits(from, to_light) {
                if t <= 0.0 || t >= distance - self.margin {
                    continue;
                }
                let (object, material) =
                    (&self.scene.objects[primitive.object as usize], self.material(primitive.object));
                note(path, u64::from(primitive.object) << 8 | 3);
                if !material.is_transparent() {
                    return DVec3::ZERO;
                }
                let surface = primitive.surface(from, to_light, t);
                let (color, cell) = look_up(self.scene, object, primitive.primitive, material.color, &surface, 0.0);
                note(path, cell as u64);
                arriving *= material.transparency.as_dvec3() * color;
            }
        }
        arriving
    }
}

/// Snell's law; `None` under total internal reflection.
fn refract(direction: DVec3, normal: DVec3, eta: f64) -> Option<DVec3> {
    let cosine = -direction.dot(normal);
    let squared = 1.0 - eta * eta * (1.0 - cosine * cosine);
    (squared >= 0.0).then(|| (direction * eta + normal * (eta * cosine - squared.sqrt())).normalize())
}

/// Fresnel's equations for unpolarised light between dielectrics of index `from` and `to`.
fn fresnel(cos_in: f64, cos_out: f64, from: f64, to: f64) -> f64 {
    let across = (from * cos_in - to * cos_out) / (from * cos_in + to * cos_out);
    let along = (from * cos_out - to * cos_in) / (from * cos_out + to * cos_in);
    (across * across + along * along) / 2.0
}

/// The BRDF of glTF 2.0, appendix B.3.
struct Brdf {
    metallic: f64,
    roughness: f64,
    color: DVec3,
    opacity: DVec3,
}

impl Brdf {
    fn reflected(&self, n_l: f64, n_v: f64, n_h: f64, v_h: f64) -> DVec3 {
        let a2 = self.roughness.powi(4);
        let d = a2 / (std::f64::consts::PI * (n_h * n_h * (a2 - 1.0) + 1.0).powi(2));
        let smith = |x: f64, y: f64| x * (y * y * (1.0 - a2) + a2).sqrt();
        let v = 0.5 / (smith(n_l, n_v) + smith(n_v, n_l));
        let f0 = DVec3::splat(0.04).lerp(self.color, self.metallic);
        let f = f0 + (1.0 - f0) * (1.0 - v_h).powi(5);
        let diffuse = self.opacity * self.color * (1.0 - self.metallic) / std::f64::consts::PI;
        (1.0 - f) * diffuse + f * d * v
    }
}
