//! When the next frame may be sent: not before the terminal has shown those sent before.
//!
//! Lines buffer what they cannot carry yet, SSH up to megabytes, which at a megabit a second is seconds of old pictures.
//! So each frame ends with a question that the terminal answers once it has come so far, and few may be unanswered. A
//! terminal that answers nothing gets bytes at a rate that most lines carry.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Asks where the cursor is.
pub const QUESTION: &str = "\x1b[6n";
/// Frames under way: while one is shown the next travels.
const UNDER_WAY: usize = 2;
/// An answer that takes longer than this is not waited for any more.
const PATIENCE: Duration = Duration::from_secs(5);
/// Bytes a second for terminals that answer nothing.
const BLIND_RATE: f64 = 500e3;

/// What is under way to the terminal.
#[derive(Debug)]
pub struct Flow {
    answers: bool,
    /// When the frames were sent that were not answered.
    unanswered: VecDeque<Instant>,
    /// When a terminal that does not answer can have taken everything.
    taken: Option<Instant>,
}

impl Flow {
    /// Nothing is under way. `answers`: the terminal answers the [`QUESTION`].
    pub fn new(answers: bool) -> Self {
        Self { answers, unanswered: VecDeque::new(), taken: None }
    }

    /// What follows a frame.
    pub fn question(&self) -> &'static str {
        if self.answers { QUESTION } else { "" }
    }

    /// A frame of so many bytes was sent, with its question.
    pub fn sent(&mut self, now: Instant, bytes: usize) {
        if self.answers {
            self.unanswered.push_back(now);
        } else {
            self.taken = Some(now + Duration::from_secs_f64(bytes as f64 / BLIND_RATE));
        }
    }

    /// The terminal answered.
    pub fn answered(&mut self) {
        self.unanswered.pop_front();
    }

    /// Whether an answer is still to come.
    pub fn is_waiting(&self) -> bool {
        !self.unanswered.is_empty()
    }

    /// When the next frame may be sent: at once, or at the latest then. Of an answer [`answered`](Self::answered) tells.
    pub fn opens(&mut self, now: Instant) -> Option<Instant> {
        while self.unanswered.front().is_some_and(|sent| now.saturating_duration_since(*sent) >= PATIENCE) {
            self.unanswered.pop_front();
        }
        let answer =
            self.unanswered.front().filter(|_| self.unanswered.len() >= UNDER_WAY).map(|sent| *sent + PATIENCE);
        answer.or(self.taken.filter(|taken| *taken > now))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_frames_are_under_way_at_most() {
        let now = Instant::now();
        let mut flow = Flow::new(true);
        for _ in 0..2 {
            assert_eq!(flow.opens(now), None);
            flow.sent(now, 1_000_000);
        }
        assert_eq!(flow.opens(now), Some(now + PATIENCE));
        flow.answered();
        assert_eq!(flow.opens(now), None, "the answer counts, not the size");
        flow.sent(now, 10);
        assert_eq!(flow.opens(now + PATIENCE), None, "answers get lost");
        // One that comes late does not count for two.
        flow.answered();
        flow.answered();
        flow.sent(now, 10);
        flow.sent(now, 10);
        assert!(flow.opens(now).is_some());
    }

    #[test]
    fn a_silent_terminal_gets_bytes_at_a_steady_rate() {
        let now = Instant::now();
        let mut flow = Flow::new(false);
        assert_eq!((flow.question(), flow.opens(now)), ("", None));
        flow.sent(now, 250_000);
        let due = now + Duration::from_millis(500);
        assert_eq!(flow.opens(now), Some(due));
        assert_eq!(flow.opens(due), None);
    }
}
