//! `raywalk info`: what a scene holds, and what drawing it takes.

use super::options::Reading;
use super::stage;
use super::{Failure, stdout};
use clap::ArgMatches;
use glam::DVec3;
use raywalk::geometry::Aabb;
use raywalk::measure::counts::SceneCounts;
use raywalk::render::Plan;
use raywalk::scene::light::LightKind;
use raywalk::scene::start::Unit;
use raywalk::scene::texture::Texture;
use raywalk::scene::{Light, NamedCamera, Scene};
use raywalk::settings::Settings;
use serde::Serialize;
use std::collections::BTreeMap;

/// Describes the scene that `asked` names.
pub fn run(asked: &ArgMatches) -> Result<(), Failure> {
    let reading = Reading::of(asked)?;
    let loaded = stage::load(&reading)?;
    let info = Info::of(&loaded.scene);
    stdout::print(&if asked.get_flag("json") { stdout::json(&info)? } else { info.text() })
}

/// What there is to say about a scene.
#[derive(Debug, Serialize)]
struct Info {
    scene: String,
    format: &'static str,
    #[serde(flatten)]
    counts: SceneCounts,
    objects_by_type: BTreeMap<&'static str, usize>,
    lights_by_type: BTreeMap<&'static str, usize>,
    materials: usize,
    textures: Vec<String>,
    /// What surrounds the scene; left out where nothing does.
    #[serde(skip_serializing_if = "Option::is_none")]
    environment: Option<String>,
    cameras: Vec<CameraInfo>,
    /// How the first camera was found.
    start: String,
    /// How high the eye stands above the floor there, in the file's units; `null` where it stands on none.
    eye_height: Option<f32>,
    /// The unit that the sizes tell, where it is not the metre.
    unit: Option<&'static str>,
    /// Of everything finite, in the coordinates of the file; `null` if nothing is.
    bounds: Option<Bounds>,
    /// What was taken off all coordinates, since the scene is far from its origin; `null` if nothing was.
    origin: Option<[f64; 3]>,
    max_depth: u32,
    /// What a frame runs under the default settings, one reason a line.
    pipeline: Vec<String>,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct CameraInfo {
    name: String,
    eye: [f64; 3],
    look_at: [f64; 3],
    up: [f32; 3],
    fov: f32,
}

#[derive(Debug, Serialize)]
struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
}

impl Info {
    fn of(scene: &Scene) -> Self {
        let Aabb { min, max } = scene.bounds();
        let headlight = scene.headlight.then_some("headlight");
        Self {
            scene: scene.name.clone(),
            format: scene.format,
            counts: SceneCounts::of(scene),
            objects_by_type: tally(scene.objects.iter().map(|object| object.kind)),
            lights_by_type: tally(scene.lights.iter().map(kind_of_light).chain(headlight)),
            materials: scene.materials.len(),
            textures: scene.textures.iter().map(describe_texture).collect(),
            environment: scene.environment.as_ref().map(ToString::to_string),
            cameras: scene.cameras.iter().map(|named| CameraInfo::of(named, scene)).collect(),
            start: scene.start.to_string(),
            eye_height: scene.start.eye_height,
            unit: (scene.start.unit != Unit::Metre).then(|| scene.start.unit.name()),
            bounds: (min.is_finite() && max.is_finite()).then(|| {
                let [min, max] = [min, max].map(|corner| scene.in_file(corner).to_array());
                Bounds { min, max }
            }),
            origin: (scene.origin != DVec3::ZERO).then(|| scene.origin.to_array()),
            max_depth: scene.render.max_depth,
            pipeline: Plan::new(scene, &Settings::default()).reasons(scene),
            warnings: scene.warnings.iter().map(ToString::to_string).collect(),
        }
    }

    fn text(&self) -> String {
        let c = &self.counts;
        let cameras =
            self.cameras.iter().map(|camera| format!("{} (eye {:?}, fov {})", camera.name, camera.eye, camera.fov));
        let bounds =
            self.bounds.as_ref().map_or("nothing finite".to_owned(), |b| format!("{:?} to {:?}", b.min, b.max));
        let mut lines = vec![
            line("scene", &self.scene),
            line("format", self.format),
            line("objects", &with_types(c.objects, &self.objects_by_type)),
            line("primitives", &format!("{} ({} triangles, {} spheres)", c.primitives, c.triangles, c.spheres)),
            line("materials", &self.materials.to_string()),
            line("textures", &list(&self.textures)),
            line("lights", &with_types(c.lights, &self.lights_by_type)),
            line("cameras", &cameras.collect::<Vec<_>>().join(", ")),
            line("start", &self.start),
            line("bounds", &bounds),
            line("memory", &format!("{:.1} MiB", c.scene_bytes as f64 / f64::from(1 << 20))),
            line("depth", &format!("{} rays on a path", self.max_depth)),
        ];
        if let Some(environment) = &self.environment {
            lines.push(line("environment", environment));
        }
        if let Some(unit) = self.unit {
            lines.push(line("unit", &format!("{unit} (guessed from the sizes of rooms and streets)")));
        }
        if let Some(origin) = self.origin {
            let why = "the scene is far from the file's origin; it was moved before its numbers were rounded";
            lines.push(line("origin", &format!("{origin:?} ({why})")));
        }
        lines.push("pipeline".to_owned());
        lines.extend(self.pipeline.iter().map(|reason| format!("  {reason}")));
        lines.push(line("warnings", &self.warnings.len().to_string()));
        lines.extend(self.warnings.iter().map(|warning| format!("  {warning}")));
        lines.join("\n")
    }
}

impl CameraInfo {
    fn of(named: &NamedCamera, scene: &Scene) -> Self {
        let camera = &named.camera;
        Self {
            name: named.name.clone(),
            eye: scene.in_file(camera.eye).into(),
            look_at: scene.in_file(camera.look_at).into(),
            up: camera.up.into(),
            fov: camera.fov,
        }
    }
}

fn line(name: &str, value: &str) -> String {
    format!("{name:<12}{value}")
}

fn list(items: &[String]) -> String {
    if items.is_empty() { "0".to_owned() } else { format!("{} ({})", items.len(), items.join(", ")) }
}

fn with_types(total: u64, types: &BTreeMap<&'static str, usize>) -> String {
    let parts: Vec<_> = types.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    if parts.is_empty() { total.to_string() } else { format!("{total} ({})", parts.join(", ")) }
}

fn tally(kinds: impl Iterator<Item = &'static str>) -> BTreeMap<&'static str, usize> {
    kinds.fold(BTreeMap::new(), |mut counts, kind| {
        *counts.entry(kind).or_default() += 1;
        counts
    })
}

fn kind_of_light(light: &Light) -> &'static str {
    match light.kind {
        LightKind::Point { .. } => "point",
        LightKind::Directional { .. } => "directional",
        LightKind::Spot { .. } => "spot",
    }
}

fn describe_texture(texture: &Texture) -> String {
    match texture {
        Texture::Image(image) => format!("image {}x{}", image.texels.width(), image.texels.height()),
        Texture::Checker { size, .. } => format!("checker of size {size}"),
    }
}
