//! One walk in the terminal: waits for keys, frames and answers, and does what each asks for.
//!
//! The main thread sleeps on one channel. What is typed is read on a thread of its own, and noted with its time, so that
//! a line that stalls makes no long walk of a short press.

use super::End;
use super::cells::Cells;
use super::encoder::Encoder;
use super::flow::Flow;
use super::keys::{Command, Keys, Wish};
use super::palette::Palette;
use super::screen::Screen;
use super::signals::{self, Watch};
use super::status::Status;
use crate::app::AppError;
use crate::app::history::History;
use crate::app::lowering::Lowering;
use crate::app::methods::Aspect;
use crate::app::scenes::Arrival;
use crate::app::tally::Tally;
use crate::app::tracer::{Job, TracedFrame, Tracer, Word};
use crate::app::walker::Walker;
use crate::measure::Record;
use crate::scene::Scene;
use crate::settings::{PRESETS, Preset, Settings};
use glam::DVec2;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};
use termina::escape::csi::{Csi, Cursor};
use termina::event::{MouseButton, MouseEvent, MouseEventKind};
use termina::{Event, EventReader};

/// Between two frames: as many as a terminal draws without effort.
const INTERVAL: Duration = Duration::from_millis(33);
/// Between two steps of the walker.
const STEP: Duration = Duration::from_millis(16);
/// Most that is walked at once: whoever comes back from a stall should not find themselves elsewhere.
const MAX_WALK: Duration = Duration::from_millis(250);
/// Degrees of turn for a drag over one pixel of the picture.
const DRAG: f64 = 1.5;
/// At the end, answers under way are waited for this long: the shell would take them for something typed.
const FAREWELL: Duration = Duration::from_secs(2);
/// Most columns and rows of the picture; the rest of a larger terminal stays empty.
const MAX_CELLS: (u16, u16) = (1000, 500);

/// What the walk is woken up by.
enum Message {
    Input(Event, Instant),
    InputGone(std::io::Error),
    Tracer(Word),
    Signal(i32),
}

/// What is done beyond walking.
enum Step {
    /// Hand the terminal to the shell until it hands it back.
    Suspend,
    End(End),
}

/// See [`run`](super::run).
pub fn run(arrival: &Arrival, settings: Settings, tells: bool) -> Result<(End, Option<Record>), AppError> {
    let (sender, messages) = channel();
    // Dropped last, when the terminal is given back.
    let signals = sender.clone();
    // Without a walk there is no one left to tell; so in all the others.
    let watch = Watch::start(move |signal| signals.send(Message::Signal(signal)).unwrap_or(()));
    let _watch = watch.map_err(AppError::Terminal)?;
    let screen = Screen::take().map_err(AppError::Terminal)?;
    let _reading = Reading::start(screen.reader(), sender.clone()).map_err(AppError::NoThread)?;
    let word = move |word| sender.send(Message::Tracer(word)).unwrap_or(());
    let tracer = Tracer::start(INTERVAL, word)?;
    let mut session = Session::new(arrival, settings, screen, tracer);
    session.tally = tells.then(Tally::default);
    let end = session.walk(&messages);
    session.settle(&messages);
    let record = session.tally.and_then(|tally| tally.record(arrival.load_ms));
    Ok((end?, record))
}

/// Everything that lives as long as the walk. Dropped from the top: the tracer is joined before the terminal goes.
struct Session {
    tracer: Tracer,
    screen: Screen,
    palette: Palette,
    encoder: Encoder,
    flow: Flow,
    keys: Keys,
    /// Columns and rows of the terminal.
    size: (u16, u16),
    scene: Arc<Scene>,
    walker: Walker,
    settings: Settings,
    history: History,
    /// What a record at the end is made of, where one is wanted.
    tally: Option<Tally>,
    posted: Option<Job>,
    /// A frame to be shown when the terminal has shown those before.
    fresh: Option<TracedFrame>,
    /// What is shown: its cells, size and samples a pixel.
    shown: Option<(Cells, Job, Option<u32>)>,
    /// Something but the picture changed.
    is_stale: bool,
    /// When the walker last took a step, while keys are held.
    stepped: Option<Instant>,
    /// Where the mouse was last, while its button is down.
    drag: Option<(u16, u16)>,
}

