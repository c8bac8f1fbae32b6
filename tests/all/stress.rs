//! Scenes that are hard on a tracer: every type of object, material and light, coincident, thin, huge, tiny, far away.

use crate::random::Random;
use crate::temporary::load_text;
use glam::DVec3;
use raywalk::scene::{Camera, Scene};
use serde_json::{Value, json};

/// A scene with its name.
pub type Named = (String, Scene);

/// All stress scenes.
pub fn scenes() -> Vec<Named> {
    let far = DVec3::new(148_376.0, 1234.0, -223_423.0);
    let written = [
        ("crowd", crowd(1.0, DVec3::ZERO)),
        ("tiny crowd", crowd(1e-4, DVec3::ZERO)),
        ("huge crowd", crowd(1e5, DVec3::ZERO)),
        ("far crowd", crowd(1.0, far)),
        ("coincident", coincident()),
        ("needles", needles()),
        ("within glass", within_glass()),
        ("eye on a plane", eye_on_plane()),
        ("mirrors", mirrors()),
        ("water", water()),
        ("panes", panes()),
        ("many lights", many_lights()),
        ("only a headlight", headlight()),
        ("heap", heap()),
    ];
    written.map(|(name, text)| (name.to_owned(), load_text(text.to_string()).unwrap())).into()
}

/// The scene's own cameras and `count` more.
pub fn cameras(scene: &Scene, count: usize, random: &mut Random) -> Vec<Camera> {
    let bounds = scene.bounds();
    let (min, max) = if bounds.is_empty() { (glam::Vec3::NEG_ONE, glam::Vec3::ONE) } else { (bounds.min, bounds.max) };
    let wider = (max - min) * 0.3;
    let others = (0..count).map(|_| {
        let (eye, look_at) = (random.inside(min - wider, max + wider), random.inside(min, max));
        let camera = Camera { eye, look_at, fov: random.within(20.0, 100.0) as f32, ..Camera::default() };
        assert!(camera.is_valid(), "{camera:?}");
        camera
    });
    scene.cameras.iter().take(3).map(|c| c.camera).chain(others).collect()
}

pub fn triple(v: DVec3) -> Value {
    json!(v.to_array())
}

/// One material of each sort.
pub fn materials() -> Value {
    json!({
        "matte": { "color": [0.8, 0.4, 0.2], "specular": 0 },
        "shiny": { "color": [0.2, 0.5, 0.9], "reflectivity": [0.3, 0.2, 0.1], "shininess": 33 },
        "mirror": { "diffuse": 0, "specular": 0, "ambient": 0, "reflectivity": 0.95 },
        "glass": { "transparency": 1, "ior": 1.5, "ambient": 0, "diffuse": 0, "specular": 0.5, "color": [0.9, 1, 0.95] },
        "amber": { "transparency": [0.9, 0.7, 0.4], "ior": 1.2, "absorption": [0.1, 0.3, 1.5], "reflectivity": 0.1 },
        "pane": { "transparency": 0.6, "fresnel": false, "color": [0.7, 1, 0.8], "reflectivity": 0.2 },
        "steel": { "base_color": [0.8, 0.7, 0.6], "metallic": 1, "roughness": 0.05 },
        "clay": { "base_color": [0.6, 0.3, 0.2], "metallic": 0.1, "roughness": 0.6 },
        "tiles": { "color": { "texture": "tiles" }, "emission": [0.01, 0, 0.02], "reflectivity": 0.1 }
    })
}

pub const MATERIALS: [&str; 9] = ["matte", "shiny", "mirror", "glass", "amber", "pane", "steel", "clay", "tiles"];

pub fn textures() -> Value {
    json!({ "tiles": { "checker": [[0.9, 0.9, 0.9], [0.1, 0.2, 0.1]], "size": 0.4 } })
}

fn scene(camera: &Value, depth: u32, lights: &Value, objects: &[Value]) -> Value {
    json!({
        "version": 1, "camera": camera, "textures": textures(), "materials": materials(), "lights": lights,
        "render": { "max_depth": depth, "background": [0.3, 0.4, 0.6], "ambient": [0.9, 1, 1.1] }, "objects": objects,
    })
}

