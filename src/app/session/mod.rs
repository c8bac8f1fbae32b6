//! One open window: what it is made of, and when to trace and draw. The rest of what it does is sorted by occasion.

mod changes;
mod commands;
mod drawing;
mod events;
mod keeping;
mod scenes;

use crate::app::at_rest::REST;
use crate::app::capture::Capture;
use crate::app::config::{Keeper, WindowState};
use crate::app::errands::{self, Errands};
use crate::app::error::AppError;
use crate::app::gpu::Gpu;
use crate::app::hint::Hint;
use crate::app::history::History;
use crate::app::input::Keys;
use crate::app::inspection::Inspection;
use crate::app::journey::Journey;
use crate::app::labels::Labels;
use crate::app::layer::Layer;
use crate::app::lighting::Lighting;
use crate::app::lowering::{Lowering, lowered, presets_below};
use crate::app::methods::Methods;
use crate::app::outside::{Crossing, Outside};
use crate::app::overlay::{self, Notices, Panel, Shown};
use crate::app::pacing::{Limiter, Rates};
use crate::app::present::{PixelRect, Presenter};
use crate::app::scenes::Scenes;
use crate::app::screenshot::Camerawork;
use crate::app::steering::Steering;
use crate::app::surroundings::Surroundings;
use crate::app::survey::Survey;
use crate::app::tally::Tally;
use crate::app::tracer::{Job, TracedFrame, Tracer};
use crate::app::viewer::Call;
use crate::app::walker::Walker;
use crate::app::{AppExit, AppOptions, Opening, desktop};
use crate::measure::metric::{METRICS, metric};
use crate::measure::tune::Bound;
use crate::picture::NumberedName;
use crate::render::FrameStats;
use crate::scene::{self, Camera, Scene};
use crate::settings::Settings;
use glam::DVec2;
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::event_loop::{ActiveEventLoop, OwnedDisplayHandle};
use winit::window::Window;

/// Between two steps of the walker: finer than any display, so that a frame starts from a fresh place.
const STEP: Duration = Duration::from_millis(8);
/// Most pixels of a traced picture (8K): larger windows show it enlarged.
const MAX_PIXELS: f64 = 7680.0 * 4320.0;
/// What is told where a walker does not fit.
const NO_ROOM: &str = "Not enough room to walk here; still flying";
/// What is told where there is nothing to be seen around.
const OUTSIDE: &str = "Outside the scene: Home returns";

/// Everything that lives as long as the window. Dropped from the top: the tracer is joined before the window goes.
pub struct Session {
    tracer: Tracer,
    layer: Layer,
    presenter: Presenter,
    gpu: Gpu,
    window: Arc<Window>,
    display: OwnedDisplayHandle,
    scenes: Scenes,
    /// The scene as it was loaded, and as it is lit.
    scene: Arc<Scene>,
    lit: Arc<Scene>,
    lighting: Lighting,
    surroundings: Surroundings,
    inspection: Option<Inspection>,
    settings: Settings,
    walker: Walker,
    keys: Keys,
    labels: Labels,
    journey: Journey,
    capture: Capture,
    /// Where the pointer is, in physical pixels.
    pointer: DVec2,
    history: History,
    stats: FrameStats,
    /// What a record at the end is made of, where one is wanted.
    tally: Option<Tally>,
    shown: Shown,
    notices: Notices,
    hint: Hint,
    outside: Outside,
    keeper: Keeper,
    /// The window opened as the last one was: no scene resizes it.
    is_placed: bool,
    ui_scale: f32,
    errands: Errands,
    screenshots: NumberedName,
    camerawork: Camerawork,
    posted: Option<Job>,
    /// What the last frame shows, and with how many samples a pixel if it was refined.
    traced: Option<(Job, Option<u32>)>,
    steering: Steering,
    methods: Methods,
    /// What the next search has to keep, and what is known of the last.
    bound: Bound,
    survey: Option<Survey>,
    /// Where the walker last was, and since when it has been there.
    stands: (Camera, Option<Instant>),
    fresh: Option<TracedFrame>,
    rates: Rates,
    /// When to present, and when to draw the overlay before that.
    picture: Limiter,
    figures: Limiter,
    redraw_requested: bool,
    occluded: bool,
    /// When the walker last took a step, while keys are held.
    stepped: Option<Instant>,
    device_made: Instant,
}

