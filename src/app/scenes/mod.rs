//! Scenes that come and go while the window is open: opened, reloaded, watched.
//!
//! | file | what |
//! |---|---|
//! | [`load`] | a load on a thread of its own |
//! | [`folder`] | which scene file is meant by a path |
//! | [`watch`] | which of a scene's files have changed |
//! | [`dialog`] | the desktop's file dialog |
//! | [`recent`] | the files that were opened last |
//!
//! Architecture invariant: the scene that is shown stays until another stands, whatever becomes of the load.

mod dialog;
mod folder;
mod load;
mod recent;
#[cfg(test)]
mod temporary;
mod watch;

pub use load::{Arrival, Failed, Load, Outcome};
pub use recent::RecentFiles;

use crate::scene::progress::Step;
use crate::scene::{self, LoadOptions, Progress, Scene, Warning};
use dialog::Answer;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};
use watch::{Sight, Watch};
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};

/// A load that is done sooner is not worth a word.
const WORTH_A_WORD: Duration = Duration::from_millis(250);

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

/// A load that came to nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What could not be done.
    pub title: String,
    /// Why: file and place, problem, remedy.
    pub message: String,
    /// What to open to try it again.
    pub file: Option<PathBuf>,
}

/// A load as the overlay shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Loading {
    /// What is loaded.
    pub name: String,
    /// What the load is busy with.
    pub step: Step,
    /// How long it has taken.
    pub seconds: f64,
}

/// What there is to say of scenes.
#[derive(Clone, Debug, Default)]
pub struct Report<'a> {
    /// The load under way, if it takes long.
    pub loading: Option<Loading>,
    /// The load that came to nothing, until it is dismissed or another begins.
    pub failure: Option<&'a Failure>,
    /// A scene that was odd, until that is dismissed.
    pub odd: Option<&'a Scene>,
    /// What may be done now.
    pub hint: Option<&'static str>,
    /// The files that were opened last.
    pub recent: &'a [PathBuf],
    /// Why files are not watched, if they are not.
    pub blind: Option<&'a str>,
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
    /// There is nothing to show: the first load of all failed.
    Nothing(Failed),
}

