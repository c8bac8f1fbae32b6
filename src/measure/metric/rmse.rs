//! Root mean square error.

use super::{Pair, Score};

/// The root of the mean squared difference over all channels of all pixels.
pub(super) fn rmse(pair: &Pair) -> Score {
    Score::Number(pair.mean_squared_error().sqrt())
}
