//! Screenshots: the picture on display as a PNG that says how to make it again.

use super::at_rest::{self, SAMPLES};
use super::errands::{Errand, News};
use super::maps::Map;
use super::tracer::Job;
use crate::picture::{EightBit, Note, NumberedName, PendingFile, write_annotated};
use crate::render::Film;
use crate::scene::camera::shortest;
use crate::scene::{Camera, EnvironmentChoice, Limits, NamedCamera};
use crate::settings::{ROWS, Row, Settings, Supersample};
use glam::DVec3;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Where screenshots go unless something else is asked for.
pub const USUAL_NAME: &str = "raywalk-%04d.png";
/// Most pictures of one name.
const MOST: u64 = 999_999;

/// The name that was asked for, if screenshots can have it.
///
/// # Errors
/// What a name needs.
pub fn name(asked: &Path) -> Result<NumberedName, String> {
    let name = NumberedName::new(asked);
    let is_png = asked.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    if is_png && name.has_number() { Ok(name) } else { Err(format!("expected a name such as {USUAL_NAME}")) }
}

/// Where a picture was taken, beside what its job says.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The scene's file as it was opened; `None` for the built-in scene.
    pub file: Option<PathBuf>,
    /// The scene's cameras.
    pub cameras: Vec<NamedCamera>,
    /// Lights that were turned, in words.
    pub turned: Vec<String>,
    /// How the scene was loaded.
    pub limits: Limits,
    /// What surrounds the scene, as far as it can be named.
    pub environment: EnvironmentChoice,
    /// How that differs from what it is by its name, in words.
    pub environment_turned: Option<String>,
}

/// A picture on display, and what made it.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    picture: EightBit,
    job: Job,
    samples: Option<u32>,
    place: Place,
}

impl Shot {
    /// Of `film`, traced for `job` at `place`; `samples` a pixel where it was refined at rest.
    pub fn new(film: &Film, job: &Job, samples: Option<u32>, place: Place) -> Self {
        Self { picture: EightBit::of_film(film), job: job.clone(), samples, place }
    }

    /// Whether it is to have more samples, as long as its view is the one that is asked for.
    fn is_under_way(&self) -> bool {
        at_rest::is_refined(&self.job.settings) && self.samples != Some(SAMPLES)
    }

    /// Whether flags can make the same picture: there are none for a part of the samples.
    fn is_final(&self) -> bool {
        self.samples.is_none_or(|samples| samples == SAMPLES)
    }

    /// The settings that make this picture, or for one that is being refined what it comes to.
    fn settings(&self) -> Settings {
        let settings = self.job.settings.clone();
        match self.samples {
            None => settings,
            Some(_) => {
                let supersample = Supersample::Grid { side: Supersample::REFINED_SIDE };
                Settings { supersample, render_scale: 1.0, ..settings }
            }
        }
    }
}

/// Screenshots that wait for the last of their samples: what is taken of a view at rest is what it comes to.
#[derive(Debug, Default)]
pub struct Camerawork {
    waiting: Option<Shot>,
    /// One was asked for that is of the next picture.
    is_due: bool,
}

impl Camerawork {
    /// A screenshot was asked for: returns it if it can be written, or lets it wait until its view is refined, which
    /// comes while `is_kept`: nothing else has been asked of the tracer since.
    pub fn ask(&mut self, shot: Shot, is_kept: bool) -> Option<Shot> {
        if shot.is_final() && !(is_kept && shot.is_under_way()) {
            return Some(shot);
        }
        self.waiting = Some(shot);
        None
    }

    /// A screenshot was asked for that cannot be taken before the next picture.
    pub fn postpone(&mut self) {
        self.is_due = true;
    }

    /// Whether one was postponed; asked again, it is not.
    pub fn is_due(&mut self) -> bool {
        std::mem::take(&mut self.is_due)
    }

    /// A frame came while one waited. Returns what is to be written: the refined picture, or, where the view was left,
    /// what was seen.
    pub fn frame(&mut self, film: &Film, job: &Job, samples: Option<u32>) -> Option<Shot> {
        let waiting = self.waiting.take()?;
        if waiting.job != *job || samples < waiting.samples {
            return Some(waiting);
        }
        if samples == Some(SAMPLES) {
            return Some(Shot { picture: EightBit::of_film(film), samples, ..waiting });
        }
        self.waiting = Some(waiting);
        None
    }