enum Note {
    LoadEnded,
    Saw(Sight),
    Answered(Answer),
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
    pending: Option<Pending>,
    /// The scene that is shown has changed on disk while another was loaded.
    outdated: bool,
    failure: Option<Failure>,
    odd: Option<Arc<Scene>>,
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
            pending: None,
            outdated: false,
            failure: None,
            odd: None,
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
        self.failure = None;
        let is_odd = !arrival.scene.warnings.is_empty() && arrival.scene.warnings != self.dismissed;
        self.odd = is_odd.then(|| Arc::clone(&arrival.scene));
        self.file.clone_from(&arrival.file);
        if let Some(file) = &arrival.file {
            self.recent.opened(file);
        }
        self.watch.files(arrival.files.clone());
    }

    /// Opens a scene file, or the one in a folder; what is shown already is reloaded.
    pub fn open(&mut self, path: &Path) {
        let is_shown = self.file.as_deref().is_some_and(|file| is_same(file, path));
        self.load(path, if is_shown { Errand::Reload } else { Errand::Open });
    }

    /// Loads what is shown once more, if it is of a file.
    pub fn reload(&mut self) {
        if let Some(file) = self.file.clone() {
            self.load(&file, Errand::Reload);
        }
    }

    /// Ends the load under way; false where there is none.
    pub fn cancel(&mut self) -> bool {
        let Some(pending) = self.pending.take() else { return false };
        pending.load.progress().cancel();
        if self.outdated {
            self.reload();
        }
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
            Wish::DismissWarnings => self.dismiss_warnings(),
        }
    }

    fn dismiss_warnings(&mut self) {
        if let Some(scene) = self.odd.take() {
            self.dismissed.clone_from(&scene.warnings);
        }
    }

    /// The file of the scene that is shown; `None` for the built-in one.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The files that were opened last.
    pub fn recent(&self) -> &RecentFiles {
        &self.recent
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
            odd: self.odd.as_deref(),
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
                Note::Saw(Sight::Blind(reason)) => self.blind = Some(reason),
                Note::Saw(Sight::Changed) => match &self.pending {
                    Some(pending) if pending.errand != Errand::Reload => self.outdated = true,
                    _ => self.reload(),
                },
                Note::Answered(answer) => {
                    self.is_asking = false;
                    match answer {
                        Answer::Chosen(path) => self.open(&path),
                        Answer::Closed => {}
                        Answer::NoDialog => self.failure = Some(no_dialog()),
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
                self.failure = Some(failure(format!("{name} could not be opened"), &failed, file));
                if self.outdated {
                    self.reload();
                }
            }
            Errand::Reload => {
                let title = format!("{name} could not be reloaded; it is shown as it was");
                self.failure = Some(failure(title, &failed, file));
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
    let file = folder::scene_file(path)?;
    let scene = scene::load(&file, options)?;
    Ok(Arrival {
        camera: scene.cameras[0].camera,
        scene: Arc::new(scene),
        file: Some(file),
        files: options.progress.files(),
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

fn failure(title: String, failed: &Failed, file: PathBuf) -> Failure {
    Failure { title, message: failed.to_string(), file: Some(file) }
}

fn no_dialog() -> Failure {
    Failure {
        title: "There is no file dialog here".to_owned(),
        message:
            "This desktop has neither a portal for file dialogs (xdg-desktop-portal) nor zenity. Drop a scene file or \
                  its folder on this window, or name it on the command line."
                .to_owned(),
        file: None,
    }
}

#[cfg(test)]
mod tests {
    use super::temporary::Folder;
    use super::*;
    use std::sync::Mutex;

    const SOON: Duration = Duration::from_secs(20);
    const BALL: &str = r#"{ "type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "red" }"#;

    /// Scenes, and a channel that says when to ask for news.
    fn scenes() -> (Scenes, Receiver<()>) {
        let (sender, woken) = channel();
        let sender = Mutex::new(sender);
        let wake = move || sender.lock().expect("nobody panics").send(()).unwrap_or(());
        (Scenes::new(LoadOptions::default(), RecentFiles::default(), Arc::new(wake)), woken)
    }

    fn ball(color: &str) -> String {
        format!(r#"{{ "version": 1, "materials": {{ "red": {{ "color": {color} }} }}, "objects": [{BALL}] }}"#)
    }

    /// Waits for news, or for `until` to come true.
    fn wait(scenes: &mut Scenes, woken: &Receiver<()>, until: impl Fn(&Scenes) -> bool) -> Option<News> {
        let end = Instant::now() + SOON;
        loop {
            if let Some(news) = scenes.news() {
                return Some(news);
            }
            if until(scenes) {
                return None;
            }
            let left = end.saturating_duration_since(Instant::now());
            woken.recv_timeout(left).expect("something comes of it");
        }
    }

    fn opened(scenes: &mut Scenes, woken: &Receiver<()>) -> Arrival {
        match wait(scenes, woken, |_| false) {
            Some(News::Opened(arrival)) => arrival,
            other => panic!("{other:?}"),
        }
    }

    fn reloaded(scenes: &mut Scenes, woken: &Receiver<()>) -> Arrival {
        match wait(scenes, woken, |_| false) {
            Some(News::Reloaded(arrival)) => arrival,
            other => panic!("{other:?}"),
        }
    }

    fn red(arrival: &Arrival) -> f32 {
        arrival.scene.materials[0].color.factor.x
    }

    #[test]
    fn a_folder_is_opened_and_its_file_remembered() {
        let folder = Folder::new();
        let file = folder.write("ball.json", ball("[0.5, 0, 0]"));
        let (mut scenes, woken) = scenes();
        scenes.drop_in(folder.path().to_owned());
        assert!(scenes.open_dropped() && scenes.is_loading() && !scenes.open_dropped());
        let arrival = opened(&mut scenes, &woken);
        assert_eq!((red(&arrival), arrival.file.as_ref()), (0.5, Some(&file)));
        assert_eq!(scenes.recent().files(), [file]);
        assert!(!scenes.is_loading());
    }

    #[test]
    fn an_edit_is_seen_a_broken_one_is_survived_and_mended() {
        let folder = Folder::new();
        let file = folder.write("ball.json", ball("[0.5, 0, 0]"));
        let (mut scenes, woken) = scenes();
        scenes.open(&file);
        opened(&mut scenes, &woken);
        folder.write("ball.json", ball("[0.25, 0, 0]"));
        assert_eq!(red(&reloaded(&mut scenes, &woken)), 0.25);
        folder.write("ball.json", "{ \"version\": 1,");
        assert!(wait(&mut scenes, &woken, |scenes| scenes.failure.is_some()).is_none());
        let failure = scenes.report(Instant::now()).failure.expect("it was broken");
        assert!(failure.title.contains("ball.json could not be reloaded"), "{}", failure.title);
        assert!(failure.message.contains("ball.json:1:"), "{}", failure.message);
        let new = folder.write("ball.json.new", ball("[0.125, 0, 0]"));
        std::fs::rename(new, &file).expect("saved by renaming");
        assert_eq!(red(&reloaded(&mut scenes, &woken)), 0.125);
        assert!(scenes.report(Instant::now()).failure.is_none());
    }

    #[test]
    fn a_texture_may_be_missing_and_come_and_change() {
        let folder = Folder::new();
        let file = folder.write(
            "ball.json",
            format!(
                r#"{{ "version": 1, "textures": {{ "wood": {{ "image": "wood.bmp" }} }},
                    "materials": {{ "red": {{ "color": {{ "texture": "wood" }} }} }}, "objects": [{BALL}] }}"#
            ),
        );
        let (mut scenes, woken) = scenes();
        scenes.open(&file);
        // A JSON scene needs its textures; the scene was not opened, so what it lacks is not waited for.
        assert!(wait(&mut scenes, &woken, |scenes| scenes.failure.is_some()).is_none());
        folder.write("wood.bmp", bitmap(10));
        scenes.open(&file);
        opened(&mut scenes, &woken);
        folder.write("wood.bmp", bitmap(200));
        reloaded(&mut scenes, &woken);
        std::fs::remove_file(folder.path().join("wood.bmp")).expect("removed");
        assert!(wait(&mut scenes, &woken, |scenes| scenes.failure.is_some()).is_none());
        folder.write("wood.bmp", bitmap(10));
        reloaded(&mut scenes, &woken);
    }

    /// A bitmap of one grey pixel.
    fn bitmap(grey: u8) -> Vec<u8> {
        let mut bytes = b"BM".to_vec();
        for word in [58_u32, 0, 54, 40, 1, 1, 1 | 24 << 16, 0, 4, 0, 0, 0, 0] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend([grey, grey, grey, 0]);
        bytes
    }

    #[test]
    fn what_cannot_be_opened_leaves_what_is_shown_and_says_why() {
        let folder = Folder::new();
        let file = folder.write("ball.json", ball("[0.5, 0, 0]"));
        let (mut scenes, woken) = scenes();
        scenes.open(&file);
        opened(&mut scenes, &woken);
        let bad = folder.write("notes.txt", "");
        scenes.drop_in(bad.clone());
        assert!(scenes.open_dropped() && wait(&mut scenes, &woken, |scenes| scenes.failure.is_some()).is_none());
        let failure = scenes.report(Instant::now()).failure.cloned().expect("it is no scene");
        assert!(failure.message.contains("unknown scene format") && failure.file.as_ref() == Some(&bad));
        // What is shown is still watched.
        folder.write("ball.json", ball("[0.25, 0, 0]"));
        assert_eq!(red(&reloaded(&mut scenes, &woken)), 0.25);
    }

    #[test]
    fn a_cancelled_load_is_forgotten() {
        let folder = Folder::new();
        let file = folder.write("ball.json", ball("[0.5, 0, 0]"));
        let (mut scenes, woken) = scenes();
        assert!(!scenes.cancel());
        scenes.open(&file);
        assert!(scenes.is_loading() && scenes.cancel() && !scenes.is_loading());
        scenes.open(&file);
        opened(&mut scenes, &woken);
        assert!(scenes.report(Instant::now()).failure.is_none() && scenes.news().is_none());
    }

    #[test]
    fn what_is_shown_is_not_opened_but_reloaded() {
        let folder = Folder::new();
        let file = folder.write("ball.json", ball("[0.5, 0, 0]"));
        let (mut scenes, woken) = scenes();
        scenes.open(&file);
        opened(&mut scenes, &woken);
        scenes.open(&file);
        reloaded(&mut scenes, &woken);
    }

    #[test]
    fn the_first_load_of_all_has_to_succeed() {
        let (mut scenes, woken) = scenes();
        let load = Load::start(Progress::default(), || Err("no such file".into()));
        scenes.expect(load, PathBuf::from("room.json"));
        match wait(&mut scenes, &woken, |_| false) {
            Some(News::Nothing(failed)) => assert_eq!(failed.to_string(), "no such file"),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn warnings_stay_until_they_were_read_and_come_back_when_they_are_others() {
        let folder = Folder::new();
        let odd = |key: &str| format!(r#"{{ "version": 1, "{key}": 1, "objects": [] }}"#);
        let file = folder.write("odd.json", odd("colour"));
        let (mut scenes, woken) = scenes();
        scenes.open(&file);
        opened(&mut scenes, &woken);
        assert!(scenes.report(Instant::now()).odd.is_some());
        scenes.dismiss_warnings();
        scenes.reload();
        reloaded(&mut scenes, &woken);
        assert!(scenes.report(Instant::now()).odd.is_none());
        folder.write("odd.json", odd("colours"));
        reloaded(&mut scenes, &woken);
        assert!(scenes.report(Instant::now()).odd.is_some());
    }
}
