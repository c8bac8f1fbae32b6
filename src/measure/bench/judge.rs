//! How wrong a method's picture is.

use crate::measure::difference::difference_picture;
use crate::measure::metric::{METRICS, Pair, Score, metric};
use crate::measure::pops::{Pops, Seen, is_visibly_wrong};
use crate::measure::records::{FrameError, WRONG_SHARE};
use crate::picture::EightBit;
use std::collections::BTreeMap;

/// Errors of `picture` by every metric.
pub fn by_metrics(reference: &EightBit, picture: &EightBit) -> BTreeMap<String, Option<f64>> {
    // Pictures that are equal have the same errors whatever they show, so they are told by the smallest of them.
    let pair = if reference == picture {
        let black = EightBit { width: 16, height: 16, rgb: vec![0; 3 * 16 * 16] };
        pair(&black, &black)
    } else {
        pair(reference, picture)
    };
    let scores = METRICS.iter().map(|metric| {
        let score = pair.as_ref().map_or(Score::Undefined, |pair| (metric.score)(pair));
        (metric.name.to_owned(), score.number())
    });
    scores.collect()
}

/// The share of pixels that are visibly wrong, in per cent of those that count; `None` where none does.
pub fn by_share(reference: &EightBit, picture: &EightBit, counts: &[bool]) -> BTreeMap<String, Option<f64>> {
    let counted = counts.iter().filter(|counts| **counts).count();
    let seen = visibly_wrong(reference, picture).zip(counts).filter(|(wrong, counts)| *wrong && **counts).count();
    let share = (counted > 0).then(|| 100.0 * seen as f64 / counted as f64);
    BTreeMap::from([(WRONG_SHARE.to_owned(), share)])
}

/// Errors of several pictures as one: of greatest errors the greatest, of roots and logarithms of a mean that of the mean,
/// of all others the mean. What no picture has a value of has none.
pub fn of_all(pictures: &[BTreeMap<String, Option<f64>>]) -> BTreeMap<String, Option<f64>> {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let of = |name: &str| -> Vec<f64> { pictures.iter().filter_map(|errors| errors.get(name).copied()?).collect() };
    let squared = || mean(&of("rmse").iter().map(|rmse| rmse * rmse).collect::<Vec<_>>());
    let all = |name: &String| {
        let values = of(name);
        let value = match name.as_str() {
            "max_abs" | "p999_abs" => values.iter().copied().fold(0.0, f64::max),
            "rmse" => squared().sqrt(),
            "psnr" => -10.0 * libm::log10(squared()),
            _ => mean(&values),
        };
        (name.clone(), Some(value).filter(|_| !values.is_empty()))
    };
    match pictures {
        [alone] => alone.clone(),
        _ => pictures.first().map(|errors| errors.keys().map(all).collect()).unwrap_or_default(),
    }
}

/// The map of a picture's errors; `None` where it has none.
pub fn error_map(reference: &EightBit, picture: &EightBit) -> Option<EightBit> {
    if reference == picture {
        return None;
    }
    pair(reference, picture).map(|pair| difference_picture(&pair))
}

/// Errors of frame after frame.
#[derive(Default)]
pub struct Frames {
    followed: Pops,
}

impl Frames {
    /// Takes the next frame.
    pub fn judge(&mut self, reference: &EightBit, picture: &EightBit) -> FrameError {
        let Seen { pixels_off, pops } = self.followed.add(visibly_wrong(reference, picture));
        // Equal pictures need no metric to say so.
        let pair = if reference == picture { None } else { pair(reference, picture) };
        let score = |name: &str| {
            let metric = metric(name);
            let score = pair.as_ref().zip(metric).map(|(pair, metric)| (metric.score)(pair));
            score.and_then(Score::number).unwrap_or_default()
        };
        let (rmse, p999_abs) = (score("rmse"), score("p999_abs"));
        FrameError { rmse, p999_abs, pixels_off: pixels_off as f64, pops: pops as f64 }
    }
}

/// Which pixels are visibly wrong.
fn visibly_wrong<'a>(reference: &'a EightBit, picture: &'a EightBit) -> impl Iterator<Item = bool> + 'a {
    picture.rgb.chunks_exact(3).zip(reference.rgb.chunks_exact(3)).map(|(a, b)| is_visibly_wrong(a, b))
}

/// `None` for pictures of different sizes, which no bench makes.
fn pair(a: &EightBit, b: &EightBit) -> Option<Pair> {
    Pair::of_eight_bit(a, b).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(values: &[u8]) -> EightBit {
        EightBit { width: values.len() as u32, height: 1, rgb: values.iter().flat_map(|v| [*v; 3]).collect() }
    }

    #[test]
    fn equal_pictures_are_exact_and_have_no_map() {
        let a = picture(&[1, 2, 3, 4]);
        let errors = by_metrics(&a, &a);
        assert_eq!((errors["max_abs"], errors["psnr"], errors["ssim"]), (Some(0.0), None, Some(1.0)));
        assert_eq!(error_map(&a, &a), None);
    }

    #[test]
    fn errors_along_a_path_are_those_of_all_its_pixels() {
        let (exact, wrong) = (picture(&[0, 0, 0, 0]), picture(&[51, 0, 0, 0]));
        let errors = [by_metrics(&exact, &exact), by_metrics(&exact, &wrong)];
        let all = of_all(&errors);
        let rmse = 0.2 / 8.0_f64.sqrt();
        let near = |name: &str, wanted: f64| assert!((all[name].expect("it has") - wanted).abs() < 1e-6, "{name}");
        near("rmse", rmse);
        near("psnr", -20.0 * rmse.log10());
        near("max_abs", 0.2);
        near("pixels_off", 0.5);
        assert_eq!(of_all(&errors[..1]), errors[0]);
        assert_eq!(of_all(&[errors[0].clone(), errors[0].clone()])["psnr"], None);
    }

    #[test]
    fn shares_count_the_pixels_that_count() {
        let (a, b) = (picture(&[0, 0, 0, 0]), picture(&[9, 9, 1, 0]));
        assert_eq!(by_share(&a, &b, &[true, false, true, false])[WRONG_SHARE], Some(50.0));
        assert_eq!(by_share(&a, &b, &[false; 4])[WRONG_SHARE], None);
    }
}
