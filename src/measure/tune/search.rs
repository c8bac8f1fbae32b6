//! The walk through the settings.

use super::axes::{Axis, axes, is_varied, with_one_change_undone};
use super::trial::{NOISE_PARTS, Trial, Verdict, front};
use super::{Bound, Stopped, Studio, Task, Tuning};
use crate::picture::EightBit;
use crate::render::{Film, Planes};
use crate::settings::{PRESETS, Promise, ROWS, Settings};
use std::time::{Duration, Instant};

/// Views of a path that candidates are timed and first judged on, at most.
const VIEWS: usize = 3;
/// Visits that everything is given that others are held against.
const VISITS: usize = 5;
/// Visits of each of the last candidates: so many, more of frames that are so short that these take less than some time, and
/// no more than [`NOISE_PARTS`] of those so long that they take more than another.
const LAST_VISITS: usize = 24;
const MOST_LAST_VISITS: usize = 240;
const LEAST_LAST_TIME: Duration = Duration::from_secs(2);
const LAST_TIME: Duration = Duration::from_secs(8);
/// The last candidates: how much slower than the best they may be, and how many there are, without the simpler ones that
/// they are held against.
const LAST_SLACK: f64 = 1.15;
const LAST: usize = 4;
/// Candidates that an axis hands on to the next, at most.
const KEPT: usize = 8;
/// Times from few visits that differ by less than this share are the same, and the least that any noise is taken for.
const ROUGH_NOISE: f64 = 0.05;
const LEAST_NOISE: f64 = 0.02;
/// Visits in which a candidate has to prove faster than what it approximates, at least by a little.
const PROOFS: usize = 6;
/// By how much two visits may miss that, until the others are left out.
const NEAR: f64 = 1.15;
/// A frame that takes this many times as long as what it should be faster than is dropped, after some time in any case.
const HOPELESS: u32 = 3;
const PATIENCE: Duration = Duration::from_millis(100);

/// Searches for the cheapest settings within the bounds of `task`.
///
/// Trying all products of all axes would take some 1,600 candidates; one row at a time never finds what only works together,
/// such as a grid and its filling, of which the first alone is slower. So rows that mean little alone are multiplied out, and
/// axes are walked one after the other with all that is worth going on with: what keeps the bounds, since more approximation
/// does not mend it, and what nothing else beats in both time and error, since further approximations act much alike on both.
/// What is no faster than what it approximates is left without a look at its picture, which mostly costs more than the frame;
/// and of a number that breaks a bound no further value is tried. That leaves 15 to 50 candidates on the scenes that come along.
pub(super) fn run(task: &Task, studio: &mut dyn Studio) -> Result<Tuning, Stopped> {
    let base = start(task);
    let axes = axes(&base, &task.fixed);
    let views = task.cameras.len();
    let (width, height) = task.size;
    let mut search = Search {
        task,
        studio,
        film: Film::new(width, height, Planes::default()),
        views: (0..views.min(VIEWS)).map(|i| (2 * i + 1) * views / (2 * views.min(VIEWS))).collect(),
        truths: Vec::new(),
        breakers: Vec::new(),
        trials: Vec::new(),
        deadline: Instant::now() + task.budget,
        share: 0.0,
    };
    for i in 0..search.views.len() {
        let camera = search.views[i];
        let truth = search.truth(camera)?;
        search.truths.push(truth);
    }
    // The first frame of all starts threads and touches memory.
    search.studio.frame(&task.cameras[search.views[0]], &base, &mut search.film, None)?;
    let first = search.look(&base, None)?;
    search.complete(&[first])?;
    let walked = search.walk(&axes, &base, first)?;
    search.complete(&of_judged(&search.trials, task))?;
    let (chosen, passed_over, noise) = search.choose(&base)?;
    search.tell(1.0);

    let Search { trials, .. } = search;
    let mut front = of_judged(&trials, task);
    // Of what is the same within noise only the simpler is on the front; what was chosen is there in any case.
    front.extend(chosen.filter(|chosen| !front.contains(chosen)));
    front.sort_by(|&a, &b| trials[b].cost().total_cmp(&trials[a].cost()));
    let varied = axes.iter().flat_map(|axis| axis.values(&base)).collect();
    let bounds = task.bounds.clone();
    Ok(Tuning {
        bounds,
        trials,
        front,
        chosen,
        passed_over,
        noise,
        varied,
        frames: views,
        size: task.size,
        cut_short: !walked,
    })
}

/// The front of all trials that were judged.
fn of_judged(trials: &[Trial], task: &Task) -> Vec<usize> {
    let judged: Vec<usize> = (0..trials.len()).filter(|&i| trials[i].verdict != Verdict::Slow).collect();
    front(trials, &judged, &task.bounds, LEAST_NOISE)
}

