//! Camera paths: keys in time, a smooth curve between them, the same frames on every run.
//!
//! ```json
//! { "version": 1, "fps": 60,
//!   "keys": [ { "t": 0, "position": [0, 1, 5], "look_at": [0, 1, 0], "fov": 60 },
//!             { "t": 2, "position": [4, 1, 0], "look_at": [0, 1, 0] } ] }
//! ```
//!
//! Frame `i` is taken at the first key's time plus `i / fps`; after the last key the camera stands still. Position,
//! target and field of view each follow a cubic Hermite spline whose tangents are the three-point differences of
//! their neighbours (Catmull-Rom for keys evenly spaced in time). A key without `fov` takes that of the camera which
//! the walk starts from; its near and far limits hold for the whole path, and so does its `up`, unless the path gives
//! one (`"up": [0, 1, 0]`) beside `fps`. A key may give another `up`, which holds from it on. Where the camera looks along
//! its `up`, the picture's up is carried over from the frame before.

mod curve;
mod fit;
mod upright;

pub use fit::{Sample, Tolerance};

use super::error::{Place, SceneError};
use super::{Camera, Warning};
use curve::Stretch;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Largest file read as a path, in bytes.
const MAX_BYTES: u64 = 64 << 20;
/// Most frames from the first key to the last: more than anyone waits for.
const MAX_FRAMES: f64 = 1e8;
/// So many keys make a file that can be read, whatever numbers are in them.
pub const READABLE_KEYS: usize = 250_000;

/// A camera that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    fps: f64,
    /// At least one, in strictly ascending order of time.
    keys: Vec<Key>,
}

/// Where the camera is at one moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Key {
    t: f64,
    position: [f64; 3],
    look_at: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    fov: Option<f64>,
    /// What is up from here on: as in the key before where the file gives none, at first that of the camera which the
    /// walk starts from.
    #[serde(skip_serializing_if = "Option::is_none")]
    up: Option<[f64; 3]>,
}

/// The file as it stands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PathFile {
    version: u32,
    #[serde(default, rename = "comment")]
    _comment: serde::de::IgnoredAny,
    #[serde(default = "default_fps")]
    fps: f64,
    up: Option<[f64; 3]>,
    keys: Vec<Key>,
}

fn default_fps() -> f64 {
    60.0
}

impl CameraPath {
    /// Reads a path from a JSON file.
    ///
    /// # Errors
    /// [`SceneError::Io`] when the file cannot be read; [`SceneError::Invalid`] with line and column, or with the
    /// JSON pointer, when its contents are wrong.
    pub fn load(file: &Path) -> Result<Self, SceneError> {
        let whole = || Place { file: file.to_owned(), line_column: None, pointer: String::new() };
        let io = |source| SceneError::Io { place: whole(), what: "the camera path".to_owned(), source };
        let invalid = |message: String| SceneError::Invalid { place: whole(), message };
        if !std::fs::metadata(file).map_err(io)?.is_file() {
            return Err(invalid("not a regular file".to_owned()));
        }
        let mut text = String::new();
        let read = File::open(file).map_err(io)?.take(MAX_BYTES + 1).read_to_string(&mut text).map_err(io)?;
        if read as u64 > MAX_BYTES {
            return Err(invalid(format!("a camera path has at most {MAX_BYTES} bytes")));
        }
        Self::parse(&text, file)
    }

