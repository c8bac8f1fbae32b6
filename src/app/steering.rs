//! What a moving picture gives up for speed: first the preset, then the render scale, as far as measured frame times ask.
//!
//! A pure function of these times. Down it goes when two frames in a row took too long; up again when for a while every
//! frame left room for what the level above is expected to cost. Between both lies a margin, and a rise that failed makes
//! the next one wait longer: so it settles.

use super::lowering::Lowering;

/// Edge of the traced picture as a share of the window's, level by level.
const SCALES: [f32; 8] = [1.0, 0.85, 0.7, 0.6, 0.5, 0.42, 0.35, 0.25];
/// Frames in a row that must be too slow: one alone may be the system's fault.
const SLOW_FRAMES: u32 = 2;
/// A fall aims at this share of the time that there is, a rise at that one.
const FALL_TO: f64 = 0.9;
const RISE_TO: f64 = 0.8;
/// Frames in a row with room for the level above, before a rise: at first, and at most.
const ROOM_FRAMES: u32 = 12;
const MOST_ROOM_FRAMES: u32 = 192;
/// A rise that is taken back within so many frames has failed.
const TRIAL_FRAMES: u32 = 30;
/// What the preset above is expected to cost where that was never measured, against the one below.
const USUAL_RATIO: f64 = 2.0;

/// Chooses the level.
#[derive(Clone, Debug, Default)]
pub struct Steering {
    /// Presets to fall back to, best picture first.
    presets: Vec<&'static str>,
    level: usize,
    /// Of each preset, the time that the level above took against its own.
    ratios: Vec<f64>,
    /// The time of the last frame before the last fall by one preset, until its ratio is known.
    before_fall: Option<f64>,
    /// Frames since the level changed.
    frames: u32,
    /// Frames in a row that were too slow, or left room for the level above.
    slow: u32,
    roomy: u32,
    /// Frames with room that the next rise takes.
    patience: u32,
    rose: bool,
}

impl Steering {
    /// Starts with nothing given up. `presets` are those that are faster than what was chosen.
    pub fn new(presets: Vec<&'static str>) -> Self {
        let ratios = vec![USUAL_RATIO; presets.len()];
        Self { presets, ratios, patience: ROOM_FRAMES, ..Self::default() }
    }

    /// What the next frame gives up: nothing at rest. A new movement begins as the last one ended.
    pub fn lowering(&self, is_moving: bool) -> Lowering {
        if is_moving { self.at(self.level) } else { Lowering::NONE }
    }

    /// Takes the time of a frame at `level`, which should be within `target`, both in milliseconds.
    pub fn measured(&mut self, level: usize, milliseconds: f64, target: f64) {
        if level != self.level {
            return;
        }
        self.frames += 1;
        let slow = milliseconds > target;
        self.slow = if slow { self.slow + 1 } else { 0 };
        // The first frame of a level has caches to fill: what it took says little of the others.
        if self.frames == 1 {
            return;
        }
        if let Some(before) = self.before_fall.take() {
            self.ratios[level - 1] = before / milliseconds.max(1e-3);
        }
        let roomy = !slow && level > 0 && milliseconds * self.cost_of_rise() <= RISE_TO * target;
        self.roomy = if roomy { self.roomy + 1 } else { 0 };
        if self.slow >= SLOW_FRAMES && level + 1 < self.levels() {
            self.fall(milliseconds, target);
        } else if self.roomy >= self.patience {
            self.enter(level - 1);
            self.rose = true;
        }
    }

    fn fall(&mut self, milliseconds: f64, target: f64) {
        if self.rose && self.frames <= TRIAL_FRAMES {
            self.patience = (2 * self.patience).min(MOST_ROOM_FRAMES);
        }
        let presets = self.presets.len();
        let next = if self.level < presets {
            self.before_fall = Some(milliseconds);
            self.level + 1
        } else {
            let fits = |&level: &usize| milliseconds * self.area(level) / self.area(self.level) <= FALL_TO * target;
            (self.level + 1..self.levels()).find(fits).unwrap_or(self.levels() - 1)
        };
        self.enter(next);
        self.rose = false;
    }

    fn enter(&mut self, level: usize) {
        (self.level, self.frames, self.slow, self.roomy) = (level, 0, 0, 0);
    }

    /// What the level above is expected to cost against this one.
    fn cost_of_rise(&self) -> f64 {
        match self.level.checked_sub(1) {
            Some(above) if above < self.presets.len() => self.ratios[above],
            Some(above) => self.area(above) / self.area(self.level),
            None => 1.0,
        }
    }

    fn levels(&self) -> usize {
        self.presets.len() + SCALES.len()
    }

    fn at(&self, level: usize) -> Lowering {
        let scale = SCALES[level.saturating_sub(self.presets.len()).min(SCALES.len() - 1)];
        let preset = level.min(self.presets.len()).checked_sub(1).map(|preset| self.presets[preset]);
        Lowering { level, preset, scale }
    }