/// Where the walk starts: what is fixed, and what is another picture by intent, on the preset `exact`.
fn start(task: &Task) -> Settings {
    let mut settings = Settings::exact();
    for row in ROWS {
        let is_different = row.promise(&(row.get)(&task.settings)) == Some(Promise::Different);
        if task.fixed.contains(&row.name) || is_different || !is_varied(row) {
            row.copy(&task.settings, &mut settings);
        }
    }
    settings
}

struct Search<'a> {
    task: &'a Task,
    studio: &'a mut dyn Studio,
    film: Film,
    /// The cameras that candidates are timed and first judged on, and the reference of each.
    views: Vec<usize>,
    truths: Vec<EightBit>,
    /// Other cameras that some candidate failed on: the first to ask of the next.
    breakers: Vec<usize>,
    trials: Vec<Trial>,
    deadline: Instant,
    /// How far it has come, 0 to 1.
    share: f64,
}

impl Search<'_> {
    fn bounds(&self) -> &[Bound] {
        &self.task.bounds
    }

    fn tell(&mut self, share: f64) {
        self.share = share;
        self.studio.told(share, &self.trials);
    }

    /// The reference picture of a camera.
    fn truth(&mut self, camera: usize) -> Result<EightBit, Stopped> {
        self.studio.frame(&self.task.cameras[camera], &self.task.settings.reference(), &mut self.film, None)?;
        Ok(EightBit::of_film(&self.film))
    }

    /// Tries settings for the first time. Their place in `trials`.
    fn look(&mut self, settings: &Settings, parent: Option<usize>) -> Result<usize, Stopped> {
        let trial = self.trial(settings, parent)?;
        self.trials.push(trial);
        Ok(self.trials.len() - 1)
    }

    /// Times and judges settings, unless they prove no faster than `parent`.
    fn trial(&mut self, settings: &Settings, parent: Option<usize>) -> Result<Trial, Stopped> {
        let mut trial = Trial::new(settings.clone(), self.bounds(), self.views.len());
        for view in 0..self.views.len() {
            let least = parent.map_or(f64::INFINITY, |parent| self.trials[parent].least(view));
            let longest = parent.map(|_| PATIENCE + Duration::from_secs_f64(least / 1e3) * HOPELESS);
            let mut is_faster = false;
            for proof in 0..PROOFS {
                let camera = &self.task.cameras[self.views[view]];
                let Some(time) = self.studio.frame(camera, settings, &mut self.film, longest)? else { break };
                trial.add(view, time);
                is_faster = time < least * (1.0 - LEAST_NOISE / 2.0);
                if is_faster || proof > 0 && trial.least(view) > NEAR * least {
                    break;
                }
            }
            if !is_faster {
                trial.verdict = Verdict::Slow;
                break;
            }
            // One frame that breaks a bound is enough; its time is still told.
            if trial.verdict == Verdict::Holds {
                trial.judge(&self.truths[view], &EightBit::of_film(&self.film), &self.task.bounds);
            }
        }
        Ok(trial)
    }

    /// The trial of some settings, which are looked at unless they were before.
    fn tried(&mut self, settings: &Settings, parent: Option<usize>) -> Result<usize, Stopped> {
        match self.trials.iter().position(|trial| trial.settings == *settings) {
            Some(place) => Ok(place),
            None => self.look(settings, parent),
        }
    }

    /// The trial of some settings, which are judged even if they are slow.
    fn judged(&mut self, settings: &Settings) -> Result<usize, Stopped> {
        let place = self.tried(settings, None)?;
        if self.trials[place].verdict == Verdict::Slow {
            self.trials[place] = self.trial(settings, None)?;
        }
        Ok(place)
    }

    /// Times trials in turn, so that what else the machine does meets them alike.
    fn visit(&mut self, places: &[usize]) -> Result<(), Stopped> {
        for &place in places {
            for view in 0..self.views.len() {
                let camera = &self.task.cameras[self.views[view]];
                let trial = &mut self.trials[place];
                if let Some(time) = self.studio.frame(camera, &trial.settings, &mut self.film, None)? {
                    trial.add(view, time);
                }
            }
        }
        Ok(())
    }

    /// Visits trials until each has had its visits.
    fn complete(&mut self, places: &[usize]) -> Result<(), Stopped> {
        for visits in 1..=VISITS {
            let missing: Vec<usize> =
                places.iter().copied().filter(|&place| self.trials[place].visits() < visits).collect();
            self.visit(&missing)?;
        }
        Ok(())
    }

    /// Tries the presets and what else was asked for, then walks the axes from the trial `first`. False when the time was up.
    fn walk(&mut self, axes: &[Axis], base: &Settings, first: usize) -> Result<bool, Stopped> {
        /// What the walk is of the whole search, in time.
        const WALK: f64 = 0.85;
        for settings in self.also(base) {
            self.tried(&settings, None)?;
        }
        let mut kept = vec![first];
        // Later axes start from more candidates.
        let weight = |i: usize| (axes[i].products(base).len() * (1 + i)) as f64;
        let all: f64 = (0..axes.len()).map(weight).sum();
        let mut done = 0.0;
        let mut in_time = true;
        for (i, axis) in axes.iter().enumerate() {
            let candidates: Vec<(usize, Settings)> = kept
                .iter()
                .flat_map(|&parent| {
                    let products = axis.products(&self.trials[parent].settings).into_iter().skip(1);
                    products.map(move |settings| (parent, settings)).collect::<Vec<_>>()
                })
                .collect();
            let count = candidates.len() as f64;
            let mut broken = Vec::new();
            for (nth, (parent, settings)) in candidates.into_iter().enumerate() {
                if Instant::now() > self.deadline {
                    in_time = false;
                    break;
                }
                // More of the same does not mend it.
                if axis.is_ladder() && broken.contains(&parent) {
                    continue;
                }
                let place = self.tried(&settings, Some(parent))?;
                match self.trials[place].verdict {
                    Verdict::Holds if kept.contains(&place) => {}
                    Verdict::Holds => kept.push(place),
                    Verdict::Breaks => broken.push(parent),
                    Verdict::Slow => {}
                }
                self.tell(WALK * (done + weight(i) * nth as f64 / count) / all);
            }
            done += weight(i);
            self.complete(&kept)?;
            kept = front(&self.trials, &kept, &self.task.bounds, ROUGH_NOISE);
            kept.sort_by(|&a, &b| self.trials[a].cost().total_cmp(&self.trials[b].cost()));
            kept.truncate(KEPT);
        }
        self.tell(WALK);
        Ok(in_time)
    }

    /// What is tried whatever the walk came by: the presets, as far as their rows are free, and what was asked for.
    fn also(&self, base: &Settings) -> Vec<Settings> {
        let of_preset = |preset: Settings| {
            let mut settings = base.clone();
            settings.take_changes(&preset, |row| !self.task.fixed.contains(&row.name));
            settings
        };
        PRESETS.iter().map(|preset| of_preset((preset.settings)())).chain(self.task.also.iter().cloned()).collect()
    }

    /// The cheapest trial that keeps the bounds on every frame; what was faster within noise, if anything; and the noise.
    ///
    /// The last candidates are timed anew, all in the same rounds. From the fastest of them on, a simpler one is taken as long
    /// as what it lacks gains no more than the noise.
    ///
    /// Of a path only a few views were looked at so far. So the choice is judged on all of them, and where one breaks a bound
    /// the next best is taken, which is asked about that view first.
    fn choose(&mut self, base: &Settings) -> Result<(Option<usize>, Option<usize>, f64), Stopped> {
        let end = Instant::now() + LAST_TIME;
        loop {
            let last = self.last(base)?;
            let last = self.time_anew(last, end)?;
            let cost = |place: usize| self.trials[place].cost();
            let changes = |place: usize| self.trials[place].changes();
            let noise = |a: usize, b: usize| self.trials[a].noise().max(self.trials[b].noise()).max(LEAST_NOISE);
            let by_cost = |a: &usize, b: &usize| cost(*a).total_cmp(&cost(*b));
            let Some(mut chosen) = last.iter().copied().min_by(by_cost) else { return Ok((None, None, LEAST_NOISE)) };
            let mut passed_over = None;
            loop {
                let is_as_good = |&place: &usize| {
                    changes(place) < changes(chosen) && cost(place) <= cost(chosen) * (1.0 + noise(place, chosen))
                };
                let as_good = last.iter().copied().filter(is_as_good);
                let Some(simpler) = as_good.min_by(|a, b| changes(*a).cmp(&changes(*b)).then(by_cost(a, b))) else {
                    break;
                };
                passed_over = Some(chosen);
                chosen = simpler;
            }
            let noise = noise(chosen, passed_over.unwrap_or(chosen));
            if self.holds_everywhere(chosen)? {
                return Ok((Some(chosen), passed_over, noise));
            }
        }
    }

    /// The last candidates: the best, each of them with any one of its changes undone, and `base`; all keep the bounds.
    fn last(&mut self, base: &Settings) -> Result<Vec<usize>, Stopped> {
        let holds = |trials: &[Trial], place: usize| trials[place].verdict == Verdict::Holds;
        let mut last: Vec<usize> = (0..self.trials.len()).filter(|&place| holds(&self.trials, place)).collect();
        last.sort_by(|&a, &b| self.trials[a].cost().total_cmp(&self.trials[b].cost()));
        let slowest = LAST_SLACK * last.first().map_or(0.0, |&best| self.trials[best].cost());
        last.retain(|&place| self.trials[place].cost() <= slowest);
        last.truncate(LAST);
        let undone = last.iter().flat_map(|&place| with_one_change_undone(&self.trials[place].settings, base));
        let simpler: Vec<Settings> = undone.chain([base.clone()]).collect();
        for settings in simpler {
            let place = self.judged(&settings)?;
            if holds(&self.trials, place) && !last.contains(&place) {
                last.push(place);
            }
        }
        Ok(last)
    }

    /// Times trials anew, in turn and equally often, and gives those that are near the fastest.
    fn time_anew(&mut self, mut last: Vec<usize>, end: Instant) -> Result<Vec<usize>, Stopped> {
        last.iter().for_each(|&place| self.trials[place].forget_times());
        let start = Instant::now();
        for visits in 1..=MOST_LAST_VISITS {
            self.visit(&last)?;
            if visits == NOISE_PARTS {
                let cost = |place: usize| self.trials[place].cost();
                let least = last.iter().map(|&place| cost(place)).fold(f64::INFINITY, f64::min);
                last.retain(|&place| cost(place) <= LAST_SLACK * least);
            }
            let is_certain = last.len() == 1 || visits >= LAST_VISITS && start.elapsed() > LEAST_LAST_TIME;
            if visits >= NOISE_PARTS && (is_certain || Instant::now() > end) {
                break;
            }
        }
        Ok(last)
    }

    /// Judges a trial on all views that it was not judged on yet, until one breaks a bound.
    fn holds_everywhere(&mut self, place: usize) -> Result<bool, Stopped> {
        let others = (0..self.task.cameras.len()).filter(|i| !self.views.contains(i) && !self.breakers.contains(i));
        let order: Vec<usize> = self.breakers.iter().copied().chain(others).collect();
        let from = self.share;
        for (nth, camera) in order.iter().copied().enumerate() {
            let truth = self.truth(camera)?;
            let settings = self.trials[place].settings.clone();
            self.studio.frame(&self.task.cameras[camera], &settings, &mut self.film, None)?;
            if !self.trials[place].judge(&truth, &EightBit::of_film(&self.film), &self.task.bounds) {
                self.breakers.retain(|breaker| *breaker != camera);
                self.breakers.insert(0, camera);
                return Ok(false);
            }
            self.tell(from + (0.99 - from) * nth as f64 / order.len() as f64);
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Camera;

    /// Frames that cost what they are said to, or up to 3 % more, and the first ones twice that; all pictures are equal.
    struct Pretended {
        cost: fn(&Settings) -> f64,
        frames: u32,
    }

    impl Studio for Pretended {
        fn frame(
            &mut self,
            _: &Camera,
            settings: &Settings,
            _: &mut Film,
            _: Option<Duration>,
        ) -> Result<Option<f64>, Stopped> {
            self.frames += 1;
            let cold = if self.frames <= 2 { 2.0 } else { 1.0 };
            let disturbed = 1.0 + 0.03 * f64::from(self.frames * 7919 % 101) / 101.0;
            Ok(Some(cold * disturbed * (self.cost)(settings)))
        }

        fn told(&mut self, _: f64, _: &[Trial]) {}
    }

    /// The settings found on one view.
    fn found(cost: fn(&Settings) -> f64) -> Settings {
        let task = Task {
            cameras: vec![Camera::default()],
            size: (16, 9),
            settings: Settings::exact(),
            fixed: Vec::new(),
            bounds: vec![Bound::parse("flip=0.1").expect("right")],
            also: Vec::new(),
            budget: Duration::from_secs(60),
        };
        let tuning = run(&task, &mut Pretended { cost, frames: 0 }).expect("nothing stops it");
        tuning.trials[tuning.chosen.expect("every picture is equal")].settings.clone()
    }

    #[test]
    fn what_gains_nothing_is_not_chosen() {
        assert_eq!(found(|_| 10.0), Settings::exact());
    }

    #[test]
    fn of_many_changes_those_are_chosen_that_gain() {
        let cost = |settings: &Settings| {
            let weight = if settings.min_weight > 0.01 { 0.9 } else { 1.0 };
            let scale = f64::from(settings.render_scale.max(0.5));
            10.0 * weight * scale * if settings.bvh { 1.0 } else { 0.995 }
        };
        let found = found(cost);
        assert!(found.min_weight > 0.01 && found.render_scale <= 0.5, "{}", found.flags());
        assert_eq!(found.changed().count(), 2, "{}", found.flags());
    }
}
