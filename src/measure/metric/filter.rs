//! Separable filters over one channel.

use rayon::prelude::*;
use std::iter::Sum;
use std::ops::{AddAssign, Mul};

/// What planes hold: `f32`, or `f64` where differences of large values count.
pub(super) trait Real: Copy + Default + Send + Sync + AddAssign + Mul<Output = Self> + Sum {
    /// The value nearest to `value`.
    fn nearest(value: f64) -> Self;
}

impl Real for f32 {
    fn nearest(value: f64) -> Self {
        value as f32
    }
}

impl Real for f64 {
    fn nearest(value: f64) -> Self {
        value
    }
}

/// One channel of a picture, row by row.
#[derive(Clone, Debug)]
pub(super) struct Plane<T = f32> {
    pub width: usize,
    pub height: usize,
    pub values: Vec<T>,
}

impl<T: Real> Plane<T> {
    /// A plane of `f(i)` for each pixel index `i`.
    pub fn from_fn(width: usize, height: usize, f: impl Fn(usize) -> T) -> Self {
        Self { width, height, values: (0..width * height).map(f).collect() }
    }

    /// Correlates rows with `horizontal` and columns with `vertical`, both of odd length and centred; pixels beyond
    /// the border repeat the border's.
    pub fn filtered(&self, horizontal: &[T], vertical: &[T]) -> Self {
        let rows = self.map_rows(|y, row| {
            let source = &self.values[y * self.width..][..self.width];
            let radius = horizontal.len() / 2;
            let inner = radius.min(self.width)..self.width.saturating_sub(radius).max(radius.min(self.width));
            for x in (0..inner.start).chain(inner.end..self.width) {
                row[x] = taps(horizontal, x, self.width, |i| source[i]);
            }
            // Weight by weight: loops over neighbours become vector code.
            for (tap, weight) in horizontal.iter().enumerate() {
                let sources = source.get(tap..).unwrap_or_default();
                row[inner.clone()].iter_mut().zip(sources).for_each(|(sum, value)| *sum += *weight * *value);
            }
        });
        rows.map_rows(|y, row| {
            let radius = vertical.len() / 2;
            for (tap, weight) in vertical.iter().enumerate() {
                let line = (y + tap).saturating_sub(radius).min(self.height - 1);
                let source = &rows.values[line * self.width..][..self.width];
                row.iter_mut().zip(source).for_each(|(sum, value)| *sum += *weight * *value);
            }
        })
    }

    fn map_rows(&self, fill: impl Fn(usize, &mut [T]) + Sync) -> Self {
        let mut values = vec![T::default(); self.values.len()];
        values.par_chunks_mut(self.width).enumerate().for_each(|(y, row)| fill(y, row));
        Self { values, ..*self }
    }
}

/// The weighted sum of the values around `center`, clamped to `0..len`.
fn taps<T: Real>(weights: &[T], center: usize, len: usize, value: impl Fn(usize) -> T) -> T {
    let radius = weights.len() / 2;
    let index = |tap: usize| (center + tap).saturating_sub(radius).min(len - 1);
    weights.iter().enumerate().map(|(tap, weight)| *weight * value(index(tap))).sum()
}

/// exp(-x² / 2σ²) for x from `-radius` to `radius`, in pixels; not normalised.
pub(super) fn gaussian(sigma: f64, radius: usize) -> Vec<f64> {
    let radius = radius as i64;
    (-radius..=radius).map(|x| (-((x * x) as f64) / (2.0 * sigma * sigma)).exp()).collect()
}

/// The weights divided by their sum, as the filter takes them.
pub(super) fn normalized<T: Real>(weights: &[f64]) -> Vec<T> {
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|w| T::nearest(w / sum)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_keeps_a_flat_plane_and_moves_a_point_where_its_weights_say() {
        let weights = normalized::<f64>(&gaussian(1.5, 5));
        let flat = Plane { width: 3, height: 2, values: vec![0.25; 6] };
        assert!(flat.filtered(&weights, &weights).values.iter().all(|v| (v - 0.25_f64).abs() < 1e-12));

        let mut point = Plane { width: 5, height: 4, values: vec![0.0; 20] };
        point.values[5 + 2] = 1.0;
        let moved = point.filtered(&[1.0, 0.0, 0.0], &[0.0, 0.0, 1.0]);
        let expected = moved.values.iter().position(|&v| v == 1.0);
        assert_eq!(expected, Some(3), "one to the right, one up: a correlation");
    }

    #[test]
    fn borders_repeat() {
        let ramp = Plane { width: 3, height: 1, values: vec![0.0, 1.0, 2.0] };
        assert_eq!(ramp.filtered(&[1.0, 0.0, 0.0], &[1.0]).values, [0.0, 0.0, 1.0]);
        assert_eq!(ramp.filtered(&[0.0, 0.0, 1.0], &[1.0]).values, [1.0, 2.0, 2.0]);
    }
}
