//! Families of nasty scenes, each after one way of deciding about many pixels at once.

use super::aimed;
use super::graze::{self, Graze, Maker};
use super::receiver::Receiver;
use super::stage::Stage;
use super::view::Ray;
use crate::random::Random;
use crate::stress::{any_shape, triple, with_material};
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

/// One way to make scenes.
pub struct Family {
    pub name: &'static str,
    /// How many of them a normal run tries.
    pub scenes: u64,
    /// Adds to a stage.
    pub compose: fn(&mut Random, &mut Stage),
}

/// All of them.
pub const FAMILIES: &[Family] = &[
    Family { name: "spheres", scenes: 300, compose: |random, stage| before_the_eye(random, stage, graze::SPHERES) },
    Family { name: "triangles", scenes: 300, compose: |random, stage| before_the_eye(random, stage, graze::TRIANGLES) },
    Family { name: "boxes", scenes: 300, compose: |random, stage| before_the_eye(random, stage, graze::BOXES) },
    Family { name: "disks", scenes: 300, compose: |random, stage| before_the_eye(random, stage, graze::DISKS) },
    Family { name: "cones", scenes: 300, compose: |random, stage| before_the_eye(random, stage, graze::CONES) },
    Family { name: "planes", scenes: 300, compose: |random, stage| before_the_eye(random, stage, graze::PLANES) },
    Family { name: "rivals", scenes: 300, compose: rivals },
    Family { name: "near and far", scenes: 300, compose: near_and_far },
    Family { name: "crowds", scenes: 60, compose: crowds },
    Family { name: "shadows", scenes: 300, compose: shadows },
    Family { name: "reflections", scenes: 300, compose: reflections },
    Family { name: "aimed", scenes: 300, compose: aimed::compose },
    Family { name: "mixed", scenes: 150, compose: mixed },
];

/// A scene of a family.
pub fn compose(family: &Family, random: &mut Random) -> Value {
    let mut stage = Stage::new(random);
    (family.compose)(random, &mut stage);
    stage.to_json()
}

/// Two rays of the eye at borders of blocks.
fn of_the_eye(random: &mut Random, stage: &Stage) -> Graze {
    let rays = stage.view.line(random).map(|place| stage.view.ray(place));
    let span = random.pick(&[[0.1, 10.0], [1.0, 1.0], [1e-3, 1e3]]).map(|t| t * stage.view.unit);
    Graze { rays, span, pixel: stage.view.pixel() }
}

/// Shapes of some makers whose outlines are rays of the eye.
fn before_the_eye(random: &mut Random, stage: &mut Stage, makers: &[Maker]) {
    for _ in 0..random.below(5) + 1 {
        let touch = of_the_eye(random, stage).touch(random);
        let object = random.pick(makers)(random, &touch);
        stage.add_any(random, object);
    }
    background(random, stage);
    some_light(random, stage);
}

/// Nothing, something behind everything, or enough small things to make a tree worth it.
fn background(random: &mut Random, stage: &mut Stage) {
    let unit = stage.view.unit;
    match random.below(4) {
        0 => {
            let distance = unit * random.magnitude(0.0, 2.0);
            let wall = Receiver::facing(random, &stage.view, distance);
            let object = wall.to_json(random, unit);
            stage.add_any(random, object);
        }
        1 => {
            let (center, radius) = (triple(stage.view.eye()), unit * random.magnitude(0.0, 3.0));
            stage.add_any(random, json!({ "type": "sphere", "center": center, "radius": radius }));
        }
        2 => filler(random, stage),
        _ => {}
    }
}

/// Small things all over the picture.
fn filler(random: &mut Random, stage: &mut Stage) {
    let makers = [graze::SPHERES, graze::TRIANGLES, graze::CONES, graze::DISKS];
    let makers = random.pick(&makers);
    for _ in 0..random.below(40) + 20 {
        let touch = of_the_eye(random, stage).touch(random);
        let object = random.pick(makers)(random, &touch);
        stage.objects.push(object);
    }
}

/// Most often none but that at the eye: no time for shadows.
fn some_light(random: &mut Random, stage: &mut Stage) {
    if random.chance(0.3) {
        stage.lights.push(json!({ "type": "directional", "direction": triple(random.direction()) }));
        stage.depth = random.below(4) as u32 + 1;
    }
}