    /// Reads a path from JSON text; `file` is named in errors.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with line and column, or with the JSON pointer.
    pub fn parse(text: &str, file: &Path) -> Result<Self, SceneError> {
        let invalid = |line_column, pointer: String, message: String| SceneError::Invalid {
            place: Place { file: file.to_owned(), line_column, pointer },
            message,
        };
        let mut path: PathFile = serde_json::from_str(text).map_err(|error| {
            let message = error.to_string();
            // The place is told apart from the message; serde appends it to the text.
            let message = message.split(" at line ").next().unwrap_or(&message).to_owned();
            invalid(Some((error.line(), error.column())), String::new(), message)
        })?;
        let wrong = |pointer: String, message: &str| Err(invalid(None, pointer, message.to_owned()));
        if path.version != 1 {
            return wrong("/version".into(), "unknown version; 1 is known");
        }
        if !(path.fps > 0.0 && path.fps <= 10_000.0) {
            return wrong("/fps".into(), "expected frames per second above 0, at most 10000");
        }
        let is_no_direction = |up: [f64; 3]| !DVec3::from(up).as_vec3().is_finite() || up == [0.0; 3];
        if path.up.is_some_and(is_no_direction) {
            return wrong("/up".into(), "expected a direction, not all zeros");
        }
        if path.keys.is_empty() {
            return wrong("/keys".into(), "expected at least one key");
        }
        for (i, key) in path.keys.iter().enumerate() {
            let numbers = [&[key.t][..], &key.position, &key.look_at].concat();
            if numbers.iter().any(|&v| !(v as f32).is_finite()) {
                return wrong(format!("/keys/{i}"), "a number is too large");
            }
            if key.fov.is_some_and(|fov| !(fov > 0.0 && fov < 180.0)) {
                return wrong(format!("/keys/{i}/fov"), "expected degrees above 0 and below 180");
            }
            if key.up.is_some_and(is_no_direction) {
                return wrong(format!("/keys/{i}/up"), "expected a direction, not all zeros");
            }
            if i > 0 && key.t <= path.keys[i - 1].t {
                return wrong(format!("/keys/{i}/t"), "expected a time after that of the key before");
            }
        }
        let last = path.keys.len() - 1;
        if (path.keys[last].t - path.keys[0].t) * path.fps > MAX_FRAMES {
            return wrong(format!("/keys/{last}/t"), "the path has more than 100 million frames; expected fewer");
        }
        let mut up = path.up;
        for key in &mut path.keys {
            up = key.up.or(up);
            key.up = up;
        }
        Ok(Self { fps: path.fps, keys: path.keys })
    }

    /// The path as a JSON file, a key a line.
    pub fn to_json(&self) -> String {
        // Numbers and lists can always be written.
        let mut up = self.keys[0].up;
        let first = up.and_then(|up| serde_json::to_string(&up).ok());
        let first = first.map_or_else(String::new, |up| format!(" \"up\": {up},"));
        let mut text = format!("{{ \"version\": 1, \"fps\": {},{first}\n  \"keys\": [", self.fps);
        let mut separator = "\n    ";
        for key in &self.keys {
            let line = Key { up: key.up.filter(|_| key.up != up), ..key.clone() };
            text.push_str(separator);
            text.extend(serde_json::to_string(&line));
            (up, separator) = (key.up, ",\n    ");
        }
        text + "\n  ] }\n"
    }

    /// Seconds from the first key to the last.
    pub fn duration(&self) -> f64 {
        self.keys[self.keys.len() - 1].t - self.keys[0].t
    }

    /// Frames from the first key to the last, both included.
    pub fn frame_count(&self) -> u64 {
        // A duration of whole frames must not lose its last one to rounding.
        (self.duration() * self.fps + 1e-6) as u64 + 1
    }

    /// The camera of frame `frame` in a scene that was moved so that `origin` is at its origin; what a key does not say is
    /// taken from `base`.
    pub fn camera(&self, frame: u64, base: &Camera, origin: DVec3) -> Camera {
        self.camera_at(self.keys[0].t + frame as f64 / self.fps, base, origin)
    }

    /// The camera `seconds` after the first key, in the same way.
    pub fn camera_after(&self, seconds: f64, base: &Camera, origin: DVec3) -> Camera {
        self.camera_at(self.keys[0].t + seconds, base, origin)
    }

    /// The same path elsewhere.
    pub fn moved(mut self, by: DVec3) -> Self {
        if by != DVec3::ZERO {
            for key in &mut self.keys {
                key.position = (DVec3::from(key.position) + by).into();
                key.look_at = (DVec3::from(key.look_at) + by).into();
            }
        }
        self
    }

    fn camera_at(&self, t: f64, base: &Camera, origin: DVec3) -> Camera {
        self.upright(t, self.by_keys(t, base, origin), base, origin)
    }

    /// The camera as the keys have it, whether or not it has a view.
    fn by_keys(&self, t: f64, base: &Camera, origin: DVec3) -> Camera {
        let after = self.keys.partition_point(|key| key.t <= t);
        let key = &self.keys[after.saturating_sub(1)];
        let base = Camera { up: key.up.map_or(base.up, |up| DVec3::from(up).as_vec3()), ..*base };
        match self.keys.get(after).filter(|_| after > 0) {
            Some(next) => {
                let neighbours = [after.checked_sub(2).map(|i| &self.keys[i]), self.keys.get(after + 1)];
                Stretch::between(neighbours, key, next, base.fov.into()).camera(t, &base, origin)
            }
            None => Camera {
                eye: (DVec3::from(key.position) - origin).as_vec3(),
                look_at: (DVec3::from(key.look_at) - origin).as_vec3(),
                fov: key.fov.map_or(base.fov, |fov| fov as f32).clamp(0.01, 179.99),
                ..base
            },
        }
    }

