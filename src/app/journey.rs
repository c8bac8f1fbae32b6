//! Recording where one goes, and going there again.

use super::errands::{Errand, News};
use crate::picture::{NumberedName, PendingFile, PictureError};
use crate::scene::path::{READABLE_KEYS, Sample, Tolerance};
use crate::scene::{Camera, CameraPath};
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// Frames a second of a recorded path.
const FPS: f64 = 60.0;
/// How far a replay may be from what was recorded: the eye as a share of the surroundings, and angles in degrees.
const DISTANCE_SHARE: f64 = 2e-4;
const ANGLE: f64 = 0.05;
/// Times a second that a moving camera is noted: a mouse moves it far more often.
const RATE: f64 = 120.0;
/// Without a movement for so long, in seconds, the camera rests, and of a rest no shorter parts are noted. Together with the
/// movement before it, it takes no more samples than a movement of the same time.
const SHORTEST_REST: f64 = 2.0 / RATE;
/// Longest recording in places, half an hour and more of movement without a rest: its file can be read. A rest before the
/// end comes on top.
const MOST_SAMPLES: usize = READABLE_KEYS - 1000;
/// Name of the files of paths, and most numbers that are tried.
const NAME: &str = "raywalk-path-%04d.json";
const MOST_FILES: u64 = 9999;

/// A recording under way.
#[derive(Debug)]
struct Recorder {
    began: Instant,
    samples: Vec<Sample>,
    /// The part of time, one of [`RATE`] a second, that the last sample stands for, unless it is the first one.
    part: Option<u64>,
    /// When the camera was last seen, also where it had not moved.
    seen: f64,
}

impl Recorder {
    fn new(began: Instant, camera: Camera) -> Self {
        Self { began, samples: vec![Sample { t: 0.0, camera }], part: None, seen: 0.0 }
    }

    /// Takes the camera of a moment.
    fn see(&mut self, now: Instant, camera: Camera) {
        let t = seconds(now.saturating_duration_since(self.began));
        if t <= self.seen {
            return;
        }
        if self.samples.last().is_none_or(|last| last.camera != camera) {
            let (sample, part) = (Sample { t, camera }, Some((t * RATE) as u64));
            // Of each part of time, the last place counts.
            match self.samples.last_mut().filter(|_| part == self.part) {
                Some(last) => *last = sample,
                None => {
                    self.end_rest();
                    self.samples.push(sample);
                }
            }
            self.part = part;
        }
        self.seen = t;
    }

    /// Everything until now.
    fn samples(mut self) -> Vec<Sample> {
        self.end_rest();
        if let Some(&last) = self.samples.last()
            && last.t < self.seen
        {
            self.samples.push(Sample { t: self.seen, ..last });
        }
        self.samples
    }

    /// Notes that the camera has not moved since the last sample. The closer to both ends the denser: a curve that has to
    /// move off at once must not swing back before.
    fn end_rest(&mut self) {
        let Some(&last) = self.samples.last() else { return };
        let (start, end) = (last.t, self.seen);
        if end - start < SHORTEST_REST {
            return;
        }
        let halves = |length: f64| std::iter::successors(Some(length / 2.0), |l| Some(l / 2.0));
        let parts = || halves(end - start).take_while(|l| *l > SHORTEST_REST);
        let mut times: Vec<f64> = parts().map(|l| start + l).chain(parts().skip(1).map(|l| end - l)).collect();
        times.push(end);
        times.sort_by(f64::total_cmp);
        for t in times.into_iter().map(|t| seconds(Duration::from_secs_f64(t))) {
            if self.samples.last().is_some_and(|last| t > last.t) {
                self.samples.push(Sample { t, ..last });
            }
        }
    }
}

/// Whole microseconds, as seconds: numbers that are written with few digits and read as they were.
fn seconds(duration: Duration) -> f64 {
    duration.as_micros() as f64 / 1e6
}

/// Recording and replay.
#[derive(Debug)]
pub struct Journey {
    recorder: Option<Recorder>,
    /// The errands that make paths of recordings send them here, in the order of the recordings.
    made: (Sender<CameraPath>, Receiver<CameraPath>),
    /// Paths that are still to come.
    expected: usize,
    last: Option<Arc<CameraPath>>,
    /// The path that is replayed, and since when.
    replay: Option<(Arc<CameraPath>, Instant)>,
}

/// What became of the wish for a replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// It goes on.
    Begun,
    /// The last recording is still being made into a path.
    TooSoon,
    /// There is no recording.
    Nothing,
}

impl Default for Journey {
    fn default() -> Self {
        Self { recorder: None, made: channel(), expected: 0, last: None, replay: None }
    }
}

impl Journey {
    /// Whether a recording is under way.
    pub fn is_recording(&self) -> bool {
        self.recorder.is_some()
    }

