//! The walk through the settings.

use super::axes::{Axis, axes};
use super::trial::{Trial, Verdict, front};
use super::{Bound, Stopped, Studio, Task, Tuning};
use crate::picture::EightBit;
use crate::render::{Film, Planes};
use crate::settings::{Kind, PRESETS, Promise, ROWS, Settings};
use std::time::{Duration, Instant};

/// Views of a path that candidates are timed and first judged on, at most.
const VIEWS: usize = 3;
/// Visits that everything is given that others are held against.
const VISITS: usize = 5;
/// Visits of the last candidates, and the time after which no further pair of them starts. They come in pairs, so that
/// their halves can be held against each other.
const LAST_VISITS: usize = 24;
const LAST_TIME: Duration = Duration::from_secs(8);
/// The last candidates: how much slower than the best they may be, and how many there are.
const LAST_SLACK: f64 = 1.15;
const LAST: usize = 6;
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
    let first = search.look(&base, None)?;
    search.complete(&[first])?;
    let walked = search.walk(&axes, &base, first)?;
    search.complete(&of_judged(&search.trials, task))?;
    let (chosen, passed_over, noise) = search.choose()?;
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
        let value = (row.get)(&task.settings);
        let is_never_tried = matches!(row.kind, Kind::Number { tries: [], .. });
        if task.fixed.contains(&row.name) || row.promise(&value) == Some(Promise::Different) || is_never_tried {
            // What a row prints it also reads.
            let _ = (row.set)(&mut settings, &value);
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

    /// Times and judges settings for the first time, unless they prove no faster than `parent`. Their place in `trials`.
    fn look(&mut self, settings: &Settings, parent: Option<usize>) -> Result<usize, Stopped> {
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
        self.trials.push(trial);
        Ok(self.trials.len() - 1)
    }

    /// The trial of some settings, which are looked at unless they were before.
    fn tried(&mut self, settings: &Settings, parent: Option<usize>) -> Result<usize, Stopped> {
        match self.trials.iter().position(|trial| trial.settings == *settings) {
            Some(place) => Ok(place),
            None => self.look(settings, parent),
        }
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
            for row in preset.changed().filter(|row| !self.task.fixed.contains(&row.name)) {
                // What a row prints it also reads.
                let _ = (row.set)(&mut settings, &(row.get)(&preset));
            }
            settings
        };
        PRESETS.iter().map(|preset| of_preset((preset.settings)())).chain(self.task.also.iter().cloned()).collect()
    }

    /// The cheapest trial that keeps the bounds on every frame; what was faster within noise, if anything; and the noise.
    ///
    /// Of a path only a few views were looked at so far. So the choice is judged on all of them, and where one breaks a bound
    /// the next best is taken, which is asked about that view first.
    fn choose(&mut self) -> Result<(Option<usize>, Option<usize>, f64), Stopped> {
        loop {
            let mut last: Vec<usize> =
                (0..self.trials.len()).filter(|&i| self.trials[i].verdict == Verdict::Holds).collect();
            last.sort_by(|&a, &b| self.trials[a].cost().total_cmp(&self.trials[b].cost()));
            let Some(&best) = last.first() else { return Ok((None, None, LEAST_NOISE)) };
            let slowest = LAST_SLACK * self.trials[best].cost();
            last.retain(|&place| self.trials[place].cost() <= slowest);
            last.truncate(LAST);
            let start = Instant::now();
            loop {
                let missing: Vec<usize> =
                    last.iter().copied().filter(|&place| self.trials[place].visits() < LAST_VISITS).collect();
                self.visit(&missing)?;
                self.visit(&missing)?;
                if missing.is_empty() || last.len() == 1 || start.elapsed() > LAST_TIME {
                    break;
                }
            }
            let noise = last.iter().map(|&place| self.trials[place].noise()).fold(LEAST_NOISE, f64::max);
            let cost = |place: usize| self.trials[place].cost();
            let fastest = last.iter().copied().min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
            let least = fastest.map_or(f64::INFINITY, cost);
            let simplest =
                last.iter().copied().filter(|&place| cost(place) <= least * (1.0 + noise)).min_by(|&a, &b| {
                    self.trials[a].changes().cmp(&self.trials[b].changes()).then(cost(a).total_cmp(&cost(b)))
                });
            let Some(chosen) = simplest else { return Ok((None, None, noise)) };
            if self.holds_everywhere(chosen)? {
                return Ok((Some(chosen), fastest.filter(|fastest| *fastest != chosen), noise));
            }
        }
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
