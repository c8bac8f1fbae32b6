//! What was on display before the exact picture, to go back to at once.

use crate::app::tracer::Job;
use crate::render::{Film, FrameStats};
use crate::scene::Camera;

/// What a picture shows, and with how many samples a pixel if it was refined.
pub type Shown = (Job, Option<u32>);

/// The picture that the exact one took the place of.
#[derive(Debug, Default)]
pub struct Kept {
    shown: Option<Shown>,
    film: Option<Film>,
    /// What it cost.
    stats: Option<FrameStats>,
}

impl Kept {
    /// An exact picture comes after what was `shown` and cost `stats`: the first one is what counts.
    pub fn leave(&mut self, shown: Option<Shown>, stats: &FrameStats) {
        if let Some(shown) = shown.filter(|(job, _)| !job.aspect.is_exact) {
            (self.shown, self.stats) = (Some(shown), Some(stats.clone()));
        }
    }

    /// Keeps the film that left the display for the first exact picture; later ones took an exact picture's place.
    pub fn keep(&mut self, film: Option<Film>, recycle: &mut dyn FnMut(Film)) {
        let Some(film) = film else { return };
        if self.film.is_none() && self.shown.is_some() { self.film = Some(film) } else { recycle(film) }
    }

    /// What to show again, what it is and what it cost. Seen from elsewhere than `camera` it would be a leap: then only that.
    pub fn take(&mut self, camera: &Camera) -> (Option<Film>, Option<Shown>, Option<FrameStats>) {
        let (film, shown) = (self.film.take(), self.shown.take());
        let is_here = shown.as_ref().is_some_and(|(job, _)| job.camera == *camera);
        (film.filter(|_| is_here), shown.filter(|_| is_here), self.stats.take())
    }

    /// Gives it up.
    pub fn clear(&mut self, recycle: &mut dyn FnMut(Film)) {
        (self.shown, self.stats) = (None, None);
        self.film.take().into_iter().for_each(recycle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::lowering::Lowering;
    use crate::app::methods::Aspect;
    use crate::render::Planes;
    use crate::scene::nothing;
    use crate::settings::Settings;
    use std::sync::Arc;

    #[test]
    fn what_comes_back_is_the_picture_before_the_first_exact_one_and_what_it_cost() {
        let scene = Arc::new(nothing().expect("it is built in"));
        let (settings, lowering, aspect) = (Settings::balanced(), Lowering::NONE, Aspect::default());
        let job = Job { scene, camera: Camera::default(), settings, width: 8, height: 4, lowering, aspect };
        let exact = Job { aspect: Aspect { is_exact: true, ..Aspect::default() }, ..job.clone() };
        let film = || Some(Film::new(8, 4, Planes::default()));
        let cost = |frame_ms| FrameStats { frame_ms, ..FrameStats::default() };
        let mut recycled = 0;
        let mut kept = Kept::default();
        for _ in 0..2 {
            kept.leave(Some((job.clone(), Some(16))), &cost(5.0));
            kept.keep(film(), &mut |_| recycled += 1);
            kept.leave(Some((exact.clone(), None)), &cost(50.0));
            kept.keep(film(), &mut |_| recycled += 1);
            let (film, shown, stats) = kept.take(&job.camera);
            assert_eq!((film.is_some(), shown, stats), (true, Some((job.clone(), Some(16))), Some(cost(5.0))));
        }
        assert_eq!(recycled, 2);
        kept.leave(Some((job, None)), &cost(5.0));
        kept.keep(film(), &mut |_| {});
        let (film, shown, stats) = kept.take(&Camera { fov: 7.0, ..Camera::default() });
        assert_eq!((film.is_none(), shown, stats), (true, None, Some(cost(5.0))), "seen from elsewhere");
    }
}