    /// Whether a replay is.
    pub fn is_replaying(&self) -> bool {
        self.replay.is_some()
    }

    /// Starts a recording.
    pub fn record(&mut self, now: Instant, camera: Camera) {
        self.replay = None;
        self.recorder = Some(Recorder::new(now, camera));
    }

    /// Takes the camera of this moment. True when the recording has become too long and ought to end.
    pub fn see(&mut self, now: Instant, camera: Camera) -> bool {
        let Some(recorder) = &mut self.recorder else { return false };
        recorder.see(now, camera);
        recorder.samples.len() >= MOST_SAMPLES
    }

    /// Ends the recording. Returns what makes a path of it and writes that to the first of `folders` that can be written;
    /// `size` is that of the surroundings in metres, `origin` that of the scene in the coordinates of its file, `how_to` what
    /// to say of a replay.
    pub fn finish(
        &mut self,
        now: Instant,
        camera: Camera,
        folders: Vec<PathBuf>,
        (size, origin): (f64, DVec3),
        how_to: String,
    ) -> Option<Errand> {
        let mut recorder = self.recorder.take()?;
        recorder.see(now, camera);
        let tolerance = Tolerance { distance: size * DISTANCE_SHARE, angle: ANGLE };
        let made = self.made.0.clone();
        self.expected += 1;
        Some(Box::new(move || {
            let path = CameraPath::fitted(&recorder.samples(), FPS, tolerance)?.moved(origin);
            let text = path.to_json();
            // It can be replayed also where it cannot be written. At the end no one listens any more.
            let _ = made.send(path);
            Some(match write(&folders, &text) {
                Ok((file, None)) => News::Done(format!("Path written to {}{how_to}", file.display())),
                Ok((file, Some(error))) => {
                    News::Problem(format!("Path written to {} ({error}){how_to}", file.display()))
                }
                Err(error) => News::Problem(format!("No file of the recorded path ({error}){how_to}")),
            })
        }))
    }

    /// Goes where the last recording went.
    pub fn replay(&mut self, now: Instant) -> Start {
        for path in self.made.1.try_iter() {
            self.expected -= 1;
            self.last = Some(Arc::new(path));
        }
        if self.expected > 0 {
            return Start::TooSoon;
        }
        self.replay = self.last.clone().map(|path| (path, now));
        if self.is_replaying() { Start::Begun } else { Start::Nothing }
    }

    /// Ends the replay, if there is one.
    pub fn stop_replay(&mut self) -> bool {
        self.replay.take().is_some()
    }

    /// The view of this moment, while a path is replayed, in a scene of that origin.
    pub fn camera(&mut self, now: Instant, base: &Camera, origin: DVec3) -> Option<Camera> {
        let (path, began) = self.replay.as_ref()?;
        let passed = now.saturating_duration_since(*began).as_secs_f64();
        let camera = path.camera_after(passed, base, origin);
        if passed >= path.duration() {
            self.replay = None;
        }
        camera.is_valid().then_some(camera)
    }
}

/// Writes a file of a name that is not taken to the first folder that takes it; with it, why those before did not.
fn write(folders: &[PathBuf], text: &str) -> Result<(PathBuf, Option<String>), String> {
    let mut refused = None;
    for folder in folders {
        match write_to(folder, text) {
            Ok(file) => return Ok((file, refused)),
            Err(error) => refused = refused.or(Some(error.to_string())),
        }
    }
    Err(refused.unwrap_or_else(|| "there is no folder for it".to_owned()))
}

