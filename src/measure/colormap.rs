//! Colours for numbers.

/// Matplotlib's viridis at `t` in [0, 1], by Matt Zucker's polynomials of degree 6 (public domain), within 1/255
/// or so of the table. Ordered in lightness, and legible to the colour-blind.
pub fn viridis(t: f64) -> [u8; 3] {
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
    use super::viridis;

    #[test]
    fn it_grows_lighter_from_dark_violet_to_yellow() {
        let lightness =
            |t: f64| viridis(t).map(f64::from).iter().zip([0.21, 0.72, 0.07]).map(|(c, w)| c * w).sum::<f64>();
        assert!((0..20).all(|i| lightness(f64::from(i) / 20.0) < lightness(f64::from(i + 1) / 20.0)));
        assert!(viridis(0.0)[1] < 10 && viridis(1.0)[0] > 240);
    }
}
