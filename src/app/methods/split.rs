//! Two settings side by side: one picture of both, joined at a divider that moves without a frame being traced anew.

use crate::render::{Film, Planes};
use crate::settings::Settings;

/// Nearer to an edge of the picture, as a share of its width, the divider does not go: it could not be reached any more.
const MARGIN: f32 = 0.02;

/// A side of the divider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The settings as ever.
    Left,
    /// Those beside.
    Right,
}

/// Two settings side by side.
#[derive(Debug)]
pub struct Split {
    /// Whether they are shown.
    pub is_on: bool,
    /// The settings of the right side.
    pub right: Settings,
    /// Which side's settings the panel edits.
    pub edited: Side,
    /// How long the frames took, left and right.
    pub milliseconds: [f64; 2],
    /// Where the divider is, as a share of the width.
    share: f32,
    /// It was moved since the films were joined.
    is_moved: bool,
    films: Option<[Film; 2]>,
    /// A film that both were joined in, not on display.
    spare: Option<Film>,
}

impl Split {
    /// Switched off, the divider in the middle.
    pub fn new(right: Settings) -> Self {
        let (is_on, is_moved) = (false, false);
        let (edited, milliseconds) = (Side::Left, [0.0; 2]);
        Self { is_on, right, edited, milliseconds, share: 0.5, is_moved, films: None, spare: None }
    }

    /// Shows or hides the right side.
    pub fn switch(&mut self, is_on: bool) {
        (self.is_on, self.edited) = (is_on, Side::Left);
    }

    /// Where the divider is, as a share of the width.
    pub fn share(&self) -> f32 {
        self.share
    }

    /// Moves the divider.
    pub fn move_to(&mut self, share: f32) {
        let share = share.clamp(MARGIN, 1.0 - MARGIN);
        self.is_moved |= share != self.share;
        self.share = share;
    }

    /// Whether the films on display are to be joined anew.
    pub fn is_outdated(&self) -> bool {
        self.is_moved && self.films.is_some()
    }

    /// Takes new films, left and right.
    pub fn take(&mut self, films: [Film; 2], recycle: &mut dyn FnMut(Film)) {
        self.films.replace(films).into_iter().flatten().for_each(recycle);
    }

    /// Gives the films up.
    pub fn clear(&mut self, recycle: &mut dyn FnMut(Film)) {
        self.films.take().into_iter().flatten().chain(self.spare.take()).for_each(recycle);
    }

    /// Joins the films at the divider and shows that.
    pub fn present(&mut self, present: &mut dyn FnMut(Film) -> Option<Film>, recycle: &mut dyn FnMut(Film)) {
        self.is_moved = false;
        let Some([left, right]) = &self.films else { return };
        let (width, height) = (left.width(), left.height());
        let fits = |film: &Film| (film.width(), film.height()) == (width, height);
        let spare = self.spare.take().filter(fits);
        let mut joined = spare.unwrap_or_else(|| Film::new(width, height, Planes::default()));
        let divider = ((self.share * width as f32).round() as u32).min(width);
        joined.copy_columns(left, 0..divider);
        joined.copy_columns(right, divider..width);
        match present(joined) {
            Some(old) if fits(&old) => self.spare = Some(old),
            old => old.into_iter().for_each(recycle),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(value: u8) -> Film {
        let mut film = Film::new(10, 4, Planes::default());
        film.paint(|_, _, _, _| [value; 3]);
        film
    }

    #[test]
    fn films_are_joined_where_the_divider_is() {
        let mut split = Split::new(Settings::exact());
        let (mut shown, mut recycled) = (Vec::new(), 0);
        split.take([film(10), film(200)], &mut |_| recycled += 1);
        assert!(!split.is_outdated());
        for (share, columns) in [(0.5, 5), (0.31, 3), (-1.0, 0), (7.0, 10)] {
            split.move_to(share);
            split.present(
                &mut |film| {
                    shown
                        .push(film.rgba().chunks(40).map(|row| row.chunks(4).filter(|p| p[0] == 10).count()).collect());
                    Some(film)
                },
                &mut |_| recycled += 1,
            );
            assert_eq!(shown.pop(), Some(vec![columns; 4]), "{share}");
            assert!(!split.is_outdated());
        }
        assert_eq!(recycled, 0);
        split.clear(&mut |_| recycled += 1);
        assert_eq!(recycled, 3);
    }

    #[test]
    fn a_divider_that_moved_asks_for_no_frame() {
        let mut split = Split::new(Settings::exact());
        split.move_to(0.4);
        assert!(!split.is_outdated(), "nothing to join");
        split.take([film(10), film(200)], &mut |_| {});
        assert!(split.is_outdated());
        split.move_to(f32::MAX);
        assert!(split.share() < 1.0, "it can be reached");
    }
}
