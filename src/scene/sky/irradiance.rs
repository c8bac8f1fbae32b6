//! Irradiance by moments up to the second order.

use super::{bounded, turned};
use glam::{DMat3, DVec3, Vec3};
use std::f64::consts::TAU;

/// Irradiance over π of a surface, as a polynomial of its normal n: c + b·n + nᵀMn, with a symmetric M without a trace.
///
/// That is the projection on spherical harmonics up to order 2 (Ramamoorthi and Hanrahan, SIGGRAPH 2001), in which Lambert's cosine
/// weakens the three orders by 1, 2/3 and 1/4.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Irradiance {
    /// Colours that multiply 1, y and yy.
    pub around_y: [Vec3; 3],
    /// Colours that multiply x, z, xx, xy, yz and zx; zz is taken from 1, xx and yy.
    pub others: [Vec3; 6],
    /// Whether the latter are the same in all channels.
    pub grey: bool,
}

/// What channels may differ by, as a share of the greatest, to be one grey.
const SAME: f32 = 1e-6;

/// Directions of the quadrature, from pole to pole and around: of equal solid angles.
const ROWS: usize = 64;
const COLUMNS: usize = 128;

/// What a sky's radiance comes to in double precision, direction by direction.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    weight: f64,
    mean: DVec3,
    first: [DVec3; 3],
    /// Of the products xx, yy, zz, xy, yz, zx.
    second: [DVec3; 6],
}

impl Moments {
    /// Adds the radiance of a solid angle around a unit direction.
    pub fn add(&mut self, direction: DVec3, radiance: DVec3, weight: f64) {
        let DVec3 { x, y, z } = direction;
        let radiance = radiance * weight;
        self.weight += weight;
        self.mean += radiance;
        for (sum, factor) in self.first.iter_mut().zip([x, y, z]) {
            *sum += radiance * factor;
        }
        for (sum, factor) in self.second.iter_mut().zip([x * x, y * y, z * z, x * y, y * z, z * x]) {
            *sum += radiance * factor;
        }
    }

    /// The moments of two parts of the sky.
    pub fn and(mut self, other: &Self) -> Self {
        self.weight += other.weight;
        self.mean += other.mean;
        for (sum, other) in self.first.iter_mut().zip(other.first) {
            *sum += other;
        }
        for (sum, other) in self.second.iter_mut().zip(other.second) {
            *sum += other;
        }
        self
    }

    /// What they give matte surfaces.
    pub fn irradiance(&self) -> Irradiance {
        let weight = self.weight.max(f64::MIN_POSITIVE);
        let (mean, first, second) =
            (self.mean / weight, self.first.map(|sum| sum / weight), self.second.map(|sum| sum / weight));
        let [xx, yy, zz, xy, yz, zx] = second;
        // Of order 1: 3 · 2/3; of order 2: 5 · 1/4 · P2, whose square term is 3/2; products of two axes count twice.
        let (linear, square) = (2.0, 15.0 / 8.0);
        let third = (xx + yy + zz) / 3.0;
        let terms = [
            // nᵀMn with x² + z² + y² = 1: M's zz is taken from all three squares.
            mean + (zz - third) * square,
            first[0] * linear,
            first[1] * linear,
            first[2] * linear,
            (xx - zz) * square,
            (yy - zz) * square,
            xy * (2.0 * square),
            yz * (2.0 * square),
            zx * (2.0 * square),
        ];
        Irradiance::of_terms(terms.map(|term| term.as_vec3()))
    }
}

impl Irradiance {
    /// Of a sky with some radiance in every direction.
    pub fn of(radiance: impl Fn(DVec3) -> DVec3) -> Self {
        let mut moments = Moments::default();
        for row in 0..ROWS {
            let y = 1.0 - (2 * row + 1) as f64 / ROWS as f64;
            let across = (1.0 - y * y).sqrt();
            for column in 0..COLUMNS {
                let angle = TAU * (column as f64 + 0.5) / COLUMNS as f64;
                let direction = DVec3::new(across * libm::cos(angle), y, across * libm::sin(angle));
                moments.add(direction, radiance(direction), 1.0);
            }
        }
        moments.irradiance()
    }

    /// Of the colours that multiply 1, x, y, z, xx, yy, xy, yz, zx.
    fn of_terms(terms: [Vec3; 9]) -> Self {
        let [one, x, y, z, xx, yy, xy, yz, zx] = terms.map(bounded);
        let others = [x, z, xx, xy, yz, zx];
        let most = one.abs().max_element() * SAME;
        let grey = others.iter().all(|term| (*term - Vec3::splat(term.x)).abs().max_element() <= most);
        Self { around_y: [one, y, yy], others, grey }
    }

