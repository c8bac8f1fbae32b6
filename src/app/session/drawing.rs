//! Drawing: the newest frame, the overlay over it, and the device that shows both.

use super::{Session, picture_size};
use crate::app::config::UI_SCALES;
use crate::app::error::AppError;
use crate::app::gpu::{Gpu, Target};
use crate::app::layer::Layer;
use crate::app::overlay::{self, Showing, Tuning, View};
use crate::app::present::{PixelRect, Presenter};
use crate::app::tracer::Job;
use cpu_time::ThreadTime;
use std::time::{Duration, Instant};

/// Until a surface that had nothing to draw on is asked again.
const ASK_AGAIN: Duration = Duration::from_millis(100);
/// A device lost twice within this time is not worth a third try.
const DEVICE_TRIAL: Duration = Duration::from_secs(10);
/// Between two looks at how far a load has come.
const TELL: Duration = Duration::from_millis(100);

impl Session {
    /// What the picture is.
    pub(super) fn showing(&self) -> Showing {
        match &self.traced {
            Some((job, samples)) if job.aspect.is_exact => Showing::Exact(*samples),
            _ if self.methods.wants_exact => Showing::ExactSoon,
            Some((_, Some(samples))) => Showing::Refined(*samples),
            Some((Job { lowering, .. }, None)) if lowering.level > 0 => {
                Showing::Moving { preset: lowering.preset, scale: lowering.scale }
            }
            _ => Showing::AsSet,
        }
    }

    pub(super) fn draw(&mut self, now: Instant) -> Result<(), AppError> {
        // What a software adapter computes on threads of its own is not seen here.
        let cpu = ThreadTime::now();
        self.redraw_requested = false;
        self.show_frame();
        if self.figures.is_due(now) {
            self.paint_overlay(now);
        }
        self.picture.met(now);
        match self.gpu.acquire() {
            Target::Ready(target) => self.presenter.show(&self.gpu, target),
            // Without a size there is nothing to ask for until the window comes back.
            Target::Later if self.gpu.size().0 == 0 || self.gpu.size().1 == 0 => {}
            Target::Later => self.picture.demand(now, ASK_AGAIN),
            Target::Lost(reason) => self.replace_device(now, reason)?,
        }
        self.stats.stages_ms.present = 1e3 * cpu.elapsed().as_secs_f64();
        Ok(())
    }

    /// Hands the newest frame to the presenter, or the films of two sides joined anew.
    pub(super) fn show_frame(&mut self) {
        let area = self.free_area();
        // Until there is a picture for the room that there is by now, the one before stays where it is.
        if self.fresh.as_ref().is_some_and(|frame| is_for(&frame.job, area)) {
            self.presenter.set_place(area);
        }
        let Self { methods, presenter, gpu, tracer, .. } = self;
        let mut present = |film| presenter.set_frame(gpu, film);
        let mut recycle = |film| tracer.recycle(film);
        if let Some(frame) = self.fresh.take() {
            methods.display(frame, &mut present, &mut recycle);
        } else if methods.split.is_outdated() && !methods.wants_exact {
            methods.split.present(&mut present, &mut recycle);
        }
    }

