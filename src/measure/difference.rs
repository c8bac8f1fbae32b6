//! The difference picture: where two pictures differ, and how much.

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

/// Matplotlib's viridis at `t` in [0, 1], by Matt Zucker's polynomials of degree 6 (public domain), within 1/255
/// or so of the table. Ordered in lightness, and legible to the colour-blind.
fn viridis(t: f64) -> [u8; 3] {
    const COEFFICIENTS: [[f64; 3]; 7] = [
        [0.277_727_327_223_417_7, 0.005_407_344_544_966_578, 0.334_099_805_335_306_1],
        [0.105_093_043_108_577_4, 1.404_613_529_898_575, 1.384_590_162_594_685],
        [-0.330_861_828_725_556_3, 0.214_847_559_468_213, 0.095_095_163_028_236_59],
        [-4.634_230_498_983_486, -5.799_100_973_351_585, -19.332_440_956_279_87],
        [6.228_269_936_347_081, 14.179_933_366_805_65, 56.690_552_600_681_05],
        [4.776_384_997_670_288, -13.745_145_377_746_01, -65.353_032_633_372_34],
        [-5.435_455_855_934_631, 4.645_852_612_178_535, 26.312_435_282_494_4],
    ];
    std::array::from_fn(|channel| {
        let value = COEFFICIENTS.iter().rev().fold(0.0, |sum, c| sum * t + c[channel]);
        (value.clamp(0.0, 1.0) * 255.0).round() as u8
    })
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
