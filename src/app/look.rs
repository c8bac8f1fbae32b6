//! Mouse look: raw counts to angles, with the rare absurd event left out.

use glam::DVec2;

/// Movements below this many counts are never doubted.
const TRUSTED_COUNTS: f64 = 40.0;
/// A movement this many times as long as the recent ones is taken for a glitch.
const ABSURD_FACTOR: f64 = 8.0;

/// Drops single movements far out of line: drivers and pointer warps make them now and then, and each
/// would throw the view around. Fast turns pass, as every one of them is more than a single event.
#[derive(Debug, Default)]
pub struct SpikeFilter {
    typical: f64,
}

impl SpikeFilter {
    /// The movement to use: `delta` in counts, or zero for a glitch.
    pub fn pass(&mut self, delta: DVec2) -> DVec2 {
        let length = delta.length();
        if !length.is_finite() {
            return DVec2::ZERO;
        }
        let absurd = length > ABSURD_FACTOR * self.typical.max(TRUSTED_COUNTS);
        // What is dropped still counts as seen, so that the second of two long movements is believed.
        self.typical = 0.5 * (self.typical + length);
        if absurd { DVec2::ZERO } else { delta }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_spike_among_small_movements_is_dropped() {
        let mut filter = SpikeFilter::default();
        for i in 0..50 {
            let small = DVec2::new(if i % 2 == 0 { 40.0 } else { -40.0 }, 3.0);
            assert_eq!(filter.pass(small), small);
        }
        assert_eq!(filter.pass(DVec2::new(400.0, 0.0)), DVec2::ZERO);
        assert_eq!(filter.pass(DVec2::new(12.0, 0.0)), DVec2::new(12.0, 0.0));
        assert_eq!(filter.pass(DVec2::new(f64::NAN, 0.0)), DVec2::ZERO);
    }

    #[test]
    fn a_fast_turn_passes() {
        let mut filter = SpikeFilter::default();
        let passed: f64 = (0..10).map(|_| filter.pass(DVec2::new(500.0, 0.0)).x).sum();
        assert!(passed >= 9.0 * 500.0, "{passed}");
    }
}
