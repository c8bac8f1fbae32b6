//! One scene for each paragraph of the contract.

use serde_json::{Value, json};

/// Names and scene files. Textures are found in `picture.png` beside them.
pub fn all() -> Vec<(&'static str, Value)> {
    vec![
        ("phong", phong()),
        ("metallic-roughness", metallic_roughness()),
        ("headlight", headlight()),
        ("textures", textures()),
        ("glass ball", glass_ball()),
        ("nested glass", nested_glass()),
        ("no fresnel", no_fresnel()),
        ("water", water()),
        ("coloured shadows", coloured_shadows()),
        ("mirrors", mirrors()),
        ("near and far", near_and_far()),
        ("smooth glass", smooth_glass()),
    ]
}

fn scene(cameras: &Value, materials: &Value, lights: &Value, objects: &Value) -> Value {
    let mut materials = materials.clone();
    materials["floor"] = json!({ "color": { "texture": "floor" }, "diffuse": 0.8, "specular": 0 });
    json!({
        "version": 1, "cameras": cameras, "materials": materials, "objects": objects, "lights": lights,
        "textures": { "floor": { "checker": [[0.9, 0.9, 0.9], [0.15, 0.2, 0.15]], "size": 2 } },
        "render": { "max_depth": 6, "background": [0.25, 0.45, 0.75], "ambient": [1, 0.9, 1.2] },
    })
}

fn camera(position: [f64; 3], look_at: [f64; 3]) -> Value {
    json!({ "c": { "position": position, "look_at": look_at, "fov": 45 } })
}

fn lamp() -> Value {
    json!([{ "type": "point", "position": [-4, 6, 5], "color": [0.9, 0.9, 0.8] }])
}

fn phong() -> Value {
    let materials = json!({
        "red": { "color": "#e04020", "ambient": 0.1, "diffuse": [0.5, 0.6, 0.7], "specular": [0.5, 0.4, 0.3], "shininess": 20 },
        "shiny": { "color": [0.2, 0.3, 0.8], "reflectivity": [0.5, 0.3, 0.1], "shininess": 300 },
        "lamp": { "color": 0.2, "emission": [0.7, 0.5, 0.1], "diffuse": 0.3, "specular": 0 }
    });
    let lights = json!([
        { "type": "point", "position": [-4, 6, 5], "color": [0.6, 0.5, 0.5], "temperature": 3500 },
        { "type": "point", "position": [4, 3, 4], "intensity": 9, "falloff": "inverse_square", "temperature": 9000 },
        { "type": "directional", "direction": [1, -2, -1], "color": [0.2, 0.2, 0.3] },
        { "type": "spot", "position": [0, 5, 1], "direction": [0.1, -1, 0], "inner_angle": 10, "outer_angle": 25, "intensity": 0.8 }
    ]);
    let objects = json!([
        { "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor" },
        { "type": "sphere", "center": [-1.5, 0, 0], "radius": 1, "material": "red" },
        { "type": "cylinder", "base": [0.4, -1, 0], "top": [0.6, 0.6, -0.2], "radius": 0.5, "material": "shiny" },
        { "type": "cone", "base": [2, -1, 0.3], "top": [2, 1, 0], "radius": 0.8, "radius_top": 0.2, "material": "red" },
        { "type": "cone", "base": [1.1, -1, 1.3], "top": [1.1, 0, 1.3], "radius": 0.5, "capped": false, "material": "lamp" },
        { "type": "box", "min": [-3.6, -1, -1], "max": [-2.7, 0.4, 0], "material": "shiny" },
        { "type": "disk", "center": [-0.5, 1.5, -1], "normal": [0.3, -0.2, 1], "radius": 0.8, "material": "red" },
        { "type": "rectangle", "corner": [1, 1, -2], "edge_u": [2, 0.3, 0], "edge_v": [0, 1, 0.4], "material": "lamp" },
        { "type": "triangle", "vertices": [[-1, -0.9, 2], [0.4, -0.9, 1.8], [-0.5, 0.3, 1.2]], "material": "red",
          "normals": [[-0.5, 0.2, 1], [0.6, 0, 1], [0, 0.9, 0.8]] }
    ]);
    let mut cameras = camera([0.5, 1.5, 7.0], [0.0, 0.0, 0.0]);
    cameras["tilted"] = json!({ "position": [-5, 2, 3], "look_at": [0, 0, 0], "up": [0.3, 1, 0.2], "fov": 50 });
    scene(&cameras, &materials, &lights, &objects)
}