impl Session {
    fn new(arrival: &Arrival, settings: Settings, screen: Screen, tracer: Tracer) -> Self {
        let scene = &arrival.scene;
        let abilities = screen.abilities();
        Self {
            tracer,
            palette: screen.palette(),
            encoder: Encoder::default(),
            flow: Flow::new(abilities.answers),
            keys: Keys::new(abilities.tells_releases),
            size: screen.size(),
            screen,
            scene: scene.clone(),
            walker: Walker::in_scene(scene, arrival.camera),
            settings,
            history: History::default(),
            tally: None,
            posted: None,
            fresh: None,
            shown: None,
            is_stale: false,
            stepped: None,
            drag: None,
        }
    }

    /// Walks until something ends it.
    fn walk(&mut self, messages: &Receiver<Message>) -> Result<End, AppError> {
        loop {
            let next = self.tick(Instant::now())?;
            let message = match next {
                None => messages.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(at) => messages.recv_timeout(at.saturating_duration_since(Instant::now())),
            };
            for message in message.into_iter().chain(messages.try_iter()) {
                match self.on_message(message)? {
                    Some(Step::Suspend) => {
                        self.settle(messages);
                        self.suspend().map_err(AppError::Terminal)?;
                    }
                    Some(Step::End(end)) => return Ok(end),
                    None => {}
                }
            }
        }
    }

