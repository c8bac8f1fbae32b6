//! LDR-FLIP: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A difference evaluator for
//! alternating images", Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2), 2020.
//!
//! Names and constants are the paper's. Borders repeat, and tristimulus values are relative to the display's white,
//! as in the authors' program.

use super::filter::{Plane, gaussian, normalized};
use super::{Pair, Score};
use crate::picture::srgb_decode;
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Pixels per degree of visual angle: the authors' default, a 0.7 m wide 4K display seen from 0.7 m.
const PIXELS_PER_DEGREE: f64 = 67.0;

/// Exponent of the colour difference (q_c), and the two ends of its compression (p_c, p_t).
const QC: f64 = 0.7;
const PC: f64 = 0.4;
const PT: f64 = 0.95;
/// Width of the feature filters in degrees (w), and exponent of the feature difference (q_f).
const FEATURE_WIDTH: f64 = 0.082;
const QF: f64 = 0.5;

/// Mean FLIP error, 0 to 1. Undefined for linear pairs: the metric is about what a display shows.
pub(super) fn flip(pair: &Pair) -> Score {
    if !pair.is_display() {
        return Score::Undefined;
    }
    let (width, height) = (pair.width(), pair.height());
    let a = Channels::new(width, height, pair.pixels().map(|(a, _)| a));
    let b = Channels::new(width, height, pair.pixels().map(|(_, b)| b));
    let (features_a, features_b) = (Features::of(&a.achromatic), Features::of(&b.achromatic));
    let (seen_a, seen_b) = (a.as_seen(), b.as_seen());
    let greatest = greatest_color_difference();

    let error = |i: usize| {
        let color = compress(hyab(hunt_lab(seen_a.at(i)), hunt_lab(seen_b.at(i))).powf(QC), greatest);
        let feature = features_a.difference(&features_b, i);
        color.powf(1.0 - feature)
    };
    // Row by row, so that the sum is the same whichever threads make it.
    let rows = (0..height).into_par_iter().map(|y| (y * width..(y + 1) * width).map(error).sum());
    let rows: Vec<f64> = rows.collect();
    Score::Number(rows.iter().sum::<f64>() / (width * height) as f64)
}

/// A picture in the opponent space YyCxCz.
struct Channels {
    achromatic: Plane,
    red_green: Plane,
    blue_yellow: Plane,
}

impl Channels {
    fn new(width: usize, height: usize, srgb: impl Iterator<Item = [f32; 3]>) -> Self {
        let srgb: Vec<[f32; 3]> = srgb.collect();
        let pixels: Vec<DVec3> = srgb.into_par_iter().map(opponent_of_srgb).collect();
        let values: [Vec<f32>; 3] = std::array::from_fn(|i| pixels.iter().map(|pixel| pixel[i] as f32).collect());
        let [achromatic, red_green, blue_yellow] = values.map(|values| Plane { width, height, values });
        Self { achromatic, red_green, blue_yellow }
    }

    fn at(&self, i: usize) -> DVec3 {
        let Self { achromatic, red_green, blue_yellow } = self;
        [achromatic, red_green, blue_yellow].map(|plane| f64::from(plane.values[i])).into()
    }

    /// What the eye makes of it at this distance: each channel under its contrast sensitivity.
    fn as_seen(&self) -> Self {
        Self {
            achromatic: contrast_filtered(&self.achromatic, &[(1.0, 0.0047)]),
            red_green: contrast_filtered(&self.red_green, &[(1.0, 0.0053)]),
            blue_yellow: contrast_filtered(&self.blue_yellow, &[(34.1, 0.04), (13.5, 0.025)]),
        }
    }
}

