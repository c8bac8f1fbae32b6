//! What is known of the thing that a point of the picture shows.

use crate::geometry::{Aabb, PrimitiveId};
use crate::scene::material::{Alpha, ColorSource, Lookup, Model};
use crate::scene::{Camera, Material, Scene};
use glam::{DVec2, Vec3};

/// Nearer to the eye than this share of the bounds' size, an edge is not drawn.
const NEAREST: f32 = 1e-4;

/// What is known of a thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// Its name, or what it is.
    pub title: String,
    /// What is known of it: names and values.
    pub facts: Vec<(&'static str, String)>,
    /// What was pointed at.
    pub point: Vec3,
    /// Bounds of the whole object; infinite for planes.
    pub bounds: Aabb,
}

/// Looks at the thing that `camera` shows at `place` of a picture of `size`: (0, 0) is its upper left corner and (1, 1)
/// its lower right one. `None` where nothing is to be seen.
pub fn inspect(scene: &Scene, camera: &Camera, size: (u32, u32), place: DVec2) -> Option<Inspection> {
    let view = camera.frame(size.0, size.1);
    let [x, y] = [2.0 * place.x - 1.0, 1.0 - 2.0 * place.y].map(|offset| offset as f32);
    let direction = (view.forward + view.right * x + view.up * y).normalize();
    let pick = scene.pick(camera.eye, direction, camera.near).filter(|pick| pick.distance <= camera.far)?;
    let object = scene.objects.get(pick.id.object as usize)?;
    let material = scene.materials.get(object.material as usize)?;
    let point = camera.eye + direction * pick.distance;
    let mut facts = vec![
        ("kind", format!("{}, object {} of {}", object.kind, pick.id.object + 1, scene.objects.len())),
        ("point", scene.in_file(point).to_array().map(rounded).join(" ")),
        ("size", if object.bounds.is_finite() { vector(object.bounds.size()) } else { "endless".to_owned() }),
    ];
    facts.extend(part(scene, pick.id, object.kind));
    facts.extend(facts_of(material));
    Some(Inspection {
        title: object.name.clone().unwrap_or_else(|| format!("a {} without a name", object.kind)),
        facts,
        point,
        bounds: object.bounds,
    })
}

/// Which part of an object of some kind it is; `None` where that is the whole.
fn part(scene: &Scene, id: PrimitiveId, kind: &str) -> Option<(&'static str, String)> {
    let part = match kind {
        "sphere" | "plane" | "disk" | "rectangle" | "triangle" => return None,
        "box" => format!("face {} of 6", id.primitive + 1),
        "cone" | "cylinder" => ["side", "base", "top"].get(id.primitive as usize)?.to_string(),
        // Numbers are the file's, as in messages about it; triangles without area are not among those that are there.
        _ => {
            let count = scene.primitives_of(id.object);
            format!("triangle {}, counted from 0; {count} of them can be seen", id.primitive)
        }
    };
    Some(("part", part))
}

/// What of a material is not as usual, and its colour and model.
fn facts_of(material: &Material) -> Vec<(&'static str, String)> {
    let mut facts =
        vec![("material", if material.name.is_empty() { "the default" } else { &material.name }.to_owned())];
    facts.push(("color", color(&material.color)));
    match material.model {
        _ if material.unlit => facts.push(("model", "unlit: its colour is what is seen".to_owned())),
        Model::Phong { ambient, diffuse, specular, shininess } => {
            facts.push(("ambient", vector(ambient)));
            facts.push(("diffuse", vector(diffuse)));
            facts.push(("specular", format!("{}, shininess {}", vector(specular), rounded(shininess))));
        }
        Model::MetallicRoughness { metallic, roughness, .. } => {
            facts.push(("metallic", format!("{}{}", rounded(metallic), textured(material.metallic_roughness))));
            facts.push(("roughness", format!("{}{}", rounded(roughness), textured(material.metallic_roughness))));
        }
    }
    if material.emission.factor != Vec3::ZERO {
        facts.push(("emission", color(&material.emission)));
    }
    if material.reflectivity != Vec3::ZERO {
        facts.push(("reflectivity", vector(material.reflectivity)));
    }
    if material.transparency != Vec3::ZERO {
        facts.push(("transparency", format!("{}, ior {}", vector(material.transparency), rounded(material.ior))));
    }
    if material.absorption != Vec3::ZERO {
        facts.push(("absorption", vector(material.absorption)));
    }
    match material.alpha {
        Alpha::Opaque => {}
        Alpha::Mask(least) => facts.push(("alpha", format!("holes below {}", rounded(least)))),
        Alpha::Blend => facts.push(("alpha", format!("blended, opacity {}", rounded(material.opacity)))),
    }
    facts
}

