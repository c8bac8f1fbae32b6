//! Peak signal-to-noise ratio.

use super::{Pair, Score};

/// 10 log10(1 / MSE) in dB, the peak being 1. Undefined (infinite) for equal pictures, as JSON knows no infinity.
pub(super) fn psnr(pair: &Pair) -> Score {
    let mse = pair.mean_squared_error();
    if mse > 0.0 { Score::Number(-10.0 * mse.log10()) } else { Score::Undefined }
}
