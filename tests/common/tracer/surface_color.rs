//! Texture coordinates and textures, in double precision.

use super::shapes::Surface;
use glam::{DVec2, DVec3};
use raywalk::scene::material::ColorSource;
use raywalk::scene::object::Mapping;
use raywalk::scene::texture::{ImageTexture, srgb_to_linear};
use raywalk::scene::{Object, Scene, Texture};
use std::f64::consts::{PI, TAU};

/// The colour of a surface seen by a ray that is `width` wide there, and a number that changes where the colour jumps.
pub fn look_up(
    scene: &Scene,
    object: &Object,
    primitive: u32,
    source: ColorSource,
    surface: &Surface,
    width: f64,
) -> (DVec3, i64) {
    let factor = source.factor.as_dvec3();
    let Some(lookup) = source.texture else { return (factor, 0) };
    let is_image = matches!(scene.textures[lookup.texture as usize], Texture::Image(_));
    let uv = coordinates(object, primitive, surface, is_image);
    let (color, cell) = match &scene.textures[lookup.texture as usize] {
        Texture::Checker { colors, size } => {
            let cell = (uv / f64::from(*size)).floor();
            let odd = (cell.x + cell.y).rem_euclid(2.0) != 0.0;
            (colors[usize::from(odd)].as_dvec3(), (cell.x as i64) * 1009 + cell.y as i64)
        }
        Texture::Image(image) => {
            let cell = (uv / f64::from(image.size)).floor();
            let spread = gradients(object, primitive, surface).map(|gradient| gradient.length() * width);
            (sample(image, uv / f64::from(image.size), spread), (cell.x as i64) * 1009 + cell.y as i64)
        }
    };
    (factor * color, cell)
}

/// How an image's coordinates grow along a surface, by differences.
fn gradients(object: &Object, primitive: u32, surface: &Surface) -> [DVec3; 2] {
    if let (Mapping::Vertex, Some(gradients)) = (object.mapping, surface.uv_gradients) {
        return gradients;
    }
    let mut gradients = [DVec3::ZERO; 2];
    let across = surface.geometric.any_orthonormal_vector();
    for step in [across, surface.geometric.cross(across)].map(|direction| direction * 1e-6) {
        let at = |position| coordinates(object, primitive, &Surface { position, ..*surface }, true);
        let grown = (at(surface.position + step) - at(surface.position - step)) / 2.0;
        gradients[0] += step * (grown.x / 1e-12);
        gradients[1] += step * (grown.y / 1e-12);
    }
    gradients
}

fn coordinates(object: &Object, primitive: u32, surface: &Surface, is_image: bool) -> DVec2 {
    let into = |p: DVec3| match object.world_to_object {
        None => p,
        Some(m) => {
            let [x, y, z, w] = [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis, m.translation]
                .map(|column| DVec3::new(column.x.into(), column.y.into(), column.z.into()));
            x * p.x + y * p.y + z * p.z + w
        }
    };
    let p = into(surface.position);
    // An own-space normal, by two points of the surface's own plane.
    let across = surface.geometric.any_orthonormal_vector();
    let other = surface.geometric.cross(across);
    let normal = (into(surface.position + across) - p).cross(into(surface.position + other) - p).normalize();
    // Whoever sees a surface from outside has these to the right and up.
    let upright = |n: DVec3| match n.x == 0.0 && n.z == 0.0 {
        true => DVec2::new(p.x, -p.z * n.y.signum()),
        false => {
            let right = DVec3::Y.cross(n).normalize();
            DVec2::new(p.dot(right), p.dot(n.cross(right)))
        }
    };
    match object.mapping {
        Mapping::Planar { checker, image } => {
            let [u, v] = if is_image { image } else { checker };
            DVec2::new(p.dot(u.as_dvec3()), p.dot(v.as_dvec3()))
        }
        Mapping::BoxFaces if is_image => {
            let axis = normal.abs().max_position();
            upright(DVec3::AXES[axis] * normal[axis].signum())
        }
        Mapping::BoxFaces => match normal.abs().max_position() {
            0 => DVec2::new(p.y, p.z),
            1 => DVec2::new(p.x, p.z),
            _ => DVec2::new(p.x, p.y),
        },
        Mapping::Sphere { center } => {
            let d = (p - center.as_dvec3()).normalize();
            let south = if is_image { -d.z } else { d.z };
            DVec2::new(south.atan2(d.x) / TAU + 0.5, d.y.asin() / PI + 0.5)
        }
        Mapping::Axial { base, axis } => {
            let axis = axis.as_dvec3();
            let [a, mut b] = plane_axes(axis);
            match (primitive, is_image) {
                (0, true) => b = axis.cross(a),
                (0, false) => {}
                (1, true) => return upright(-axis),
                (_, true) => return upright(axis),
                (_, false) => return DVec2::new(p.dot(a), p.dot(b)),
            }
            let from = p - base.as_dvec3();
            DVec2::new(from.dot(b).atan2(from.dot(a)) / TAU + 0.5, from.dot(axis))
        }
        Mapping::Vertex => surface.uv.unwrap_or_default(),
    }
}

/// On an axis-aligned plane the other two axes in order, else norm(Y x n) and n x that.
fn plane_axes(n: DVec3) -> [DVec3; 2] {
    match (n.x != 0.0, n.y != 0.0, n.z != 0.0) {
        (true, false, false) => [DVec3::Y, DVec3::Z],
        (false, true, false) => [DVec3::X, DVec3::Z],
        (false, false, true) => [DVec3::X, DVec3::Y],
        _ => {
            let a = DVec3::Y.cross(n).normalize();
            [a, n.cross(a)]
        }
    }
}

/// Trilinear between sizes and texel centres, repeated, v upwards. `spread` is how far apart rays are along u and v.
fn sample(image: &ImageTexture, uv: DVec2, spread: [f64; 2]) -> DVec3 {
    let [width, height] = image.texels.size(0).map(|texels| f64::from(texels) / f64::from(image.size));
    let last = image.texels.levels() - 1;
    let level = (spread[0] * width).max(spread[1] * height).log2().clamp(0.0, last as f64);
    let finer = sample_level(image, uv, level.floor() as usize);
    // Within a quarter of a size, it alone.
    let share = (level.fract() * 2.0 - 0.5).clamp(0.0, 1.0);
    finer.lerp(sample_level(image, uv, last.min(level.floor() as usize + 1)), share)
}

fn sample_level(image: &ImageTexture, uv: DVec2, level: usize) -> DVec3 {
    let [width, height] = image.texels.size(level).map(i64::from);
    let texel = |x: i64, y: i64| {
        let [x, y] = [x.rem_euclid(width), y.rem_euclid(height)].map(|place| place as u32);
        let [r, g, b, _] = image.texels.texel(level, x, y).map(srgb_to_linear);
        DVec3::new(r.into(), g.into(), b.into())
    };
    let (x, y) = (uv.x * width as f64 - 0.5, -uv.y * height as f64 - 0.5);
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let (x, y) = (x.floor() as i64, y.floor() as i64);
    let row = |y| texel(x, y) * (1.0 - fx) + texel(x + 1, y) * fx;
    row(y) * (1.0 - fy) + row(y + 1) * fy
}