impl Session {
    /// Opens the window and starts the tracer. Other threads wake the event loop by `call`.
    pub fn open(
        event_loop: &ActiveEventLoop,
        options: &AppOptions,
        call: Arc<dyn Fn(Call) + Send + Sync>,
    ) -> Result<Self, AppError> {
        let wake = Arc::clone(&call);
        let mut scenes =
            Scenes::new(options.load.clone(), options.config.recent.clone(), Arc::new(move || wake(Call::Scenes)));
        let (scene, camera) = match &options.opening {
            Opening::Scene(arrival) => {
                scenes.show(arrival);
                (Arc::clone(&arrival.scene), arrival.camera)
            }
            Opening::Loading(..) => {
                let nothing = scene::nothing().map_err(|error| AppError::NoScene(error.into()))?;
                let camera = nothing.cameras[0].camera;
                (Arc::new(nothing), camera)
            }
        };
        let attributes = Window::default_attributes().with_title(title(&scene));
        let size = WindowState { size: WindowState::nearest_size(options.size), ..WindowState::default() };
        let place = options.config.window.filter(|_| options.as_before).unwrap_or(size);
        let attributes = desktop::placed(attributes, place, event_loop);
        let window = event_loop.create_window(attributes).map_err(|error| AppError::NoDisplay(error.to_string()))?;
        let window = Arc::new(window);
        let display = event_loop.owned_display_handle();
        let gpu = Gpu::new(&window, &display).map_err(AppError::NoDisplay)?;
        // Not sooner: without a window the load is waited for elsewhere.
        if let Opening::Loading(load, file) = &options.opening {
            scenes.expect(load.clone(), file.clone());
        }
        let millihertz = window.current_monitor().and_then(|monitor| monitor.refresh_rate_millihertz());
        let rates = Rates::new(millihertz, gpu.is_software);
        let now = Instant::now();
        let mut keeper = Keeper::new(options.store.clone(), options.config.clone(), &options.settings);
        keeper.open_window(place);
        let is_placed = options.as_before && options.config.window.is_some();
        let config = &keeper.config;
        let mut walker = Walker::in_scene(&scene, camera);
        walker.invert_look = config.invert_look;
        walker.sensitivity = config.sensitivity.unwrap_or(walker.sensitivity);
        let outside = whereabouts(&scene, camera);
        let news = Arc::clone(&call);
        let mut session = Self {
            tracer: Tracer::start(rates.display, move |word| call(Call::Traced(word)))?,
            layer: Layer::new(&gpu, &window, config.ui_scale),
            presenter: Presenter::new(&gpu, options.settings.present),
            gpu,
            window,
            display,
            settings: options.settings.clone(),
            walker,
            scenes,
            lighting: Lighting::of(&scene),
            surroundings: Surroundings::of(&scene),
            lit: Arc::clone(&scene),
            scene,
            inspection: None,
            keys: Keys::default(),
            labels: Labels::default(),
            journey: Journey::default(),
            capture: Capture::default(),
            pointer: DVec2::ZERO,
            history: History::default(),
            stats: FrameStats::default(),
            tally: options.tells.then(Tally::default),
            shown: Shown { panel: if config.panel { Panel::Open } else { Panel::Closed }, ..Shown::default() },
            notices: Notices::default(),
            hint: Hint::default(),
            outside,
            ui_scale: config.ui_scale,
            keeper,
            is_placed,
            errands: Errands::start(move || news(Call::Errand))?,
            screenshots: options.screenshots.clone(),
            camerawork: Camerawork::default(),
            posted: None,
            traced: None,
            steering: Steering::new(presets_below(&options.settings)),
            methods: Methods::new(&options.settings),
            bound: overlay::usual_bound(metric("flip").unwrap_or(&METRICS[0])),
            survey: None,
            stands: (camera, None),
            fresh: None,
            rates,
            picture: Limiter::default(),
            figures: Limiter::default(),
            redraw_requested: false,
            occluded: false,
            stepped: None,
            device_made: now,
        };
        session.repaint(now);
        Ok(session)
    }