    pub(super) fn paint_overlay(&mut self, now: Instant) {
        let resting = self.history.is_resting(now) && !self.tracer.is_busy();
        self.notices.expire(now);
        self.scenes.expire(now);
        let camera = self.walker.camera();
        self.methods.is_elsewhere = self.methods.exam.as_ref().is_some_and(|exam| exam.camera != camera);
        let view = View {
            scene: &self.scene,
            settings: self.methods.edited(&self.settings),
            stats: &self.stats,
            history: &self.history,
            resting,
            refining: self.tracer.is_refining(),
            size: self.traced.as_ref().map_or(self.picture_size(), |(job, _)| (job.width, job.height)),
            showing: self.showing(),
            walking: self.walker.is_walking(),
            eye_height: self.walker.eye_height(),
            speed: self.walker.speed(),
            fov: self.walker.fov(),
            sensitivity: self.walker.sensitivity,
            invert_look: self.walker.invert_look,
            ui_scale: self.ui_scale,
            methods: &self.methods,
            left: &self.settings,
            tuning: Tuning {
                bound: self.bound,
                survey: self.survey.as_ref(),
                drawn: self.traced.as_ref().map_or(&self.settings, |(job, _)| &job.settings),
                is_elsewhere: self.survey.as_ref().is_some_and(|survey| survey.camera != camera),
            },
            scenes: self.scenes.report(now),
            lights: self.lighting.dials(),
            surroundings: &self.surroundings,
            inspection: self.inspection.as_ref(),
            stands: self.traced.as_ref().map(|(job, _)| job.camera).filter(|camera| *camera == self.walker.camera()),
            crosshair: self.capture.is_active(),
            notices: self.notices.current(),
            hint: self.hint.opacity(now),
            labels: &self.labels,
            activity: match (self.journey.is_recording(), self.journey.is_replaying()) {
                (true, _) => Some("recording"),
                (_, true) => Some("replaying"),
                _ => None,
            },
        };
        let mut changes = Vec::new();
        let shown = self.shown;
        let pointer_is_free = !self.capture.is_active();
        let painting = self.layer.run(self.gpu.size(), &self.window, pointer_is_free, |ui| {
            changes.extend(overlay::show(ui, &view, shown));
        });
        self.figures.met(now);
        let ends = [self.notices.next_end(), self.scenes.next_end(), self.hint.next_change(now)];
        ends.into_iter().flatten().for_each(|end| self.figures.demand_at(end));
        let Some(painting) = painting else { return };
        self.presenter.set_overlay(&self.gpu, &painting.job, painting.textures);
        if let Some(delay) = painting.again {
            // What egui wants redrawn by itself, such as a column that grew, is urgent only to someone pointing there.
            let interval = if self.layer.is_pointed_at() { self.rates.display } else { self.rates.figures };
            self.figures.demand(now + delay, interval);
        }
        if self.scenes.is_loading() {
            self.figures.demand_at(now + TELL);
        }
        if shown.overlay && !resting {
            // The last frame may have been shown: look again, to say so.
            self.figures.demand_at(now + Duration::from_millis(300));
        }
        if !changes.is_empty() {
            changes.into_iter().for_each(|change| self.apply(change));
            self.keeper.touch(now);
            self.repaint(now);
        }
    }

    /// Panel and text `scale` times as large as usual.
    pub(super) fn scale_ui(&mut self, scale: f32) {
        // In steps of a twentieth, so that as many steps back lead back.
        self.ui_scale = ((20.0 * scale).round() / 20.0).clamp(*UI_SCALES.start(), *UI_SCALES.end());
        self.layer.set_scale(self.ui_scale);
    }

    /// Starts over on a new device, unless the old one did not even last.
    pub(super) fn replace_device(&mut self, now: Instant, reason: String) -> Result<(), AppError> {
        if now.saturating_duration_since(self.device_made) < DEVICE_TRIAL {
            return Err(AppError::GraphicsLost(reason));
        }
        self.gpu = Gpu::new(&self.window, &self.display).map_err(AppError::GraphicsLost)?;
        self.device_made = now;
        self.replace_presenter(now);
        Ok(())
    }

    /// Starts showing frames in another way, or on another device.
    pub(super) fn replace_presenter(&mut self, now: Instant) {
        self.presenter = Presenter::new(&self.gpu, self.settings.present);
        self.presenter.set_place(self.free_area());
        self.layer = Layer::new(&self.gpu, &self.window, self.ui_scale);
        (self.posted, self.traced) = (None, None);
        self.repaint(now);
    }
}

/// Whether a job is for a picture in this part of the window.
fn is_for(job: &Job, [_, _, width, height]: PixelRect) -> bool {
    let (width, height) = picture_size((width, height));
    (job.width, job.height) == (job.lowering.scaled(width), job.lowering.scaled(height))
}