    /// Frames `range` of the path that run past its end, worded for people; `None` when all lie on it.
    pub fn warning(&self, file: &Path, end: u64) -> Option<Warning> {
        let count = self.frame_count();
        (end > count).then(|| Warning {
            place: Place { file: file.to_owned(), line_column: None, pointer: String::new() },
            message: format!("the path has {count} frames; the camera stands still in those after"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn parse(text: &str) -> Result<CameraPath, SceneError> {
        CameraPath::parse(text, Path::new("walk.json"))
    }

    const PATH: &str = r#"{ "version": 1, "comment": ["round the ball"], "fps": 10, "keys": [
        { "t": 1.0, "position": [0, 0, 5], "look_at": [0, 0, 0], "fov": 60 },
        { "t": 1.5, "position": [1, 0, 5], "look_at": [0, 1, 0] },
        { "t": 2.5, "position": [3, 0, 5], "look_at": [0, 1, 0], "fov": 40 } ] }"#;

    #[test]
    fn the_path_goes_through_its_keys_and_stands_still_after_the_last() {
        let path = parse(PATH).expect("it is right");
        let base = Camera { fov: 50.0, up: Vec3::X, ..Camera::default() };
        assert_eq!(path.frame_count(), 16);
        for (frame, x, fov) in [(0, 0.0, 60.0), (5, 1.0, 50.0), (15, 3.0, 40.0), (1000, 3.0, 40.0)] {
            let camera = path.camera(frame, &base, DVec3::ZERO);
            assert!((camera.eye.x - x).abs() < 1e-6, "frame {frame}: {camera:?}");
            assert!((camera.fov - fov).abs() < 1e-4, "frame {frame}: {camera:?}");
            assert_eq!(camera.up, Vec3::X);
        }
    }

    #[test]
    fn a_path_without_end_is_refused() {
        for (end, is_read) in [("1.6e6", true), ("1e20", false), ("3e38", false)] {
            let text = PATH.replace("2.5,", &format!("{end},")).replace("\"fps\": 10,", "");
            match parse(&text) {
                Ok(path) => assert!(is_read && path.frame_count() > 95_000_000, "{end}"),
                Err(error) => assert!(!is_read && error.to_string().contains("/keys/2/t"), "{end}: {error}"),
            }
        }
    }

    #[test]
    fn even_motion_stays_even_whatever_the_spacing_of_keys() {
        let path = parse(PATH).expect("it is right");
        for frame in 0..=15 {
            let x = path.camera(frame, &Camera::default(), DVec3::ZERO).eye.x;
            assert!((x - frame as f32 * 0.2).abs() < 1e-6, "frame {frame}: {x}");
        }
    }

    #[test]
    fn speed_does_not_jump_at_a_key() {
        let path = parse(
            r#"{ "version": 1, "fps": 1000, "keys": [
            { "t": 0, "position": [0, 0, 0], "look_at": [0, 0, -1] }, { "t": 1, "position": [4, 0, 0], "look_at": [0, 0, -1] },
            { "t": 3, "position": [5, 2, 0], "look_at": [0, 0, -1] }, { "t": 4, "position": [0, 3, 0], "look_at": [0, 0, -1] } ] }"#,
        )
        .expect("it is right");
        let eye = |frame| path.camera(frame, &Camera::default(), DVec3::ZERO).eye;
        for key in [1000, 3000] {
            let (before, after) = (eye(key) - eye(key - 1), eye(key + 1) - eye(key));
            assert!((after - before).length() < 0.02 * before.length(), "{before} {after}");
        }
    }