/// How far apart two things are that are all but in the same place, as a share of their size.
fn all_but_nothing(random: &mut Random) -> f64 {
    if random.chance(0.3) { 0.0 } else { random.sign() * random.magnitude(-8.0, -2.0) }
}

/// A surface over many pixels and others all but as far away: the same once more, crossing it, touching it, breaking
/// through it with a tip.
fn rivals(random: &mut Random, stage: &mut Stage) {
    let unit = stage.view.unit;
    let distance = unit * random.magnitude(-1.0, 1.0);
    let surface = Receiver::any(random, &stage.view, distance);
    let object = surface.to_json(random, unit);
    stage.add_any(random, object.clone());
    for _ in 0..random.below(4) + 1 {
        let [p, q] = stage.view.line(random).map(|place| surface.meet(stage.view.ray(place)));
        let (Some((p, normal)), Some((q, _))) = (p, q) else { continue };
        let off = normal * all_but_nothing(random) * distance;
        let size = distance * random.magnitude(-3.0, 1.0);
        let rival = match random.below(6) {
            0 => object.clone(),
            1 => surface.moved(all_but_nothing(random) * distance).to_json(random, unit),
            2 => {
                let tilted = normal + random.direction() * random.magnitude(-7.0, -1.0);
                Receiver::Flat { point: p.lerp(q, 0.5) + off, normal: tilted.normalize() }.to_json(random, unit)
            }
            3 => {
                let center = p + normal * size * random.sign() + off;
                json!({ "type": "sphere", "center": triple(center), "radius": size })
            }
            4 => {
                let [a, b] = [(); 2].map(|()| random.direction() * size - normal * size);
                let corners = [p + off, p + a, p + b].map(triple);
                json!({ "type": "triangle", "vertices": corners })
            }
            _ => {
                let [a, b] = [p + off, q + off].map(triple);
                let third = p + normal.cross(q - p).normalize_or(normal) * size + off;
                json!({ "type": "triangle", "vertices": [a, b, triple(third)] })
            }
        };
        stage.add_any(random, rival);
    }
    if random.chance(0.3) {
        filler(random, stage);
    }
    some_light(random, stage);
}

/// The picture's nearest and farthest distance are those of something.
fn near_and_far(random: &mut Random, stage: &mut Stage) {
    let eye = stage.view.eye();
    for makers in [graze::any(random), graze::any(random), graze::any(random)] {
        let touch = of_the_eye(random, stage).touch(random);
        let object = makers(random, &touch);
        stage.add_any(random, object);
        let distance = (touch.ends[0].distance(eye) * (1.0 + all_but_nothing(random) * 1e-3)) as f32;
        let camera = &mut stage.view.camera;
        match random.below(4) {
            0 if distance > camera.near => camera.far = distance,
            1 | 2 if distance < camera.far => camera.near = distance,
            _ => {}
        }
    }
    background(random, stage);
}

/// More things within few pixels than any list is long.
fn crowds(random: &mut Random, stage: &mut Stage) {
    let span = random.pick(&[[1.0, 1.0], [0.5, 2.0], [0.99, 1.01]]).map(|t| t * stage.view.unit);
    let line = stage.view.line(random);
    let spread = random.magnitude(-2.0, 1.5);
    let maker = graze::any(random);
    let material = random.pick(&["matte", "matte", "shiny", "glass"]);
    for _ in 0..random.below(400) + 50 {
        let rays = line.map(|place| {
            let off = DVec2::new(random.within(-spread, spread), random.within(-spread, spread));
            stage.view.ray(place + off)
        });
        let touch = Graze { rays, span, pixel: stage.view.pixel() }.touch(random);
        let object = with_material(maker(random, &touch), material);
        stage.objects.push(object);
    }
    // Brute force takes long.
    stage.view.size = (stage.view.size.0.min(67), stage.view.size.1.min(40));
}

/// Blockers whose shadows' borders are borders of blocks.
fn shadows(random: &mut Random, stage: &mut Stage) {
    let unit = stage.view.unit;
    let distance = unit * random.magnitude(-0.5, 0.5);
    let ground = Receiver::any(random, &stage.view, distance);
    let object = ground.to_json(random, unit);
    stage.add_any(random, object);
    for _ in 0..random.below(3) + 1 {
        let [p, q] = stage.view.line(random).map(|place| ground.meet(stage.view.ray(place)));
        let (Some((p, normal)), Some((q, _))) = (p, q) else { continue };
        let (light, graze) = light_over(random, stage, [p, q], normal);
        stage.lights.push(light);
        for _ in 0..random.below(3) + 1 {
            let touch = graze.touch(random);
            let blocker = graze::any(random)(random, &touch);
            stage.add_any(random, blocker);
        }
    }
    if random.chance(0.2) {
        filler(random, stage);
    }
    stage.depth = random.pick(&[1, 1, 1, 3]);
}

