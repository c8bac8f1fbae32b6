//! How many pixels are visibly wrong.

use super::{Pair, Score};

/// Errors of more than so many steps of an 8-bit channel are seen.
pub const SEEN_STEPS: u8 = 2;

/// That, and a rounding error's room: a difference of exactly two steps is not "more".
const THRESHOLD: f64 = SEEN_STEPS as f64 / 255.0 + 1e-6;

/// The number of pixels with any channel off by more than 2/255.
pub(super) fn pixels_off(pair: &Pair) -> Score {
    Score::Count(pair.differences().filter(|d| d.iter().any(|&d| d > THRESHOLD)).count() as u64)
}

#[cfg(test)]
mod tests {
    use super::super::tests::pair;
    use super::*;

    #[test]
    fn exactly_two_steps_do_not_count_and_three_do() {
        for base in 0..=252_u8 {
            let byte = |b: u8| f32::from(b) / 255.0;
            let at = |steps: u8| {
                pixels_off(&pair(1, 1, |_, _| [0.0, byte(base), 0.0], |_, _| [0.0, byte(base + steps), 0.0]))
            };
            assert_eq!((at(2), at(3)), (Score::Count(0), Score::Count(1)), "{base}");
        }
    }
}
