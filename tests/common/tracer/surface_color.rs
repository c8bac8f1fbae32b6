//! Texture coordinates and textures, in double precision.

use super::shapes::Surface;
use glam::{DVec2, DVec3};
use raywalk::scene::material::ColorSource;
use raywalk::scene::object::Mapping;
use raywalk::scene::texture::{ImageTexture, srgb_to_linear};
use raywalk::scene::{Object, Scene, Texture};
use std::f64::consts::{PI, TAU};

/// The colour of a surface, and a number that changes where the colour jumps.
pub fn look_up(scene: &Scene, object: &Object, primitive: u32, source: ColorSource, surface: &Surface) -> (DVec3, i64) {
    let texture = match source {
        ColorSource::Constant(color) => return (color.as_dvec3(), 0),
        ColorSource::Texture(texture) => &scene.textures[texture as usize],
    };
    let uv = coordinates(object, primitive, surface);
    match texture {
        Texture::Checker { colors, size } => {
            let cell = (uv / f64::from(*size)).floor();
            let odd = (cell.x + cell.y).rem_euclid(2.0) != 0.0;
            (colors[usize::from(odd)].as_dvec3(), (cell.x as i64) * 1009 + cell.y as i64)
        }
        Texture::Image(image) => {
            let cell = (uv / f64::from(image.size)).floor();
            (sample(image, uv / f64::from(image.size)), (cell.x as i64) * 1009 + cell.y as i64)
        }
    }
}

fn coordinates(object: &Object, primitive: u32, surface: &Surface) -> DVec2 {
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
    match object.mapping {
        Mapping::Planar { u, v } => DVec2::new(p.dot(u.as_dvec3()), p.dot(v.as_dvec3())),
        Mapping::BoxFaces => match normal.abs().max_position() {
            0 => DVec2::new(p.y, p.z),
            1 => DVec2::new(p.x, p.z),
            _ => DVec2::new(p.x, p.y),
        },
        Mapping::Sphere { center } => {
            let d = (p - center.as_dvec3()).normalize();
            DVec2::new(d.z.atan2(d.x) / TAU + 0.5, d.y.asin() / PI + 0.5)
        }
        Mapping::Axial { base, axis } => {
            let axis = axis.as_dvec3();
            let [a, b] = plane_axes(axis);
            if primitive > 0 {
                return DVec2::new(p.dot(a), p.dot(b));
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

/// Bilinear between texel centres, repeated, v upwards.
fn sample(image: &ImageTexture, uv: DVec2) -> DVec3 {
    let (width, height) = (i64::from(image.texels.width()), i64::from(image.texels.height()));
    let texel = |x: i64, y: i64| {
        let [x, y] = [x.rem_euclid(width), y.rem_euclid(height)].map(|place| place as u32);
        let [r, g, b] = image.texels.texel(x, y).map(srgb_to_linear);
        DVec3::new(r.into(), g.into(), b.into())
    };
    let (x, y) = (uv.x * width as f64 - 0.5, -uv.y * height as f64 - 0.5);
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let (x, y) = (x.floor() as i64, y.floor() as i64);
    let row = |y| texel(x, y) * (1.0 - fx) + texel(x + 1, y) * fx;
    row(y) * (1.0 - fy) + row(y + 1) * fy
}
