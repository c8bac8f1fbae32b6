//! Error metrics: two pictures to one number.
//!
//! Values are those of [`Pair`]: a channel's full range is 1. To add a metric, add its file and one row to [`METRICS`].

mod filter;
mod flip;
mod max_abs;
mod p999_abs;
mod pixels_off;
mod psnr;
mod rmse;
mod ssim;

pub use pixels_off::SEEN_STEPS;

use crate::picture::{EightBit, Encoding, Picture};
use serde::Serialize;
use std::fmt;

/// Two pictures of one size and one encoding.
#[derive(Clone, Debug)]
pub struct Pair {
    a: Picture,
    b: Picture,
}

/// Two pictures that cannot be compared pixel by pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the pictures differ in size: {}x{} and {}x{}", a.0, a.1, b.0, b.1)]
pub struct SizesDiffer {
    /// Width and height of the first.
    pub a: (u32, u32),
    /// Width and height of the second.
    pub b: (u32, u32),
}

impl Pair {
    /// Brings both pictures to `encoding`: sRGB for what a viewer sees, clamped to [0, 1]; linear for light itself,
    /// unbounded.
    ///
    /// # Errors
    /// [`SizesDiffer`].
    pub fn new(a: Picture, b: Picture, encoding: Encoding) -> Result<Self, SizesDiffer> {
        if (a.width, a.height) != (b.width, b.height) {
            return Err(SizesDiffer { a: (a.width, a.height), b: (b.width, b.height) });
        }
        Ok(Self { a: a.encoded_as(encoding), b: b.encoded_as(encoding) })
    }

    /// What a display shows of two pictures of 8 bits.
    ///
    /// # Errors
    /// [`SizesDiffer`].
    pub fn of_eight_bit(a: &EightBit, b: &EightBit) -> Result<Self, SizesDiffer> {
        let picture = |picture: &EightBit| Picture {
            width: picture.width,
            height: picture.height,
            pixels: picture.rgb.as_chunks::<3>().0.iter().map(|rgb| rgb.map(|v| f32::from(v) / 255.0)).collect(),
            encoding: Encoding::Srgb,
        };
        Self::new(picture(a), picture(b), Encoding::Srgb)
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.a.width as usize
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.a.height as usize
    }

    /// Whether the values are what a viewer sees, sRGB-encoded in [0, 1].
    fn is_display(&self) -> bool {
        self.a.encoding == Encoding::Srgb
    }

    /// The pixels of both pictures, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = ([f32; 3], [f32; 3])> + '_ {
        self.a.pixels.iter().copied().zip(self.b.pixels.iter().copied())
    }

    /// |a - b| of every channel, pixel by pixel.
    pub fn differences(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.pixels().map(|(a, b)| std::array::from_fn(|i| (f64::from(a[i]) - f64::from(b[i])).abs()))
    }

    /// Mean squared difference over all channels of all pixels.
    fn mean_squared_error(&self) -> f64 {
        let sum: f64 = self.differences().flatten().map(|d| d * d).sum();
        sum / (3 * self.a.pixels.len()) as f64
    }
}

/// What a metric says of a pair. In JSON a number, or `null` where the metric is undefined.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Score {
    /// How many.
    Count(u64),
    /// How much; finite.
    Number(f64),
    /// The metric has no value for this pair; its file says when.
    Undefined,
}

impl Score {
    /// The value, if there is one.
    pub fn number(self) -> Option<f64> {
        match self {
            Self::Count(count) => Some(count as f64),
            Self::Number(number) => Some(number),
            Self::Undefined => None,
        }
    }
}

impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(n) => write!(f, "{n}"),
            Self::Number(x) => write!(f, "{x:.6}"),
            Self::Undefined => f.write_str("-"),
        }
    }
}

/// One metric.
pub struct Metric {
    /// Its name on the command line and in records.
    pub name: &'static str,
    /// One line of help: unit, range, which way is better.
    pub help: &'static str,
    /// What it says of equal pictures, the best there is: infinity for psnr.
    pub best: f64,
    /// Computes it.
    pub score: fn(&Pair) -> Score,
}

