//! When to draw: no more often than the display shows, no more than there is something new.
//!
//! Presentation takes CPU from the tracer, most of all on a software adapter, and an unmapped window never
//! blocks in its swap chain. So the limit is ours.

use std::time::{Duration, Instant};

/// Display rate where the monitor does not tell.
const USUAL_RATE: f64 = 60.0;

/// How often things may happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rates {
    /// Between two presented pictures, and between two traced frames.
    pub display: Duration,
    /// Between two drawings of the overlay while only its figures change.
    pub figures: Duration,
}

impl Rates {
    /// For a monitor of `millihertz` (where known), drawn by a software adapter or not.
    pub fn new(millihertz: Option<u32>, software: bool) -> Self {
        let rate = millihertz.map_or(USUAL_RATE, |rate| f64::from(rate) / 1e3).clamp(30.0, 240.0);
        // Drawing the overlay in software costs as much as tracing a small frame, and no one reads figures faster.
        let figures = if software { Duration::from_millis(200) } else { Duration::from_millis(33) };
        Self { display: Duration::from_secs_f64(1.0 / rate), figures }
    }
}

/// Something that is drawn on demand, but not too often.
#[derive(Debug, Default)]
pub struct Limiter {
    last: Option<Instant>,
    due: Option<Instant>,
}

impl Limiter {
    /// Asks for a drawing at least `interval` after the last one; an earlier demand stands.
    pub fn demand(&mut self, now: Instant, interval: Duration) {
        let at = self.last.map_or(now, |last| (last + interval).max(now));
        self.demand_at(at);
    }

    /// Asks for a drawing at a given time; an earlier demand stands.
    pub fn demand_at(&mut self, at: Instant) {
        self.due = Some(self.due.map_or(at, |due| due.min(at)));
    }

    /// When the next drawing is due, if any.
    pub fn due(&self) -> Option<Instant> {
        self.due
    }

    /// Whether a drawing is due.
    pub fn is_due(&self, now: Instant) -> bool {
        self.due.is_some_and(|due| due <= now)
    }

    /// It was drawn: all demands so far are met.
    pub fn met(&mut self, now: Instant) {
        self.last = Some(now);
        self.due = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: Duration = Duration::from_millis(16);

    #[test]
    fn nothing_is_due_without_a_demand() {
        let now = Instant::now();
        let mut limiter = Limiter::default();
        assert!(!limiter.is_due(now));
        limiter.demand(now, TICK);
        assert!(limiter.is_due(now));
        limiter.met(now);
        assert!(!limiter.is_due(now + 9 * TICK));
    }

    #[test]
    fn demands_are_spaced_and_the_earliest_stands() {
        let now = Instant::now();
        let mut limiter = Limiter::default();
        limiter.met(now);
        limiter.demand(now + TICK / 4, 8 * TICK);
        limiter.demand(now + TICK / 4, TICK);
        assert_eq!(limiter.due(), Some(now + TICK));
        assert!(!limiter.is_due(now + TICK / 2) && limiter.is_due(now + TICK));
        limiter.met(now + TICK);
        limiter.demand(now + 9 * TICK, TICK);
        assert_eq!(limiter.due(), Some(now + 9 * TICK), "after a rest, at once");
    }

    #[test]
    fn odd_monitors_are_brought_to_reason() {
        assert_eq!(Rates::new(None, false).display, Duration::from_secs_f64(1.0 / 60.0));
        assert_eq!(Rates::new(Some(0), true).display, Duration::from_secs_f64(1.0 / 30.0));
        assert_eq!(Rates::new(Some(144_000), false).display, Duration::from_secs_f64(1.0 / 144.0));
    }
}
