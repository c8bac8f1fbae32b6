//! Recording where one goes, and going there again.

use crate::picture::{NumberedName, PendingFile, PictureError};
use crate::scene::path::{Sample, Tolerance};
use crate::scene::{Camera, CameraPath};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Frames a second of a recorded path.
const FPS: f64 = 60.0;
/// How far a replay may be from what was recorded: the eye as a share of the surroundings, and angles in degrees.
const DISTANCE_SHARE: f64 = 2e-4;
const ANGLE: f64 = 0.05;
/// Longest recording in places: an hour and more of movement without a rest.
const MOST_SAMPLES: usize = 500_000;
/// Of a rest, parts shorter than this are not looked at, in seconds.
const SHORTEST_REST: f64 = 0.004;
/// Name of the files of paths, and most numbers that are tried.
const NAME: &str = "raywalk-path-%04d.json";
const MOST_FILES: u64 = 9999;
/// Until a file that is being written is asked after.
pub const ASK_AGAIN: Duration = Duration::from_millis(50);

/// A recording under way.
#[derive(Debug)]
struct Recorder {
    began: Instant,
    samples: Vec<Sample>,
    /// When the camera was last seen, also where it had not moved.
    seen: f64,
}

impl Recorder {
    /// Takes the camera of a moment.
    fn see(&mut self, now: Instant, camera: Camera) {
        let t = seconds(now.saturating_duration_since(self.began));
        if self.samples.last().is_none_or(|last| last.camera != camera) && t > self.seen {
            self.end_rest();
            self.samples.push(Sample { t, camera });
        }
        self.seen = self.seen.max(t);
    }

    /// Everything until now.
    fn samples(mut self) -> Vec<Sample> {
        self.end_rest();
        self.samples
    }

