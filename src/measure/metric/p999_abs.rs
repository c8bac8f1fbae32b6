//! The difference that one value in a thousand exceeds.

use super::{Pair, Score};
use crate::measure::statistics::percentile;

/// The 99.9th percentile of the differences of all channels of all pixels.
pub(super) fn p999_abs(pair: &Pair) -> Score {
    let mut differences: Vec<f64> = pair.differences().flatten().collect();
    differences.sort_by(f64::total_cmp);
    percentile(&differences, 0.999).map_or(Score::Undefined, Score::Number)
}
