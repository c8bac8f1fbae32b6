//! What was on display before the exact picture, to go back to at once.

use crate::app::tracer::Job;
use crate::render::Film;
use crate::scene::Camera;

/// What a picture shows, and with how many samples a pixel if it was refined.
pub type Shown = (Job, Option<u32>);

/// The picture that the exact one took the place of.
#[derive(Debug, Default)]
pub struct Kept {
    shown: Option<Shown>,
    film: Option<Film>,
}

impl Kept {
    /// An exact picture comes after what was `shown`: the first one is what counts.
    pub fn leave(&mut self, shown: Option<Shown>) {
        if let Some(shown) = shown.filter(|(job, _)| !job.aspect.is_exact) {
            self.shown = Some(shown);
        }
    }

    /// Keeps the film that left the display for the first exact picture; later ones took an exact picture's place.
    pub fn keep(&mut self, film: Option<Film>, recycle: &mut dyn FnMut(Film)) {
        let Some(film) = film else { return };
        if self.film.is_none() && self.shown.is_some() { self.film = Some(film) } else { recycle(film) }
    }

    /// What to show again, and what it is. Seen from elsewhere than `camera` it would be a leap: then nothing.
    pub fn take(&mut self, camera: &Camera) -> (Option<Film>, Option<Shown>) {
        let (film, shown) = (self.film.take(), self.shown.take());
        let is_here = shown.as_ref().is_some_and(|(job, _)| job.camera == *camera);
        (film.filter(|_| is_here), shown.filter(|_| is_here))
    }

    /// Gives it up.
    pub fn clear(&mut self, recycle: &mut dyn FnMut(Film)) {
        self.shown = None;
        self.film.take().into_iter().for_each(recycle);
    }
}
