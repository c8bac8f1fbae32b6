//! What the tracing thread keeps of a view from frame to frame, and what it adds to a frame that shows more than a picture.

use super::at_rest::AtRest;
use super::survey::of_frames;
use super::tracer::{Job, Render, TracedFrame};
use crate::render::{Film, Planes};
use crate::scene::Scene;
use std::sync::Arc;

/// What is kept of views.
#[derive(Debug, Default)]
pub struct Views {
    /// The last one, as it is refined at rest.
    pub at_rest: AtRest,
    exact: ExactView,
}

impl Views {
    /// Adds to a frame, whose own picture was traced, what its job asks for besides: the picture by other settings, and a map's
    /// colours. False when that was cancelled.
    pub fn complete(&mut self, frame: &mut TracedFrame, film_for: &dyn Fn(&Job) -> Film, render: Render<'_>) -> bool {
        self.exact.stay_in(&frame.job.scene);
        if let Some(settings) = &frame.job.aspect.beside {
            let mut film = film_for(&frame.job);
            let stats = render(&frame.job.with_settings(settings.clone()), &mut film);
            frame.beside = Some((film, stats.frame_ms));
            if !stats.completed {
                return false;
            }
        }
        let map = frame.job.aspect.map;
        let exact = if map.needs_exact() {
            let Some(exact) = self.exact.of(&frame.job, render) else { return false };
            Some(exact)
        } else {
            None
        };
        frame.legend = match &mut frame.beside {
            Some((beside, _)) => map.paint(&mut [&mut frame.film, beside], exact),
            None => map.paint(&mut [&mut frame.film], exact),
        };
        true
    }
}

/// The exact picture of the last view that it was asked for.
#[derive(Debug, Default)]
struct ExactView {
    traced: Option<(Job, Film)>,
}

impl ExactView {
    /// Gives up what is kept of other scenes than `scene`: it would hold all of them in memory.
    fn stay_in(&mut self, scene: &Arc<Scene>) {
        self.traced.take_if(|(job, _)| !Arc::ptr_eq(&job.scene, scene));
    }

    /// The exact picture of what `job` shows; `None` when it was cancelled.
    fn of(&mut self, job: &Job, render: Render<'_>) -> Option<&Film> {
        let exact = job.with_settings(of_frames(&job.settings.reference(), 0));
        let kept = self.traced.take().filter(|(_, film)| (film.width(), film.height()) == (job.width, job.height));
        let film = match kept {
            Some((kept, film)) if kept == exact => film,
            kept => {
                let mut film =
                    kept.map_or_else(|| Film::new(job.width, job.height, Planes::default()), |(_, film)| film);
                if !render(&exact, &mut film).completed {
                    return None;
                }
                film
            }
        };
        Some(&self.traced.insert((exact, film)).1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::lowering::Lowering;
    use crate::app::maps::{Key, Map};
    use crate::app::methods::Aspect;
    use crate::render::{Scratch, render_frame};
    use crate::scene::{LoadOptions, builtin, nothing};
    use crate::settings::{Settings, Visibility};
    use std::sync::LazyLock;
    use std::time::Instant;

    /// Completes a frame of the built-in scene; its picture was traced before. Returns the settings of what was traced then.
    fn completed(views: &mut Views, job: Job) -> (TracedFrame, Vec<Settings>) {
        let scene = Arc::clone(&job.scene);
        let mut scratch = Scratch::new();
        let mut traced = Vec::new();
        let mut render = |job: &Job, film: &mut Film| {
            traced.push(job.settings.clone());
            render_frame(&scene, &scene.cameras[0].camera, &job.settings, &mut scratch, film)
        };
        let film_for = |job: &Job| Film::new(job.width, job.height, job.aspect.map.planes());
        let mut film = film_for(&job);
        let stats = render(&job, &mut film);
        let (finished, samples) = (Instant::now(), None);
        let mut frame =
            TracedFrame { film, stats, cpu_ms: 0.0, whole_ms: 0.0, finished, job, samples, beside: None, legend: None };
        assert!(views.complete(&mut frame, &film_for, &mut render));
        traced.remove(0);
        (frame, traced)
    }

    fn job(aspect: Aspect) -> Job {
        static SCENE: LazyLock<Arc<Scene>> =
            LazyLock::new(|| Arc::new(builtin(&LoadOptions::default()).expect("it loads")));
        let (scene, settings, lowering) = (Arc::clone(&SCENE), Settings::fast(), Lowering::NONE);
        Job { scene, camera: Default::default(), settings, width: 64, height: 36, lowering, aspect }
    }

    #[test]
    fn a_picture_needs_nothing_more() {
        let (frame, traced) = completed(&mut Views::default(), job(Aspect::default()));
        assert!(traced.is_empty() && frame.beside.is_none() && frame.legend.is_none());
    }

    #[test]
    fn the_exact_picture_of_a_view_is_traced_once_for_all_error_maps() {
        let mut views = Views::default();
        let aspect = Aspect { map: Map::Error, ..Aspect::default() };
        let (frame, traced) = completed(&mut views, job(aspect.clone()));
        assert_eq!(traced.iter().map(|settings| settings.visibility).collect::<Vec<_>>(), [Visibility::Full]);
        let Some(Key::Scale(scale)) = frame.legend.map(|legend| legend.key) else { panic!("errors are numbers") };
        assert_ne!(scale.sums, ["max 0, RMSE 0.00"]);
        let mut other = job(aspect);
        other.settings.fill = crate::settings::Fill::Hit;
        assert!(completed(&mut views, other).1.is_empty(), "of other settings the exact picture is the same");
    }

    #[test]
    fn a_scene_that_was_left_is_not_kept() {
        let mut views = Views::default();
        let scene = Arc::new(nothing().expect("it is built in"));
        let left = Arc::downgrade(&scene);
        let aspect = Aspect { map: Map::Error, ..Aspect::default() };
        completed(&mut views, Job { scene, ..job(aspect) });
        assert!(left.upgrade().is_some(), "its exact picture may be wanted again");
        completed(&mut views, job(Aspect::default()));
        assert!(left.upgrade().is_none());
    }

    #[test]
    fn settings_beside_are_painted_with_the_same_map() {
        let beside = Some(Settings::exact());
        let aspect = Aspect { map: Map::Error, beside, ..Aspect::default() };
        let (frame, traced) = completed(&mut Views::default(), job(aspect));
        assert_eq!(traced.len(), 2);
        let Some(Key::Scale(scale)) = frame.legend.map(|legend| legend.key) else { panic!("errors are numbers") };
        assert_eq!(scale.sums.len(), 2);
        assert_eq!(scale.sums[1], "max 0, RMSE 0.00", "exact");
        let (_, other) =
            completed(&mut Views::default(), job(Aspect { beside: Some(Settings::exact()), ..Aspect::default() }));
        assert_eq!(other, [Settings::exact()]);
    }
}
