//! Notices: one line each on what was just done or went wrong, gone after some seconds.

use super::{placing, theme};
use egui::{Align2, Area, Color32, Frame, Label, RichText, Ui};
use std::time::{Duration, Instant};

/// Most notices on display: the oldest makes room for the newest.
const MOST: usize = 4;
/// How long a notice stays: at least so long, and longer for every character.
const LEAST_TIME: Duration = Duration::from_millis(3000);
const TIME_PER_CHARACTER: Duration = Duration::from_millis(50);
/// However long it is, it goes after this time.
const MOST_TIME: Duration = Duration::from_secs(15);
/// Greatest width of a notice, and its distance from the window's lower edge, in points.
const WIDTH: f32 = 640.0;
const MARGIN: f32 = 24.0;

/// What a notice speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// Something was done.
    Done,
    /// Something could not be done.
    Problem,
}

/// A line for the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// What it says.
    pub text: String,
    /// What it speaks of.
    pub tone: Tone,
    until: Instant,
}

/// What is on display, the oldest first.
#[derive(Clone, Debug, Default)]
pub struct Notices {
    current: Vec<Notice>,
}

impl Notices {
    /// Says that something was done.
    pub fn tell(&mut self, now: Instant, text: impl Into<String>) {
        self.add(now, text.into(), Tone::Done);
    }

    /// Says that something could not be done, and why.
    pub fn warn(&mut self, now: Instant, text: impl Into<String>) {
        self.add(now, text.into(), Tone::Problem);
    }

    /// The same words again are not said twice: they stay for longer.
    fn add(&mut self, now: Instant, text: String, tone: Tone) {
        self.current.retain(|notice| notice.text != text);
        if self.current.len() == MOST {
            self.current.remove(0);
        }
        let characters = u32::try_from(text.chars().count()).unwrap_or(u32::MAX);
        let time = LEAST_TIME + TIME_PER_CHARACTER.saturating_mul(characters);
        self.current.push(Notice { text, tone, until: now + time.min(MOST_TIME) });
    }

    /// Takes away what was there for long enough.
    pub fn expire(&mut self, now: Instant) {
        self.current.retain(|notice| notice.until > now);
    }

    /// What is on display, the oldest first.
    pub fn current(&self) -> &[Notice] {
        &self.current
    }

    /// When the next one goes, if there is any.
    pub fn next_end(&self) -> Option<Instant> {
        self.current.iter().map(|notice| notice.until).min()
    }
}

/// Draws notices above the middle of the lower edge, the newest lowest. Clicks go through them.
pub fn show(ui: &Ui, notices: &[Notice]) {
    if notices.is_empty() {
        return;
    }
    let width = WIDTH.min(ui.ctx().content_rect().width() - 2.0 * MARGIN).max(1.0);
    let id = egui::Id::unique("notices");
    let area = Area::new(id).anchor(Align2::CENTER_BOTTOM, [0.0, -MARGIN]).order(egui::Order::Foreground);
    placing::show(ui.ctx(), id, area.interactable(false), |ui| {
        ui.set_max_width(width);
        for notice in notices {
            let frame = Frame::new().fill(theme::BACKGROUND).inner_margin(8.0).corner_radius(5.0);
            frame.show(ui, |ui| ui.add(Label::new(RichText::new(&notice.text).color(color(notice.tone))).wrap()));
        }
    });
}

fn color(tone: Tone) -> Color32 {
    match tone {
        Tone::Done => theme::STRONG,
        Tone::Problem => theme::WARNING,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(notices: &Notices) -> Vec<&str> {
        notices.current().iter().map(|notice| notice.text.as_str()).collect()
    }

    #[test]
    fn a_notice_goes_after_its_time_and_longer_ones_stay_longer() {
        let now = Instant::now();
        let mut notices = Notices::default();
        assert_eq!(notices.next_end(), None);
        notices.tell(now, "short");
        notices.warn(now, "l".repeat(100));
        let first = notices.next_end().expect("there are two");
        assert!(first > now + LEAST_TIME);
        notices.expire(first);
        assert_eq!(notices.current().len(), 1);
        assert_eq!(notices.current()[0].tone, Tone::Problem);
        notices.warn(now, "x".repeat(100_000));
        notices.expire(now + MOST_TIME);
        assert!(notices.current().is_empty());
    }

    #[test]
    fn words_said_again_stay_and_the_oldest_make_room() {
        let now = Instant::now();
        let later = now + Duration::from_secs(1);
        let mut notices = Notices::default();
        for text in ["a", "b", "a"] {
            notices.tell(if text == "b" { now } else { later }, text);
        }
        assert_eq!(texts(&notices), ["b", "a"]);
        for text in ["c", "d", "e"] {
            notices.tell(later, text);
        }
        assert_eq!(texts(&notices), ["a", "c", "d", "e"]);
    }
}
