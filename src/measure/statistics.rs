//! Order statistics of a run.

use serde::Serialize;

/// The value below which the share `q` (0 to 1) of `sorted` lies, interpolated linearly between the two nearest
/// ranks (NumPy's default); `None` for no values. 999 frames of 8 ms and one of 200 ms have a p99 of 8 ms.
pub fn percentile(sorted: &[f64], q: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let rank = q.clamp(0.0, 1.0) * last as f64;
    let (below, above) = (sorted[rank.floor() as usize], sorted[rank.ceil() as usize]);
    Some(below + (above - below) * rank.fract())
}

/// How a run's frames spread. All zero for no frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Least.
    pub min: f64,
    /// Half lie below.
    pub median: f64,
    /// 95 % lie below.
    pub p95: f64,
    /// 99 % lie below.
    pub p99: f64,
    /// Greatest.
    pub max: f64,
}

impl Spread {
    /// The spread of `values`, in any order.
    pub fn of(values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |q| percentile(&sorted, q).unwrap_or_default();
        Self { min: at(0.0), median: at(0.5), p95: at(0.95), p99: at(0.99), max: at(1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_interpolate_between_ranks() {
        assert_eq!(percentile(&[], 0.5), None);
        assert_eq!(percentile(&[7.0], 0.99), Some(7.0));
        assert_eq!(percentile(&[1.0, 2.0, 3.0, 4.0], 0.5), Some(2.5));
        assert_eq!(percentile(&[0.0, 10.0], 0.95), Some(9.5));
    }

    #[test]
    fn one_slow_frame_in_a_thousand_shows_in_the_maximum_only() {
        let mut frames = vec![8.0; 999];
        frames.insert(500, 200.0);
        assert_eq!(Spread::of(&frames), Spread { min: 8.0, median: 8.0, p95: 8.0, p99: 8.0, max: 200.0 });
        assert_eq!(Spread::of(&[]), Spread::default());
    }
}