    /// The one that waits, as it is.
    pub fn give_up(&mut self) -> Option<Shot> {
        self.waiting.take()
    }
}

/// What writes `shot` under the first free name.
pub fn errand(shot: Shot, name: NumberedName) -> Errand {
    Box::new(move || {
        let notes = notes(&shot);
        let write = |pending: PendingFile| {
            pending.commit_to_free((1..=MOST).map(|number| name.of(number)), |sink| {
                write_annotated(&shot.picture, &notes, sink)
            })
        };
        // Its first name is only where it is: a file of that name is no obstacle, even if it cannot be written.
        Some(match PendingFile::beside(&name.of(1)).and_then(write) {
            Ok(path) => {
                let path = std::path::absolute(&path).unwrap_or(path);
                News::Done(format!("Screenshot: {}", path.display()))
            }
            Err(error) => News::Problem(format!("No screenshot: {error}")),
        })
    })
}

/// What is written into the file.
fn notes(shot: &Shot) -> Vec<Note> {
    let (settings, place) = (shot.settings(), &shot.place);
    let values: serde_json::Map<_, _> =
        picture_rows().map(|row| (row.name.to_owned(), (row.get)(&settings).into())).collect();
    let scene = place.file.as_ref().map_or_else(|| "built-in".to_owned(), |file| file.display().to_string());
    let mut notes = vec![
        ("Software", format!("raywalk {}", env!("CARGO_PKG_VERSION"))),
        ("raywalk:command", command(shot, &settings)),
        ("raywalk:scene", scene),
        ("raywalk:camera", shot.job.scene.file_camera(&shot.job.camera).to_json()),
        ("raywalk:settings", serde_json::Value::Object(values).to_string()),
    ];
    if !place.turned.is_empty() {
        let turned = place.turned.join("; ");
        notes.push(("raywalk:lights", format!("{turned}; the command makes the picture with all as in the file")));
    }
    if let Some(turned) = &place.environment_turned {
        notes.push(("raywalk:environment", format!("{turned}; the command makes the picture without that")));
    }
    let Camera { near, far, .. } = shot.job.camera;
    if camera_alike(shot).is_none() {
        notes.push(("raywalk:clipping", format!("from {near} to {far}, which the command leaves out")));
    }
    if let Some(beside) = &shot.job.aspect.beside {
        notes.push(("raywalk:beside", format!("right of the divider: {}", beside.flags())));
    }
    if let Some(samples) = shot.samples.filter(|_| !shot.is_final()) {
        notes.push((
            "raywalk:samples",
            format!("{samples} of {SAMPLES}: the command makes the picture with all of them"),
        ));
    }
    notes
}

/// The rows that a picture may depend on.
fn picture_rows() -> impl Iterator<Item = &'static Row> {
    let of_this_machine = ["threads", "simd", "refine-at-rest", "target-fps", "present"];
    ROWS.iter().filter(move |row| !of_this_machine.contains(&row.name))
}

/// The command line that renders the same picture.
fn command(shot: &Shot, settings: &Settings) -> String {
    let place = &shot.place;
    let vector = |vector: DVec3| format!("{},{},{}", vector.x, vector.y, vector.z);
    let Camera { eye, look_at, up, fov, .. } = shot.job.camera;
    let (eye, look_at) = (shot.job.scene.in_file(eye), shot.job.scene.in_file(look_at));
    let up = DVec3::from(up.to_array().map(shortest));
    let mut words = vec!["raywalk".to_owned(), "render".to_owned()];
    words.extend(place.file.as_ref().map(|file| quoted(file.as_os_str())));
    words.push(format!("--size {}x{}", shot.picture.width, shot.picture.height));
    words.extend(place.limits.changed().map(|(name, value)| format!("--limit {name}={value}")));
    words.extend(environment_flag(&place.environment));
    if let Some(index) = camera_alike(shot).filter(|index| *index > 0) {
        words.push(format!("--camera {}", quoted(place.cameras[index].name.as_ref())));
    }
    words.push(format!("--eye {} --look-at {} --up {} --fov {fov}", vector(eye), vector(look_at), vector(up)));
    let exact = Settings::exact();
    let changed = picture_rows().filter(|row| (row.get)(settings) != (row.get)(&exact));
    words.extend(changed.map(|row| format!("--{} {}", row.name, (row.get)(settings))));
    if shot.job.aspect.map != Map::Picture {
        words.push(format!("--map {}", shot.job.aspect.map.name()));
    }
    words.join(" ")
}

