//! `{ "translate": [0, 1, 0], "rotate": [0, 45, 0], "scale": 2 }` or `{ "matrix": [16 numbers, column by column] }`

use super::Context;
use super::map::Map;
use super::node::{Kind, Node};
use super::problem::{Outcome, Problem};
use super::value::{number, tuple, vector};
use glam::{DAffine3, DMat3, DVec3};

/// Reads an affine map: translation · rotation about the parent's x, then y, then z · scale, or a matrix.
pub fn read<'t, N: Node<'t>>(node: N, context: &mut Context) -> Outcome<DAffine3> {
    let mut map = Map::open(node)?;
    let transform = match map.optional("matrix", matrix)? {
        Some(matrix) => matrix,
        None => {
            let translation = map.or("translate", DVec3::ZERO, vector)?;
            let rotation = map.or("rotate", DVec3::ZERO, vector)?;
            let scale = map.or("scale", DVec3::ONE, scale)?;
            let linear = rotation_degrees(rotation) * DMat3::from_diagonal(scale);
            DAffine3 { matrix3: linear, translation }
        }
    };
    let determinant = transform.matrix3.determinant();
    if determinant == 0.0 || !determinant.is_finite() || !transform.inverse().is_finite() {
        return Err(Problem::new(
            map.at(),
            "the transform flattens what it moves; its scale must differ from 0 along every axis",
        ));
    }
    map.finish(&mut context.warnings);
    Ok(transform)
}

fn scale<'t>(node: impl Node<'t>) -> Outcome<DVec3> {
    match node.kind() {
        Kind::Number => number(node).map(DVec3::splat),
        Kind::List => vector(node),
        _ => Err(node.mismatch("a number or a list of 3 numbers")),
    }
}

fn matrix<'t>(node: impl Node<'t>) -> Outcome<DAffine3> {
    let m: [f64; 16] = tuple(node)?;
    if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
        return Err(Problem::new(node.at(), "the matrix's last row must be 0, 0, 0, 1 (numbers 4, 8, 12 and 16)"));
    }
    let column = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
    Ok(DAffine3::from_cols(column(0), column(4), column(8), column(12)))
}

/// Rotation about the parent's x, then y, then z axis, in degrees.
fn rotation_degrees(degrees: DVec3) -> DMat3 {
    let (sx, cx) = sin_cos_degrees(degrees.x);
    let (sy, cy) = sin_cos_degrees(degrees.y);
    let (sz, cz) = sin_cos_degrees(degrees.z);
    let x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, cx, sx), DVec3::new(0.0, -sx, cx));
    let y = DMat3::from_cols(DVec3::new(cy, 0.0, -sy), DVec3::Y, DVec3::new(sy, 0.0, cy));
    let z = DMat3::from_cols(DVec3::new(cz, sz, 0.0), DVec3::new(-sz, cz, 0.0), DVec3::Z);
    z * y * x
}

/// Sine and cosine, exact at the multiples of 90 degrees: what was aligned to the axes stays aligned.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let reduced = degrees % 360.0;
    let quarter = (reduced / 90.0).round();
    let rest = (reduced - quarter * 90.0).to_radians();
    let (sin, cos) = (libm::sin(rest), libm::cos(rest));
    match quarter.rem_euclid(4.0) as u32 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact_and_others_match_the_library() {
        assert_eq!(sin_cos_degrees(90.0), (1.0, -0.0));
        assert_eq!(sin_cos_degrees(-180.0).1, -1.0);
        assert_eq!(sin_cos_degrees(720.0), (0.0, 1.0));
        for degrees in [-1000.5, -50.0, 30.0, 44.9, 45.1, 200.0, 359.0_f64] {
            let (sin, cos) = sin_cos_degrees(degrees);
            let radians = degrees.to_radians();
            assert!((sin - radians.sin()).abs() < 1e-12 && (cos - radians.cos()).abs() < 1e-12, "{degrees}");
        }
    }

    #[test]
    fn turns_about_x_before_y_before_z() {
        // y goes to z about x, z goes to x about y, x goes to y about z.
        let turned = rotation_degrees(DVec3::splat(90.0)) * DVec3::Y;
        assert_eq!(turned.to_array().map(|v| v.round()), [0.0, 1.0, 0.0]);
        let turned = rotation_degrees(DVec3::new(90.0, 90.0, 0.0)) * DVec3::Y;
        assert_eq!(turned.to_array().map(|v| v + 0.0), [1.0, 0.0, 0.0]);
    }
}