    /// Notes that the camera has not moved since the last sample. The closer to both ends the denser: a curve that has to
    /// move off at once must not swing back before.
    fn end_rest(&mut self) {
        let Some(&last) = self.samples.last() else { return };
        let (start, end) = (last.t, self.seen);
        let halves = |length: f64| std::iter::successors(Some(length / 2.0), |l| Some(l / 2.0));
        let mut times: Vec<f64> = halves(end - start).take_while(|l| *l > SHORTEST_REST).map(|l| start + l).collect();
        times.extend(halves(end - start).take_while(|l| *l > SHORTEST_REST).map(|l| end - l));
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

/// A path that was written, or why it was not.
type Written = Result<(CameraPath, PathBuf), String>;

/// Recording and replay.
#[derive(Debug, Default)]
pub struct Journey {
    recorder: Option<Recorder>,
    writer: Option<JoinHandle<Written>>,
    last: Option<Arc<CameraPath>>,
    /// The path that is replayed, and since when.
    replay: Option<(Arc<CameraPath>, Instant)>,
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

    /// When it has to be asked again at the latest, if at all, given how often the view is to change.
    pub fn next(&self, now: Instant, step: Duration) -> Option<Instant> {
        let writing = self.writer.is_some().then_some(now + ASK_AGAIN);
        self.replay.is_some().then_some(now + step).or(writing)
    }

    /// Starts a recording.
    pub fn record(&mut self, now: Instant, camera: Camera) {
        self.replay = None;
        let first = Sample { t: 0.0, camera };
        self.recorder = Some(Recorder { began: now, samples: vec![first], seen: 0.0 });
    }

    /// Takes the camera of this moment. True when the recording has become too long and ought to end.
    pub fn see(&mut self, now: Instant, camera: Camera) -> bool {
        let Some(recorder) = &mut self.recorder else { return false };
        recorder.see(now, camera);
        recorder.samples.len() >= MOST_SAMPLES
    }

    /// Ends the recording; a file is written to `folder` meanwhile. `size` is that of the surroundings in metres.
    pub fn finish(&mut self, now: Instant, camera: Camera, folder: PathBuf, size: f64) {
        let Some(mut recorder) = self.recorder.take() else { return };
        recorder.see(now, camera);
        let tolerance = Tolerance { distance: size * DISTANCE_SHARE, angle: ANGLE };
        let samples = recorder.samples();
        // The fit takes a while for a long walk, and a disk may be slow.
        self.writer = Some(std::thread::spawn(move || {
            let path = CameraPath::fitted(&samples, FPS, tolerance).ok_or("nothing was recorded")?;
            let file = write(&folder, &path.to_json()).map_err(|error| error.to_string())?;
            Ok((path, file))
        }));
    }

    /// What came of the file that is being written, once it is known: where it is, or why it is not.
    pub fn written(&mut self) -> Option<Result<PathBuf, String>> {
        let writer = self.writer.take_if(|writer| writer.is_finished())?;
        let written = writer.join().unwrap_or_else(|_| Err("the recording was lost".to_owned()));
        Some(written.map(|(path, file)| {
            self.last = Some(Arc::new(path));
            file
        }))
    }

    /// Goes where the last recording went. False where there is none.
    pub fn replay(&mut self, now: Instant) -> bool {
        self.replay = self.last.clone().map(|path| (path, now));
        self.is_replaying()
    }

    /// Ends the replay, if there is one.
    pub fn stop_replay(&mut self) -> bool {
        self.replay.take().is_some()
    }

    /// The view of this moment, while a path is replayed.
    pub fn camera(&mut self, now: Instant, base: &Camera) -> Option<Camera> {
        let (path, began) = self.replay.as_ref()?;
        let passed = now.saturating_duration_since(*began).as_secs_f64();
        let camera = path.camera_after(passed, base);
        if passed >= path.duration() {
            self.replay = None;
        }
        camera.is_valid().then_some(camera)
    }
}

/// Writes a file of a name that is not taken.
fn write(folder: &Path, text: &str) -> Result<PathBuf, PictureError> {
    let name = NumberedName::new(&folder.join(NAME));
    let names = (1..=MOST_FILES).map(|number| name.of(number));
    PendingFile::beside(&name.of(1))?.commit_to_free(names, |sink| Ok(sink.write_all(text.as_bytes())?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn view(x: f32) -> Camera {
        Camera::from_yaw_pitch(Vec3::new(x, 1.6, 0.0), 10.0 * x, 0.0, 60.0)
    }

    fn after(start: Instant, seconds: f64) -> Instant {
        start + Duration::from_secs_f64(seconds)
    }

    #[test]
    fn what_was_recorded_is_replayed_and_no_file_is_written_over() {
        let folder = std::env::temp_dir().join(format!("raywalk-journey-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("it can be made");
        let start = Instant::now();
        let mut journey = Journey::default();
        assert!(!journey.replay(start), "nothing is recorded yet");
        let mut files = Vec::new();
        for _ in 0..2 {
            journey.record(start, view(0.0));
            // A rest of a second, a walk of two, and a rest.
            for i in 0..400 {
                let t = f64::from(i) * 0.01;
                journey.see(after(start, t), view((t - 1.0).clamp(0.0, 2.0) as f32));
            }
            journey.finish(after(start, 4.0), view(2.0), folder.clone(), 10.0);
            let written = loop {
                match journey.written() {
                    Some(written) => break written,
                    None => std::thread::sleep(Duration::from_millis(1)),
                }
            };
            files.push(written.expect("it can be written"));
        }
        assert_ne!(files[0], files[1]);
        let path = CameraPath::load(&files[1]).expect("it is a path");
        assert!((path.duration() - 4.0).abs() < 1e-6, "{}", path.duration());
        assert!(journey.replay(start));
        for i in 0..=40 {
            let t = f64::from(i) * 0.1;
            let camera = journey.camera(after(start, t), &view(7.0)).expect("it goes on");
            let expected = (t - 1.0).clamp(0.0, 2.0) as f32;
            // Between two moments that were seen it may lag by one of them.
            assert!((camera.eye.x - expected).abs() < 0.012, "at {t}: {camera:?}");
            assert_eq!(camera, path.camera_after(t, &view(7.0)), "as any replay of the file");
        }
        assert!(!journey.is_replaying(), "it ended");
        std::fs::remove_dir_all(&folder).expect("it is ours");
    }

    #[test]
    fn a_file_that_cannot_be_written_is_told() {
        let error = write(Path::new("/no/such/folder"), "").expect_err("there is no such folder").to_string();
        assert!(error.contains("cannot write") && error.contains("/no/such/folder/raywalk-path-0001.json"), "{error}");
    }
}
