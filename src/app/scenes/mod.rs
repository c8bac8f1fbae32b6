//! Scenes that come and go while the window is open: opened, reloaded, watched.
//!
//! | file | what |
//! |---|---|
//! | [`load`] | a load on a thread of its own |
//! | [`folder`] | which scene file is meant by a path |
//! | [`sky`] | skies that are brought to a scene |
//! | [`watch`] | which of a scene's files have changed |
//! | [`dialog`] | the desktop's file dialog |
//! | [`recent`] | the files that were opened last |
//! | [`report`] | what there is to say of all this |
//! | [`warnings`] | a scene's warnings in short |
//!
//! Architecture invariant: the scene that is shown stays until another stands, whatever becomes of the load.

mod dialog;
mod folder;
mod load;
mod recent;
mod report;
mod sky;
#[cfg(test)]
mod trials;
pub mod warnings;
mod watch;

pub use folder::{NoScene, scene_file};
pub use load::{Arrival, Failed, Load, Outcome, place_of};
pub use recent::RecentFiles;
pub use report::{Failure, Loading, Oddities, Report};
pub use sky::SkyArrival;

use crate::scene::{self, EnvironmentChoice, Limits, LoadOptions, Progress, Scene, Warning};
use dialog::Answer;
use sky::{SkyFile, SkyNote};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};
use watch::{Sight, Watch};
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};

/// A load that is done sooner is not worth a word.
const WORTH_A_WORD: Duration = Duration::from_millis(250);
/// How long the line that sums warnings up stays.
const LINE_TIME: Duration = Duration::from_secs(6);

/// Why something is loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Errand {
    /// The command line names it, and nothing is shown yet.
    First,
    /// The user wants to see it.
    Open,
    /// It is shown already, and may have changed.
    Reload,
}

/// A load under way.
#[derive(Debug)]
struct Pending {
    load: Load,
    file: PathBuf,
    errand: Errand,
    began: Instant,
}

/// What the user may ask for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Choose a file to open.
    Open,
    /// Open this one.
    OpenFile(PathBuf),
    /// Load the scene once more.
    Reload,
    /// Give up what is being loaded; where nothing is, what there is to read was read.
    Cancel,
    /// The failure was read.
    DismissFailure,
    /// List the warnings of the scene that is shown, or no longer.
    ToggleWarnings,
    /// The warnings were read.
    DismissWarnings,
}

/// What has become of a load.
#[derive(Debug)]
pub enum News {
    /// Another scene is to be shown.
    Opened(Arrival),
    /// The scene shown is to be replaced by what it has become.
    Reloaded(Arrival),
    /// A sky was brought to the scene that is shown; or why it was not, in one line.
    Sky(Result<SkyArrival, String>),
    /// There is nothing to show: the first load of all failed.
    Nothing(Failed),
}

/// How warnings are told of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Telling {
    /// Not, or no longer.
    Nothing,
    /// In one line, until then.
    Line(Instant),
    /// All of them, until they are dismissed.
    List,
}

enum Note {
    LoadEnded,
    Saw(Sight),
    Answered(Answer),
    Sky(Box<SkyNote>),
    SkyChanged,
}