fn lights() -> Value {
    json!([
        { "type": "point", "position": [-6, 9, 8], "color": [0.5, 0.5, 0.4] },
        { "type": "directional", "direction": [1, -3, -0.5], "intensity": 0.4 },
        { "type": "spot", "position": [3, 7, 4], "direction": [-2, -7, -3], "inner_angle": 20, "outer_angle": 40,
          "intensity": 30, "falloff": "inverse_square", "temperature": 3000 }
    ])
}

/// A shape of any type but a plane, about 1 large, around `center`.
pub fn any_shape(random: &mut Random, center: DVec3) -> Value {
    let (a, b, c) = (random.direction(), random.direction(), random.direction());
    let (size, part) = (random.within(0.2, 0.8), random.within(0.1, 0.9));
    let capped = random.below(2) == 0;
    let (from, to) = (triple(center - a * size), triple(center + a * size));
    match random.below(8) {
        0 => json!({ "type": "sphere", "center": triple(center), "radius": size }),
        1 => json!({ "type": "cylinder", "base": from, "top": to, "radius": size * part, "capped": capped }),
        2 => {
            json!({ "type": "cone", "base": from, "top": to, "radius": size, "radius_top": size * part, "capped": capped })
        }
        3 => json!({ "type": "cone", "base": from, "top": to, "radius": size * part, "capped": capped }),
        4 => {
            json!({ "type": "box", "min": triple(center - size * part), "max": triple(center + DVec3::new(size, part, size)) })
        }
        5 => json!({ "type": "disk", "center": triple(center), "normal": triple(a), "radius": size }),
        6 => {
            json!({ "type": "rectangle", "corner": triple(center), "edge_u": triple(a * size), "edge_v": triple(b * part) })
        }
        _ => json!({ "type": "triangle", "vertices": [from, to, triple(center + b * size)],
                     "normals": [triple(a + b * 3.0), triple(b - a * 0.5), triple(c * 0.2 + b)] }),
    }
}

pub fn with_material(mut object: Value, material: &str) -> Value {
    object["material"] = json!(material);
    object
}

/// Eighty objects of all types and materials over a floor, made `scale` times as large, then moved.
fn crowd(scale: f64, shift: DVec3) -> Value {
    let mut random = Random::new(7);
    let mut children =
        vec![json!({ "type": "plane", "point": [0, -3, 0], "normal": [0.1, 1, 0], "material": "tiles" })];
    for _ in 0..80 {
        let center = random.point(3.0);
        let material = MATERIALS[random.below(MATERIALS.len())];
        children.push(with_material(any_shape(&mut random, center), material));
    }
    let place = |p: DVec3| triple(p * scale + shift);
    let lights = json!([
        { "type": "point", "position": place(DVec3::new(-6.0, 9.0, 8.0)), "color": [0.6, 0.5, 0.4] },
        { "type": "directional", "direction": [1, -3, -0.5], "intensity": 0.4 },
        { "type": "spot", "position": place(DVec3::new(3.0, 7.0, 4.0)), "direction": [-2, -7, -3],
          "inner_angle": 20, "outer_angle": 40, "intensity": 0.5 }
    ]);
    let camera = json!({ "position": place(DVec3::new(0.0, 1.0, 8.0)), "look_at": place(DVec3::ZERO), "fov": 50 });
    let group =
        json!({ "type": "group", "transform": { "translate": triple(shift), "scale": scale }, "children": children });
    scene(&camera, 5, &lights, &[group])
}

/// Everything twice or face to face: which one is hit is decided by the order of identity alone.
fn coincident() -> Value {
    let mut objects = Vec::new();
    for (i, material) in MATERIALS.iter().enumerate() {
        let (x, y) = ((i % 3) as f64 - 1.5, (i / 3) as f64 - 1.5);
        objects.push(json!({ "type": "box", "min": [x, y, 0], "max": [x + 1.0, y + 1.0, 1], "material": material }));
        let other = MATERIALS[(i + 4) % MATERIALS.len()];
        objects.push(json!({ "type": "box", "min": [x, y, 1], "max": [x + 1.0, y + 1.0, 1.5], "material": other }));
        objects.push(json!({ "type": "rectangle", "corner": [x, y, 1.5], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0], "material": material }));
        let (middle, twin) = ([x + 0.5, y + 0.5, 2.5], if i % 2 == 0 { material } else { &other });
        for material in [*twin, *material] {
            objects.push(json!({ "type": "sphere", "center": middle, "radius": 0.4, "material": material }));
            objects.push(json!({ "type": "disk", "center": [x + 0.5, y + 0.5, 1.5], "normal": [0, 0, 1], "radius": 0.4, "material": material }));
        }
    }
    objects.push(json!({ "type": "plane", "point": [0, -1.5, 0], "normal": [0, 1, 0], "material": "tiles" }));
    objects.push(json!({ "type": "plane", "point": [5, -1.5, 0], "normal": [0, 1, 0], "material": "matte" }));
    scene(&json!({ "position": [0, 0, 8], "look_at": [0, 0, 0], "fov": 40 }), 5, &lights(), &objects)
}