/// A light that shines on two points of a surface, and the rays from there to the light.
fn light_over(random: &mut Random, stage: &Stage, [p, q]: [DVec3; 2], normal: DVec3) -> (Value, Graze) {
    let middle = p.lerp(q, 0.5);
    let unit = stage.view.unit;
    let tilt = random.pick(&[0.0, 1.0, 1.0, 30.0]);
    let up = (normal + random.direction() * tilt).normalize_or(normal);
    let pixel = stage.view.pixel() * middle.distance(stage.view.eye());
    if random.chance(0.3) {
        let rays = [p, q].map(|origin| Ray { origin, direction: up * unit });
        let light = json!({ "type": "directional", "direction": triple(-up) });
        return (light, Graze { rays, span: [1e-5, 10.0], pixel });
    }
    let place = match random.below(6) {
        // On the surface, or next to it.
        0 => p + normal * unit * random.pick(&[0.0, 1e-6, -1e-6]),
        1 => middle + normal * unit * random.magnitude(-6.0, -2.0),
        2 => stage.view.eye() + random.direction() * unit * random.pick(&[0.0, 1e-6, 0.01]),
        _ => middle + up * unit * random.magnitude(-1.0, 2.0),
    };
    let rays = [p, q].map(|origin| Ray { origin, direction: place - origin });
    let graze = Graze { rays, span: random.pick(&[[0.1, 0.9], [1e-6, 1.0], [0.999, 1.001]]), pixel };
    let axis = middle - place;
    if random.chance(0.3) && axis.length() > 0.0 {
        // The cone's border runs through the point.
        let outer = axis.angle_between(p - place).to_degrees().clamp(0.001, 90.0);
        let spot = json!({ "type": "spot", "position": triple(place), "direction": triple(axis),
                           "outer_angle": outer, "inner_angle": outer * random.pick(&[0.0, 0.5, 1.0]) });
        return (spot, graze);
    }
    (json!({ "type": "point", "position": triple(place) }), graze)
}

/// Things whose mirror images' outlines are borders of blocks.
fn reflections(random: &mut Random, stage: &mut Stage) {
    let unit = stage.view.unit;
    let distance = unit * random.magnitude(-0.5, 0.5);
    let mirror = Receiver::any(random, &stage.view, distance);
    let material = random.pick(&["mirror", "mirror", "mirror", "shiny", "glass", "steel"]);
    let object = with_material(mirror.to_json(random, unit), material);
    stage.add(random, object);
    for _ in 0..random.below(4) + 1 {
        let sight = stage.view.line(random).map(|place| stage.view.ray(place));
        let [p, q] = sight.map(|ray| mirror.meet(ray).map(|(point, normal)| (ray, point, normal)));
        let (Some(p), Some(q)) = (p, q) else { continue };
        let rays = [p, q]
            .map(|(ray, origin, normal)| Ray { origin, direction: ray.direction.reflect(normal).normalize() * unit });
        let pixel = stage.view.pixel() * p.1.distance(stage.view.eye());
        let span = random.pick(&[[0.1, 10.0], [1e-6, 1.0], [1.0, 1e3]]);
        let touch = Graze { rays, span, pixel }.touch(random);
        let object = graze::any(random)(random, &touch);
        stage.add_any(random, object);
    }
    if random.chance(0.2) {
        filler(random, stage);
    }
    some_light(random, stage);
    stage.depth = random.below(4) as u32 + 2;
}

/// Two or three other families over each other, and things that nobody aimed.
fn mixed(random: &mut Random, stage: &mut Stage) {
    for _ in 0..random.below(2) + 2 {
        let others = &FAMILIES[..FAMILIES.len() - 2];
        (others[random.below(others.len())].compose)(random, stage);
    }
    for _ in 0..random.below(8) {
        let (eye, unit) = (stage.view.eye(), stage.view.unit);
        let shape = any_shape(random, DVec3::ZERO);
        let place = json!({ "translate": triple(eye + random.direction() * unit), "scale": unit });
        stage.add(random, json!({ "type": "group", "transform": place, "children": [shape] }));
    }
}
