//! The hint of the first seconds: how to look and move, until the user does.

use super::labels::Labels;
use std::time::{Duration, Instant};

/// From the first move until the hint is gone.
const FADE: Duration = Duration::from_millis(900);
/// Between two pictures of the fading hint.
const STEP: Duration = Duration::from_millis(90);

/// Shown from the start, fading since the first move.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hint {
    moved: Option<Instant>,
}

impl Hint {
    /// The user moved or looked around.
    pub fn moved(&mut self, now: Instant) {
        self.moved.get_or_insert(now);
    }

    /// Its opacity from 0 to 1.
    pub fn opacity(&self, now: Instant) -> f32 {
        let passed = self.moved.map_or(Duration::ZERO, |moved| now.saturating_duration_since(moved));
        (1.0 - passed.as_secs_f32() / FADE.as_secs_f32()).clamp(0.0, 1.0)
    }

    /// When it looks different, if ever by itself.
    pub fn next_change(&self, now: Instant) -> Option<Instant> {
        self.moved.filter(|_| self.opacity(now) > 0.0).map(|_| now + STEP)
    }
}

/// What it says, with the names of the user's own keys.
pub fn text(labels: &Labels) -> String {
    let block = labels.of("W A S D").replace(' ', "");
    format!("Click to look · {block} move · Esc releases the mouse · Tab panel · F1 help")
}

#[cfg(test)]
mod tests {
    use super::*;
    use winit::keyboard::{Key, KeyCode, PhysicalKey};

    #[test]
    fn the_hint_stays_until_the_first_move_and_fades_then() {
        let start = Instant::now();
        let mut hint = Hint::default();
        let much_later = start + Duration::from_secs(3600);
        assert_eq!((hint.opacity(much_later), hint.next_change(much_later)), (1.0, None));
        hint.moved(start);
        hint.moved(start + FADE);
        let half = hint.opacity(start + FADE / 2);
        assert!((half - 0.5).abs() < 0.01, "{half}");
        assert_eq!(hint.next_change(start), Some(start + STEP));
        assert_eq!((hint.opacity(start + FADE), hint.next_change(start + FADE)), (0.0, None));
    }

    #[test]
    fn keys_are_called_as_on_the_users_keyboard() {
        let mut labels = Labels::default();
        assert!(text(&labels).starts_with("Click to look · WASD move · Esc"));
        for (code, own) in [(KeyCode::KeyW, "z"), (KeyCode::KeyA, "q")] {
            labels.learn(PhysicalKey::Code(code), &Key::Character(own.into()));
        }
        assert!(text(&labels).contains("· ZQSD move ·"));
    }
}