fn color(source: &ColorSource) -> String {
    format!("{}{}", vector(source.factor), textured(source.texture))
}

fn textured(lookup: Option<Lookup>) -> String {
    lookup.map_or_else(String::new, |lookup| format!(" x texture {}", lookup.texture))
}

/// Three numbers, or one where they are the same.
fn vector(v: Vec3) -> String {
    if v.x == v.y && v.y == v.z {
        return rounded(v.x);
    }
    v.to_array().map(rounded).join(" ")
}

/// Three decimals at most, or three figures of what is small.
fn rounded(value: impl Into<f64>) -> String {
    let value = value.into();
    if value != 0.0 && value.abs() < 0.01 {
        return format!("{value:.2e}");
    }
    ((value * 1e3).round() / 1e3).to_string()
}

impl Inspection {
    /// How far what was pointed at is from a camera's eye, in words.
    pub fn distance(&self, camera: &Camera) -> String {
        format!("{} m", rounded(self.point.distance(camera.eye)))
    }

    /// The edges of its bounds, as far as `camera` shows them in a picture of `size`; places as for [`inspect`].
    pub fn outline(&self, camera: &Camera, size: (u32, u32)) -> Vec<[DVec2; 2]> {
        if !self.bounds.is_finite() || self.bounds.is_empty() {
            return Vec::new();
        }
        let corner = |i: usize| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.bounds.min[axis] } else { self.bounds.max[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        };
        let least = self.bounds.size().max_element() * NEAREST;
        let edges = (0..8).flat_map(|i| (0..3).map(move |axis| (i, i | 1 << axis))).filter(|(from, to)| from != to);
        edges.filter_map(|(from, to)| project([corner(from), corner(to)], camera, size, least)).collect()
    }

    /// Where `camera` shows what was pointed at, if it is in front of it.
    pub fn place(&self, camera: &Camera, size: (u32, u32)) -> Option<DVec2> {
        project([self.point; 2], camera, size, f32::MIN_POSITIVE).map(|[place, _]| place)
    }
}

