//! Exams: what the settings as they are get wrong on a view, and what each of them costs or saves there.

use super::survey::of_frames;
use crate::math::simd;
use crate::measure::metric::{METRICS, Pair, Score};
use crate::measure::tune::{Stopped, Studio};
use crate::picture::EightBit;
use crate::render::{Film, Planes};
use crate::scene::Camera;
use crate::settings::{Kind, ROWS, Row, Settings};
use std::time::Duration;

/// How often frames with and without a setting are timed, in turns.
const TURNS: usize = 4;
/// A frame that takes so many times as long as with the settings as they are tells enough, after some time in any case.
const HOPELESS: f64 = 6.0;
const PATIENCE: Duration = Duration::from_millis(200);

/// What is examined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The error of the picture against the exact one.
    Errors,
    /// The cost of every setting.
    Costs,
}

/// An exam of settings on a view, under way or ended.
#[derive(Clone, Debug)]
pub struct Exam {
    /// What it asks.
    pub subject: Subject,
    /// From where it looks.
    pub camera: Camera,
    /// The settings; what only the window looks at plays no part.
    pub settings: Settings,
    /// Width and height of the picture.
    pub size: (u32, u32),
    /// How far it has come, 0 to 1.
    pub share: f64,
    /// Errors by the metric's name, those known so far.
    pub errors: Vec<(&'static str, Score)>,
    /// Costs by row, those known so far.
    pub costs: Vec<RowCost>,
    /// It is over, or was stopped.
    pub has_ended: bool,
}

/// What a setting costs, against another value of it with all others as they are.
#[derive(Clone, Debug, PartialEq)]
pub struct RowCost {
    /// The setting's name.
    pub row: &'static str,
    /// The other value.
    pub other: String,
    /// Least CPU milliseconds of a frame as it is.
    pub cpu_ms: f64,
    /// The same with the other value; at least that, if such frames were dropped.
    pub other_ms: f64,
    /// They were.
    pub is_bound: bool,
}

impl RowCost {
    /// What the value costs more (or, negative, saves) of what the other takes, as a share.
    pub fn change(&self) -> f64 {
        self.cpu_ms / self.other_ms - 1.0
    }

    /// In few letters: "-38 %", "+4 %", "0 %".
    pub fn short(&self) -> String {
        let percent = (100.0 * self.change()).round();
        let more = if self.is_bound { "<" } else { "" };
        // No sign before nothing.
        if percent == 0.0 { "0 %".to_owned() } else { format!("{more}{percent:+.0} %") }
    }

    /// In a sentence.
    pub fn words(&self) -> String {
        let least = if self.is_bound { "more than " } else { "" };
        let Self { row, other, cpu_ms, other_ms, .. } = self;
        format!("as it is a frame takes {cpu_ms:.1} CPU ms here, with {row} {other} {least}{other_ms:.1} ms")
    }
}

/// Where exams are held.
pub trait Examiner: Studio {
    /// Hears how far an exam has come, and lets others have their turn.
    ///
    /// # Errors
    /// [`Stopped`].
    fn hear(&mut self, exam: &Exam) -> Result<(), Stopped>;
}

impl Exam {
    /// An exam that begins.
    pub fn new(subject: Subject, camera: Camera, settings: Settings, size: (u32, u32)) -> Self {
        let (errors, costs) = (Vec::new(), Vec::new());
        Self { subject, camera, settings, size, share: 0.0, errors, costs, has_ended: false }
    }

    /// Takes over what an earlier exam of the same settings and the same view came to in the other subject.
    pub fn with_answers_of(mut self, earlier: Option<&Self>) -> Self {
        if let Some(earlier) = earlier.filter(|earlier| {
            (earlier.camera, earlier.size) == (self.camera, self.size)
                && of_frames(&earlier.settings, 0) == of_frames(&self.settings, 0)
        }) {
            match self.subject {
                Subject::Errors => self.costs.clone_from(&earlier.costs),
                Subject::Costs => self.errors.clone_from(&earlier.errors),
            }
        }
        self
    }

