//! How fast one goes: a speed that fits, and what the wheel makes of it.

/// Speed is multiplied by this for each notch of the wheel.
const NOTCH: f64 = 1.1;
/// Most notches away from the usual speed, either way: hundreds of millions of times, yet never zero.
const MAX_NOTCHES: f64 = 200.0;

/// A speed that can be changed and always comes back.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Metres a second at no notch.
    usual: f64,
    notches: f64,
}

impl Pace {
    /// Starts at `usual` metres a second, above 0.
    pub fn new(usual: f64) -> Self {
        Self { usual, notches: 0.0 }
    }

    /// Another usual speed, as many notches away.
    pub fn set_usual(&mut self, usual: f64) {
        self.usual = usual;
    }

    /// Metres a second.
    pub fn speed(&self) -> f64 {
        self.usual * NOTCH.powf(self.notches)
    }

    /// Sets the speed in metres a second, within the range that notches cover.
    pub fn set_speed(&mut self, speed: f64) {
        if !speed.is_nan() {
            // Without the end, 0 would be infinitely many notches away.
            let notches = (speed.max(0.0) / self.usual).ln() / NOTCH.ln();
            self.notches = notches.clamp(-MAX_NOTCHES, MAX_NOTCHES);
        }
    }

    /// Changes the speed by notches of the wheel.
    pub fn scroll(&mut self, notches: f64) {
        if notches.is_finite() {
            self.notches = (self.notches + notches).clamp(-MAX_NOTCHES, MAX_NOTCHES);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wheel_multiplies_and_comes_back() {
        let mut pace = Pace::new(2.0);
        pace.scroll(1.0);
        assert!((pace.speed() / 2.0 - 1.1).abs() < 1e-12);
        pace.scroll(-1.0);
        (0..200).for_each(|_| pace.scroll(-1.0));
        assert!(pace.speed() > 0.0);
        (0..200).for_each(|_| pace.scroll(1.0));
        assert!((pace.speed() / 2.0 - 1.0).abs() < 1e-9);
        (0..1000).for_each(|_| pace.scroll(5.0));
        assert!(pace.speed().is_finite());
        pace.set_speed(3.5);
        assert!((pace.speed() - 3.5).abs() < 1e-9);
        let slowest = 2.0 * NOTCH.powf(-MAX_NOTCHES);
        for speed in [0.0, -1.0, 1e-300] {
            pace.set_speed(speed);
            assert_eq!(pace.speed(), slowest, "set to {speed}");
        }
        pace.scroll(f64::NAN);
        pace.set_speed(f64::NAN);
        assert!(pace.speed() > 0.0);
    }
}