fn metallic_roughness() -> Value {
    let materials = json!({
        "gold": { "base_color": [1, 0.7, 0.3], "metallic": 1, "roughness": 0.3 },
        "steel": { "base_color": [0.7, 0.7, 0.75], "metallic": 1, "roughness": 0.07 },
        "plastic": { "base_color": [0.2, 0.6, 0.3], "metallic": 0, "roughness": 0.08, "ambient": 0.2 },
        "chalk": { "base_color": { "texture": "floor" }, "metallic": 0.3, "roughness": 0.9 }
    });
    let lights = json!([
        { "type": "point", "position": [-4, 6, 5], "intensity": 3 },
        { "type": "spot", "position": [4, 4, 4], "direction": [-1, -1, -1], "intensity": 60, "falloff": "inverse_square" }
    ]);
    let ball =
        |x: f64, material: &str| json!({ "type": "sphere", "center": [x, 0, 0], "radius": 0.9, "material": material });
    let plane = json!({ "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor" });
    let objects = json!([plane, ball(-3.0, "gold"), ball(-1.0, "steel"), ball(1.0, "plastic"), ball(3.0, "chalk")]);
    scene(&camera([0.5, 1.0, 8.0], [0.0, 0.0, 0.0]), &materials, &lights, &objects)
}

/// Without a light of its own; the mirror shows the shadows of the light at the eye.
fn headlight() -> Value {
    let materials =
        json!({ "mirror": { "color": 0, "reflectivity": 0.9, "specular": 0 }, "blue": { "color": [0.2, 0.3, 0.9] } });
    let objects = json!([
        { "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor" },
        { "type": "rectangle", "corner": [-3, -1, -3], "edge_u": [6, 0, -1], "edge_v": [0, 4, 0], "material": "mirror" },
        { "type": "sphere", "center": [-0.5, 0, 0], "radius": 0.7, "material": "blue" },
        { "type": "box", "min": [1, -1, -1], "max": [2, 1, -0.5], "material": "blue" }
    ]);
    scene(&camera([0.5, 1.0, 6.0], [0.0, 0.0, 0.0]), &materials, &json!([]), &objects)
}

