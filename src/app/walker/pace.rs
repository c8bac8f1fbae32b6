//! How fast one goes: a speed that fits, and what the wheel makes of it.

/// Speed is multiplied by this for each notch of the wheel.
const NOTCH: f64 = 1.1;
/// The speed stays within this factor of the usual one, either way: slower, keys would seem dead.
const MAX_FACTOR: f64 = 32.0;

/// A speed in words, of two figures: "2.4 m/s".
pub fn in_words(speed: f64) -> String {
    let digits = if speed > 0.0 { (1.0 - speed.log10().floor()).clamp(0.0, 9.0) as usize } else { 1 };
    format!("{speed:.digits$} m/s")
}

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

    /// Back to the usual speed.
    pub fn reset(&mut self) {
        self.notches = 0.0;
    }

    /// The most notches away from the usual speed, either way.
    fn most_notches() -> f64 {
        MAX_FACTOR.ln() / NOTCH.ln()
    }

    /// Sets the speed in metres a second, within the range that notches cover.
    pub fn set_speed(&mut self, speed: f64) {
        if !speed.is_nan() {
            // Without the end, 0 would be infinitely many notches away.
            let notches = (speed.max(0.0) / self.usual).ln() / NOTCH.ln();
            self.notches = notches.clamp(-Self::most_notches(), Self::most_notches());
        }
    }

    /// Changes the speed by notches of the wheel.
    pub fn scroll(&mut self, notches: f64) {
        if notches.is_finite() {
            self.notches = (self.notches + notches).clamp(-Self::most_notches(), Self::most_notches());
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
        assert!((pace.speed() / 2.0 - 1.0).abs() < 1e-12);
        pace.set_speed(3.5);
        assert!((pace.speed() - 3.5).abs() < 1e-9);
        pace.scroll(f64::NAN);
        pace.set_speed(f64::NAN);
        assert!((pace.speed() - 3.5).abs() < 1e-9);
        pace.reset();
        assert_eq!(pace.speed(), 2.0);
    }

    #[test]
    fn speeds_are_told_in_two_figures() {
        for (speed, text) in
            [(2.44, "2.4 m/s"), (0.0781, "0.078 m/s"), (12.3, "12 m/s"), (929.0, "929 m/s"), (0.0, "0.0 m/s")]
        {
            assert_eq!(in_words(speed), text);
        }
    }

    #[test]
    fn the_speed_stays_within_32_times_the_usual_one() {
        let near = |pace: Pace, speed: f64| (pace.speed() / speed - 1.0).abs() < 1e-9;
        let mut pace = Pace::new(2.0);
        (0..200).for_each(|_| pace.scroll(-1.0));
        assert!(near(pace, 2.0 / 32.0), "{pace:?}");
        // None of those beyond the end are owed.
        (0..100).for_each(|_| pace.scroll(1.0));
        assert!(near(pace, 2.0 * 32.0), "{pace:?}");
        for (speed, kept) in [(0.0, 0.0625), (-1.0, 0.0625), (1e-300, 0.0625), (f64::INFINITY, 64.0), (1e9, 64.0)] {
            pace.set_speed(speed);
            assert!(near(pace, kept), "set to {speed}: {pace:?}");
        }
    }
}