    /// Pixels, as a share of all.
    fn area(&self, level: usize) -> f64 {
        f64::from(self.at(level).scale).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TARGET: f64 = 1000.0 / 30.0;

    fn steering() -> Steering {
        Steering::new(vec!["balanced", "fast"])
    }

    /// Milliseconds of a frame: what the chosen settings take, each preset `gain` times less; a tenth of it is not by pixel.
    fn cost(full: f64, gain: f64, lowering: Lowering) -> f64 {
        let presets = ["balanced", "fast"].iter().position(|&name| Some(name) == lowering.preset).map_or(0, |i| i + 1);
        full / gain.powi(presets as i32) * (0.1 + 0.9 * f64::from(lowering.scale).powi(2))
    }

    /// Steers through `frames` frames and returns the levels they were traced at.
    fn walk(steering: &mut Steering, frames: usize, cost: impl Fn(usize, Lowering) -> f64) -> Vec<usize> {
        let frame = |frame| {
            let lowering = steering.lowering(true);
            steering.measured(lowering.level, cost(frame, lowering), TARGET);
            lowering.level
        };
        (0..frames).map(frame).collect()
    }

    #[test]
    fn it_falls_below_the_target_within_some_frames_and_stays() {
        for full in [20.0, 40.0, 60.0, 100.0, 200.0] {
            for gain in [1.0, 1.3, 2.0] {
                let mut steering = steering();
                let levels = walk(&mut steering, 600, |_, lowering| cost(full, gain, lowering));
                let (begin, end) = levels.split_at(20);
                assert!(end.iter().all(|level| level == &end[0]), "{full} ms, gain {gain}: {levels:?}");
                assert!(begin.is_sorted(), "{full} ms, gain {gain}: {levels:?}");
                let settled = steering.lowering(true);
                assert!(cost(full, gain, settled) <= TARGET, "{full} ms, gain {gain}: {settled:?}");
                assert_eq!(full <= TARGET, settled == Lowering::NONE, "no more than needed");
            }
        }
    }

    #[test]
    fn the_preset_goes_before_the_scale() {
        let mut steering = steering();
        let mut seen: Vec<(Option<&str>, f32)> = Vec::new();
        for _ in 0..100 {
            let lowering = steering.lowering(true);
            seen.push((lowering.preset, lowering.scale));
            steering.measured(lowering.level, 200.0, TARGET);
        }
        seen.dedup();
        assert_eq!(seen[..3], [(None, 1.0), (Some("balanced"), 1.0), (Some("fast"), 1.0)]);
        assert!(seen[3..].iter().all(|&(preset, scale)| preset == Some("fast") && scale < 1.0), "{seen:?}");
        assert_eq!(seen.last(), Some(&(Some("fast"), 0.25)), "and no lower");
    }

    #[test]
    fn noise_does_not_make_it_swing() {
        for full in [50.0, 90.0, 150.0] {
            let mut steering = steering();
            let noise = |frame: usize| 1.0 + 0.1 * ((frame * 7919 % 101) as f64 / 50.0 - 1.0);
            let levels = walk(&mut steering, 1000, |frame, lowering| noise(frame) * cost(full, 1.4, lowering));
            let changes = levels[60..].windows(2).filter(|pair| pair[0] != pair[1]).count();
            assert!(changes <= 4, "{full} ms: {changes} changes");
        }
    }

    #[test]
    fn one_slow_frame_is_forgiven() {
        let mut steering = steering();
        let levels = walk(&mut steering, 100, |frame, _| if frame % 10 == 5 { 300.0 } else { 20.0 });
        assert!(levels.iter().all(|&level| level == 0));
    }

    #[test]
    fn it_rises_where_the_view_is_cheaper() {
        let mut steering = steering();
        walk(&mut steering, 100, |_, lowering| cost(200.0, 1.4, lowering));
        assert!(steering.lowering(true).scale < 1.0);
        walk(&mut steering, 300, |_, lowering| cost(15.0, 1.4, lowering));
        assert_eq!(steering.lowering(true), Lowering::NONE);
    }

    #[test]
    fn at_rest_nothing_is_given_up_and_the_next_movement_begins_as_the_last_ended() {
        let mut steering = steering();
        walk(&mut steering, 50, |_, lowering| cost(200.0, 1.4, lowering));
        let moving = steering.lowering(true);
        assert!(moving.level > 0);
        assert_eq!(steering.lowering(false), Lowering::NONE);
        // The frame at rest, however slow, tells nothing of the movement.
        (0..9).for_each(|_| steering.measured(Lowering::NONE.level, 200.0, TARGET));
        assert_eq!(steering.lowering(true), moving);
    }
}