    fn terms(&self) -> [Vec3; 9] {
        let ([one, y, yy], [x, z, xx, xy, yz, zx]) = (self.around_y, self.others);
        [one, x, y, z, xx, yy, xy, yz, zx]
    }

    /// Irradiance over π of a surface with this unit normal.
    pub fn over_pi(&self, normal: Vec3) -> Vec3 {
        let Vec3 { x, y, z } = normal;
        let factors = [1.0, x, y, z, x * x, y * y, x * y, y * z, z * x];
        self.terms().iter().zip(factors).map(|(&term, factor)| term * factor).sum::<Vec3>().max(Vec3::ZERO)
    }

    /// That of so many times the radiance.
    pub fn scaled(&self, factor: f32) -> Self {
        Self::of_terms(self.terms().map(|term| term * factor))
    }

    /// That of the sky turned to the left about +Y by the angle of this cosine and sine.
    pub fn turned(&self, turn: [f64; 2]) -> Self {
        let back = [turn[0], -turn[1]];
        // Columns are what x, y, z of the turned sky are in the sky as it was.
        let from = DMat3::from_cols(turned(DVec3::X, back), DVec3::Y, turned(DVec3::Z, back));
        let [one, x, y, z, xx, yy, xy, yz, zx] = self.terms().map(|term| term.as_dvec3());
        let mut terms = [DVec3::ZERO; 9];
        for channel in 0..3 {
            let first = DVec3::new(x[channel], y[channel], z[channel]);
            let half = |term: DVec3| term[channel] / 2.0;
            let square = DMat3::from_cols(
                DVec3::new(xx[channel], half(xy), half(zx)),
                DVec3::new(half(xy), yy[channel], half(yz)),
                DVec3::new(half(zx), half(yz), 0.0),
            );
            let first = from.transpose() * first;
            let square = from.transpose() * square * from;
            let zz = square.z_axis.z;
            let values = [
                one[channel] + zz,
                first.x,
                first.y,
                first.z,
                square.x_axis.x - zz,
                square.y_axis.y - zz,
                2.0 * square.x_axis.y,
                2.0 * square.y_axis.z,
                2.0 * square.z_axis.x,
            ];
            for (term, value) in terms.iter_mut().zip(values) {
                term[channel] = value;
            }
        }
        Self::of_terms(terms.map(|term| term.as_vec3()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(d: DVec3) -> DVec3 {
        DVec3::new(1.0, d.y.max(0.0), (0.5 * d.x + 0.4 * d.z + 0.6 * d.x * d.y + 1.0).max(0.0))
    }

    /// Irradiance over π by a sum over directions.
    fn summed(normal: DVec3) -> DVec3 {
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for row in 0..400 {
            let y = 1.0 - (2 * row + 1) as f64 / 400.0;
            for column in 0..400 {
                let angle = TAU * column as f64 / 400.0;
                let d = DVec3::new((1.0 - y * y).sqrt() * angle.cos(), y, (1.0 - y * y).sqrt() * angle.sin());
                sum += sky(d) * d.dot(normal).max(0.0);
                weights += d.dot(normal).max(0.0);
            }
        }
        sum / weights
    }

    #[test]
    fn irradiance_is_that_of_a_sum_over_directions() {
        let irradiance = Irradiance::of(sky);
        for normal in [DVec3::X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::new(0.6, -0.48, 0.64)] {
            let difference = irradiance.over_pi(normal.as_vec3()).as_dvec3() - summed(normal);
            assert!(difference.abs().max_element() < 0.012, "{normal}: off by {difference}");
        }
    }

    #[test]
    fn a_half_white_sky_lights_by_half_of_one_plus_the_cosine() {
        let irradiance = Irradiance::of(|d| DVec3::splat(if d.y > 0.0 { 1.0 } else { 0.0 }));
        for y in [-1.0_f32, -0.5, 0.0, 0.3, 0.9, 1.0] {
            let normal = Vec3::new((1.0 - y * y).sqrt(), y, 0.0);
            assert!((irradiance.over_pi(normal).x - (1.0 + y) / 2.0).abs() < 1e-3, "{y}");
        }
    }

    #[test]
    fn turning_the_sky_turns_its_light() {
        let angle = 0.7_f64;
        let turn = [angle.cos(), angle.sin()];
        let of_turned = Irradiance::of(|d| sky(turned(d, [turn[0], -turn[1]])));
        let turned_after = Irradiance::of(sky).turned(turn);
        for (a, b) in of_turned.terms().iter().zip(turned_after.terms()) {
            assert!((*a - b).abs().max_element() < 2e-3, "{a} {b}");
        }
        // A quarter to the left brings what was ahead to the left.
        assert!((turned(DVec3::NEG_Z, [0.0, 1.0]) - DVec3::NEG_X).length() < 1e-12);
    }
}