    /// Holds it to its end, or until it is stopped.
    pub fn run(&mut self, examiner: &mut dyn Examiner) {
        // What is known when it is stopped stays known.
        let _ = match self.subject {
            Subject::Errors => self.find_errors(examiner),
            Subject::Costs => self.find_costs(examiner),
        };
        self.has_ended = true;
    }

    fn find_errors(&mut self, examiner: &mut dyn Examiner) -> Result<(), Stopped> {
        examiner.hear(self)?;
        let mut film = Film::new(self.size.0, self.size.1, Planes::default());
        let mut picture = |examiner: &mut dyn Examiner, settings: &Settings| {
            examiner.frame(&self.camera, settings, &mut film, None)?;
            Ok(EightBit::of_film(&film))
        };
        let exact = picture(examiner, &self.settings.reference())?;
        let own = picture(examiner, &self.settings)?;
        let Ok(pair) = Pair::of_eight_bit(&exact, &own) else { return Ok(()) };
        for (done, metric) in (1..).zip(METRICS) {
            self.errors.push((metric.name, (metric.score)(&pair)));
            self.share = f64::from(done) / METRICS.len() as f64;
            examiner.hear(self)?;
        }
        Ok(())
    }

    fn find_costs(&mut self, examiner: &mut dyn Examiner) -> Result<(), Stopped> {
        examiner.hear(self)?;
        let mut film = Film::new(self.size.0, self.size.1, Planes::default());
        // Threads and memory are made ready untimed.
        examiner.frame(&self.camera, &self.settings, &mut film, None)?;
        let flips: Vec<_> = ROWS.iter().filter_map(|row| Some((row, other_value(row, &self.settings)?))).collect();
        for (done, (row, (other, settings))) in (1..).zip(&flips) {
            let cost = self.cost_of(row, other, settings, &mut film, examiner)?;
            self.costs.push(cost);
            self.share = f64::from(done) / flips.len() as f64;
            examiner.hear(self)?;
        }
        Ok(())
    }