fn textures() -> Value {
    let materials = json!({
        "small": { "color": { "texture": "small" } },
        "picture": { "color": { "texture": "picture" }, "specular": 0 },
        "glow": { "color": 0.1, "emission": { "texture": "picture" } }
    });
    let objects = json!([
        { "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor" },
        { "type": "plane", "point": [0, 0, -6], "normal": [0.2, 0.5, 1], "material": "picture" },
        { "type": "group", "transform": { "translate": [-2.4, 0, 0], "rotate": [20, 30, 10], "scale": 1.2 }, "children": [
            { "type": "box", "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5], "material": "picture" } ] },
        { "type": "sphere", "center": [-0.7, 0, 0], "radius": 0.8, "material": "picture" },
        { "type": "group", "transform": { "translate": [1, -0.2, 0], "rotate": [0, 130, 25] }, "children": [
            { "type": "sphere", "center": [0, 0, 0], "radius": 0.7, "material": "small" },
            { "type": "cylinder", "base": [0, -0.3, 1.5], "top": [0, 0.8, 1.6], "radius": 0.4, "material": "picture" },
            { "type": "cone", "base": [1, -0.6, 0], "top": [1, 0.6, 0], "radius": 0.5, "radius_top": 0.3, "material": "small" } ] },
        { "type": "disk", "center": [-1.2, 1.6, -0.5], "normal": [0, 0.3, 1], "radius": 0.7, "material": "small" },
        { "type": "rectangle", "corner": [0.2, 1, -0.5], "edge_u": [1.4, 0.2, 0.3], "edge_v": [0, 1, 0.2], "material": "picture" },
        { "type": "triangle", "vertices": [[2, 0.6, 0], [3, 0.6, 0], [2.5, 1.8, 0.3]], "uvs": [[0, 0], [2, 0], [1, 1.5]], "material": "glow" },
        { "type": "triangle", "vertices": [[-3, 1, 0], [-2, 1, 0.4], [-2.5, 2, 0]], "material": "small" },
        { "type": "mesh", "vertices": [[2, -1, 1.5], [3, -1, 1.5], [3, -0.2, 1.2], [2, -0.2, 1.4]], "triangles": [[0, 1, 2], [0, 2, 3]], "material": "small" }
    ]);
    let mut scene = scene(&camera([0.3, 0.8, 6.0], [0.0, 0.4, 0.0]), &materials, &lamp(), &objects);
    scene["textures"]["small"] = json!({ "checker": [[0.9, 0.2, 0.1], [0.1, 0.3, 0.8]], "size": 0.25 });
    scene["textures"]["picture"] = json!({ "image": "picture.png", "size": 0.8 });
    scene
}

fn glass_ball() -> Value {
    let materials = json!({
        "glass": { "transparency": 0.95, "ior": 1.5, "ambient": 0, "diffuse": 0.5, "specular": 0.5, "color": [0.9, 1, 0.9] },
        "tinted": { "transparency": [1, 0.8, 0.5], "ior": 1.33, "absorption": [0.2, 0.5, 1], "reflectivity": 0.05 }
    });
    let objects = json!([
        { "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor" },
        { "type": "sphere", "center": [-1.1, 0.1, 0], "radius": 1, "material": "glass" },
        { "type": "box", "min": [0.3, -0.9, -0.5], "max": [1.5, 0.7, 0.7], "material": "tinted" },
        { "type": "cylinder", "base": [2.3, -0.9, 0], "top": [2.3, 1, 0.2], "radius": 0.4, "material": "glass" }
    ]);
    scene(&camera([0.4, 1.2, 6.0], [0.3, 0.0, 0.0]), &materials, &lamp(), &objects)
}

/// Bodies within bodies, bodies that overlap, and an eye within.
fn nested_glass() -> Value {
    let materials = json!({
        "shell": { "transparency": 1, "ior": 1.5, "ambient": 0, "diffuse": 0, "specular": 0 },
        "core": { "transparency": 1, "ior": 1.1, "ambient": 0, "diffuse": 0, "specular": 0, "absorption": [0.6, 0.2, 0.1] },
        "heart": { "color": [0.9, 0.3, 0.3] }
    });
    let objects = json!([
        { "type": "plane", "point": [0, -2, 0], "normal": [0, 1, 0], "material": "floor" },
        { "type": "sphere", "center": [-1.2, 0, 0], "radius": 1.4, "material": "shell" },
        { "type": "sphere", "center": [-1.3, 0.1, 0.1], "radius": 0.9, "material": "core" },
        { "type": "sphere", "center": [-1.2, 0, 0], "radius": 0.4, "material": "heart" },
        { "type": "sphere", "center": [1.3, 0, 0], "radius": 0.9, "material": "shell" },
        { "type": "box", "min": [1.4, -0.7, -0.6], "max": [2.6, 0.6, 0.7], "material": "core" }
    ]);
    let mut cameras = camera([0.2, 0.6, 6.5], [0.0, -0.2, 0.0]);
    cameras["within"] = json!({ "position": [-1.0, 0.6, 0.5], "look_at": [1, -0.3, -0.5], "fov": 70 });
    cameras["overlap"] = json!({ "position": [1.7, 0.1, 0.1], "look_at": [-1, 0, 0.5], "fov": 60 });
    scene(&cameras, &materials, &lamp(), &objects)
}

fn no_fresnel() -> Value {
    let materials = json!({
        "plain": { "transparency": 0.8, "reflectivity": 0.15, "ior": 1.6, "fresnel": false, "color": [0.8, 0.9, 1] },
        "thin": { "transparency": 0.7, "ior": 1.5, "color": [1, 0.8, 0.6] },
        "plain thin": { "transparency": [0.3, 0.5, 0.7], "reflectivity": 0.2, "fresnel": false }
    });
    let objects = json!([
        { "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor" },
        { "type": "box", "min": [-2.4, -0.9, -0.6], "max": [-1, 0.8, 0.6], "material": "plain" },
        { "type": "sphere", "center": [0, 0, 0], "radius": 0.8, "material": "plain" },
        { "type": "rectangle", "corner": [1, -0.9, 1], "edge_u": [1.2, 0, -0.4], "edge_v": [0, 1.6, 0.1], "material": "thin" },
        { "type": "disk", "center": [2.2, 0, -0.6], "normal": [-0.5, 0.1, 1], "radius": 0.9, "material": "plain thin" },
        { "type": "cylinder", "base": [-0.5, -0.9, 2], "top": [0.5, -0.7, 2], "radius": 0.25, "capped": false, "material": "thin" }
    ]);
    scene(&camera([0.4, 1.0, 6.5], [0.2, 0.0, 0.0]), &materials, &lamp(), &objects)
}

/// A half-space of water seen from above and from within, things halfway in it.
fn water() -> Value {
    let materials = json!({
        "water": { "transparency": 0.9, "ior": 1.33, "ambient": 0, "diffuse": 0.1, "specular": 0.3, "absorption": [0.3, 0.1, 0.05] },
        "glass": { "transparency": 1, "ior": 1.6, "ambient": 0, "diffuse": 0, "specular": 0 },
        "red": { "color": [0.9, 0.2, 0.1] }
    });
    let objects = json!([
        { "type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "water" },
        { "type": "plane", "point": [0, -2, 0], "normal": [0, 1, 0], "material": "floor" },
        { "type": "sphere", "center": [-1, 0.1, 0], "radius": 0.8, "material": "red" },
        { "type": "sphere", "center": [1, -1, 0.5], "radius": 0.7, "material": "glass" }
    ]);
    let mut cameras = camera([0.4, 1.5, 5.0], [0.0, -0.5, 0.0]);
    cameras["within"] = json!({ "position": [0.3, -1, 4], "look_at": [0, -0.4, 0], "fov": 60 });
    scene(&cameras, &materials, &lamp(), &objects)
}

fn coloured_shadows() -> Value {
    let materials = json!({
        "red pane": { "color": [1, 0.2, 0.1], "transparency": 0.8, "fresnel": false },
        "green pane": { "color": [0.2, 1, 0.3], "transparency": [0.9, 0.8, 0.7], "ior": 1.2 },
        "checked": { "color": { "texture": "floor" }, "transparency": 0.6 },
        "opaque": { "color": [0.4, 0.4, 0.8] }
    });
    let lights = json!([
        { "type": "point", "position": [-2, 6, 3], "color": [0.6, 0.6, 0.6] },
        { "type": "directional", "direction": [-1, -3, 0.5], "color": [0.4, 0.4, 0.4] }
    ]);
    let objects = json!([
        { "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor" },
        { "type": "rectangle", "corner": [-2, 1.5, -1], "edge_u": [1.5, 0, 0.2], "edge_v": [0, 0.3, 1.5], "material": "red pane" },
        { "type": "disk", "center": [0.3, 1.2, 0], "normal": [0.1, 1, 0.2], "radius": 0.9, "material": "green pane" },
        { "type": "sphere", "center": [1.8, 0.3, 0], "radius": 0.7, "material": "green pane" },
        { "type": "rectangle", "corner": [-1, 2, -0.5], "edge_u": [3, 0.1, 0], "edge_v": [0, 0.1, 1.2], "material": "checked" },
        { "type": "cone", "base": [-1.5, -0.9, 0.5], "top": [-1.5, 0.4, 0.5], "radius": 0.4, "material": "opaque" }
    ]);
    scene(&camera([0.4, 2.0, 7.0], [0.0, 0.0, 0.0]), &materials, &lights, &objects)
}

fn mirrors() -> Value {
    let materials = json!({ "mirror": { "diffuse": 0, "ambient": 0, "specular": 0.2, "reflectivity": [0.9, 0.95, 1] }, "red": { "color": [0.9, 0.2, 0.1] } });
    let objects = json!([
        { "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor" },
        { "type": "rectangle", "corner": [-3, -1, -2], "edge_u": [6, 0, 0], "edge_v": [0, 3, 0], "material": "mirror" },
        { "type": "rectangle", "corner": [-3, -1, 7], "edge_u": [6, 0, 0.4], "edge_v": [0, 3, 0], "material": "mirror" },
        { "type": "sphere", "center": [0.8, 0, 0], "radius": 0.7, "material": "red" },
        { "type": "sphere", "center": [-1, -0.2, 0.4], "radius": 0.6, "material": "mirror" }
    ]);
    let mut scene = scene(&camera([0.4, 0.6, 5.0], [0.0, 0.0, 0.0]), &materials, &lamp(), &objects);
    scene["render"]["max_depth"] = json!(5);
    scene
}

fn near_and_far() -> Value {
    let materials = json!({ "red": { "color": [0.9, 0.2, 0.1] }, "glass": { "transparency": 1, "ior": 1.5, "ambient": 0, "diffuse": 0 } });
    let objects = json!([
        { "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor" },
        { "type": "sphere", "center": [0, 0, 3], "radius": 0.8, "material": "red" },
        { "type": "sphere", "center": [-1.2, 0, 0], "radius": 0.8, "material": "red" },
        { "type": "sphere", "center": [0.9, 0, 0.6], "radius": 0.8, "material": "glass" }
    ]);
    let cameras = json!({ "c": { "position": [0.4, 0.6, 6], "look_at": [0, 0, 0], "fov": 45, "near": 3, "far": 9 } });
    scene(&cameras, &materials, &lamp(), &objects)
}

/// A glass body whose mesh carries its own normals.
fn smooth_glass() -> Value {
    let corners =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let materials = json!({ "glass": { "transparency": 1, "ior": 1.3, "ambient": 0, "diffuse": 0, "specular": 0.4, "absorption": [0.1, 0.2, 0.4] } });
    // Normals that lean a little from the faces' own towards the corners.
    let objects = json!([
        { "type": "plane", "point": [0, -1.3, 0], "normal": [0, 1, 0], "material": "floor" },
        { "type": "group", "transform": { "rotate": [10, 25, 5] }, "children": [
            { "type": "mesh", "vertices": corners, "triangles": faces, "material": "glass" } ] },
        { "type": "triangle", "vertices": [[1.2, -1, 1], [2.6, -1, 0.6], [1.8, 0.6, 0.4]], "material": "glass",
          "normals": [[0.1, 0.2, 1], [0.4, 0.2, 1], [0.2, 0.5, 1]] }
    ]);
    scene(&camera([0.4, 1.0, 5.0], [0.3, -0.1, 0.0]), &materials, &lamp(), &objects)
}
