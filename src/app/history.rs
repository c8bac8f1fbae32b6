//! Frame times of the recent past: the rate, the percentiles, the graph.

use crate::measure::statistics::Spread;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Frames that are remembered: enough that a hundredth of them is more than a handful.
const CAPACITY: usize = 1000;
/// What "1 % low" means here. Elsewhere the same words stand for at least two other figures.
pub const ONE_PERCENT_LOW: &str = "1 % low: frames a second at the mean time of the slowest hundredth of the last 1000 \
                                   frames (of the slowest one where there are fewer than 100)";
/// The rate is counted over this long.
const RATE_WINDOW: Duration = Duration::from_secs(1);
/// A pause beyond the frame's own time that is rest, not slowness.
const REST: Duration = Duration::from_millis(250);

/// One traced frame.
#[derive(Clone, Copy, Debug)]
struct Entry {
    finished: Instant,
    milliseconds: f64,
}

/// What the overlay says of the remembered frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Milliseconds a frame.
    pub spread: Spread,
    /// Frames a second, see [`ONE_PERCENT_LOW`].
    pub one_percent_low: f64,
}

/// The last frames, oldest first.
#[derive(Debug, Default)]
pub struct History {
    entries: VecDeque<Entry>,
}

impl History {
    /// Remembers a frame that took `milliseconds`.
    pub fn record(&mut self, finished: Instant, milliseconds: f64) {
        if self.entries.len() == CAPACITY {
            self.entries.pop_front();
        }
        self.entries.push_back(Entry { finished, milliseconds });
    }

    /// Milliseconds of each frame, oldest first.
    pub fn milliseconds(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.entries.iter().map(|entry| entry.milliseconds)
    }

    /// Milliseconds of the last frame.
    pub fn last(&self) -> Option<f64> {
        self.entries.back().map(|entry| entry.milliseconds)
    }

    /// Frames a second over the last second of uninterrupted tracing; a lone frame is judged by its own time.
    pub fn rate(&self) -> Option<f64> {
        let newest = self.entries.back()?;
        let mut oldest = newest;
        let mut intervals = 0;
        for entry in self.entries.iter().rev().skip(1) {
            let frame = Duration::from_secs_f64(oldest.milliseconds.max(0.0) / 1e3);
            let paused = oldest.finished.saturating_duration_since(entry.finished) > frame + REST;
            if paused || newest.finished.saturating_duration_since(entry.finished) > RATE_WINDOW {
                break;
            }
            oldest = entry;
            intervals += 1;
        }
        let span = newest.finished.saturating_duration_since(oldest.finished).as_secs_f64();
        Some(if span > 0.0 { f64::from(intervals) / span } else { 1e3 / newest.milliseconds.max(1e-3) })
    }

    /// Whether nothing was traced for a while before `now`.
    pub fn is_resting(&self, now: Instant) -> bool {
        self.entries.back().is_none_or(|newest| now.saturating_duration_since(newest.finished) > REST)
    }

    /// How the times of the remembered frames spread; `None` for no frames.
    pub fn summary(&self) -> Option<Summary> {
        let mut sorted: Vec<f64> = self.milliseconds().collect();
        sorted.sort_by(f64::total_cmp);
        let slowest = sorted.len().div_ceil(100);
        let mean = sorted.iter().rev().take(slowest).sum::<f64>() / slowest as f64;
        (!sorted.is_empty()).then(|| Summary { spread: Spread::of(&sorted), one_percent_low: 1e3 / mean.max(1e-3) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every(milliseconds: u64, frames: u32) -> History {
        let start = Instant::now();
        let mut history = History::default();
        for i in 0..frames {
            history.record(start + Duration::from_millis(milliseconds) * i, milliseconds as f64);
        }
        history
    }

    #[test]
    fn the_rate_is_counted_over_the_last_second() {
        assert!((every(20, 200).rate().expect("frames") - 50.0).abs() < 1e-9);
        assert!((every(400, 9).rate().expect("frames") - 2.5).abs() < 1e-9);
        assert!((every(2000, 3).rate().expect("frames") - 0.5).abs() < 1e-9);
        assert_eq!(History::default().rate(), None);
    }

    #[test]
    fn rest_does_not_count_as_slowness() {
        let mut history = every(20, 100);
        let after_rest = history.entries[99].finished + Duration::from_secs(5);
        history.record(after_rest, 20.0);
        assert_eq!(history.rate(), Some(50.0));
        history.record(after_rest + Duration::from_millis(25), 20.0);
        assert!((history.rate().expect("frames") - 40.0).abs() < 1e-9);
        assert!(!history.is_resting(after_rest + Duration::from_millis(30)));
        assert!(history.is_resting(after_rest + Duration::from_secs(1)));
    }

    #[test]
    fn one_slow_frame_in_a_thousand_is_a_tenth_of_the_slowest_hundredth() {
        let now = Instant::now();
        let mut history = History::default();
        assert_eq!(history.summary(), None);
        (0..999).for_each(|_| history.record(now, 8.0));
        history.record(now, 200.0);
        let Summary { spread, one_percent_low } = history.summary().expect("frames");
        assert_eq!((spread.median, spread.p95, spread.p99, spread.max), (8.0, 8.0, 8.0, 200.0));
        // The slowest ten take 9 * 8 + 200 ms together.
        assert!((one_percent_low - 1e3 / 27.2).abs() < 1e-9, "{one_percent_low}");
    }

    #[test]
    fn of_a_few_frames_the_slowest_is_the_low() {
        let now = Instant::now();
        let mut history = History::default();
        [10.0, 40.0, 20.0].into_iter().for_each(|ms| history.record(now, ms));
        assert_eq!(history.summary().expect("frames").one_percent_low, 25.0);
    }

    #[test]
    fn memory_is_bounded() {
        assert_eq!(every(1, 10_000).milliseconds().len(), CAPACITY);
    }
}
