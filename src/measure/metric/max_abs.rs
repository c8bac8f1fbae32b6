//! The greatest difference.

use super::{Pair, Score};

/// The greatest difference of any channel of any pixel: averages hide one lost wire, this does not.
pub(super) fn max_abs(pair: &Pair) -> Score {
    Score::Number(pair.differences().flatten().fold(0.0, f64::max))
}