    /// Ends the session and says where it stood.
    pub fn close(mut self) -> AppExit {
        let (camera, settings) = (self.walker.camera(), self.settings.clone());
        self.save_config();
        if let Some(shot) = self.camerawork.give_up() {
            self.write(shot);
        }
        let place = (self.walker.surroundings(), self.scene.origin);
        let recorded = self.journey.finish(Instant::now(), camera, self.path_folders(), place, String::new());
        recorded.into_iter().for_each(|errand| self.errands.run(errand));
        let (mut notes, mut warnings) = (Vec::new(), Vec::new());
        for news in self.errands.finish() {
            match news {
                errands::News::Done(text) => notes.push(text),
                errands::News::Problem(text) => warnings.push(text),
            }
        }
        if self.camerawork.is_due() {
            warnings.push("No screenshot: the changed scene was not shown any more".to_owned());
        }
        let record = self.tally.and_then(|tally| tally.record(self.scenes.load_ms()));
        AppExit { camera, settings, notes, warnings, record }
    }

    /// Takes the newest frame from the tracer, to be shown when it is time, and what a search has come to.
    pub fn fetch_frame(&mut self) {
        if let Some(survey) = self.tracer.take_survey(&self.lit) {
            self.survey = Some(survey);
            self.figures.demand(Instant::now(), self.rates.figures);
        }
        if let Some(exam) = self.tracer.take_exam(&self.lit) {
            self.methods.exam = Some(exam);
            self.figures.demand(Instant::now(), self.rates.figures);
        }
        let Some(frame) = self.tracer.take() else { return };
        let now = Instant::now();
        // The same view with fewer samples is a step back: it is on its way to more.
        let is_less = self.traced.as_ref().is_some_and(|(job, samples)| *job == frame.job && *samples > frame.samples);
        if is_less || !self.methods.shows(&frame) {
            return frame.into_films().for_each(|film| self.tracer.recycle(film));
        }
        if let Some(shot) = self.camerawork.frame(&frame.film, &frame.job, frame.samples) {
            self.write(shot);
        }
        let before = self.traced.replace((frame.job.clone(), frame.samples));
        if frame.job.aspect.is_exact {
            self.methods.leave(before, &self.stats);
        }
        if frame.samples.is_none() {
            // What is looked at for a moment is no part of the walk's times.
            if !frame.job.aspect.is_exact {
                self.history.record(frame.finished, frame.stats.frame_ms);
                if let Some(fps) = self.settings.target_fps {
                    self.steering.measured(frame.job.lowering.level, frame.whole_ms, 1e3 / f64::from(fps));
                }
            }
            let present = self.stats.stages_ms.present;
            self.stats = frame.stats.clone();
            // Of the one before: this one is still to be presented.
            self.stats.stages_ms.present = present;
            if let Some(tally) = &mut self.tally {
                tally.add(&frame, &self.stats);
            }
        }
        if let Some(missed) = self.fresh.replace(frame) {
            missed.into_films().for_each(|film| self.tracer.recycle(film));
        }
        self.picture.demand(now, self.rates.display);
        if self.shown.overlay {
            self.figures.demand(now, self.rates.figures);
        }
        if self.camerawork.is_due() {
            self.take_screenshot(now);
        }
    }

    /// Moves on, asks for frames and drawings as needed, and says when to be called again at the latest.
    pub fn tick(&mut self, now: Instant) -> Option<Instant> {
        self.step(now);
        if self.scenes.open_dropped() {
            self.repaint(now);
        }
        if self.keeper.due().is_some_and(|due| due <= now) {
            self.save_config();
        }
        let travel = self.travel(now);
        let rest = self.post(now);
        let mut next = self.tracer.drop_outdated();
        let mut call_at = |at: Instant| next = Some(next.map_or(at, |next: Instant| next.min(at)));
        rest.into_iter().chain(travel).chain(self.keeper.due()).for_each(&mut call_at);
        if self.stepped.is_some() {
            call_at(now + STEP);
        }
        if !self.redraw_requested && !self.occluded {
            if self.figures.is_due(now) {
                self.picture.demand(now, self.rates.display);
            }
            if self.picture.is_due(now) {
                self.redraw_requested = true;
                self.window.request_redraw();
            } else {
                let figures = self.figures.due().filter(|&at| at > now);
                figures.into_iter().chain(self.picture.due()).for_each(call_at);
            }
        }
        next
    }

