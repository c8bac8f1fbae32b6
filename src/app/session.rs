//! One open window: who gets which event, when to trace, when to draw.

use super::at_rest::REST;
use super::capture::{Capture, PointerHost};
use super::config::{Keeper, UI_SCALES, WindowState};
use super::desktop;
use super::errands::{self, Errands};
use super::error::AppError;
use super::exam::{Exam, Subject};
use super::gpu::{Gpu, Target};
use super::history::History;
use super::input::{Command, Hold, Keys};
use super::inspection::{self, Inspection};
use super::journey::Journey;
use super::labels::Labels;
use super::layer::Layer;
use super::lighting::Lighting;
use super::lowering::{Lowering, lowered, presets_below};
use super::methods::{self, Methods};
use super::overlay::{self, Change, Notices, Showing, Shown, Tuning, View};
use super::pacing::{Limiter, Rates};
use super::present::Presenter;
use super::scenes::{Arrival, News, Scenes, Wish};
use super::screenshot::{self, Camerawork, Place, Shot};
use super::steering::Steering;
use super::survey::{self, End, Survey};
use super::tracer::{Job, TracedFrame, Tracer};
use super::viewer::Call;
use super::walker::{self, Walker};
use super::{AppExit, AppOptions, Opening};
use crate::measure::metric::{METRICS, metric};
use crate::measure::tune::{Bound, Task};
use crate::picture::NumberedName;
use crate::render::FrameStats;
use crate::scene::{self, Camera, Scene};
use crate::settings::Settings;
use glam::DVec2;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::dpi::{PhysicalPosition, PhysicalSize};
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, OwnedDisplayHandle};
use winit::platform::modifier_supplement::KeyEventExtModifierSupplement;
use winit::window::{CursorGrabMode, Window};