/// Applies a contrast sensitivity function: a sum of Gaussians a √(π/b) exp(-π² d² / b), d in degrees (table 1).
fn contrast_filtered(plane: &Plane, terms: &[(f64, f64)]) -> Plane {
    /// The widest b of all channels: it sets one radius for all of them.
    const WIDEST: f64 = 0.04;
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as usize;
    let kernels = terms.iter().map(|&(a, b)| {
        let sigma = (b / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE;
        let kernel = gaussian(sigma, radius);
        let sum: f64 = kernel.iter().sum();
        // In two dimensions a kernel weighs its sum squared; all terms together are normalised to 1.
        (a * (PI / b).sqrt() * sum * sum, normalized(&kernel))
    });
    let kernels: Vec<_> = kernels.collect();
    let total: f64 = kernels.iter().map(|(weight, _)| weight).sum();

    let mut seen = Plane { values: vec![0.0; plane.values.len()], ..*plane };
    for (weight, kernel) in &kernels {
        let share = (weight / total) as f32;
        let filtered = plane.filtered(kernel, kernel);
        seen.values.iter_mut().zip(filtered.values).for_each(|(sum, value)| *sum += share * value);
    }
    seen
}

/// Responses to edges and to points: first and second derivatives of a Gaussian along both axes.
struct Features {
    edge: [Plane; 2],
    point: [Plane; 2],
}

impl Features {
    fn of(achromatic: &Plane) -> Self {
        let sigma = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let radius = (3.0 * sigma).ceil() as usize;
        let across = gaussian(sigma, radius);
        let along = |derivative: &dyn Fn(f64) -> f64| {
            let weights: Vec<f64> =
                across.iter().enumerate().map(|(i, g)| derivative(i as f64 - radius as f64) * g).collect();
            balanced(&weights)
        };
        let edge = along(&|x| -x);
        let point = along(&|x| x * x / (sigma * sigma) - 1.0);
        let across = normalized(&across);
        // Y of YyCxCz runs from -16 to 100; features work on 0 to 1.
        let y = Plane::from_fn(achromatic.width, achromatic.height, |i| (achromatic.values[i] + 16.0) / 116.0);
        let both = |kernel: &[f32]| [y.filtered(kernel, &across), y.filtered(&across, kernel)];
        Self { edge: both(&edge), point: both(&point) }
    }

    /// The feature difference at pixel `i`, 0 to 1.
    fn difference(&self, other: &Self, i: usize) -> f64 {
        let strength = |planes: &[Plane; 2]| f64::from(planes[0].values[i]).hypot(f64::from(planes[1].values[i]));
        let edge = (strength(&self.edge) - strength(&other.edge)).abs();
        let point = (strength(&self.point) - strength(&other.point)).abs();
        (edge.max(point) / 2.0_f64.sqrt()).powf(QF)
    }
}

/// Weights scaled so that the positive ones sum to 1 and the negative ones to -1.
fn balanced(weights: &[f64]) -> Vec<f32> {
    let positive: f64 = weights.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = -weights.iter().filter(|w| **w < 0.0).sum::<f64>();
    weights.iter().map(|w| (if *w > 0.0 { w / positive } else { w / negative }) as f32).collect()
}

/// sRGB's primaries, the exact fractions of IEC 61966-2-1's chromaticities; columns are R, G, B.
const LINEAR_TO_XYZ: DMat3 = DMat3::from_cols(
    DVec3::new(10_135_552.0 / 24_577_794.0, 2_613_072.0 / 12_288_897.0, 1_425_312.0 / 73_733_382.0),
    DVec3::new(8_788_810.0 / 24_577_794.0, 8_788_810.0 / 12_288_897.0, 8_788_810.0 / 73_733_382.0),
    DVec3::new(4_435_075.0 / 24_577_794.0, 887_015.0 / 12_288_897.0, 70_074_185.0 / 73_733_382.0),
);
static XYZ_TO_LINEAR: LazyLock<DMat3> = LazyLock::new(|| LINEAR_TO_XYZ.inverse());
/// XYZ of linear (1, 1, 1).
static WHITE: LazyLock<DVec3> = LazyLock::new(|| LINEAR_TO_XYZ * DVec3::ONE);

/// XYZ of linear sRGB, each relative to the display's white.
fn relative_xyz(linear: DVec3) -> DVec3 {
    LINEAR_TO_XYZ * linear / *WHITE
}

/// YyCxCz of an sRGB-encoded colour (section 4.1 of the paper).
fn opponent_of_srgb(srgb: [f32; 3]) -> DVec3 {
    let linear = srgb.map(srgb_decode).map(f64::from);
    let DVec3 { x, y, z } = relative_xyz(linear.into());
    DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

/// L*a*b* of a YyCxCz colour clamped to the display's gamut, its chroma lowered in the dark (the Hunt effect).
fn hunt_lab(opponent: DVec3) -> DVec3 {
    let y = (opponent.x + 16.0) / 116.0;
    let relative = DVec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0);
    let linear = *XYZ_TO_LINEAR * (relative * *WHITE);
    hunt_lab_of_linear(linear.clamp(DVec3::ZERO, DVec3::ONE))
}

fn hunt_lab_of_linear(linear: DVec3) -> DVec3 {
    /// Where CIELAB's cube root gives way to a line.
    const DELTA: f64 = 6.0 / 29.0;
    let DVec3 { x, y, z } =
        relative_xyz(linear).map(|t| if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 });
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    DVec3::new(lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z))
}

/// The HyAB distance: city-block in lightness, Euclidean in chroma; apt for large differences.
fn hyab(a: DVec3, b: DVec3) -> f64 {
    (a.x - b.x).abs() + (a.y - b.y).hypot(a.z - b.z)
}

/// The greatest colour difference of the gamut, between green and blue, under the exponent.
fn greatest_color_difference() -> f64 {
    hyab(hunt_lab_of_linear(DVec3::Y), hunt_lab_of_linear(DVec3::Z)).powf(QC)
}

/// Maps differences below p_c of the greatest to [0, p_t], the rest to [p_t, 1]: large ones all look wrong alike.
fn compress(difference: f64, greatest: f64) -> f64 {
    let knee = PC * greatest;
    if difference < knee { PT / knee * difference } else { PT + (difference - knee) / (greatest - knee) * (1.0 - PT) }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{number, pair};
    use super::*;
    use crate::picture::{Encoding, Picture};

    #[test]
    fn black_against_white_is_nearly_one() {
        let score = number(flip(&pair(64, 64, |_, _| [0.0; 3], |_, _| [1.0; 3])));
        assert!(score > 0.95 && score <= 1.0, "{score}");
    }

    #[test]
    fn linear_pairs_have_no_flip() {
        let picture = Picture { width: 1, height: 1, pixels: vec![[0.5; 3]], encoding: Encoding::Linear };
        let pair = Pair::new(picture.clone(), picture, Encoding::Linear).expect("equal sizes");
        assert_eq!(flip(&pair), Score::Undefined);
    }
}