    /// Walks up to `now`, as far as keys were held until here.
    fn step(&mut self, now: Instant) {
        let motion = self.keys.motion();
        if motion.is_moving() {
            self.journey.stop_replay();
            self.first_move(now);
        }
        let passed = self.stepped.map_or(Duration::ZERO, |before| now.saturating_duration_since(before));
        if !self.walker.advance(&self.scene.geometry, motion, passed.as_secs_f64()) {
            self.notices.warn(now, NO_ROOM);
            self.repaint(now);
        }
        self.stepped = (motion.is_moving() || self.walker.is_under_way()).then_some(now);
        match self.outside.see(self.walker.camera().eye) {
            Some(Crossing::Left) => self.notices.advise(now, OUTSIDE),
            Some(Crossing::Returned) => self.notices.take_back(OUTSIDE),
            None => return,
        }
        self.repaint(now);
    }

    /// The user knows how to move: the hint fades.
    fn first_move(&mut self, now: Instant) {
        if self.hint.opacity(now) > 0.0 && self.hint.next_change(now).is_none() {
            self.hint.moved(now);
            self.repaint(now);
        }
    }

    /// The part of the window in pixels that the picture has to itself.
    fn free_area(&self) -> PixelRect {
        overlay::free_area(self.gpu.size(), self.pixels_per_point(), self.shown)
    }

    /// Size of the traced picture in pixels; 0 while the window has none.
    fn picture_size(&self) -> (u32, u32) {
        let [_, _, width, height] = self.free_area();
        picture_size((width, height))
    }

    /// Pixels in a point of the overlay.
    fn pixels_per_point(&self) -> f32 {
        self.window.scale_factor() as f32 * self.ui_scale
    }

    /// Whether there is room for the panel beside the picture.
    fn panel_fits(&self) -> bool {
        overlay::panel_pixels(self.gpu.size().0, self.pixels_per_point()).is_some()
    }

    /// Asks for a frame when it would differ from the one last asked for. Says when motion will have stopped, if that
    /// would change what is asked for.
    fn post(&mut self, now: Instant) -> Option<Instant> {
        let (width, height) = self.picture_size();
        if width == 0 || height == 0 {
            return None;
        }
        self.hold_exact(now);
        let camera = self.walker.camera();
        if self.stands.0 != camera {
            self.stands = (camera, Some(now));
        }
        let stops =
            self.stands.1.map(|since| since + REST).filter(|&at| at > now && self.settings.target_fps.is_some());
        // What is exact gives nothing up.
        let is_exact = self.methods.wants_exact;
        let lowering = if is_exact { Lowering::NONE } else { self.steering.lowering(stops.is_some()) };
        let (settings, aspect) = self.methods.ask(&lowered(&self.settings, lowering));
        let (width, height) = (lowering.scaled(width), lowering.scaled(height));
        let scene = Arc::clone(&self.lit);
        let job = Job { scene, camera, settings, width, height, lowering, aspect };
        if self.posted.as_ref() != Some(&job) {
            self.posted = Some(job.clone());
            self.tracer.post(job);
        }
        stops.filter(|_| lowering.level > 0)
    }

    /// Something of the overlay changed: draw it at once, within the display's rate.
    fn repaint(&mut self, now: Instant) {
        self.figures.demand(now, self.rates.display);
    }
}

/// The traced picture for a window of `size`: the same, or of the same shape where that would be too many pixels.
fn picture_size((width, height): (u32, u32)) -> (u32, u32) {
    let pixels = f64::from(width) * f64::from(height);
    if pixels <= MAX_PIXELS {
        return (width, height);
    }
    let scale = (MAX_PIXELS / pixels).sqrt();
    let scaled = |side: u32| ((f64::from(side) * scale) as u32).max(1);
    (scaled(width), scaled(height))
}

/// Where the eye is against the scene and its cameras, `home` among them.
fn whereabouts(scene: &Scene, home: Camera) -> Outside {
    let eyes = scene.cameras.iter().map(|named| named.camera.eye).chain([home.eye]);
    Outside::new(scene.bounds(), eyes)
}

fn title(scene: &Scene) -> String {
    format!("raywalk - {}", scene.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn huge_windows_get_a_smaller_picture_of_the_same_shape() {
        assert_eq!(picture_size((1280, 720)), (1280, 720));
        assert_eq!(picture_size((0, 720)), (0, 720));
        let (width, height) = picture_size((16384, 8192));
        assert!(f64::from(width) * f64::from(height) <= MAX_PIXELS);
        assert!((f64::from(width) / f64::from(height) - 2.0).abs() < 1e-3);
    }
}