/// Long and thin, flat, all but edge-on, all but aligned with an axis.
fn needles() -> Value {
    let mut random = Random::new(11);
    let mut objects = Vec::new();
    for i in 0..40 {
        let (center, a, b) = (random.point(2.0), random.direction(), random.direction());
        let thin = 10_f64.powf(random.within(-5.0, -1.0));
        // Tilts that f32 can hold, but whose cosine it rounds to 1.
        let tilt = 10_f64.powf(random.within(-6.0, -1.5));
        let almost_y = DVec3::new(tilt, 1.0, -0.3 * tilt).normalize();
        let (from, to) = (center - a * 2.0, center + a * 2.0);
        objects.push(with_material(
            match i % 5 {
                0 => json!({ "type": "triangle", "vertices": [triple(from), triple(to), triple(from + b * thin)] }),
                1 => json!({ "type": "cone", "base": triple(from), "top": triple(to), "radius": thin * 2.0, "radius_top": thin }),
                2 => json!({ "type": "disk", "center": triple(center), "normal": triple(almost_y), "radius": 1.5 }),
                3 => json!({ "type": "cone", "base": triple(center), "top": triple(center + a * thin), "radius": 0.8, "radius_top": 0.1 }),
                _ => json!({ "type": "cylinder", "base": triple(center - almost_y), "top": triple(center + almost_y), "radius": 0.5, "capped": false }),
            },
            MATERIALS[i % MATERIALS.len()],
        ));
    }
    scene(&json!({ "position": [0, 0.2, 6], "look_at": [0, 0, 0], "fov": 45 }), 5, &lights(), &objects)
}

fn within_glass() -> Value {
    let mut objects = vec![
        json!({ "type": "sphere", "center": [0, 0, 0], "radius": 3, "material": "amber" }),
        json!({ "type": "sphere", "center": [0.5, 0, 0], "radius": 2, "material": "glass" }),
        json!({ "type": "box", "min": [-1, -0.5, -2.5], "max": [1, 0.5, -1], "material": "glass" }),
        json!({ "type": "plane", "point": [0, -3.5, 0], "normal": [0, 1, 0], "material": "tiles" }),
    ];
    let mut random = Random::new(5);
    for i in 0..12 {
        let center = random.direction() * random.within(1.0, 5.0);
        objects.push(with_material(any_shape(&mut random, center), MATERIALS[i % MATERIALS.len()]));
    }
    scene(&json!({ "position": [0.3, 0.1, 0.2], "look_at": [0, 0, -3], "fov": 90 }), 5, &lights(), &objects)
}

fn eye_on_plane() -> Value {
    let objects = [
        json!({ "type": "plane", "point": [0, 1, 0], "normal": [0, 1, 0], "material": "glass" }),
        json!({ "type": "rectangle", "corner": [-2, -2, -1], "edge_u": [4, 0, 0], "edge_v": [0, 5, 0], "material": "tiles" }),
        json!({ "type": "box", "min": [0, 0, 0], "max": [1, 1, 1], "material": "shiny" }),
        json!({ "type": "sphere", "center": [-1, 0.5, 0], "radius": 0.5, "material": "mirror" }),
        json!({ "type": "plane", "point": [0, -2, 0], "normal": [0, 1, 0], "material": "matte" }),
    ];
    scene(&json!({ "position": [0.25, 1, 4], "look_at": [0.25, 1, 0], "fov": 60 }), 6, &lights(), &objects)
}