/// Between two steps of the walker: finer than any display, so that a frame starts from a fresh place.
const STEP: Duration = Duration::from_millis(8);
/// Until a surface that had nothing to draw on is asked again.
const ASK_AGAIN: Duration = Duration::from_millis(100);
/// A device lost twice within this time is not worth a third try.
const DEVICE_TRIAL: Duration = Duration::from_secs(10);
/// Most pixels of a traced picture (8K): larger windows show it enlarged.
const MAX_PIXELS: f64 = 7680.0 * 4320.0;
/// A search tries no new settings after this time.
const SEARCH_BUDGET: Duration = Duration::from_secs(30);
/// Between two looks at how far a load has come.
const TELL: Duration = Duration::from_millis(100);
/// What is told where a walker does not fit.
const NO_ROOM: &str = "There is no room to walk here: flying on";
/// A step of the size of panel and text.
const UI_STEP: f32 = 1.1;
/// Pixels of smooth scrolling that count as one notch of a wheel.
const PIXELS_PER_NOTCH: f64 = 40.0;

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
    shown: Shown,
    notices: Notices,
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
            Opening::Loading(load, file) => {
                scenes.expect(load.clone(), file.clone());
                let nothing = scene::nothing().map_err(|error| AppError::NoScene(error.into()))?;
                let camera = nothing.cameras[0].camera;
                (Arc::new(nothing), camera)
            }
        };
        let attributes = Window::default_attributes().with_title(title(&scene));
        let size = WindowState { size: options.size, ..WindowState::default() };
        let place = options.config.window.filter(|_| options.as_before).unwrap_or(size);
        let attributes = desktop::placed(attributes, place, event_loop);
        let window = event_loop.create_window(attributes).map_err(|error| AppError::NoDisplay(error.to_string()))?;
        let window = Arc::new(window);
        let display = event_loop.owned_display_handle();
        let gpu = Gpu::new(&window, &display).map_err(AppError::NoDisplay)?;
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
            shown: Shown { panel: config.panel, ..Shown::default() },
            notices: Notices::default(),
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
        let warnings = self.errands.finish().into_iter().filter_map(|news| match news {
            errands::News::Problem(text) => Some(text),
            errands::News::Done(_) => None,
        });
        AppExit { camera, settings, warnings: warnings.collect() }
    }

    /// Brings what is remembered up to date and has it written, if there is anything new.
    fn save_config(&mut self) {
        if let Some(state) = desktop::state_of(&self.window) {
            self.keeper.keep_window(state);
        }
        self.keeper.keep_settings(&self.settings);
        let config = &mut self.keeper.config;
        config.ui_scale = self.ui_scale;
        config.invert_look = self.walker.invert_look;
        config.sensitivity = (self.walker.sensitivity != walker::SENSITIVITY).then_some(self.walker.sensitivity);
        config.panel = self.shown.panel;
        config.recent.clone_from(self.scenes.recent());
        if let Some(errand) = self.keeper.save() {
            self.errands.run(errand);
        }
    }

    /// Keeps the picture on display as a file, or what it is about to become.
    fn take_screenshot(&mut self, now: Instant) {
        let film = self.fresh.as_ref().map(|frame| &frame.film).or_else(|| self.presenter.frame());
        let shot = film.zip(self.traced.as_ref()).map(|(film, (job, samples))| Shot::new(film, job, *samples));
        match shot.map(|shot| self.camerawork.ask(shot)) {
            None => self.notices.warn(now, "no picture yet"),
            Some(None) => self.notices.tell(now, "screenshot as soon as the picture has all its samples"),
            Some(Some(shot)) => self.write(shot),
        }
    }

    fn write(&self, shot: Shot) {
        let place = Place { file: self.scenes.file().map(Path::to_owned), cameras: self.scene.cameras.clone() };
        self.errands.run(screenshot::errand(shot, place, self.screenshots.clone()));
    }

    /// Tells what came of errands.
    pub fn tell_news(&mut self, now: Instant) {
        for news in self.errands.news().collect::<Vec<_>>() {
            match news {
                errands::News::Done(text) => self.notices.tell(now, text),
                errands::News::Problem(text) => self.notices.warn(now, text),
            }
            self.repaint(now);
        }
    }

    /// Passes an event to whom it concerns; true to close the window.
    pub fn on_window_event(&mut self, event: &WindowEvent) -> Result<bool, AppError> {
        let now = Instant::now();
        match event {
            WindowEvent::RedrawRequested => {
                self.draw(now)?;
                return Ok(false);
            }
            WindowEvent::KeyboardInput { event: key, is_synthetic, .. } => {
                return Ok(self.on_key(now, key, *is_synthetic, event));
            }
            WindowEvent::CursorMoved { position, .. } => {
                self.pointer = DVec2::new(position.x, position.y);
                let turn = self.capture.pointer_moved(&WindowHost(&self.window), self.pointer);
                self.look(turn);
            }
            WindowEvent::MouseInput { state, button: MouseButton::Left, .. } if self.on_button(*state) => {
                return Ok(false);
            }
            WindowEvent::MouseInput { state: ElementState::Pressed, button: MouseButton::Right, .. }
                if self.capture.is_active() || !self.layer.takes_click() =>
            {
                self.inspect();
                self.repaint(now);
                return Ok(false);
            }
            WindowEvent::MouseWheel { delta, .. } if self.capture.is_active() || !self.layer.is_under_pointer() => {
                self.walker.scroll(notches(*delta));
                self.repaint(now);
                return Ok(false);
            }
            WindowEvent::ModifiersChanged(modifiers) => self.keys.set_ctrl(modifiers.state().control_key()),
            WindowEvent::Focused(false) => {
                self.step(now);
                self.keys.clear();
                self.capture.release(&WindowHost(&self.window));
            }
            WindowEvent::Resized(size) => {
                self.gpu.resize(*size);
                self.keeper.touch(now);
                self.repaint(now);
            }
            WindowEvent::Moved(position) => self.keeper.window_moved(now, (position.x, position.y)),
            WindowEvent::Occluded(occluded) => self.occluded = *occluded,
            WindowEvent::DroppedFile(path) => self.scenes.drop_in(path.clone()),
            WindowEvent::HoveredFile(_) | WindowEvent::HoveredFileCancelled => {
                self.scenes.hover(matches!(event, WindowEvent::HoveredFile(_)));
                self.repaint(now);
            }
            _ => {}
        }
        let of_the_mouse = matches!(
            event,
            WindowEvent::CursorMoved { .. } | WindowEvent::MouseInput { .. } | WindowEvent::MouseWheel { .. }
        );
        if !(of_the_mouse && self.capture.is_active()) && self.layer.on_event(&self.window, event) {
            self.repaint(now);
        }
        Ok(false)
    }

    /// The mouse moved, in its own counts; concerns us while the pointer is locked.
    pub fn on_device_motion(&mut self, delta: DVec2) {
        let turn = self.capture.device_moved(delta);
        self.look(turn);
    }

    fn look(&mut self, counts: DVec2) {
        if counts != DVec2::ZERO {
            self.journey.stop_replay();
            self.walker.look(counts);
        }
    }

    /// True to close the window.
    fn on_key(&mut self, now: Instant, key: &KeyEvent, is_synthetic: bool, event: &WindowEvent) -> bool {
        self.step(now);
        let of_overlay = self.layer.takes_keys() && !self.capture.is_active();
        let command = match key.state {
            ElementState::Released => {
                self.keys.release(key.physical_key);
                // Whoever saw a key go down should see it come up; that alone changes no looks.
                self.layer.on_event(&self.window, event);
                None
            }
            // A press made up at a change of focus is none.
            ElementState::Pressed if is_synthetic => None,
            ElementState::Pressed => {
                if self.labels.learn(key.physical_key, &key.key_without_modifiers()) {
                    self.repaint(now);
                }
                self.keys.press(key.physical_key, key.repeat)
            }
        };
        if command == Some(Command::Quit) {
            return true;
        }
        if of_overlay && key.state.is_pressed() {
            self.keys.forget_holds();
            if self.layer.on_event(&self.window, event) {
                self.repaint(now);
            }
            return false;
        }
        match command {
            Some(Command::ReleasePointer) if self.capture.is_active() => {
                self.journey.stop_replay();
                self.capture.release(&WindowHost(&self.window));
            }
            Some(Command::ReleasePointer) if self.journey.stop_replay() => {}
            Some(Command::ReleasePointer) if self.shown.help => self.shown.help = false,
            Some(Command::ReleasePointer) => self.wish(Wish::Cancel),
            Some(Command::ToggleHelp) => {
                // It is read with a free pointer.
                self.capture.release(&WindowHost(&self.window));
                self.shown = self.shown.with_help_toggled();
            }
            Some(Command::Open) => self.wish(Wish::Open),
            Some(Command::Reload) => self.wish(Wish::Reload),
            Some(Command::Inspect) => self.inspect(),
            Some(Command::TogglePanel) => self.shown = self.shown.with_panel_toggled(),
            Some(Command::ToggleOverlay) => self.shown.overlay = !self.shown.overlay,
            Some(Command::Home) => {
                self.journey.stop_replay();
                self.walker.go_home();
            }
            Some(Command::ToggleWalking) => self.toggle_walking(now),
            Some(Command::Screenshot) => self.take_screenshot(now),
            Some(Command::ToggleFullscreen) => desktop::toggle_fullscreen(&self.window),
            Some(Command::EnlargeUi) => self.scale_ui(self.ui_scale * UI_STEP),
            Some(Command::ReduceUi) => self.scale_ui(self.ui_scale / UI_STEP),
            Some(Command::ResetUi) => self.scale_ui(1.0),
            Some(Command::StoreBookmark(number)) => {
                self.keeper.config.bookmarks.of_mut(self.scenes.file()).store(number, self.walker.camera());
                self.notices.tell(now, format!("Bookmark {number} set: key {number} comes back here"));
            }
            Some(Command::GoToBookmark(number)) => {
                match self.keeper.config.bookmarks.of(self.scenes.file()).get(number) {
                    Some(camera) => self.go_to(camera),
                    None => self.notices.warn(now, format!("There is no bookmark {number}: Ctrl+{number} sets it")),
                }
            }
            Some(Command::CopyCamera) => {
                self.layer.copy(self.walker.camera().to_json());
                self.notices.tell(now, "Camera copied as JSON");
            }
            Some(Command::PasteCamera) => self.paste(now),
            Some(Command::ToggleRecording) => self.toggle_recording(now),
            Some(Command::ToggleReplay) => self.toggle_replay(now),
            Some(Command::NextMap) => self.change_methods(&methods::Change::Map(self.methods.map.next())),
            Some(Command::ToggleSplit) => self.change_methods(&methods::Change::Split(!self.methods.split.is_on)),
            Some(Command::Quit) | None => return false,
        }
        self.keeper.touch(now);
        self.repaint(now);
        false
    }

    fn go_to(&mut self, camera: Camera) {
        self.journey.stop_replay();
        self.walker.go_to(camera);
    }

    /// Goes to the camera on the clipboard.
    fn paste(&mut self, now: Instant) {
        let text = self.layer.pasted().filter(|text| !text.trim().is_empty());
        match text.as_deref().map(|text| scene::read_camera("clipboard", text)) {
            None => self.notices.warn(now, "There is no text on the clipboard to paste a camera from"),
            Some(Err(error)) => self.notices.warn(now, format!("What was pasted is no camera: {error}")),
            Some(Ok(camera)) => {
                self.go_to(camera);
                self.notices.tell(now, "Camera pasted");
            }
        }
    }

    fn toggle_recording(&mut self, now: Instant) {
        let camera = self.walker.camera();
        if self.journey.is_recording() {
            self.journey.finish(now, camera, PathBuf::new(), self.walker.surroundings());
        } else {
            self.journey.record(now, camera);
            self.notices.tell(now, self.labels.of("Recording where you go: R stops"));
        }
    }

    fn toggle_replay(&mut self, now: Instant) {
        if self.journey.is_recording() {
            self.notices.warn(now, self.labels.of("Still recording: R stops"));
        } else if !self.journey.stop_replay() && !self.journey.replay(now) {
            self.notices.warn(now, self.labels.of("Nothing is recorded yet: R starts"));
        }
    }

    /// Follows a recording and a replay; says when to be called again.
    fn travel(&mut self, now: Instant) -> Option<Instant> {
        let base = self.walker.camera();
        if let Some(camera) = self.journey.camera(now, &base) {
            self.walker.go_to(camera);
        }
        if self.journey.see(now, self.walker.camera()) {
            self.toggle_recording(now);
        }
        if let Some(written) = self.journey.written() {
            match written {
                Ok(file) => {
                    let told = format!("Path written to {}: P replays it", file.display());
                    self.notices.tell(now, self.labels.of(&told));
                }
                Err(reason) => self.notices.warn(now, reason),
            }
            self.repaint(now);
        }
        self.journey.next(now, STEP)
    }

    /// Fly or walk. The speed that held keys had so far was that of the other.
    fn toggle_walking(&mut self, now: Instant) {
        if !self.walker.toggle_walking(&self.scene.geometry) {
            self.notices.warn(now, NO_ROOM);
        } else if self.walker.is_walking() {
            self.notices.tell(now, self.labels.of("Walking: Space jumps, G flies"));
        } else {
            self.notices.tell(now, self.labels.of("Flying: G walks"));
        }
        self.step(now);
    }

    /// The left button; true when the picture took it.
    fn on_button(&mut self, state: ElementState) -> bool {
        match state {
            ElementState::Released => self.capture.button_up(),
            ElementState::Pressed if self.capture.is_active() => return true,
            ElementState::Pressed if self.layer.takes_click() => {}
            ElementState::Pressed => {
                self.layer.let_go();
                self.capture.begin(&WindowHost(&self.window), self.pointer);
                return true;
            }
        }
        false
    }

    /// Takes the newest frame from the tracer, to be shown when it is time, and what a search has come to.
    pub fn fetch_frame(&mut self) {
        if let Some(survey) = self.tracer.take_survey() {
            self.survey = Some(survey);
            self.figures.demand(Instant::now(), self.rates.figures);
        }
        if let Some(exam) = self.tracer.take_exam() {
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
        if frame.samples.is_none() {
            self.history.record(frame.finished, frame.stats.frame_ms);
            if let Some(fps) = self.settings.target_fps {
                self.steering.measured(frame.job.lowering.level, frame.stats.frame_ms, 1e3 / f64::from(fps));
            }
            let present = self.stats.stages_ms.present;
            self.stats = frame.stats.clone();
            self.stats.stages_ms.present = present;
        }
        let before = self.traced.replace((frame.job.clone(), frame.samples));
        if frame.job.aspect.is_exact {
            self.methods.leave(before);
        }
        if let Some(missed) = self.fresh.replace(frame) {
            missed.into_films().for_each(|film| self.tracer.recycle(film));
        }
        self.picture.demand(now, self.rates.display);
        if self.shown.overlay {
            self.figures.demand(now, self.rates.figures);
        }
    }

    /// Takes up what has become of scenes.
    ///
    /// # Errors
    /// The first scene of all could not be loaded.
    pub fn on_news(&mut self) -> Result<(), AppError> {
        while let Some(news) = self.scenes.news() {
            match news {
                News::Opened(arrival) => self.enter(arrival),
                News::Reloaded(arrival) => self.replace_scene(arrival.scene),
                News::Nothing(failed) => return Err(AppError::NoScene(failed)),
            }
        }
        self.repaint(Instant::now());
        Ok(())
    }

    /// Goes to another scene.
    fn enter(&mut self, Arrival { scene, camera, size, .. }: Arrival) {
        self.walker.enter(&scene, camera);
        self.lighting = Lighting::of(&scene);
        if let Some((width, height)) = size.filter(|_| !self.is_placed) {
            // The window stays as it is where the system does not let it be resized.
            let _ = self.window.request_inner_size(PhysicalSize::new(width, height));
        }
        self.show_scene(scene);
    }

    /// Shows what the scene has become, from where the walker stands.
    fn replace_scene(&mut self, scene: Arc<Scene>) {
        let home = self.walker.home();
        let named = self.scene.cameras.iter().position(|named| named.camera == home);
        if let Some(moved) = named.and_then(|index| scene.cameras.get(index)) {
            self.walker.set_home(moved.camera);
        }
        self.lighting.keep_for(&scene);
        self.show_scene(scene);
    }

    fn show_scene(&mut self, scene: Arc<Scene>) {
        self.tracer.stop_search();
        self.survey = None;
        self.steering = Steering::new(presets_below(&self.settings));
        self.window.set_title(&title(&scene));
        self.inspection = None;
        self.lit = self.lighting.lit(&scene);
        self.walker.lose_footing();
        self.scene = scene;
    }

    /// Tells of what the picture shows under the pointer, or in its middle while the pointer is captured.
    fn inspect(&mut self) {
        let Some((Job { scene, camera, width, height, .. }, _)) = &self.traced else { return };
        let host = WindowHost(&self.window);
        let place = if self.capture.is_active() { DVec2::splat(0.5) } else { self.pointer / host.size() };
        self.inspection = inspection::inspect(scene, camera, (*width, *height), place);
    }

    /// Does what the user asks of scenes.
    fn wish(&mut self, wish: Wish) {
        self.scenes.grant(wish, &*self.window);
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
        }
        let passed = self.stepped.map_or(Duration::ZERO, |before| now.saturating_duration_since(before));
        if !self.walker.advance(&self.scene.geometry, motion, passed.as_secs_f64()) {
            self.notices.warn(now, NO_ROOM);
            self.repaint(now);
        }
        self.stepped = (motion.is_moving() || self.walker.is_under_way()).then_some(now);
    }

    /// Asks for a frame when it would differ from the one last asked for. Says when motion will have stopped, if that
    /// would change what is asked for.
    fn post(&mut self, now: Instant) -> Option<Instant> {
        let (width, height) = picture_size(self.gpu.size());
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

    /// What the picture is.
    fn showing(&self) -> Showing {
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

    /// Something of the overlay changed: draw it at once, within the display's rate.
    fn repaint(&mut self, now: Instant) {
        self.figures.demand(now, self.rates.display);
    }

    fn draw(&mut self, now: Instant) -> Result<(), AppError> {
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
        self.stats.stages_ms.present = 1e3 * now.elapsed().as_secs_f64();
        Ok(())
    }

    fn paint_overlay(&mut self, now: Instant) {
        let resting = self.history.is_resting(now) && !self.tracer.is_busy();
        self.notices.expire(now);
        let camera = self.walker.camera();
        self.methods.is_elsewhere = self.methods.exam.as_ref().is_some_and(|exam| exam.camera != camera);
        let view = View {
            scene: &self.scene,
            settings: self.methods.edited(&self.settings),
            stats: &self.stats,
            history: &self.history,
            resting,
            size: self.traced.as_ref().map_or(picture_size(self.gpu.size()), |(job, _)| (job.width, job.height)),
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
            inspection: self.inspection.as_ref(),
            stands: self.traced.as_ref().map(|(job, _)| job.camera).filter(|camera| *camera == self.walker.camera()),
            crosshair: self.capture.is_active(),
            notices: self.notices.current(),
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
        self.notices.next_end().into_iter().for_each(|end| self.figures.demand_at(end));
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

    fn apply(&mut self, change: Change) {
        match change {
            Change::Settings(settings) if self.methods.edits_right() => self.methods.split.right = settings,
            Change::Settings(settings) => {
                let shown_otherwise = settings.present != self.settings.present;
                self.steering = Steering::new(presets_below(&settings));
                self.settings = settings;
                if shown_otherwise {
                    self.replace_presenter(Instant::now());
                }
            }
            Change::Camera(index) => {
                if let Some(camera) = self.scene.cameras.get(index).map(|named| named.camera) {
                    self.go_to(camera);
                }
            }
            Change::Home => {
                self.journey.stop_replay();
                self.walker.go_home();
            }
            Change::Speed(speed) => self.walker.set_speed(speed),
            Change::Walking(_) => self.toggle_walking(Instant::now()),
            Change::EyeHeight(height) => {
                if !self.walker.set_eye_height(&self.scene.geometry, height) {
                    self.notices.warn(Instant::now(), "There is no room for that eye height here");
                }
            }
            Change::Fov(fov) => self.walker.set_fov(fov),
            Change::Sensitivity(sensitivity) => self.walker.sensitivity = sensitivity,
            Change::InvertLook(invert) => self.walker.invert_look = invert,
            Change::Bound(bound) => self.bound = bound,
            Change::Search(bound) => self.search(bound),
            Change::StopSearch => {
                self.tracer.stop_search();
                if let Some(survey) = &mut self.survey {
                    survey.end.get_or_insert(End::Stopped);
                }
            }
            Change::UiScale(scale) => self.scale_ui(scale),
            Change::Methods(change) => self.change_methods(&change),
            Change::TogglePanel => self.shown = self.shown.with_panel_toggled(),
            Change::Scenes(wish) => self.wish(wish),
            Change::Light(light, dial) => {
                self.lighting.turn(light, dial);
                self.lit = self.lighting.lit(&self.scene);
            }
            Change::ResetLights => {
                self.lighting.reset();
                self.lit = self.lighting.lit(&self.scene);
            }
            Change::CloseInspection => self.inspection = None,
            Change::ToggleHelp => self.shown = self.shown.with_help_toggled(),
        }
    }

    /// Panel and text `scale` times as large as usual.
    fn scale_ui(&mut self, scale: f32) {
        // In steps of a twentieth, so that as many steps back lead back.
        self.ui_scale = ((20.0 * scale).round() / 20.0).clamp(*UI_SCALES.start(), *UI_SCALES.end());
        self.layer.set_scale(self.ui_scale);
    }

    /// Hands the newest frame to the presenter, or the films of two sides joined anew.
    fn show_frame(&mut self) {
        let Self { methods, presenter, gpu, tracer, .. } = self;
        let mut present = |film| presenter.set_frame(gpu, film);
        let mut recycle = |film| tracer.recycle(film);
        if let Some(frame) = self.fresh.take() {
            methods.display(frame, &mut present, &mut recycle);
        } else if methods.split.is_outdated() && !methods.wants_exact {
            methods.split.present(&mut present, &mut recycle);
        }
    }

    /// Notes whether the key for the exact picture is down; once it is up, goes back to what was there before.
    fn hold_exact(&mut self, now: Instant) {
        let wants = self.keys.is_held(Hold::Exact);
        if self.methods.wants_exact == wants {
            return;
        }
        self.methods.wants_exact = wants;
        self.repaint(now);
        if wants {
            return;
        }
        if let Some(late) = self.fresh.take_if(|frame| frame.job.aspect.is_exact) {
            late.into_films().for_each(|film| self.tracer.recycle(film));
        }
        let (film, what) = self.methods.go_back(&self.walker.camera());
        if let Some(exact) = film.and_then(|film| self.presenter.set_frame(&self.gpu, film)) {
            self.tracer.recycle(exact);
        }
        self.traced = what.or(self.traced.take());
        self.picture.demand(now, self.rates.display);
    }

    fn change_methods(&mut self, change: &methods::Change) {
        self.methods.apply(change, &self.settings);
        match change {
            methods::Change::MeasureErrors => self.examine(Subject::Errors),
            methods::Change::MeasureCosts => self.examine(Subject::Costs),
            methods::Change::Stop => self.tracer.stop_search(),
            _ => self.picture.demand(Instant::now(), self.rates.display),
        }
    }

    /// Starts an exam of the settings on what is seen from here.
    fn examine(&mut self, subject: Subject) {
        let size = picture_size(self.gpu.size());
        if size.0 == 0 || size.1 == 0 {
            return;
        }
        let settings = self.methods.edited(&self.settings).clone();
        let exam = Exam::new(subject, self.walker.camera(), settings, size).with_answers_of(self.methods.exam.as_ref());
        self.methods.exam = Some(exam.clone());
        self.tracer.examine(Arc::clone(&self.lit), exam);
        if let Some(survey) = &mut self.survey {
            survey.end.get_or_insert(End::Stopped);
        }
    }

    /// Starts a search on what is seen from here.
    fn search(&mut self, bound: Bound) {
        let size = picture_size(self.gpu.size());
        if size.0 == 0 || size.1 == 0 {
            return;
        }
        let camera = self.walker.camera();
        let settings = survey::of_frames(&self.settings, self.scene.render.max_depth);
        let task = Task {
            cameras: vec![camera],
            size,
            settings: settings.clone(),
            fixed: Vec::new(),
            bounds: vec![bound],
            also: vec![settings],
            budget: SEARCH_BUDGET,
        };
        let survey = Survey::new(camera, bound);
        self.survey = Some(survey.clone());
        self.tracer.search(Arc::clone(&self.lit), task, survey);
        self.methods.end_exam();
    }

    /// Starts over on a new device, unless the old one did not even last.
    fn replace_device(&mut self, now: Instant, reason: String) -> Result<(), AppError> {
        if now.saturating_duration_since(self.device_made) < DEVICE_TRIAL {
            return Err(AppError::GraphicsLost(reason));
        }
        self.gpu = Gpu::new(&self.window, &self.display).map_err(AppError::GraphicsLost)?;
        self.device_made = now;
        self.replace_presenter(now);
        Ok(())
    }

    /// Starts showing frames in another way, or on another device.
    fn replace_presenter(&mut self, now: Instant) {
        self.presenter = Presenter::new(&self.gpu, self.settings.present);
        self.layer = Layer::new(&self.gpu, &self.window, self.ui_scale);
        (self.posted, self.traced) = (None, None);
        self.repaint(now);
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

fn title(scene: &Scene) -> String {
    format!("raywalk - {}", scene.name)
}

fn notches(delta: MouseScrollDelta) -> f64 {
    match delta {
        MouseScrollDelta::LineDelta(_, lines) => f64::from(lines),
        MouseScrollDelta::PixelDelta(pixels) => pixels.y / PIXELS_PER_NOTCH,
    }
}

/// The window as capture sees it.
struct WindowHost<'a>(&'a Window);

impl PointerHost for WindowHost<'_> {
    fn lock(&self) -> bool {
        self.0.set_cursor_grab(CursorGrabMode::Locked).is_ok()
    }

    fn unlock(&self) {
        // Refused, there is nothing more to do: a lost focus frees the pointer anyway.
        let _ = self.0.set_cursor_grab(CursorGrabMode::None);
    }

    fn warp(&self, position: DVec2) -> bool {
        self.0.set_cursor_position(PhysicalPosition::new(position.x, position.y)).is_ok()
    }

    fn show(&self, visible: bool) {
        self.0.set_cursor_visible(visible);
    }

    fn size(&self) -> DVec2 {
        let size = self.0.inner_size();
        DVec2::new(f64::from(size.width), f64::from(size.height))
    }
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

    #[test]
    fn smooth_scrolling_adds_up_to_notches() {
        assert_eq!(notches(MouseScrollDelta::LineDelta(0.0, -2.0)), -2.0);
        assert_eq!(notches(MouseScrollDelta::PixelDelta(PhysicalPosition::new(0.0, 20.0))), 0.5);
    }
}