/// A line as it is seen, without what lies less than `least` ahead of the eye.
fn project(ends: [Vec3; 2], camera: &Camera, size: (u32, u32), least: f32) -> Option<[DVec2; 2]> {
    let view = camera.frame(size.0, size.1);
    let ahead = ends.map(|end| (end - view.eye).dot(view.forward));
    let [mut from, mut to] = ends;
    match ahead.map(|ahead| ahead >= least) {
        [false, false] => return None,
        [true, true] => {}
        [from_is_seen, _] => {
            let cut = from.lerp(to, (least - ahead[0]) / (ahead[1] - ahead[0]));
            if from_is_seen { to = cut } else { from = cut }
        }
    }
    let place = |point: Vec3| {
        let from_eye = (point - view.eye).as_dvec3();
        let ahead = from_eye.dot(view.forward.as_dvec3()).max(f64::from(least));
        let along = |axis: Vec3| from_eye.dot(axis.as_dvec3()) / f64::from(axis.length_squared()) / ahead;
        DVec2::new((1.0 + along(view.right)) / 2.0, (1.0 - along(view.up)) / 2.0)
    };
    let places = [place(from), place(to)];
    places.iter().all(|place| place.is_finite()).then_some(places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{LoadOptions, load_text};

    const ROOM: &str = r#"{ "version": 1, "camera": { "position": [0, 0, 5], "look_at": [0, 0, 0], "fov": 60 },
        "materials": { "gold": { "metallic": 1, "roughness": 0.25, "base_color": [1, 0.8, 0.3] },
                       "glass": { "transparency": 1, "ior": 1.5 } },
        "objects": [
            { "type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "gold", "name": "ball" },
            { "type": "mesh", "vertices": [[2, -1, 0], [4, -1, 0], [4, 1, 0], [2, 1, 0]],
              "triangles": [[0, 0, 1], [0, 1, 2], [0, 2, 3]], "material": "glass" },
            { "type": "plane", "point": [0, -2, 0], "normal": [0, 1, 0] } ] }"#;

    fn scene() -> Scene {
        load_text("room.json", ROOM, &LoadOptions::default()).expect("right")
    }

    /// A ball far from the origin of its file.
    fn far() -> Scene {
        let text = r#"{ "version": 1, "camera": { "position": [582143, 0, 5340127], "look_at": [582143, 0, 5340122] },
            "objects": [{ "type": "sphere", "center": [582143, 0, 5340122], "radius": 1 }] }"#;
        load_text("far.json", text, &LoadOptions::default()).expect("right")
    }

    fn at(scene: &Scene, x: f64, y: f64) -> Option<Inspection> {
        inspect(scene, &scene.cameras[0].camera, (200, 100), DVec2::new(x, y))
    }

    fn fact<'a>(inspection: &'a Inspection, name: &str) -> &'a str {
        inspection.facts.iter().find(|(known, _)| *known == name).map_or("", |(_, value)| value)
    }

    #[test]
    fn it_tells_name_material_distance_and_triangles() {
        let scene = scene();
        let ball = at(&scene, 0.5, 0.5).expect("the ball");
        assert_eq!((ball.title.as_str(), ball.distance(&scene.cameras[0].camera).as_str()), ("ball", "4 m"));
        assert_eq!((fact(&ball, "material"), fact(&ball, "metallic"), fact(&ball, "roughness")), ("gold", "1", "0.25"));
        assert_eq!(fact(&ball, "color"), "1 0.8 0.3");
        assert!(ball.point.abs_diff_eq(Vec3::Z, 1e-5), "{}", ball.point);
        assert_eq!(fact(&at(&far(), 0.5, 0.5).expect("the ball"), "point"), "582143 0 5340123");
        let pane = at(&scene, 0.76, 0.45).expect("the pane");
        assert_eq!(pane.title, "a mesh without a name");
        assert_eq!(fact(&pane, "kind"), "mesh, object 2 of 3");
        assert_eq!(fact(&pane, "part"), "triangle 2, counted from 0; 2 of them can be seen");
        assert_eq!(fact(&ball, "part"), "", "a sphere has none");
        assert_eq!(fact(&pane, "transparency"), "1, ior 1.5");
        assert_eq!(fact(&at(&scene, 0.5, 0.99).expect("the floor"), "size"), "endless");
        assert_eq!(at(&scene, 0.02, 0.02), None, "the sky");
    }

    #[test]
    fn it_tells_the_parts_of_what_has_some() {
        let text = |object: &str| {
            format!(
                r#"{{ "version": 1, "camera": {{ "position": [0, 0, 5], "look_at": [0, 0, 0], "fov": 60 }},
                    "objects": [{object}] }}"#
            )
        };
        for (object, part) in [
            (r#"{ "type": "box", "min": [-1, -1, -1], "max": [1, 1, 1] }"#, "face 6 of 6"),
            (r#"{ "type": "cylinder", "base": [0, 0, -1], "top": [0, 0, 1], "radius": 1, "capped": true }"#, "top"),
            (r#"{ "type": "cone", "base": [0, -1, 0], "top": [0, 1, 0], "radius": 1 }"#, "side"),
        ] {
            let scene = load_text("one.json", &text(object), &LoadOptions::default()).expect("right");
            assert_eq!(fact(&at(&scene, 0.5, 0.5).expect("it is ahead"), "part"), part);
        }
    }

    #[test]
    fn it_is_outlined_where_it_is_seen() {
        let scene = scene();
        let camera = scene.cameras[0].camera;
        let ball = at(&scene, 0.5, 0.5).expect("the ball");
        let place = ball.place(&camera, (200, 100)).expect("in front");
        assert!(place.abs_diff_eq(DVec2::splat(0.5), 1e-5));
        let outline = ball.outline(&camera, (200, 100));
        assert_eq!(outline.len(), 12);
        assert!(outline.iter().flatten().all(|place| (0.2..0.8).contains(&place.x) && (0.1..0.9).contains(&place.y)));
        let inside = Camera { eye: Vec3::new(0.0, 0.0, 0.5), ..camera };
        assert_eq!(ball.outline(&inside, (200, 100)).len(), 8, "without the face behind the eye");
        let turned = Camera { look_at: camera.eye * 2.0, ..camera };
        assert_eq!((ball.outline(&turned, (200, 100)).len(), ball.place(&turned, (200, 100))), (0, None));
        assert!(at(&scene, 0.5, 0.99).expect("the floor").outline(&camera, (200, 100)).is_empty());
    }
}
