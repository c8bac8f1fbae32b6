//! Notices: one line each on what was just done or went wrong, gone after some seconds.

use super::{placing, theme};
use egui::{Align2, Area, Color32, Frame, Label, Rect, RichText, Ui};
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

    /// Says that something was done, in place of the notice that begins with the same word.
    pub fn replace(&mut self, now: Instant, text: impl Into<String>) {
        let text = text.into();
        let first = |text: &str| text.split(' ').next().map(str::to_owned);
        self.current.retain(|notice| first(&notice.text) != first(&text));
        self.add(now, text, Tone::Done);
    }

    /// Says what is to be known until it is [taken back](Self::take_back), for as long as a notice can stay.
    pub fn advise(&mut self, now: Instant, text: impl Into<String>) {
        let text = text.into();
        self.add(now, text.clone(), Tone::Problem);
        if let Some(notice) = self.current.iter_mut().find(|notice| notice.text == text) {
            notice.until = now + MOST_TIME;
        }
    }

    /// Takes a notice away before its time.
    pub fn take_back(&mut self, text: &str) {
        self.current.retain(|notice| notice.text != text);
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

/// Draws notices above the middle of the lower edge of the picture, which is `free` of the panel, the newest lowest; below
/// them a hint of some opacity. Clicks go through them.
pub fn show(ui: &Ui, notices: &[Notice], hint: Option<(&str, f32)>, free: Rect) {
    if notices.is_empty() && hint.is_none() {
        return;
    }
    let width = WIDTH.min(free.width() - 2.0 * MARGIN).max(1.0);
    let id = egui::Id::unique("notices");
    let area = Area::new(id).constrain_to(free).anchor(Align2::CENTER_BOTTOM, [0.0, -MARGIN]);
    placing::show(ui.ctx(), id, area.order(egui::Order::Foreground).interactable(false), |ui| {
        ui.set_max_width(width);
        for notice in notices {
            line(ui, &notice.text, color(notice.tone));
        }
        if let Some((hint, opacity)) = hint {
            ui.set_opacity(opacity);
            line(ui, hint, theme::STRONG);
        }
    });
}

fn line(ui: &mut Ui, text: &str, color: Color32) {
    let frame = Frame::new().fill(theme::BACKGROUND).inner_margin(8.0).corner_radius(5.0);
    frame.show(ui, |ui| ui.add(Label::new(RichText::new(text).color(color)).wrap()));
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
    fn a_figure_that_changes_is_one_notice() {
        let now = Instant::now();
        let mut notices = Notices::default();
        notices.tell(now, "Camera copied");
        notices.replace(now, "Speed 2.4 m/s");
        notices.replace(now, "Speed 2.6 m/s");
        assert_eq!(texts(&notices), ["Camera copied", "Speed 2.6 m/s"]);
    }

    #[test]
    fn advice_stays_until_it_is_taken_back() {
        let now = Instant::now();
        let mut notices = Notices::default();
        notices.advise(now, "outside");
        notices.expire(now + MOST_TIME - Duration::from_millis(1));
        assert_eq!(texts(&notices), ["outside"]);
        notices.take_back("outside");
        assert!(notices.current().is_empty());
        notices.advise(now, "outside");
        notices.expire(now + MOST_TIME);
        assert!(notices.current().is_empty(), "at last");
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