    /// Times frames as they are and with another value in turns: what else the machine does then disturbs both alike.
    fn cost_of(
        &self,
        row: &Row,
        other: &str,
        settings: &Settings,
        film: &mut Film,
        examiner: &mut dyn Examiner,
    ) -> Result<RowCost, Stopped> {
        let mut cost = RowCost {
            row: row.name,
            other: other.to_owned(),
            cpu_ms: f64::INFINITY,
            other_ms: f64::INFINITY,
            is_bound: false,
        };
        for _ in 0..TURNS {
            if let Some(milliseconds) = examiner.frame(&self.camera, &self.settings, film, None)? {
                cost.cpu_ms = cost.cpu_ms.min(milliseconds);
            }
            let longest = Duration::from_secs_f64(HOPELESS * cost.cpu_ms.min(1e6) / 1e3).max(PATIENCE);
            match examiner.frame(&self.camera, settings, film, Some(longest))? {
                Some(milliseconds) => cost.other_ms = cost.other_ms.min(milliseconds),
                None => {
                    // CPU time is at least what one thread spent.
                    cost.other_ms = cost.other_ms.min(1e3 * longest.as_secs_f64());
                    cost.is_bound = true;
                    break;
                }
            }
        }
        Ok(cost)
    }
}

/// What a row is held against, as a value and as settings: the default where the value is another, else the next it could be.
/// `None` where CPU time does not hang on it.
fn other_value(row: &Row, settings: &Settings) -> Option<(String, Settings)> {
    if !row.has_effect(settings) {
        return None;
    }
    let values: Vec<String> = match &row.kind {
        Kind::Choice(choices) => choices.iter().map(|choice| choice.value.to_owned()).collect(),
        // It has no values to try, but the fewest rays there can be tell what the others cost.
        Kind::Number { .. } if row.name == "depth" => vec!["1".to_owned()],
        Kind::Number { tries: [], .. } => return None,
        Kind::Number { tries, .. } => {
            let default = (row.get)(&Settings::exact());
            std::iter::once(default).chain(tries.iter().map(|value| (*value as f32).to_string())).collect()
        }
    };
    values.into_iter().find_map(|value| {
        let mut other = settings.clone();
        (row.set)(&mut other, &value).ok()?;
        (other != *settings && simd::is_available(other.simd)).then_some((value, other))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::tune::Trial;
    use crate::settings::Visibility;

    /// A frame takes 100 ms, without the shadow cache 161.3, by brute force for ever. Its pictures are off by one level.
    struct Fake {
        told: usize,
        stop_after: usize,
    }

    impl Studio for Fake {
        fn frame(
            &mut self,
            _: &Camera,
            settings: &Settings,
            film: &mut Film,
            longest: Option<Duration>,
        ) -> Result<Option<f64>, Stopped> {
            let level = if settings.visibility == Visibility::Full { 100 } else { 101 };
            film.paint(|_, _, _, _| [level; 3]);
            assert!(settings.bvh || longest.is_some(), "it would last");
            Ok(settings.bvh.then_some(if settings.shadow_cache { 100.0 } else { 161.3 }))
        }

        fn told(&mut self, _: f64, _: &[Trial]) {}
    }

    impl Examiner for Fake {
        fn hear(&mut self, _: &Exam) -> Result<(), Stopped> {
            self.told += 1;
            if self.told > self.stop_after { Err(Stopped) } else { Ok(()) }
        }
    }

    fn held(subject: Subject, stop_after: usize) -> Exam {
        let mut exam = Exam::new(subject, Camera::default(), Settings::balanced(), (16, 16));
        exam.run(&mut Fake { told: 0, stop_after });
        assert!(exam.has_ended);
        exam
    }

    #[test]
    fn errors_come_by_every_metric() {
        let exam = held(Subject::Errors, usize::MAX);
        assert_eq!(exam.errors.len(), METRICS.len());
        let (_, most) = exam.errors.iter().find(|(metric, _)| *metric == "max_abs").expect("a metric");
        assert!((most.number().expect("defined") - 1.0 / 255.0).abs() < 1e-6);
        assert_eq!(exam.share, 1.0);
    }

    #[test]
    fn costs_are_against_the_other_value_and_a_hopeless_one_is_dropped() {
        let exam = held(Subject::Costs, usize::MAX);
        let cost = |name: &str| exam.costs.iter().find(|cost| cost.row == name).expect(name);
        assert_eq!((cost("shadow-cache").short(), cost("shadow-cache").other.as_str()), ("-38 %".to_owned(), "off"));
        assert_eq!(cost("bvh").short(), "<-83 %");
        assert_eq!(cost("shadows").short(), "0 %");
        assert_eq!((cost("fill").other.as_str(), cost("min-weight").other.as_str()), ("hit", "0"), "the defaults");
        assert_eq!(cost("visibility").other, "full");
        for without in ["stride", "threads", "exposure", "present", "target-fps", "refine-at-rest"] {
            assert!(exam.costs.iter().all(|cost| cost.row != without), "{without}");
        }
    }

    #[test]
    fn what_is_known_when_it_is_stopped_stays_known_and_is_handed_on() {
        let exam = held(Subject::Costs, 3);
        assert_eq!(exam.costs.len(), 3);
        let next = Exam::new(Subject::Errors, exam.camera, exam.settings.clone(), exam.size);
        assert_eq!(next.clone().with_answers_of(Some(&exam)).costs, exam.costs);
        let elsewhere = Exam { camera: Camera { fov: 7.0, ..exam.camera }, ..next.clone() };
        assert!(elsewhere.with_answers_of(Some(&exam)).costs.is_empty());
        let larger = Exam { size: (32, 32), ..next };
        assert!(larger.with_answers_of(Some(&exam)).costs.is_empty());
    }
}
