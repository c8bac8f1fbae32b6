//! The difference picture: where two pictures differ, and how much.

use super::colormap::viridis;
use super::metric::Pair;
use crate::picture::EightBit;

/// One step of an 8-bit channel: the least scale, so that equal pictures come out dark instead of undefined.
const LEAST_SCALE: f64 = 1.0 / 255.0;

/// A map of each pixel's greatest channel difference in viridis colours: dark violet is 0, yellow is the greatest
/// difference of the pair (the metric `max_abs`), or 1/255 where that is less.
pub fn difference_picture(pair: &Pair) -> EightBit {
    let differences: Vec<f64> = pair.differences().map(|d| d.into_iter().fold(0.0, f64::max)).collect();
    let scale = differences.iter().copied().fold(LEAST_SCALE, f64::max);
    let rgb = differences.iter().flat_map(|d| viridis(d / scale)).collect();
    EightBit { width: pair.width() as u32, height: pair.height() as u32, rgb }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Encoding, Picture};

    fn pair(b: Vec<[f32; 3]>) -> Pair {
        let picture = |pixels| Picture { width: 2, height: 1, pixels, encoding: Encoding::Srgb };
        Pair::new(picture(vec![[0.5; 3]; 2]), picture(b), Encoding::Srgb).expect("equal sizes")
    }

    #[test]
    fn the_greatest_difference_is_yellow_and_none_is_dark() {
        let picture = difference_picture(&pair(vec![[0.5; 3], [0.5, 0.75, 0.5]]));
        assert_eq!(picture.rgb.len(), 6);
        let (dark, bright) = (&picture.rgb[..3], &picture.rgb[3..]);
        assert!(dark[0] < 80 && dark[1] < 10 && dark[2] < 100, "{dark:?}");
        assert!(bright[0] > 240 && bright[1] > 220 && bright[2] < 60, "{bright:?}");
    }

    #[test]
    fn equal_pictures_are_dark_all_over() {
        let picture = difference_picture(&pair(vec![[0.5; 3]; 2]));
        assert!(picture.rgb[0] < 80);
        assert_eq!(picture.rgb[..3], picture.rgb[3..]);
    }
}
