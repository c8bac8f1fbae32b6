//! Settings that were tried: what they cost, and how wrong their pictures are.

use super::bound::Bound;
use crate::measure::front::unbeaten;
use crate::measure::metric::Pair;
use crate::measure::run::CpuTime;
use crate::measure::statistics::Spread;
use crate::picture::EightBit;
use crate::settings::Settings;

/// Parts of a trial's visits that are held against each other to tell what its least time is worth.
pub(super) const NOISE_PARTS: usize = 3;

/// What is known of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is no faster than what it approximates: its picture was not judged.
    Slow,
    /// Some frame breaks a bound.
    Breaks,
    /// Every frame that was looked at keeps all bounds.
    Holds,
}

/// Settings that were tried.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The settings.
    pub settings: Settings,
    /// What came of it.
    pub verdict: Verdict,
    /// By bound: what its metric says of the worst frame that was judged. Infinite for the psnr of equal pictures, NaN for a
    /// metric that has no value.
    pub scores: Vec<f64>,
    /// CPU milliseconds of each timed frame, visit by visit.
    times: Vec<Vec<f64>>,
}

impl Trial {
    /// Nothing is known yet. Each of `frames` views is timed.
    pub(super) fn new(settings: Settings, bounds: &[Bound], frames: usize) -> Self {
        let scores = bounds.iter().map(|bound| bound.metric.best).collect();
        Self { settings, verdict: Verdict::Holds, scores, times: vec![Vec::new(); frames] }
    }

    /// CPU time of a frame, in milliseconds; the mean of all views where there are several. `None` where no frame was
    /// completed.
    pub fn cpu_ms(&self) -> Option<CpuTime> {
        let spreads: Vec<Spread> = self.times.iter().filter(|times| !times.is_empty()).map(|t| Spread::of(t)).collect();
        let mean = |of: fn(&Spread) -> f64| spreads.iter().map(of).sum::<f64>() / spreads.len() as f64;
        (!spreads.is_empty()).then(|| CpuTime { min: mean(|spread| spread.min), median: mean(|spread| spread.median) })
    }

    /// What trials are compared by: the least CPU time, which other work of the machine disturbs least.
    pub fn cost(&self) -> f64 {
        self.cpu_ms().map_or(f64::INFINITY, |time| time.min)
    }

    /// How many settings differ from the preset `exact`.
    pub fn changes(&self) -> usize {
        self.settings.changed().count()
    }

    /// By bound, the error that its score stands for; see [`Bound::error`].
    pub fn errors<'a>(&'a self, bounds: &'a [Bound]) -> impl Iterator<Item = f64> + 'a {
        bounds.iter().zip(&self.scores).map(|(bound, score)| bound.error(*score))
    }