/// What other threads put notes into; waking the event loop is part of it.
#[derive(Clone)]
struct Inbox {
    notes: Sender<Note>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Inbox {
    fn put(&self, note: Note) {
        // After the window is closed nobody reads it.
        let _ = self.notes.send(note);
        (self.wake)();
    }
}

/// The scene shown, the one that is loaded, and what else is known of scenes.
pub struct Scenes {
    options: LoadOptions,
    /// The file of the scene that is shown.
    file: Option<PathBuf>,
    /// The one path of that file.
    place: Option<PathBuf>,
    /// Milliseconds it took to load.
    load_ms: f64,
    pending: Option<Pending>,
    sky: SkyFile,
    /// The scene that is shown has changed on disk while another was loaded.
    outdated: bool,
    failure: Option<Failure>,
    /// The scene that is shown, if it has warnings.
    odd: Option<Arc<Scene>>,
    telling: Telling,
    /// What was odd when it was last dismissed.
    dismissed: Vec<Warning>,
    /// Whether a first scene was shown.
    has_scene: bool,
    recent: RecentFiles,
    watch: Watch,
    blind: Option<String>,
    is_asking: bool,
    hovered: bool,
    dropped: Vec<PathBuf>,
    inbox: Inbox,
    notes: Receiver<Note>,
}

impl Scenes {
    /// Nothing is shown or loaded yet; scenes will be loaded by `options`. `wake` is called, on any thread, when
    /// [`news`](Self::news) may have some.
    pub fn new(options: LoadOptions, recent: RecentFiles, wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        let (sender, notes) = channel();
        let inbox = Inbox { notes: sender, wake };
        let eye = inbox.clone();
        Self {
            options,
            file: None,
            place: None,
            load_ms: 0.0,
            pending: None,
            sky: SkyFile::default(),
            outdated: false,
            failure: None,
            odd: None,
            telling: Telling::Nothing,
            dismissed: Vec::new(),
            has_scene: false,
            recent,
            watch: Watch::start(move |sight| eye.put(Note::Saw(sight))),
            blind: None,
            is_asking: false,
            hovered: false,
            dropped: Vec::new(),
            inbox,
            notes,
        }
    }

    /// Waits for a load that was begun before there was a window.
    pub fn expect(&mut self, load: Load, file: PathBuf) {
        self.begin(load, file, Errand::First);
    }

    /// Takes note of a scene that is shown from now on.
    pub fn show(&mut self, arrival: &Arrival) {
        self.has_scene = true;
        self.outdated = false;
        let is_reload = self.place == arrival.place;
        // That another scene could not be opened stays true while this one is loaded again.
        self.failure.take_if(|failure| match (&failure.file, &arrival.file) {
            (Some(failed), Some(file)) => is_same(failed, file),
            _ => true,
        });
        if self.file != arrival.file {
            self.sky.forget();
        }
        let warnings = &arrival.scene.warnings;
        self.odd = (!warnings.is_empty()).then(|| Arc::clone(&arrival.scene));
        let is_list = self.telling == Telling::List;
        self.telling = match () {
            () if warnings.is_empty() => Telling::Nothing,
            () if is_list && is_reload => Telling::List,
            () if *warnings == self.dismissed => Telling::Nothing,
            () => Telling::Line(Instant::now() + LINE_TIME),
        };
        self.file.clone_from(&arrival.file);
        self.place.clone_from(&arrival.place);
        self.load_ms = arrival.load_ms;
        if let Some(place) = &arrival.place {
            self.recent.opened(place);
        }
        self.watch.files(arrival.files.clone());
    }

    /// Opens a scene file, or the one in a folder; what is shown already is reloaded. A picture of the sky is brought to the
    /// scene that is shown.
    pub fn open(&mut self, path: &Path) {
        if EnvironmentChoice::is_image(path) {
            return self.sky.bring(path, &self.options.limits, &self.inbox);
        }
        let is_shown = self.file.as_deref().is_some_and(|file| is_same(file, path));
        self.load(path, if is_shown { Errand::Reload } else { Errand::Open });
    }

    /// Follows the sky that was brought no longer.
    pub fn forget_sky(&mut self) {
        self.sky.forget();
    }

    /// Loads what is shown once more, if it is of a file.
    pub fn reload(&mut self) {
        if let Some(file) = self.file.clone() {
            self.load(&file, Errand::Reload);
        }
    }

    /// Loads what is shown once more if it has changed while another scene was loaded.
    fn catch_up(&mut self) {
        if std::mem::take(&mut self.outdated) {
            self.reload();
        }
    }

    /// Ends the load under way; false where there is none.
    pub fn cancel(&mut self) -> bool {
        let Some(pending) = self.pending.take() else { return false };
        pending.load.progress().cancel();
        self.catch_up();
        true
    }

    /// Something is held over the window, or no longer.
    pub fn hover(&mut self, hovered: bool) {
        self.hovered = hovered;
    }

    /// A file or folder was dropped; several come one by one.
    pub fn drop_in(&mut self, path: PathBuf) {
        self.hovered = false;
        self.dropped.push(path);
    }

    /// Opens what was dropped; false where nothing was.
    pub fn open_dropped(&mut self) -> bool {
        let dropped = std::mem::take(&mut self.dropped);
        let best = folder::best(&dropped);
        if let Some(path) = best {
            self.open(path);
        }
        best.is_some()
    }