    #[test]
    fn one_key_is_a_path_of_one_frame() {
        let path = parse(r#"{ "version": 1, "keys": [ { "t": 7, "position": [1, 2, 3], "look_at": [0, 0, 0] } ] }"#);
        let path = path.expect("it is right");
        assert_eq!(path.frame_count(), 1);
        assert_eq!(path.camera(0, &Camera::default(), DVec3::ZERO).eye, Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(path.warning(Path::new("walk.json"), 1), None);
        assert!(path.warning(Path::new("walk.json"), 2).is_some());
    }

    #[test]
    fn wrong_paths_are_told_with_their_place() {
        let key = |t: &str| format!(r#"{{ "t": {t}, "position": [0, 0, 5], "look_at": [0, 0, 0] }}"#);
        let cases = [
            ("{ \"version\": 1,\n \"kyes\": [] }".to_owned(), "walk.json:2:"),
            (r#"{ "version": 2, "keys": [] }"#.to_owned(), "/version"),
            (r#"{ "version": 1, "keys": [] }"#.to_owned(), "/keys"),
            (format!(r#"{{ "version": 1, "up": [0, 0, 0], "keys": [{}] }}"#, key("0")), "/up"),
            (r#"{ "version": 1, "keys": [ { "t": 0, "position": [0, 0, 5], "look_at": [0, 0, 0], "up": [0, 0, 0] } ] }"#.to_owned(), "/keys/0/up"),
            (format!(r#"{{ "version": 1, "fps": 0, "keys": [{}] }}"#, key("0")), "/fps"),
            (format!(r#"{{ "version": 1, "keys": [{}, {}] }}"#, key("1"), key("1")), "/keys/1/t"),
            (format!(r#"{{ "version": 1, "keys": [{}] }}"#, key("1e39")), "/keys/0"),
            (r#"{ "version": 1, "keys": [ { "t": 0, "position": [0, 0, 5] } ] }"#.to_owned(), "look_at"),
            (String::new(), "walk.json:1:0"),
        ];
        for (text, expected) in cases {
            let message = parse(&text).expect_err(&text).to_string();
            assert!(message.contains(expected) && !message.contains('\n'), "{message}");
        }
        assert!(matches!(CameraPath::load(Path::new("no/such.json")), Err(SceneError::Io { .. })));
        assert!(matches!(CameraPath::load(&std::env::temp_dir()), Err(SceneError::Invalid { .. })));
    }
    #[test]
    fn up_holds_until_a_key_gives_another() {
        let path = parse(
            r#"{ "version": 1, "fps": 10, "keys": [
            { "t": 0, "position": [0, 0, 5], "look_at": [0, 0, 0] },
            { "t": 1, "position": [1, 0, 5], "look_at": [0, 0, 0], "up": [1, 2, 0] },
            { "t": 2, "position": [2, 0, 5], "look_at": [0, 0, 0] },
            { "t": 3, "position": [3, 0, 5], "look_at": [0, 0, 0], "up": [0, 0, 1] } ] }"#,
        )
        .expect("it is right");
        let base = Camera { up: Vec3::Y, ..Camera::default() };
        let tilted = Vec3::new(1.0, 2.0, 0.0);
        for (frame, up) in [(0, Vec3::Y), (9, Vec3::Y), (10, tilted), (25, tilted), (30, Vec3::Z), (99, Vec3::Z)] {
            assert_eq!(path.camera(frame, &base, DVec3::ZERO).up, up, "frame {frame}");
        }
        let text = path.to_json();
        assert_eq!(text.matches("up").count(), 2, "where it changes: {text}");
        assert_eq!(parse(&text).expect("it was written"), path);
    }

    #[test]
    fn keys_of_any_numbers_can_be_read_back() {
        let widest = -1_234_567_890_123_456.0;
        let numbers = [widest, -0.000_012_345_679, -3.402_823_5e38, -1.175_494_4e-38];
        assert!(numbers.iter().all(|number| serde_json::json!(number).to_string().len() <= 19));
        let (triple, fov) = ([widest; 3], Some(0.000_012_345_679));
        // Ten days, in microseconds.
        let key = Key { t: 864_000.123_456, position: triple, look_at: triple, fov, up: Some(triple) };
        let other = Key { t: 864_000.123_457, up: Some([1.0; 3]), ..key.clone() };
        let length =
            |keys: &[&Key]| CameraPath { fps: 60.0, keys: keys.iter().copied().cloned().collect() }.to_json().len();
        let line = length(&[&other, &key]) - length(&[&other]);
        assert!(((READABLE_KEYS + 1) * line) as u64 <= MAX_BYTES, "{line} bytes a key");
    }
}