fn mirrors() -> Value {
    let objects = [
        json!({ "type": "rectangle", "corner": [-2, -2, -2], "edge_u": [4, 0, 0], "edge_v": [0, 4, 0], "material": "mirror" }),
        json!({ "type": "rectangle", "corner": [-2, -2, 2], "edge_u": [4, 0, 0], "edge_v": [0, 4, 0], "material": "mirror" }),
        json!({ "type": "disk", "center": [1.5, 0, 0], "normal": [-1, 0, 0.1], "radius": 1, "material": "steel" }),
        json!({ "type": "cone", "base": [0, -1, 0], "top": [0, 0.5, 0], "radius": 0.4, "material": "shiny" }),
        json!({ "type": "plane", "point": [0, -2, 0], "normal": [0, 1, 0], "material": "tiles" }),
    ];
    scene(&json!({ "position": [-1, 0.5, 1.5], "look_at": [0.3, 0, -2], "fov": 70 }), 24, &lights(), &objects)
}

/// Glass in glass in water, which is a half-space.
fn water() -> Value {
    let objects = [
        json!({ "type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "amber" }),
        json!({ "type": "sphere", "center": [0, -0.2, 0], "radius": 1, "material": "glass" }),
        json!({ "type": "sphere", "center": [0, -0.2, 0], "radius": 0.6, "material": "amber" }),
        json!({ "type": "sphere", "center": [0, -0.2, 0], "radius": 0.3, "material": "glass" }),
        json!({ "type": "cylinder", "base": [1.5, -1, 0], "top": [1.5, 1, 0.3], "radius": 0.5, "material": "glass" }),
        json!({ "type": "box", "min": [-2.5, -1, -1], "max": [-1.2, 0.6, 0], "material": "glass" }),
        json!({ "type": "plane", "point": [0, -2, 0], "normal": [0, 1, 0], "material": "tiles" }),
    ];
    scene(&json!({ "position": [0, 0.8, 4], "look_at": [0, -0.2, 0], "fov": 50 }), 6, &lights(), &objects)
}

fn panes() -> Value {
    let mut objects = vec![json!({ "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "tiles" })];
    for i in 0..12 {
        let z = -0.4 * f64::from(i);
        objects.push(json!({ "type": "rectangle", "corner": [-1.0 + z * 0.2, -1, z], "edge_u": [2, 0, 0.1], "edge_v": [0, 1.5, 0],
                             "material": if i % 3 == 0 { "glass" } else { "pane" } }));
    }
    objects.push(json!({ "type": "sphere", "center": [0, 0, -6], "radius": 1, "material": "matte" }));
    scene(&json!({ "position": [1, 0.5, 3], "look_at": [0, 0, -3], "fov": 50 }), 7, &lights(), &objects)
}

fn many_lights() -> Value {
    let mut random = Random::new(3);
    let lights: Vec<Value> = (0..24)
        .map(|i| {
            let position = random.direction() * 6.0;
            let color = triple(random.point(0.1).abs());
            match i % 3 {
                0 => json!({ "type": "point", "position": triple(position), "color": color }),
                1 => json!({ "type": "directional", "direction": triple(-position), "color": color }),
                _ => json!({ "type": "spot", "position": triple(position), "direction": triple(-position), "color": color, "outer_angle": 25 }),
            }
        })
        .collect();
    let objects: Vec<Value> = (0..40)
        .map(|i| {
            let center = random.point(2.5);
            with_material(any_shape(&mut random, center), MATERIALS[i % MATERIALS.len()])
        })
        .collect();
    scene(&json!({ "position": [0, 0, 9], "look_at": [0, 0, 0], "fov": 40 }), 4, &json!(lights), &objects)
}

fn headlight() -> Value {
    let mut random = Random::new(19);
    let objects: Vec<Value> = (0..40)
        .map(|i| {
            let center = random.point(2.5);
            with_material(any_shape(&mut random, center), MATERIALS[i % MATERIALS.len()])
        })
        .collect();
    scene(&json!({ "position": [0, 0, 9], "look_at": [0, 0, 0], "fov": 40 }), 5, &json!([]), &objects)
}

/// Two thousand triangles in the same place: a tree over them has nothing to go by.
fn heap() -> Value {
    let objects: Vec<Value> = (0..2000)
        .map(|i| {
            let depth = f64::from(i % 3) * 1e-3;
            json!({ "type": "triangle", "vertices": [[-1, -1, depth], [1, -1, depth], [0, 1, depth]], "material": MATERIALS[i as usize % 3] })
        })
        .collect();
    scene(&json!({ "position": [0.2, 0.1, 4], "look_at": [0, 0, 0], "fov": 40 }), 3, &lights(), &objects)
}