    /// Opens the file dialog over `window`, unless it is open.
    fn ask<W: HasWindowHandle + HasDisplayHandle>(&mut self, window: &W) {
        if !std::mem::replace(&mut self.is_asking, true) {
            let folder = self.file.as_deref().and_then(|file| std::path::absolute(file).ok());
            let inbox = self.inbox.clone();
            let folder = folder.as_deref().and_then(Path::parent);
            dialog::ask(window, folder, move |answer| inbox.put(Note::Answered(answer)));
        }
    }

    /// Does what the user asks for; a dialog opens over `window`.
    pub fn grant<W: HasWindowHandle + HasDisplayHandle>(&mut self, wish: Wish, window: &W) {
        match wish {
            Wish::Open => self.ask(window),
            Wish::OpenFile(file) => self.open(&file),
            Wish::Reload => self.reload(),
            Wish::Cancel => {
                if !self.cancel() {
                    self.failure = None;
                    self.dismiss_warnings();
                }
            }
            Wish::DismissFailure => self.failure = None,
            Wish::ToggleWarnings => self.toggle_warnings(),
            Wish::DismissWarnings => self.dismiss_warnings(),
        }
    }

    /// Lists all warnings, or tells no longer of them.
    fn toggle_warnings(&mut self) {
        if self.telling == Telling::List {
            self.dismiss_warnings();
        } else if self.odd.is_some() {
            self.telling = Telling::List;
        }
    }

    /// Tells no longer of the warnings, nor of the same ones when the scene is loaded again.
    fn dismiss_warnings(&mut self) {
        if let (Some(scene), true) = (&self.odd, self.telling != Telling::Nothing) {
            self.dismissed.clone_from(&scene.warnings);
        }
        self.telling = Telling::Nothing;
    }

    /// Folds the line of warnings away once it was there for long enough.
    pub fn expire(&mut self, now: Instant) {
        if self.next_end().is_some_and(|end| end <= now) {
            self.dismiss_warnings();
        }
    }

    /// When the line of warnings folds away, if there is one.
    pub fn next_end(&self) -> Option<Instant> {
        match self.telling {
            Telling::Line(end) if self.odd.is_some() => Some(end),
            _ => None,
        }
    }

    /// The file of the scene that is shown; `None` for the built-in one.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Milliseconds it took to load the scene that is shown.
    pub fn load_ms(&self) -> f64 {
        self.load_ms
    }

    /// The one path of that file.
    pub fn place(&self) -> Option<&Path> {
        self.place.as_deref()
    }

    /// How much the scenes that are loaded may ask for.
    pub fn limits(&self) -> &Limits {
        &self.options.limits
    }

    /// What surrounds the scenes that are loaded.
    pub fn environment(&self) -> &EnvironmentChoice {
        &self.options.environment
    }

    /// The files that were opened last.
    pub fn recent(&self) -> &RecentFiles {
        &self.recent
    }

    /// Whether a scene is shown: not before the first is loaded.
    pub fn has_scene(&self) -> bool {
        self.has_scene
    }

    /// Whether something is being loaded.
    pub fn is_loading(&self) -> bool {
        self.pending.is_some()
    }

    /// What there is to say.
    pub fn report(&self, now: Instant) -> Report<'_> {
        let hint = match () {
            () if self.hovered => Some("Drop it here to open it"),
            () if self.is_asking => Some("Choose a scene in the file dialog; or drop one here"),
            () if self.pending.is_none() && !self.has_scene => {
                Some("Nothing is open. Drop a scene file or its folder here, or press Ctrl+O")
            }
            () => None,
        };
        let loading = self.pending.as_ref().filter(|pending| {
            pending.errand == Errand::First || now.saturating_duration_since(pending.began) >= WORTH_A_WORD
        });
        Report {
            loading: loading.map(|Pending { load, file, began, .. }| Loading {
                name: name(file),
                step: load.progress().step(),
                seconds: now.saturating_duration_since(*began).as_secs_f64(),
            }),
            failure: self.failure.as_ref(),
            odd: self
                .odd
                .as_deref()
                .filter(|_| self.telling != Telling::Nothing)
                .map(|scene| Oddities { scene, is_list: self.telling == Telling::List }),
            folder: self.file.as_deref().and_then(Path::parent),
            hint,
            recent: self.recent.files(),
            blind: self.blind.as_deref(),
        }
    }