/// The flag that names an environment, as a shell takes it.
pub fn environment_flag(choice: &EnvironmentChoice) -> Option<String> {
    choice.name().map(|name| format!("--environment {}", quoted(name)))
}

/// The first camera of the scene that sees as near and as far: these have no flags of their own.
fn camera_alike(shot: &Shot) -> Option<usize> {
    let Camera { near, far, .. } = shot.job.camera;
    shot.place.cameras.iter().position(|NamedCamera { camera, .. }| (camera.near, camera.far) == (near, far))
}

/// A word as a shell takes it, in ASCII: text of that kind is what every program reads of a PNG.
fn quoted(word: &OsStr) -> String {
    let bytes = word.as_encoded_bytes();
    let is_plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"._-/+:@%,".contains(byte);
    let is_visible = |byte: &u8| matches!(byte, b' '..=b'~');
    if !bytes.is_empty() && bytes.iter().all(is_plain) {
        word.to_string_lossy().into_owned()
    } else if bytes.iter().all(is_visible) {
        format!("'{}'", word.to_string_lossy().replace('\'', r"'\''"))
    } else {
        let escaped = |byte: &u8| match byte {
            b'\'' | b'\\' => format!("\\{}", char::from(*byte)),
            b' '..=b'~' => char::from(*byte).to_string(),
            _ => format!("\\{byte:03o}"),
        };
        format!("$'{}'", bytes.iter().map(escaped).collect::<String>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::lowering::Lowering;
    use crate::app::methods::Aspect;
    use crate::render::Planes;
    use crate::scene::{Scene, nothing};
    use crate::settings::Fill;
    use crate::temporary::Folder;
    use serde_json::json;
    use std::sync::{Arc, LazyLock};

    fn job() -> Job {
        static SCENE: LazyLock<Arc<Scene>> = LazyLock::new(|| Arc::new(nothing().expect("it is built in")));
        let settings = Settings { fill: Fill::Color, threads: 3, render_scale: 0.5, ..Settings::exact() };
        Job {
            scene: Arc::clone(&SCENE),
            camera: Camera::default(),
            settings,
            width: 8,
            height: 4,
            lowering: Lowering::NONE,
            aspect: Aspect::default(),
        }
    }

    fn shot(samples: Option<u32>) -> Shot {
        Shot::new(&Film::new(8, 4, Planes::default()), &job(), samples, place(None))
    }

    fn place(file: Option<&str>) -> Place {
        let named =
            |name: &str, near| NamedCamera { name: name.to_owned(), camera: Camera { near, ..Camera::default() } };
        Place {
            file: file.map(PathBuf::from),
            cameras: vec![named("default", 0.5), named("back door", 0.0)],
            turned: Vec::new(),
            limits: Limits::default(),
            environment: EnvironmentChoice::Scene,
            environment_turned: None,
        }
    }

    #[test]
    fn the_command_says_all_that_the_picture_depends_on() {
        let of = |shot: Shot, place: Place| {
            let shot = Shot { place, ..shot };
            command(&shot, &shot.settings())
        };
        let view = "--size 8x4 --camera 'back door' --eye 0,0,5 --look-at 0,0,0 --up 0,1,0 --fov 60 --fill color";
        let as_set = of(shot(None), place(Some("a b.json")));
        assert_eq!(as_set, format!("raywalk render 'a b.json' {view} --render-scale 0.5"));
        let refined = of(shot(Some(SAMPLES)), place(None));
        assert_eq!(refined, format!("raywalk render {view} --supersample 16"));
        let first = Place { cameras: place(None).cameras.split_off(1), ..place(None) };
        assert!(!of(shot(None), first).contains("--camera"));
        let mut limits = Limits::default();
        limits.set("nodes", "7").expect("allowed");
        assert!(of(shot(None), Place { limits, ..place(None) }).contains("--size 8x4 --limit nodes=7 --camera"));
        let sky = EnvironmentChoice::File("my sky.hdr".into());
        let surrounded = of(shot(None), Place { environment: sky, ..place(None) });
        assert!(surrounded.contains("--size 8x4 --environment 'my sky.hdr' --camera"), "{surrounded}");
        let of_file = |file| of(shot(None), place(Some(file)));
        assert!(of_file("it's.json").starts_with(r"raywalk render 'it'\''s.json' --size"));
        assert!(of_file("d'été\n.json").starts_with(r"raywalk render $'d\'\303\251t\303\251\012.json' --size"));
    }

    #[test]
    fn a_view_at_rest_is_taken_when_it_is_refined_and_one_that_is_left_as_it_was() {
        let film = Film::new(8, 4, Planes::default());
        let mut camerawork = Camerawork::default();
        assert_eq!(camerawork.ask(shot(None), true), Some(shot(None)), "it will not be refined");
        assert_eq!(camerawork.frame(&film, &job(), None), None, "nothing waits");
        let refined = Job { settings: Settings { refine_at_rest: true, ..job().settings }, ..job() };
        let shot = |samples| Shot { job: refined.clone(), ..shot(samples) };
        assert_eq!(camerawork.ask(shot(None), false), Some(shot(None)), "on the move");
        let last = Some(SAMPLES);
        assert_eq!(camerawork.ask(shot(last), true), Some(shot(last)), "it has them all");
        for samples in [None, Some(3)] {
            assert_eq!(camerawork.ask(shot(samples), true), None, "{samples:?}");
            assert_eq!(camerawork.frame(&film, &refined, Some(9)), None);
            assert_eq!(camerawork.frame(&film, &refined, last), Some(shot(last)));
            assert_eq!(camerawork.ask(shot(samples), true), None);
            let elsewhere = Job { width: 9, ..refined.clone() };
            assert_eq!(camerawork.frame(&film, &elsewhere, None), Some(shot(samples)), "as it was seen");
            assert_eq!(camerawork.give_up(), None);
        }
    }

    #[test]
    fn a_postponed_one_is_due_once() {
        let mut camerawork = Camerawork::default();
        assert!(!camerawork.is_due());
        camerawork.postpone();
        assert!(camerawork.is_due() && !camerawork.is_due());
    }

    #[test]
    fn pictures_are_numbered_past_those_that_are_there_and_tell_what_made_them() {
        let folder = Folder::new();
        folder.write("walk-0001.png", b"of old");
        let name = name(&folder.path().join("walk-%04d.png")).expect("a number and .png");
        let place = Place { turned: vec!["lamp: off".to_owned()], ..place(None) };
        for number in [2, 3] {
            let news = errand(Shot { place: place.clone(), ..shot(Some(7)) }, name.clone())();
            let path = folder.path().join(format!("walk-000{number}.png"));
            assert_eq!(news, Some(News::Done(format!("Screenshot: {}", path.display()))));
            let file = std::io::BufReader::new(std::fs::File::open(path).expect("there"));
            let reader = png::Decoder::new(file).read_info().expect("a PNG");
            let texts = &reader.info().uncompressed_latin1_text;
            let text = |keyword: &str| texts.iter().find(|t| t.keyword == keyword).expect("a note").text.clone();
            assert!(text("raywalk:command").starts_with("raywalk render --size 8x4"));
            assert_eq!(text("raywalk:scene"), "built-in");
            let camera: serde_json::Value = serde_json::from_str(&text("raywalk:camera")).expect("JSON");
            assert_eq!(camera["position"], json!([0.0, 0.0, 5.0]));
            let settings: serde_json::Value = serde_json::from_str(&text("raywalk:settings")).expect("JSON");
            assert_eq!((settings["fill"].as_str(), settings.get("threads")), (Some("color"), None));
            assert!(text("raywalk:samples").starts_with("7 of 16"));
            assert!(text("raywalk:lights").starts_with("lamp: off; "));
        }
        assert_eq!(std::fs::read(folder.path().join("walk-0001.png")).expect("there"), b"of old");
    }

    #[test]
    fn a_folder_that_is_not_there_is_told_of() {
        let folder = Folder::new();
        let name = name(&folder.path().join("missing/%d.png")).expect("a number and .png");
        let Some(News::Problem(text)) = errand(shot(None), name)() else { panic!("written") };
        assert!(text.contains("missing"), "{text}");
    }

    #[test]
    fn names_have_a_number_and_are_png() {
        assert!(["a.png", "%04d.jpg", "%04d", "%04d/a.png"].iter().all(|bad| name(Path::new(bad)).is_err()));
        assert!(name(Path::new(USUAL_NAME)).is_ok());
    }
}