fn write_to(folder: &Path, text: &str) -> Result<PathBuf, PictureError> {
    let name = folder.join(NAME);
    let name = NumberedName::new(&std::path::absolute(&name).unwrap_or(name));
    let names = (1..=MOST_FILES).map(|number| name.of(number));
    PendingFile::beside(&name.of(1))?.commit_to_free(names, |sink| Ok(sink.write_all(text.as_bytes())?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::temporary::Folder;
    use glam::Vec3;

    fn view(x: f32) -> Camera {
        Camera::from_yaw_pitch(Vec3::new(x, 1.6, 0.0), 10.0 * x, 0.0, 60.0)
    }

    fn after(start: Instant, seconds: f64) -> Instant {
        start + Duration::from_secs_f64(seconds)
    }

    /// What is told of the recording, once it is made and written.
    fn told(journey: &mut Journey, end: (Instant, Camera), folders: &[&Path]) -> News {
        let folders = folders.iter().map(|folder| folder.to_path_buf()).collect();
        let errand = journey.finish(end.0, end.1, folders, (10.0, DVec3::ZERO), ": P replays it".to_owned());
        assert_eq!(journey.replay(end.0), Start::TooSoon);
        errand.expect("there is a recording")().expect("there is news")
    }

    #[test]
    fn what_was_recorded_is_replayed_and_no_file_is_written_over() {
        let folder = Folder::new();
        let start = Instant::now();
        let mut journey = Journey::default();
        assert_eq!(journey.replay(start), Start::Nothing);
        for number in 1..=2 {
            journey.record(start, view(0.0));
            // A rest of a second, a walk of two, and a rest.
            for i in 0..400 {
                let t = f64::from(i) * 0.01;
                journey.see(after(start, t), view((t - 1.0).clamp(0.0, 2.0) as f32));
            }
            let news = told(&mut journey, (after(start, 4.0), view(2.0)), &[folder.path()]);
            let file = folder.path().join(format!("raywalk-path-000{number}.json"));
            assert_eq!(news, News::Done(format!("Path written to {}: P replays it", file.display())));
        }
        let path = CameraPath::load(&folder.path().join("raywalk-path-0002.json")).expect("it is a path");
        assert!((path.duration() - 4.0).abs() < 1e-6, "{}", path.duration());
        assert_eq!(journey.replay(start), Start::Begun);
        for i in 0..=40 {
            let t = f64::from(i) * 0.1;
            let camera = journey.camera(after(start, t), &view(7.0), DVec3::ZERO).expect("it goes on");
            let expected = (t - 1.0).clamp(0.0, 2.0) as f32;
            // Between two moments that were seen it may lag by one of them.
            assert!((camera.eye.x - expected).abs() < 0.012, "at {t}: {camera:?}");
            assert_eq!(camera, path.camera_after(t, &view(7.0), DVec3::ZERO), "as any replay of the file");
        }
        assert!(!journey.is_replaying(), "it ended");
    }

    #[test]
    fn a_moving_camera_is_noted_so_often_and_a_rest_from_its_first_moment() {
        let start = Instant::now();
        let mut recorder = Recorder::new(start, view(0.0));
        // A mouse of a thousand events a second, for one second; then a rest of ten.
        for i in 1..=1000 {
            recorder.see(after(start, f64::from(i) / 1000.0), view(i as f32 / 1000.0));
        }
        assert!((119..=122).contains(&recorder.samples.len()), "{}", recorder.samples.len());
        let last = recorder.samples.last().copied();
        assert_eq!(last, Some(Sample { t: 1.0, camera: view(1.0) }));
        recorder.see(after(start, 11.0), view(1.0));
        recorder.see(after(start, 11.001), view(3.0));
        let samples = recorder.samples();
        assert!(samples.len() < 150, "{}", samples.len());
        assert!(samples.windows(2).all(|pair| pair[0].t < pair[1].t));
        let is_there = |sample: &&Sample| (1.0..=11.0).contains(&sample.t);
        assert!(samples.iter().filter(is_there).all(|sample| sample.camera == view(1.0)));
        assert_eq!(samples.last().map(|sample| sample.camera), Some(view(3.0)));
    }

    #[test]
    fn a_recording_ends_before_its_file_could_not_be_read() {
        let start = Instant::now();
        let mut journey = Journey::default();
        journey.record(start, view(0.0));
        // A step after every rest, each of which is as short as it can be.
        let end = (1..).find(|&i| {
            let t = f64::from(i) / 55.0;
            journey.see(after(start, t - 0.001), view((i - 1) as f32)) || journey.see(after(start, t), view(i as f32))
        });
        let end = f64::from(end.expect("it ends")) / 55.0;
        assert!(end > 1800.0, "after {end} s");
        let recorder = journey.recorder.as_mut().expect("it goes on");
        let days = after(start, end + 1e6);
        recorder.see(days, recorder.samples[recorder.samples.len() - 1].camera);
        recorder.end_rest();
        assert!(recorder.samples.len() <= READABLE_KEYS, "{}", recorder.samples.len());
    }

    #[test]
    fn where_no_file_can_be_written_the_next_folder_is_tried_and_the_replay_is_kept() {
        let folder = Folder::new();
        let (missing, start) = (folder.path().join("missing"), Instant::now());
        let mut journey = Journey::default();
        let why = format!("{}: cannot write", missing.join("raywalk-path-0001.json").display());
        for folders in [vec![missing.as_path()], vec![&missing, folder.path()]] {
            journey.record(start, view(0.0));
            let News::Problem(text) = told(&mut journey, (after(start, 1.0), view(1.0)), &folders) else {
                panic!("nothing is wrong")
            };
            assert!(text.contains(&why) && text.ends_with("): P replays it"), "{text}");
            assert_eq!(text.contains("Path written to"), folders.len() == 2, "{text}");
            assert_eq!(journey.replay(start), Start::Begun);
            let replayed = journey.camera(after(start, 1.0), &view(7.0), DVec3::ZERO);
            assert_eq!(replayed.map(|camera| camera.eye), Some(view(1.0).eye));
        }
        assert_eq!(folder.names(), ["raywalk-path-0001.json"]);
    }
}