    /// What has become of things since it was last asked; to be asked until there is nothing.
    pub fn news(&mut self) -> Option<News> {
        while let Ok(note) = self.notes.try_recv() {
            match note {
                Note::LoadEnded => {
                    if let Some(news) = self.ended() {
                        return Some(news);
                    }
                }
                Note::Sky(note) => {
                    if let Some(outcome) = self.sky.ended(*note, &self.inbox) {
                        return Some(News::Sky(outcome));
                    }
                }
                Note::SkyChanged => self.sky.again(&self.options.limits, &self.inbox),
                Note::Saw(Sight::Blind(what)) => self.blind = Some(what),
                Note::Saw(Sight::Watchful) => self.blind = None,
                Note::Saw(Sight::Changed) => match &self.pending {
                    Some(pending) if pending.errand != Errand::Reload => self.outdated = true,
                    _ => self.reload(),
                },
                Note::Answered(answer) => {
                    self.is_asking = false;
                    match answer {
                        Answer::Chosen(path) => self.open(&path),
                        Answer::Closed => {}
                        Answer::NoDialog => self.failure = Some(Failure::of_no_dialog()),
                    }
                }
            }
        }
        None
    }

    fn load(&mut self, path: &Path, errand: Errand) {
        let options = LoadOptions { progress: Progress::default(), ..self.options.clone() };
        let (progress, file) = (options.progress.clone(), path.to_owned());
        let load = Load::start(progress, move || load_file(&file, &options));
        self.begin(load, path.to_owned(), errand);
    }

    fn begin(&mut self, load: Load, file: PathBuf, errand: Errand) {
        if let Some(before) = self.pending.take() {
            before.load.progress().cancel();
        }
        if errand != Errand::Reload {
            self.failure = None;
        }
        let inbox = self.inbox.clone();
        load.when_ended(move || inbox.put(Note::LoadEnded));
        self.pending = Some(Pending { load, file, errand, began: Instant::now() });
    }

    /// The load under way has ended, or one that was cancelled before.
    fn ended(&mut self) -> Option<News> {
        let outcome = self.pending.as_ref()?.load.take()?;
        let Pending { load, file, errand, .. } = self.pending.take()?;
        let failed = match outcome {
            Ok(arrival) => {
                self.show(&arrival);
                let again = errand == Errand::Reload;
                return Some(if again { News::Reloaded(arrival) } else { News::Opened(arrival) });
            }
            Err(failed) => failed,
        };
        let name = name(&file);
        match errand {
            Errand::First => return Some(News::Nothing(failed)),
            Errand::Open => {
                self.failure = Some(Failure::new(format!("{name} could not be opened"), &failed, file));
                self.catch_up();
            }
            Errand::Reload => {
                let title = format!("{name} could not be reloaded; it is shown as it was");
                self.failure = Some(Failure::new(title, &failed, file));
                // What it names by now may mend it, and so may what it named before.
                self.watch.also(load.progress().files());
            }
        }
        None
    }
}

impl std::fmt::Debug for Scenes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scenes").field("file", &self.file).field("pending", &self.pending).finish_non_exhaustive()
    }
}

impl Drop for Scenes {
    fn drop(&mut self) {
        if let Some(pending) = &self.pending {
            pending.load.progress().cancel();
        }
    }
}

fn load_file(path: &Path, options: &LoadOptions) -> Outcome {
    let file = scene_file(path)?;
    let began = Instant::now();
    let scene = scene::load(&file, options)?;
    Ok(Arrival {
        camera: scene.cameras[0].camera,
        scene: Arc::new(scene),
        place: Some(place_of(&file)),
        file: Some(file),
        files: options.progress.files(),
        load_ms: 1e3 * began.elapsed().as_secs_f64(),
        size: None,
    })
}

/// Whether two paths name one file, links aside.
fn is_same(a: &Path, b: &Path) -> bool {
    std::path::absolute(a).is_ok_and(|a| std::path::absolute(b).is_ok_and(|b| a == b))
}

fn name(file: &Path) -> String {
    file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}
