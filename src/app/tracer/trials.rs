//! Jobs in, frames out, and what happens in between.

use super::job::PATIENCE;
use super::*;
use crate::app::at_rest;
use crate::app::lowering::Lowering;
use crate::app::methods::Aspect;
use crate::app::survey::End;
use crate::render::Planes;
use crate::scene::{Camera, LoadOptions, builtin, load_text};
use crate::settings::{Settings, Supersample};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, channel};

/// An empty scene.
fn nowhere() -> Arc<Scene> {
    static NOWHERE: LazyLock<Arc<Scene>> = LazyLock::new(|| {
        Arc::new(load_text("nowhere.json", r#"{"version": 1}"#, &LoadOptions::default()).expect("right"))
    });
    NOWHERE.clone()
}

fn job(width: u32, x: f32) -> Job {
    let mut camera = Camera::default();
    camera.eye.x = x;
    Job {
        scene: nowhere(),
        camera,
        settings: Settings::default(),
        width,
        height: 4,
        lowering: Lowering::NONE,
        aspect: Aspect::default(),
    }
}

fn start(
    render: impl FnMut(&Job, &mut Film) -> FrameStats + Send + 'static,
    cancel: CancelToken,
) -> (Tracer, Receiver<Word>) {
    let (sender, receiver) = channel();
    let word = move |word| sender.send(word).unwrap_or(());
    (Tracer::start_with(render, cancel, Duration::ZERO, word).expect("a thread starts"), receiver)
}

const SOON: Duration = Duration::from_secs(20);

#[test]
fn a_job_becomes_a_frame_and_no_job_becomes_nothing() {
    let traced = Arc::new(AtomicUsize::new(0));
    let count = traced.clone();
    let render = move |_: &Job, _: &mut Film| {
        count.fetch_add(1, Ordering::SeqCst);
        FrameStats { completed: true, ..FrameStats::default() }
    };
    let (tracer, words) = start(render, CancelToken::default());
    for width in [4, 8, 8] {
        tracer.post(job(width, 0.0));
        assert_eq!(words.recv_timeout(SOON), Ok(Word::Frame));
        let frame = tracer.take().expect("a frame");
        assert_eq!(frame.film.width(), width);
        tracer.recycle(frame.film);
    }
    assert!(tracer.take().is_none());
    assert!(!tracer.is_busy());
    drop(tracer);
    assert_eq!(traced.load(Ordering::SeqCst), 3, "asleep between jobs");
    assert_eq!(words.recv_timeout(SOON), Ok(Word::Gone));
}

#[test]
fn only_the_newest_job_waits() {
    let (gate, opened) = channel::<()>();
    let (began, begins) = channel();
    let render = move |job: &Job, _: &mut Film| {
        began.send(job.camera.eye.x).expect("the test listens");
        opened.recv().expect("the test opens");
        FrameStats { completed: true, ..FrameStats::default() }
    };
    let (tracer, words) = start(render, CancelToken::default());
    tracer.post(job(4, 0.0));
    assert_eq!(begins.recv_timeout(SOON), Ok(0.0));
    for x in [1.0, 2.0, 3.0] {
        tracer.post(job(4, x));
    }
    gate.send(()).expect("the tracer waits");
    assert_eq!(begins.recv_timeout(SOON), Ok(3.0));
    gate.send(()).expect("the tracer waits");
    assert_eq!(words.recv_timeout(SOON), Ok(Word::Frame));
}

#[test]
fn a_long_frame_of_old_settings_is_dropped_and_closing_does_not_wait() {
    let cancel = CancelToken::default();
    let asked = cancel.clone();
    let (began, begins) = channel();
    let render = move |job: &Job, _: &mut Film| {
        began.send(job.settings.stride).expect("the test listens");
        while !asked.is_cancelled() {
            std::thread::sleep(Duration::from_millis(1));
        }
        FrameStats { completed: false, ..FrameStats::default() }
    };
    let (tracer, words) = start(render, cancel);
    tracer.post(job(4, 0.0));
    assert_eq!(begins.recv_timeout(SOON), Ok(8));
    tracer.post(job(4, 1.0));
    assert_eq!(tracer.drop_outdated(), None, "another place is no reason to drop a frame");
    let mut other = job(4, 2.0);
    other.settings.stride = 4;
    tracer.post(other);
    while let Some(later) = tracer.drop_outdated() {
        std::thread::sleep(later.saturating_duration_since(Instant::now()));
    }
    assert_eq!(begins.recv_timeout(SOON), Ok(4));
    drop(tracer);
    assert_eq!(words.recv_timeout(SOON), Ok(Word::Gone));
}

fn at_rest(width: u32, x: f32) -> Job {
    let mut job = job(width, x);
    job.settings.refine_at_rest = true;
    job
}

/// The frames that come until one of `samples` did, and those that come after it for a while.
fn frames(tracer: &Tracer, words: &Receiver<Word>, samples: Option<u32>) -> Vec<TracedFrame> {
    let mut frames: Vec<TracedFrame> = Vec::new();
    while frames.last().is_none_or(|frame| frame.samples != samples) {
        assert_eq!(words.recv_timeout(SOON), Ok(Word::Frame));
        frames.extend(tracer.take());
    }
    while words.recv_timeout(4 * at_rest::REST).is_ok() {
        frames.extend(tracer.take());
    }
    frames
}

#[test]
fn a_view_at_rest_becomes_supersample_16_byte_for_byte_and_then_nothing_is_traced() {
    let scene = Arc::new(builtin(&LoadOptions::default()).expect("it loads"));
    let camera = scene.cameras[0].camera;
    for settings in [Settings::exact(), Settings { supersample: Supersample::Grid { side: 2 }, ..Settings::fast() }] {
        let (width, height) = (80, 45);
        let (sender, words) = channel();
        let word = move |word| sender.send(word).unwrap_or(());
        let tracer = Tracer::start(Duration::ZERO, word).expect("a thread starts");
        let at_rest = Settings { refine_at_rest: true, ..settings.clone() };
        tracer.post(Job {
            scene: Arc::clone(&scene),
            camera,
            settings: at_rest,
            width,
            height,
            lowering: Lowering::NONE,
            aspect: Aspect::default(),
        });
        let frames = frames(&tracer, &words, Some(16));
        let picture = |supersample: Supersample| {
            let mut film = Film::new(width, height, Planes::default());
            // At rest nothing is enlarged.
            let render_scale = if supersample.rays() == 16 { 1.0 } else { settings.render_scale };
            let settings = Settings { supersample, render_scale, ..settings.clone() };
            render_frame(&scene, &camera, &settings, &mut Scratch::new(), &mut film);
            film
        };
        let (first, last) = (frames.first().expect("a frame"), frames.last().expect("a frame"));
        assert_eq!((first.samples, last.samples), (None, Some(16)));
        assert!(first.film.rgba() == picture(settings.supersample).rgba(), "the first as set");
        assert!(last.film.rgba() == picture(Supersample::Grid { side: 4 }).rgba(), "the last with 16 samples");
        assert!(first.film.rgba() != last.film.rgba(), "this scene is no test");
        let samples: Vec<_> = frames.iter().skip(1).filter_map(|frame| frame.samples).collect();
        assert!(samples.is_sorted() && samples[0] > settings.supersample.rays(), "{samples:?}");
        assert!(words.recv_timeout(2 * at_rest::REST).is_err(), "asleep");
    }
}

#[test]
fn nothing_is_refined_where_that_is_not_wanted_or_not_needed() {
    let traced = Arc::new(AtomicUsize::new(0));
    let count = traced.clone();
    let render = move |_: &Job, _: &mut Film| {
        count.fetch_add(1, Ordering::SeqCst);
        FrameStats { completed: true, ..FrameStats::default() }
    };
    let (tracer, words) = start(render, CancelToken::default());
    let mut enough = at_rest(4, 0.0);
    enough.settings.supersample = Supersample::Grid { side: 5 };
    for job in [job(4, 0.0), enough] {
        tracer.post(job);
        assert_eq!(frames(&tracer, &words, None).len(), 1);
    }
    assert_eq!(traced.load(Ordering::SeqCst), 2);
}

#[test]
fn motion_drops_a_pass_at_once() {
    let cancel = CancelToken::default();
    let asked = cancel.clone();
    let (began, begins) = channel();
    let render = move |job: &Job, film: &mut Film| {
        let pass = film.samples().is_some();
        began.send((job.camera.eye.x, pass)).expect("the test listens");
        // A pass that would take for ever.
        while pass && !asked.is_cancelled() {
            std::thread::sleep(Duration::from_millis(1));
        }
        FrameStats { completed: !pass, ..FrameStats::default() }
    };
    let (tracer, words) = start(render, cancel);
    for x in [0.0, 1.0, 2.0] {
        tracer.post(at_rest(4, x));
        assert_eq!(begins.recv_timeout(SOON), Ok((x, false)));
        assert_eq!(words.recv_timeout(SOON), Ok(Word::Frame));
        assert_eq!(begins.recv_timeout(SOON), Ok((x, true)), "at rest");
    }
    assert!(!tracer.is_busy());
    drop(tracer);
    assert_eq!(words.recv_timeout(SOON), Ok(Word::Gone), "no pass became a frame");
}

#[test]
fn while_it_moves_nothing_is_refined() {
    let (began, begins) = channel();
    let render = move |_: &Job, film: &mut Film| {
        began.send(film.samples()).expect("the test listens");
        FrameStats { completed: true, ..FrameStats::default() }
    };
    let (tracer, _words) = start(render, CancelToken::default());
    let mut before = Instant::now();
    for step in 0..30 {
        let now = Instant::now();
        tracer.post(at_rest(4, step as f32));
        let passed = before.elapsed();
        while begins.recv_timeout(SOON).expect("a frame or a pass").is_some() {
            // This thread was held up: it did rest.
            assert!(passed >= at_rest::REST, "refined {passed:?} after a step");
        }
        before = now;
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn motion_that_asks_for_speed_does_not_wait_for_a_frame_at_rest() {
    let (full, mut fast) = (job(4, 0.0), job(4, 1.0));
    fast.settings.stride = 16;
    assert_eq!(fast.patience(&full), Some(PATIENCE));
    fast.lowering = Lowering { level: 1, scale: 0.7, ..Lowering::NONE };
    assert_eq!(fast.patience(&full), Some(Duration::ZERO));
    assert_eq!(full.patience(&fast), Some(PATIENCE));
    assert_eq!(job(4, 2.0).patience(&full), None);
}

#[test]
fn a_panicking_renderer_is_reported() {
    let (tracer, words) = start(|_, _| std::panic::resume_unwind(Box::new("broken")), CancelToken::default());
    tracer.post(job(4, 0.0));
    assert_eq!(words.recv_timeout(SOON), Ok(Word::Gone));
}

/// A search on a small picture.
fn search() -> (Arc<Scene>, tune::Task, Survey) {
    let bound = tune::Bound::parse("flip=0.01").expect("right");
    let task = tune::Task {
        cameras: vec![Camera::default()],
        size: (16, 9),
        settings: Settings::exact(),
        fixed: Vec::new(),
        bounds: vec![bound],
        also: Vec::new(),
        budget: SOON,
    };
    (nowhere(), task, Survey::new(Camera::default(), bound))
}

/// Waits for the end of a search; the widths of the frames that came meanwhile.
fn end_of(tracer: &Tracer, words: &Receiver<Word>) -> (End, Vec<u32>) {
    let mut widths = Vec::new();
    loop {
        assert_eq!(words.recv_timeout(SOON), Ok(Word::Frame));
        widths.extend(tracer.take().map(|frame| frame.film.width()));
        if let Some(end) = tracer.take_survey(&nowhere()).and_then(|survey| survey.end) {
            return (end, widths);
        }
    }
}

#[test]
fn a_search_gives_way_to_frames_and_then_goes_on() {
    let (began, begins) = channel();
    let render = move |job: &Job, _: &mut Film| {
        began.send(job.width).unwrap_or(());
        std::thread::sleep(Duration::from_millis(1));
        FrameStats { completed: true, ..FrameStats::default() }
    };
    let (tracer, words) = start(render, CancelToken::default());
    let (scene, task, survey) = search();
    tracer.search(scene, task, survey);
    assert_eq!(begins.recv_timeout(SOON), Ok(16));
    tracer.post(job(4, 0.0));
    let (end, widths) = end_of(&tracer, &words);
    assert!(matches!(end, End::Found { .. }), "{end:?}");
    assert_eq!(widths, [4]);
    let measured = begins.try_iter().skip_while(|width| *width == 16).skip(1).collect::<Vec<_>>();
    assert!(measured.len() > 10 && measured.iter().all(|width| *width == 16), "{measured:?}");
}

#[test]
fn a_search_is_stopped_in_the_middle_of_a_frame() {
    let cancel = CancelToken::default();
    let asked = cancel.clone();
    let (began, begins) = channel();
    let render = move |job: &Job, _: &mut Film| {
        began.send(job.width).unwrap_or(());
        while !asked.is_cancelled() {
            std::thread::sleep(Duration::from_millis(1));
        }
        FrameStats { completed: false, ..FrameStats::default() }
    };
    let (tracer, words) = start(render, cancel);
    let (scene, task, survey) = search();
    tracer.search(scene, task, survey);
    assert_eq!(begins.recv_timeout(SOON), Ok(16));
    tracer.stop_search();
    assert_eq!(end_of(&tracer, &words).0, End::Stopped);
}

#[test]
fn news_of_another_scene_are_no_news() {
    let render = |_: &Job, _: &mut Film| FrameStats { completed: true, ..FrameStats::default() };
    let (tracer, words) = start(render, CancelToken::default());
    let (scene, task, survey) = search();
    tracer.search(scene, task, survey);
    let other = builtin(&LoadOptions::default()).expect("it loads");
    let mut word = words.recv_timeout(SOON);
    assert_eq!(word, Ok(Word::Frame));
    while word.is_ok() {
        assert_eq!(tracer.take_survey(&other), None);
        word = words.recv_timeout(Duration::from_millis(300));
    }
}