    /// Waits for the answers under way, which nobody else should read.
    fn settle(&mut self, messages: &Receiver<Message>) {
        let deadline = Instant::now() + FAREWELL;
        while self.flow.is_waiting() {
            match messages.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
                Ok(Message::Input(event, _)) if is_answer(&event) => self.flow.answered(),
                Ok(Message::Tracer(Word::Frame)) => self.fetch_frame(),
                Ok(Message::InputGone(_)) | Err(_) => return,
                Ok(_) => {}
            }
        }
    }

    fn on_message(&mut self, message: Message) -> Result<Option<Step>, AppError> {
        match message {
            Message::Input(event, at) => return Ok(self.on_input(&event, at)),
            Message::InputGone(error) => return Err(AppError::Terminal(error)),
            Message::Tracer(Word::Gone) => return Err(AppError::TracerGone),
            Message::Tracer(Word::Frame) => self.fetch_frame(),
            Message::Signal(signal) => return Ok(Some(Step::End(End::Signal(signal)))),
        }
        Ok(None)
    }

    fn on_input(&mut self, event: &Event, at: Instant) -> Option<Step> {
        self.step(at);
        match event {
            Event::Key(key) => {
                if let Some(command) = self.keys.on_key(at, *key) {
                    return self.on_command(command);
                }
                // From now on it is walked.
                self.step(at);
            }
            Event::Mouse(mouse) => self.on_mouse(mouse),
            Event::WindowResized(_) => self.size = self.screen.size(),
            Event::FocusOut => self.keys.clear(),
            event if is_answer(event) => self.flow.answered(),
            _ => {}
        }
        None
    }

    fn on_command(&mut self, command: Command) -> Option<Step> {
        match command {
            Command::Quit => return Some(Step::End(End::Quit)),
            Command::Interrupt => return Some(Step::End(End::Interrupted)),
            Command::Suspend => return Some(Step::Suspend),
            Command::Redraw => self.encoder.forget(),
            Command::Home => self.walker.go_home(),
            Command::ToggleWalking => {
                // Where there is no room it stays a flight, as the status line tells.
                self.walker.toggle_walking(&self.scene.geometry);
            }
            Command::Speed(notches) => self.walker.scroll(notches.into()),
            Command::Preset(place) => {
                if let Some(preset) = PRESETS.get(place) {
                    self.settings = with_preset(&self.settings, preset);
                }
            }
        }
        self.is_stale = true;
        None
    }

    fn on_mouse(&mut self, mouse: &MouseEvent) {
        let place = (mouse.column, mouse.row);
        match mouse.kind {
            MouseEventKind::Down(MouseButton::Left) => self.drag = Some(place),
            MouseEventKind::Up(MouseButton::Left) => self.drag = None,
            MouseEventKind::Drag(MouseButton::Left) => {
                if let Some((column, row)) = self.drag.replace(place) {
                    let cells = |to: u16, from: u16| f64::from(i32::from(to) - i32::from(from));
                    // A cell is two pixels high.
                    self.turn(DVec2::new(cells(mouse.column, column), 2.0 * cells(mouse.row, row)) * DRAG);
                }
            }
            MouseEventKind::ScrollUp => self.walker.scroll(1.0),
            MouseEventKind::ScrollDown => self.walker.scroll(-1.0),
            _ => return,
        }
        self.is_stale = true;
    }

    /// Turns by degrees to the right and down.
    fn turn(&mut self, degrees: DVec2) {
        self.walker.look(degrees / self.walker.sensitivity);
    }

    /// Walks and turns up to `now`, as far as keys were held until here: step by step, so that a key that has faded out by
    /// now counts for the time before.
    fn step(&mut self, now: Instant) {
        if let Some(mut at) = self.stepped {
            let end = now.min(at + MAX_WALK);
            while at < end {
                let next = end.min(at + STEP);
                let wish = self.keys.wish(at);
                if wish.is_none() && !self.walker.is_under_way() {
                    break;
                }
                self.walk_for((next - at).as_secs_f64(), wish.unwrap_or_default());
                at = next;
            }
        }
        self.stepped = (self.keys.wish(now).is_some() || self.walker.is_under_way()).then_some(now);
    }

    fn walk_for(&mut self, seconds: f64, wish: Wish) {
        // Feet need all the time there is: to fall as well.
        let pace = if self.walker.is_walking() { 1.0 } else { wish.pace };
        self.walker.advance(&self.scene.geometry, wish.motion, seconds * pace);
        self.turn(wish.turn * seconds);
    }

    /// Moves on, asks for frames, shows what there is, and says when to be called again at the latest.
    fn tick(&mut self, now: Instant) -> Result<Option<Instant>, AppError> {
        self.step(now);
        self.post();
        let mut next = self.tracer.drop_outdated();
        let mut call_at = |at: Instant| next = Some(next.map_or(at, |next: Instant| next.min(at)));
        if self.stepped.is_some() {
            call_at(now + STEP);
        }
        if self.fresh.is_some() || self.is_stale {
            match self.flow.opens(now) {
                Some(at) => call_at(at),
                None => self.draw(now).map_err(AppError::Terminal)?,
            }
        }
        Ok(next)
    }

    /// Asks for a frame when it would differ from the one last asked for.
    fn post(&mut self) {
        let (columns, rows) = picture_size(self.size);
        if columns == 0 || rows == 0 {
            return;
        }
        let job = Job {
            scene: self.scene.clone(),
            camera: self.walker.camera(),
            settings: self.settings.clone(),
            width: columns.into(),
            height: 2 * u32::from(rows),
            lowering: Lowering::NONE,
            aspect: Aspect::default(),
        };
        if self.posted.as_ref() != Some(&job) {
            self.posted = Some(job.clone());
            self.tracer.post(job);
        }
    }

    fn fetch_frame(&mut self) {
        let Some(frame) = self.tracer.take() else { return };
        if let Some(tally) = self.tally.as_mut().filter(|_| frame.samples.is_none()) {
            tally.add(&frame, &frame.stats);
        }
        if let Some(missed) = self.fresh.replace(frame) {
            self.tracer.recycle(missed.film);
        }
    }

    fn draw(&mut self, now: Instant) -> std::io::Result<()> {
        self.is_stale = false;
        if let Some(frame) = self.fresh.take() {
            let cells = Cells::of_picture(frame.film.rgba(), frame.job.width as usize, self.palette);
            self.tracer.recycle(frame.film);
            if frame.samples.is_none() {
                self.history.record(now, frame.stats.frame_ms);
            }
            self.shown = Some((cells, frame.job, frame.samples));
        }
        let Some((cells, job, samples)) = &self.shown else { return Ok(()) };
        // A frame of another size is late: the next one is on its way.
        let (columns, rows) = picture_size(self.size);
        if (job.width, job.height) != (columns.into(), 2 * u32::from(rows)) {
            return Ok(());
        }
        let status = Status {
            rate: self.history.rate(),
            frame_ms: self.history.last().unwrap_or_default(),
            size: (job.width, job.height),
            preset: preset_name(&self.settings),
            speed: self.walker.speed(),
            walks: self.walker.is_walking(),
            samples: *samples,
        };
        let mut bytes = self.encoder.encode(cells.clone(), &status.line(self.size.0.into()), rows.into());
        if !bytes.is_empty() {
            bytes.extend_from_slice(self.flow.question().as_bytes());
            self.flow.sent(now, bytes.len());
            self.screen.write(&bytes)?;
        }
        Ok(())
    }

    fn suspend(&mut self) -> std::io::Result<()> {
        self.screen.give_back()?;
        signals::suspend()?;
        self.screen.resume()?;
        self.keys.clear();
        self.encoder.forget();
        self.is_stale = true;
        self.size = self.screen.size();
        Ok(())
    }
}

