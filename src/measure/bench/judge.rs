//! How wrong a method's picture is.

use crate::measure::difference::difference_picture;
use crate::measure::metric::{METRICS, Pair, Score, metric};
use crate::measure::records::{FrameError, WRONG_SHARE};
use crate::picture::EightBit;
use std::collections::BTreeMap;

/// Differences of more than so many steps of 255 are seen: as in the metric `pixels_off`.
const SEEN: u8 = 2;

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
    let wrong = visibly_wrong(reference, picture);
    let counted = counts.iter().filter(|counts| **counts).count();
    let seen = wrong.iter().zip(counts).filter(|(wrong, counts)| **wrong && **counts).count();
    let share = (counted > 0).then(|| 100.0 * seen as f64 / counted as f64);
    BTreeMap::from([(WRONG_SHARE.to_owned(), share)])
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
    /// Which pixels of the last frame were wrong.
    wrong: Option<Vec<bool>>,
}

impl Frames {
    /// Takes the next frame.
    pub fn judge(&mut self, reference: &EightBit, picture: &EightBit) -> FrameError {
        let wrong = visibly_wrong(reference, picture);
        let changed = |before: &Vec<bool>| before.iter().zip(&wrong).filter(|(a, b)| a != b).count();
        let pops = self.wrong.as_ref().map_or(0, changed) as f64;
        let pixels_off = wrong.iter().filter(|wrong| **wrong).count() as f64;
        self.wrong = Some(wrong);
        // Equal pictures need no metric to say so.
        let pair = if reference == picture { None } else { pair(reference, picture) };
        let score = |name: &str| {
            let metric = metric(name);
            let score = pair.as_ref().zip(metric).map(|(pair, metric)| (metric.score)(pair));
            score.and_then(Score::number).unwrap_or_default()
        };
        let (rmse, p999_abs) = (score("rmse"), score("p999_abs"));
        FrameError { rmse, p999_abs, pixels_off, pops }
    }
}

fn visibly_wrong(reference: &EightBit, picture: &EightBit) -> Vec<bool> {
    let pixels = reference.rgb.chunks_exact(3).zip(picture.rgb.chunks_exact(3));
    pixels.map(|(a, b)| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > SEEN)).collect()
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
    fn shares_count_the_pixels_that_count() {
        let (a, b) = (picture(&[0, 0, 0, 0]), picture(&[9, 9, 1, 0]));
        assert_eq!(by_share(&a, &b, &[true, false, true, false])[WRONG_SHARE], Some(50.0));
        assert_eq!(by_share(&a, &b, &[false; 4])[WRONG_SHARE], None);
    }

    #[test]
    fn pops_are_pixels_that_come_to_be_wrong_or_cease_to() {
        let reference = picture(&[0, 0, 0, 0]);
        let mut frames = Frames::default();
        let first = frames.judge(&reference, &picture(&[9, 0, 0, 0]));
        let second = frames.judge(&reference, &picture(&[0, 9, 9, 0]));
        assert_eq!((first.pixels_off, first.pops), (1.0, 0.0));
        assert_eq!((second.pixels_off, second.pops), (2.0, 3.0));
    }
}