    /// The least time of one view so far.
    pub(super) fn least(&self, view: usize) -> f64 {
        self.times[view].iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// How often every view was timed.
    pub(super) fn visits(&self) -> usize {
        self.times.iter().map(Vec::len).min().unwrap_or_default()
    }

    /// One more visit of a view.
    pub(super) fn add(&mut self, view: usize, milliseconds: f64) {
        self.times[view].push(milliseconds);
    }

    /// Forgets all visits, to be timed anew.
    pub(super) fn forget_times(&mut self) {
        self.times.iter_mut().for_each(Vec::clear);
    }

    /// How far apart the least times of every [`NOISE_PARTS`]th visit lie, as a share: what the least time is worth.
    pub(super) fn noise(&self) -> f64 {
        let least = |times: &[f64], part: usize| {
            times.iter().skip(part).step_by(NOISE_PARTS).copied().fold(f64::INFINITY, f64::min)
        };
        let parts = || (0..NOISE_PARTS).map(|part| self.times.iter().map(|times| least(times, part)).sum::<f64>());
        let noise = parts().fold(0.0, f64::max) / parts().fold(f64::INFINITY, f64::min) - 1.0;
        if noise.is_finite() { noise } else { 0.0 }
    }

    /// Judges one frame. False when it breaks a bound.
    pub(super) fn judge(&mut self, reference: &EightBit, picture: &EightBit, bounds: &[Bound]) -> bool {
        // Equal pictures need no metric to say so.
        if reference == picture {
            return self.verdict == Verdict::Holds;
        }
        let pair = Pair::of_eight_bit(reference, picture).ok();
        for (bound, worst) in bounds.iter().zip(&mut self.scores) {
            let score = pair.as_ref().and_then(|pair| (bound.metric.score)(pair).number()).unwrap_or(f64::NAN);
            if score.is_nan() || bound.error(score) > bound.error(*worst) {
                *worst = score;
            }
            if !bound.holds(score) {
                self.verdict = Verdict::Breaks;
            }
        }
        self.verdict == Verdict::Holds
    }

    /// Whether no error of it is larger than those of `other`.
    fn is_as_true_as(&self, other: &Self, bounds: &[Bound]) -> bool {
        self.errors(bounds).zip(other.errors(bounds)).all(|(mine, theirs)| mine <= theirs)
    }
}

/// Of `places` in `trials`, those that nothing else of them beats in both time and error; of times that differ by less than
/// the share `noise`, the simplest.
pub(super) fn front(trials: &[Trial], places: &[usize], bounds: &[Bound], noise: f64) -> Vec<usize> {
    let of_as_true = |places: &[usize], is_better: &dyn Fn(&Trial, &Trial) -> bool| {
        unbeaten(places, |a, b| {
            let (a, b) = (&trials[a], &trials[b]);
            a.is_as_true_as(b, bounds) && is_better(a, b)
        })
    };
    // In two steps, neither of which can go round in circles: together they could.
    let places = of_as_true(places, &|a, b| a.cost() * (1.0 + noise) < b.cost());
    of_as_true(&places, &|a, b| {
        a.cost() <= b.cost() * (1.0 + noise) && (a.changes(), a.cost()) < (b.changes(), b.cost())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Fill;

    fn bounds() -> Vec<Bound> {
        vec![Bound::parse("flip=0.01").expect("right")]
    }

    fn trial(changes: usize, cost: f64, score: f64) -> Trial {
        let mut settings = Settings::exact();
        if changes > 0 {
            settings.fill = Fill::Color;
        }
        if changes > 1 {
            settings.min_weight = 0.5;
        }
        let mut trial = Trial::new(settings, &bounds(), 1);
        trial.add(0, cost);
        trial.scores[0] = score;
        trial
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        let trials = [trial(0, 100.0, 0.0), trial(1, 50.0, 0.1), trial(2, 60.0, 0.2), trial(2, 20.0, 0.3)];
        assert_eq!(front(&trials, &[0, 1, 2, 3], &bounds(), 0.02), [0, 1, 3]);
    }

    #[test]
    fn within_noise_the_simpler_wins_and_one_of_equals_stays() {
        let trials = [trial(0, 100.0, 0.0), trial(1, 99.0, 0.0), trial(2, 90.0, 0.0)];
        assert_eq!(front(&trials, &[0, 1], &bounds(), 0.02), [0]);
        assert_eq!(front(&trials, &[0, 1, 2], &bounds(), 0.02), [2]);
        let equals = [trial(1, 50.0, 0.0), trial(1, 50.0, 0.0)];
        assert!(!front(&equals, &[0, 1], &bounds(), 0.02).is_empty());
        let circle = [trial(0, 104.0, 0.0), trial(1, 100.0, 0.0), trial(2, 98.0, 0.0)];
        assert!(!front(&circle, &[0, 1, 2], &bounds(), 0.05).is_empty());
        let broken = [trial(0, 10.0, 0.0), trial(2, 1.0, f64::NAN)];
        assert!(front(&broken, &[0, 1], &bounds(), 0.0).contains(&0), "no score is no good score");
    }

    #[test]
    fn costs_are_means_of_least_times_and_noise_what_thirds_differ_by() {
        let mut trial = Trial::new(Settings::exact(), &bounds(), 2);
        for (view, times) in [[10.0, 11.0, 12.0, 11.0], [30.0, 32.0, 30.0, 31.0]].iter().enumerate() {
            times.iter().for_each(|time| trial.add(view, *time));
        }
        assert_eq!(trial.cost(), 20.0);
        assert!((trial.noise() - 3.0 / 40.0).abs() < 1e-9);
        trial.forget_times();
        assert_eq!((trial.visits(), trial.noise()), (0, 0.0));
    }

    #[test]
    fn the_worst_frame_decides() {
        let picture = |value| EightBit { width: 1, height: 1, rgb: vec![value; 3] };
        let bounds = [Bound::parse("max_abs=0.1").expect("right")];
        let mut trial = Trial::new(Settings::exact(), &bounds, 1);
        assert!(trial.judge(&picture(0), &picture(0), &bounds) && trial.judge(&picture(0), &picture(9), &bounds));
        assert!(!trial.judge(&picture(0), &picture(99), &bounds) && !trial.judge(&picture(0), &picture(0), &bounds));
        assert!((trial.scores[0] - 99.0 / 255.0).abs() < 1e-6);
    }
}
