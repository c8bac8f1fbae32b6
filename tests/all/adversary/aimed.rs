//! Things first, then an eye in the worst places: at corners, on edges, in the plane of faces, on and in spheres, on
//! axes, looking along what is flat there. Lights go to the same places.

use super::stage::Stage;
use crate::random::Random;
use crate::stress::triple;
use glam::DVec3;
use serde_json::{Value, json};

/// Three points of a tangent plane of something: corners, points of an axis or a side, the centre and the rim.
type Facet = [DVec3; 3];

/// Things that touch each other, an eye and a few lights in their tangent planes.
pub fn compose(random: &mut Random, stage: &mut Stage) {
    let unit = stage.view.unit;
    // Most are along the axes, so that many numbers are exact.
    let along_axes = random.chance(0.5);
    let origin = stage.view.eye();
    let [x, y] = if along_axes { [DVec3::X, DVec3::Y] } else { [random.direction(), random.direction()] };
    let mut facets = vec![[origin, origin + x * unit, origin + y * unit]];
    for _ in 0..random.below(9) + 2 {
        let facet = random.pick(&facets);
        let size = unit * random.pick(&[1.0, 0.5, 2.0, 0.1, 10.0, 1e-3, 1e3]);
        let (object, new) = thing(random, facet, size, along_axes);
        stage.add_any(random, object);
        facets.extend(new);
    }
    aim(random, stage, &facets);
    for _ in 0..random.below(3) {
        let facet = random.pick(&facets);
        let at = triple(around(random, facet, unit));
        let to = triple((facet[1] - facet[0]).normalize_or(DVec3::Y));
        stage.lights.push(match random.below(4) {
            0 => json!({ "type": "directional", "direction": to }),
            1 => json!({ "type": "spot", "position": at, "direction": to, "outer_angle": random.pick(&[45.0, 90.0, 10.0]) }),
            _ => json!({ "type": "point", "position": at }),
        });
    }
    stage.depth = random.below(4) as u32 + 1;
}

/// Turns the camera to where it sees facets from their own planes.
fn aim(random: &mut Random, stage: &mut Stage, facets: &[Facet]) {
    for _ in 0..20 {
        let facet = random.pick(facets);
        let mut camera = stage.view.camera;
        camera.eye = around(random, facet, stage.view.unit).as_vec3();
        let other = if random.chance(0.6) { facet } else { random.pick(facets) };
        camera.look_at = around(random, other, stage.view.unit).as_vec3();
        let anyhow = random.direction();
        let up = random.pick(&[facet[1] - facet[0], facet[2] - facet[0], DVec3::Y, anyhow]);
        camera.up = up.normalize_or(DVec3::Y).as_vec3();
        if camera.is_valid() {
            stage.view.camera = camera;
            return;
        }
    }
}

/// A point of a facet's plane with simple coordinates, or one all but in it.
fn around(random: &mut Random, [a, b, c]: Facet, unit: f64) -> DVec3 {
    const SHARES: [f64; 9] = [0.0, 0.0, 0.0, 1.0, 0.5, -1.0, 2.0, 3.0, -3.0];
    let (u, v) = (random.pick(&SHARES), random.pick(&SHARES));
    let point = a + (b - a) * u + (c - a) * v;
    let normal = (b - a).cross(c - a).normalize_or(DVec3::Y);
    match random.below(3) {
        0 => point + normal * unit * random.sign() * random.magnitude(-7.0, 0.5),
        _ => point,
    }
}

/// Something whose corner, edge or tangent plane is given by a facet of what is there already, and its own facets.
fn thing(random: &mut Random, facet: Facet, size: f64, along_axes: bool) -> (Value, Vec<Facet>) {
    let [a, b, c] = facet;
    let normal = (b - a).cross(c - a).normalize_or(DVec3::Z) * random.sign();
    let side = (b - a).normalize_or(DVec3::X);
    let across = normal.cross(side);
    match random.below(10) {
        0 | 1 => {
            let center = a + normal * size * random.pick(&[1.0, 1.0, 0.0, -1.0]);
            let (top, bottom) = (center + across * size, center - normal * size);
            (
                json!({ "type": "sphere", "center": triple(center), "radius": size }),
                vec![
                    [bottom, bottom + side * size, bottom + across * size],
                    [top, top + side * size, top + normal * size],
                    [center, center + side * size, center + normal * size],
                ],
            )
        }
        2 => (json!({ "type": "plane", "point": triple(a), "normal": triple(normal) }), vec![facet]),
        3 => {
            let third = a + across * size;
            let facet = [a, a + side * size, third];
            (json!({ "type": "triangle", "vertices": facet.map(triple) }), vec![facet])
        }
        4 => {
            let needle = [a, a + side * size, a + (side + normal * random.magnitude(-7.0, -1.0)) * size];
            (json!({ "type": "triangle", "vertices": needle.map(triple) }), vec![needle])
        }
        5 => {
            let facet = [a, a + side * size, a + across * size];
            let object = json!({ "type": "disk", "center": triple(a), "normal": triple(normal), "radius": size });
            let rim = a + side * size;
            (object, vec![facet, [rim, rim + across * size, rim + normal * size]])
        }
        6 | 7 => {
            let axis = random.pick(&[side, normal, across]);
            let radius = size * random.pick(&[1.0, 0.5, 1e-2, 1e-5]);
            let (u, top) = (axis.any_orthonormal_vector() * radius, a + axis * size);
            let radius_top = radius * random.pick(&[1.0, 1.0, 0.0, 0.5]);
            let object = json!({ "type": "cone", "base": triple(a), "top": triple(top), "radius": radius,
                                 "radius_top": radius_top, "capped": random.chance(0.6) });
            let rim = top + u * (radius_top / radius);
            (object, vec![[a, top, a + u], [a + u, rim, a + u + axis.cross(u)], [top, rim, top + axis.cross(u)]])
        }
        8 => {
            let object = json!({ "type": "rectangle", "corner": triple(a), "edge_u": triple(side * size),
                                 "edge_v": triple(across * size) });
            (object, vec![[a, a + side * size, a + across * size]])
        }
        _ if !along_axes => {
            let fan: Vec<[usize; 3]> = (1..8).map(|i| [0, i, i + 1]).collect();
            let tip = |i: i32| a + (side * f64::from(i - 4) + across * 3.0) * size;
            let vertices: Vec<Value> = std::iter::once(a).chain((0..8).map(tip)).map(triple).collect();
            (json!({ "type": "mesh", "vertices": vertices, "triangles": fan }), vec![[a, tip(0), tip(1)]])
        }
        _ => {
            let (min, max) = (a.min(a + DVec3::splat(size)), a + DVec3::splat(size));
            let object = json!({ "type": "box", "min": triple(min), "max": triple(max) });
            let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * size);
            (object, vec![[min, min + x, min + y], [min, min + y, min + z], [max, max - x, max - z]])
        }
    }
}
