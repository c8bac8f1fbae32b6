//! Structural similarity: Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error visibility to
//! structural similarity", IEEE Transactions on Image Processing 13(4), 2004.

use super::filter::{Plane, gaussian, normalized};
use super::{Pair, Score};

/// The paper's window: 11 x 11, a Gaussian of 1.5 pixels.
const RADIUS: usize = 5;
const SIGMA: f64 = 1.5;
/// The paper's stabilisers (K L)² with K1 = 0.01, K2 = 0.03 and a range L of 1.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// Mean SSIM of luma (Rec. 601 weights on the encoded values, as the authors' program), over the pixels whose
/// whole window lies in the picture. Undefined for pictures smaller than the window.
pub(super) fn ssim(pair: &Pair) -> Score {
    let (width, height) = (pair.width(), pair.height());
    if width.min(height) < 2 * RADIUS + 1 {
        return Score::Undefined;
    }
    // Variances are differences of large numbers where light is bright: single precision would leave nothing of them.
    let plane = |values: Vec<f64>| Plane { width, height, values };
    let a = plane(pair.pixels().map(|(a, _)| luma(a)).collect());
    let b = plane(pair.pixels().map(|(_, b)| luma(b)).collect());

    let window = normalized(&gaussian(SIGMA, RADIUS));
    let mean = |value: &dyn Fn(usize) -> f64| Plane::from_fn(width, height, value).filtered(&window, &window);
    let mean_a = a.filtered(&window, &window).values;
    let mean_b = b.filtered(&window, &window).values;
    let mean_aa = mean(&|i| a.values[i] * a.values[i]).values;
    let mean_bb = mean(&|i| b.values[i] * b.values[i]).values;
    let mean_ab = mean(&|i| a.values[i] * b.values[i]).values;

    let at = |i: usize| {
        let (ma, mb) = (mean_a[i], mean_b[i]);
        let (variance_a, variance_b) = ((mean_aa[i] - ma * ma).max(0.0), (mean_bb[i] - mb * mb).max(0.0));
        // What rounding leaves keeps to Cauchy and Schwarz, and so the score to -1 to 1.
        let most = (variance_a * variance_b).sqrt();
        let covariance = (mean_ab[i] - ma * mb).clamp(-most, most);
        let luminance = (2.0 * ma * mb + C1) / (ma * ma + mb * mb + C1);
        let structure = (2.0 * covariance + C2) / (variance_a + variance_b + C2);
        luminance * structure
    };
    let (mut sum, mut count) = (0.0, 0_u64);
    for y in RADIUS..height - RADIUS {
        for x in RADIUS..width - RADIUS {
            sum += at(y * width + x);
            count += 1;
        }
    }
    Score::Number(sum / count as f64)
}

fn luma(rgb: [f32; 3]) -> f64 {
    let [r, g, b] = rgb.map(f64::from);
    0.299 * r + 0.587 * g + 0.114 * b
}