/// Columns and rows of the picture in a terminal of `size`: the last row is the status line.
fn picture_size((columns, rows): (u16, u16)) -> (u16, u16) {
    (columns.min(MAX_CELLS.0), rows.saturating_sub(1).min(MAX_CELLS.1))
}

/// What a preset says of approximations. Samples, and what kind of picture it is, stay as chosen.
fn with_preset(chosen: &Settings, preset: &Preset) -> Settings {
    let Settings { visibility, stride, fill, match_threshold, render_scale, min_weight, .. } = (preset.settings)();
    Settings { visibility, stride, fill, match_threshold, render_scale, min_weight, ..chosen.clone() }
}

/// The preset that `settings` follow.
fn preset_name(settings: &Settings) -> &'static str {
    PRESETS
        .iter()
        .find(|preset| with_preset(settings, preset) == *settings)
        .map_or("own settings", |preset| preset.name)
}

/// Whether `event` answers the question behind a frame.
fn is_answer(event: &Event) -> bool {
    matches!(event, Event::Csi(Csi::Cursor(Cursor::ActivePositionReport { .. })))
}

/// The thread that reads what is typed. Dropping it ends and joins the thread, so that the rest is the shell's.
struct Reading {
    reader: EventReader,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Reading {
    fn start(reader: EventReader, sender: Sender<Message>) -> std::io::Result<Self> {
        let events = reader.clone();
        let read = move || {
            loop {
                let message = match events.read(|_| true) {
                    Ok(event) => Message::Input(event, Instant::now()),
                    // Woken up to end.
                    Err(error) if error.kind() == std::io::ErrorKind::Interrupted => return,
                    Err(error) => Message::InputGone(error),
                };
                let is_last = matches!(message, Message::InputGone(_));
                if sender.send(message).is_err() || is_last {
                    return;
                }
            }
        };
        let thread = std::thread::Builder::new().name("keys".to_owned()).spawn(read)?;
        Ok(Self { reader, thread: Some(thread) })
    }
}

impl Drop for Reading {
    fn drop(&mut self) {
        // It ended by itself where the terminal is gone.
        let _ = self.reader.waker().wake();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Supersample;

    #[test]
    fn the_last_row_is_the_status_line() {
        assert_eq!(picture_size((80, 24)), (80, 23));
        assert_eq!(picture_size((80, 1)), (80, 0));
        assert_eq!(picture_size((80, 0)), (80, 0));
        assert_eq!(picture_size((65535, 65535)), MAX_CELLS);
    }

    #[test]
    fn presets_keep_what_is_no_approximation() {
        let chosen = Settings { shadows: false, supersample: Supersample::Grid { side: 2 }, ..Settings::balanced() };
        let mut settings = chosen.clone();
        for preset in [2, 0, 1] {
            settings = with_preset(&settings, &PRESETS[preset]);
            assert_eq!(preset_name(&settings), PRESETS[preset].name);
        }
        assert_eq!(settings, chosen);
        assert_eq!(preset_name(&Settings { stride: 2, ..chosen }), "own settings");
    }
}