impl Metric {
    /// Whether higher values are better.
    pub fn is_higher_better(&self) -> bool {
        self.best > 0.0
    }
}

/// Looks a metric up by its name.
pub fn metric(name: &str) -> Option<&'static Metric> {
    METRICS.iter().find(|metric| metric.name == name)
}

/// Every metric, in the order in which they are printed.
pub const METRICS: &[Metric] = &[
    Metric {
        name: "psnr",
        help: "dB against a peak of 1, higher is better; none for equal pictures",
        best: f64::INFINITY,
        score: psnr::psnr,
    },
    Metric { name: "rmse", help: "root mean square difference of all channels, 0 to 1", best: 0.0, score: rmse::rmse },
    Metric { name: "max_abs", help: "greatest difference of any channel, 0 to 1", best: 0.0, score: max_abs::max_abs },
    Metric {
        name: "p999_abs",
        help: "99.9th percentile of all channels' differences",
        best: 0.0,
        score: p999_abs::p999_abs,
    },
    Metric { name: "ssim", help: "structural similarity of luma, 1 for equal pictures", best: 1.0, score: ssim::ssim },
    Metric {
        name: "flip",
        help: "mean LDR-FLIP at 67 pixels a degree, 0 to 1; none with --hdr",
        best: 0.0,
        score: flip::flip,
    },
    Metric {
        name: "pixels_off",
        help: "pixels with any channel off by more than 2/255",
        best: 0.0,
        score: pixels_off::pixels_off,
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// A pair of sRGB pictures made by a function of (x, y).
    pub(super) fn pair(
        width: u32,
        height: u32,
        a: impl Fn(u32, u32) -> [f32; 3],
        b: impl Fn(u32, u32) -> [f32; 3],
    ) -> Pair {
        let picture = |value: &dyn Fn(u32, u32) -> [f32; 3]| Picture {
            width,
            height,
            pixels: (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| value(x, y)).collect(),
            encoding: Encoding::Srgb,
        };
        Pair::new(picture(&a), picture(&b), Encoding::Srgb).expect("equal sizes")
    }

    /// The number in a score.
    pub(super) fn number(score: Score) -> f64 {
        match score {
            Score::Number(x) => x,
            other => panic!("expected a number, found {other:?}"),
        }
    }

    #[test]
    fn equal_pictures_have_no_error_by_any_metric() {
        let wave = |x: u32, y: u32| [x as f32 / 40.0, y as f32 / 30.0, ((x * y) % 7) as f32 / 7.0];
        let same = pair(40, 30, wave, wave);
        for metric in METRICS {
            let expected = match metric.name {
                "psnr" => Score::Undefined,
                "pixels_off" => Score::Count(0),
                "ssim" => Score::Number(1.0),
                _ => Score::Number(0.0),
            };
            assert_eq!((metric.score)(&same), expected, "{}", metric.name);
        }
    }

    #[test]
    fn every_metric_notices_a_small_spot_and_is_symmetric() {
        let gray = |_, _| [0.5; 3];
        let spot = |x, y| if (20..22).contains(&x) && (15..17).contains(&y) { [1.0, 0.5, 0.5] } else { [0.5; 3] };
        let (ab, ba) = (pair(40, 30, gray, spot), pair(40, 30, spot, gray));
        for metric in METRICS {
            let (score, swapped) = ((metric.score)(&ab), (metric.score)(&ba));
            assert_eq!(score, swapped, "{}", metric.name);
            assert_ne!(score, (metric.score)(&pair(40, 30, gray, gray)), "{}", metric.name);
        }
    }

    #[test]
    fn known_values_of_a_uniform_difference() {
        let off = pair(20, 20, |_, _| [0.4; 3], |_, _| [0.5; 3]);
        let score = |name| (METRICS.iter().find(|m| m.name == name).expect("listed").score)(&off);
        assert!((number(score("psnr")) - 20.0).abs() < 1e-5);
        assert!((number(score("rmse")) - 0.1).abs() < 1e-6);
        assert!((number(score("max_abs")) - 0.1).abs() < 1e-6);
        assert!((number(score("p999_abs")) - 0.1).abs() < 1e-6);
        assert_eq!(score("pixels_off"), Score::Count(400));
    }

    /// The three pairs of the golden values below.
    fn golden_pairs() -> [Pair; 3] {
        let a = |x: u32, y: u32| [4 * x % 256, 5 * y % 256, 3 * (x ^ y) % 256].map(|v| v as f32 / 255.0);
        let edges = move |x, y| if x < 48 { a(x, y) } else { a(x, y).map(|v| 1.0 - v) };
        let noise = move |x, y| {
            let step = ((x * 7 + y * 13) % 11) as f32 - 5.0;
            a(x, y).map(|v| (v + step / 100.0).clamp(0.0, 1.0))
        };
        let shift = move |x, y| a((x + 95) % 96, y);
        [pair(96, 64, a, edges), pair(96, 64, a, noise), pair(96, 64, a, shift)]
    }

    /// Values of the published programs, `pip install flip-evaluator==1.7 scikit-image`:
    ///
    /// ```python
    /// import numpy as np, flip_evaluator as flip
    /// from skimage.metrics import structural_similarity as ssim
    /// x, y = np.meshgrid(np.arange(96), np.arange(64))
    /// a = np.stack([4*x % 256, 5*y % 256, 3*(x ^ y) % 256], 2).astype(np.float32) / 255
    /// edges = a.copy(); edges[:, 48:] = 1 - a[:, 48:]
    /// noise = np.clip(a + ((x*7 + y*13) % 11 - 5)[..., None] / 100, 0, 1).astype(np.float32)
    /// shift = np.roll(a, 1, 1)
    /// luma = lambda p: p @ np.array([.299, .587, .114])
    /// for b in edges, noise, shift:
    ///     print(flip.evaluate(a, b, "LDR", applyMagma=False)[1], ssim(luma(a), luma(b), data_range=1,
    ///           gaussian_weights=True, sigma=1.5, use_sample_covariance=False))
    /// ```
    #[test]
    fn flip_and_ssim_agree_with_the_published_programs() {
        let golden = [(0.506_181, 0.354_734), (0.038_455, 0.725_874), (0.124_750, 0.904_360)];
        for (pair, (expected_flip, expected_ssim)) in golden_pairs().iter().zip(golden) {
            let (flip, ssim) = (number(flip::flip(pair)), number(ssim::ssim(pair)));
            assert!((flip - expected_flip).abs() < 1e-4, "FLIP {flip}, expected {expected_flip}");
            assert!((ssim - expected_ssim).abs() < 1e-4, "SSIM {ssim}, expected {expected_ssim}");
        }
    }

    #[test]
    fn similarity_of_bright_light_stays_a_similarity() {
        let bright = |level: f32, noise: f32| Picture {
            width: 24,
            height: 24,
            pixels: (0..24 * 24).map(|i| [level + noise * ((i * 7 % 11) as f32 - 5.0); 3]).collect(),
            encoding: Encoding::Linear,
        };
        for level in [1.0, 3000.0, 1e6, 1e30] {
            let pair = Pair::new(bright(level, 0.0), bright(level, 0.1), Encoding::Linear).expect("equal sizes");
            let score = number(ssim::ssim(&pair));
            assert!((-1.0..=1.0).contains(&score), "{level}: {score}");
            let same = Pair::new(bright(level, 0.1), bright(level, 0.1), Encoding::Linear).expect("equal sizes");
            assert_eq!(number(ssim::ssim(&same)), 1.0, "{level}");
        }
    }

    #[test]
    fn pictures_of_other_sizes_are_refused_with_both_sizes() {
        let picture =
            |width| Picture { width, height: 1, pixels: vec![[0.0; 3]; width as usize], encoding: Encoding::Srgb };
        let error = Pair::new(picture(2), picture(3), Encoding::Srgb).expect_err("sizes differ");
        assert_eq!(error.to_string(), "the pictures differ in size: 2x1 and 3x1");
    }

    #[test]
    fn names_are_unique() {
        for (i, metric) in METRICS.iter().enumerate() {
            assert!(METRICS[..i].iter().all(|m| m.name != metric.name), "{} twice", metric.name);
        }
    }
}
