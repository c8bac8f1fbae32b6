//! The waist of the program: one frame from scene, camera and settings.

use super::accumulate::Progress;
use super::film::{FilmTile, TILE};
use super::plan::Plan;
use super::resolve::Encoder;
use super::sky::Sky;
use super::tables::Tables;
use super::tile::{self, Worker};
use super::{Film, FrameStats};
use super::{adaptive, enlarge};
use crate::geometry::beam::Projection;
use crate::geometry::{Block, SphereTerms};
use crate::math::{SimdToken, dispatch};
use crate::scene::camera::CameraFrame;
use crate::scene::light::{Falloff, LightKind};
use crate::scene::{Camera, Light, Scene};
use crate::settings::{Settings, SphereCache, Supersample};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Asks a frame to stop: between tiles, and within one between the queues of its rays.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Asks the current frame to stop.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Makes the token usable again.
    pub fn reset(&self) {
        self.0.store(false, Ordering::Relaxed);
    }

    /// Whether a stop was asked for.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Counts finished tiles, so that another thread can tell how far a long frame has come.
#[derive(Clone, Debug, Default)]
pub struct TileCount(Arc<AtomicU64>);

impl TileCount {
    /// Tiles finished since it was made.
    pub fn finished(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }

    /// One more.
    pub(super) fn add(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    /// How many tiles a frame of `width` x `height` pixels counts.
    pub fn of_frame(settings: &Settings, width: u32, height: u32) -> u64 {
        let [across, down] = enlarge::traced_size(width, height, settings.render_scale);
        let tiles = [across, down].map(|side| u64::from(side).div_ceil(TILE as u64)).iter().product::<u64>();
        // Adaptive samples visit every tile again.
        if settings.supersample == Supersample::Adaptive { 2 * tiles } else { tiles }
    }
}

/// Everything a frame needs that outlives it: threads, queues, caches.
#[derive(Debug)]
pub struct Scratch {
    /// Stops a frame early.
    pub cancel: CancelToken,
    /// How many tiles its frames have finished.
    pub tiles: TileCount,
    /// The share of the proven margins that beams use: 1. With less they may lose what is seen; that is for tests of
    /// whether such a loss would be noticed.
    pub beam_margin: f32,
    pub(super) pool: Option<Pool>,
    /// The traced picture, where that is smaller than the film.
    pub(super) small: Option<Film>,
    tables: Tables,
    sphere_terms: Vec<Block<4>>,
    around_eye: Vec<u32>,
    /// The objects that the pixels' centres see, where samples are adaptive.
    objects: Vec<u32>,
}

/// Worker threads and what each of them keeps from tile to tile.
#[derive(Debug)]
pub(super) struct Pool {
    asked: i32,
    /// `None` where the calling thread does it all.
    pub threads: Option<rayon::ThreadPool>,
    workers: Vec<Mutex<Worker>>,
}

impl Pool {
    fn new(asked: i32) -> Self {
        let count = thread_count(asked);
        let builder = rayon::ThreadPoolBuilder::new().num_threads(count).thread_name(|i| format!("tracer {i}"));
        // Where the system gives no threads, the one that asks is left.
        let threads = if count > 1 { builder.build().ok() } else { None };
        let workers = threads.as_ref().map_or(1, rayon::ThreadPool::current_num_threads);
        let workers = (0..workers).map(|_| Mutex::default()).collect();
        Self { asked, threads, workers }
    }

    /// Does some work for each tile, on all threads, until it is cancelled.
    pub(super) fn for_each_tile(
        &self,
        cancel: &CancelToken,
        tiles: &mut [FilmTile],
        work: impl Fn(&mut FilmTile, &mut Worker) + Sync + Send,
    ) {
        let work = |tile: &mut FilmTile| {
            if cancel.is_cancelled() {
                return;
            }
            let index = rayon::current_thread_index().unwrap_or(0) % self.workers.len();
            // A worker whose thread panicked left nothing behind that the next tile would read.
            let mut worker = self.workers[index].lock().unwrap_or_else(PoisonError::into_inner);
            work(tile, &mut worker);
        };
        match &self.threads {
            Some(threads) => threads.install(|| tiles.par_iter_mut().with_max_len(1).for_each(work)),
            None => tiles.iter_mut().for_each(work),
        }
    }
}

impl Pool {
    /// Adds up what the workers did since the last time.
    pub(super) fn collect(&mut self, stats: &mut FrameStats) {
        for worker in &mut self.workers {
            let worker = worker.get_mut().unwrap_or_else(PoisonError::into_inner);
            stats.add(&std::mem::take(&mut worker.stats));
        }
    }
}

/// How many threads a setting means on this machine: 0 all cores, n that many, -n all but n; at least 1.
pub fn thread_count(asked: i32) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    match asked {
        0 => cores,
        1.. => asked as usize,
        _ => cores.saturating_sub(asked.unsigned_abs() as usize).max(1),
    }
}

impl Scratch {
    /// An empty scratch; the thread pool is made by the first frame.
    pub fn new() -> Self {
        Self {
            cancel: CancelToken::default(),
            tiles: TileCount::default(),
            beam_margin: 1.0,
            pool: None,
            tables: Tables::default(),
            sphere_terms: Vec::new(),
            around_eye: Vec::new(),
            objects: Vec::new(),
            small: None,
        }
    }
}

impl Default for Scratch {
    fn default() -> Self {
        Self::new()
    }
}

/// All that the tiles of one frame share.
pub(super) struct Frame<'a> {
    pub scene: &'a Scene,
    pub cancel: &'a CancelToken,
    pub tiles: &'a TileCount,
    pub settings: &'a Settings,
    pub plan: Plan,
    pub tables: &'a Tables,
    pub camera: CameraFrame,
    /// The space of beams from the eye.
    pub projection: Projection,
    /// Half of the picture's width and height at unit distance.
    pub half_picture: [f32; 2],
    pub beam_margin: f32,
    /// How wide a pixel is at unit distance.
    pub pixel_spread: f32,
    pub lights: &'a [Light],
    /// The sky around the scene.
    pub sky: Option<Sky<'a>>,
    /// Ambient light of the scene.
    pub ambient: Vec3,
    pub sphere_terms: SphereTerms<'a>,
    /// Transparent bodies around the eye, outermost first.
    pub around_eye: &'a [u32],
    /// Whether anybody asks what samples see.
    pub keeps_seen: bool,
    /// Whether the film keeps anything of what its pixels see.
    pub keeps_planes: bool,
    /// Whether the film keeps the rays of its pixels.
    pub keeps_costs: bool,
    /// Whether anybody asks for the normals of what samples see.
    pub keeps_normals: bool,
    pub encoder: Encoder,
    /// Of a film that gathers samples: how far it came before this frame.
    pub progress: Option<Progress>,
}

/// Renders one frame into `film`.
///
/// The picture depends on scene, camera, settings and the film's size alone: not on what was rendered before, nor on
/// the number of threads. A SIMD level that the machine lacks falls back to the best it has.
///
/// Once `scratch` and `film` have seen such frames, none allocates; only rayon's queue takes a block every 63 of them.
pub fn render_frame(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    scratch: &mut Scratch,
    film: &mut Film,
) -> FrameStats {
    let start = Instant::now();
    // A film that gathers samples takes one a frame, however many the settings ask for.
    let one_sample;
    let settings = if film.progress.is_some() {
        one_sample = Settings { supersample: Supersample::Off, render_scale: 1.0, ..settings.clone() };
        &one_sample
    } else {
        settings
    };
    if settings.render_scale < 1.0 {
        return enlarge::render_scaled(scene, camera, settings, scratch, film);
    }
    let token = SimdToken::new(settings.simd).unwrap_or_else(SimdToken::best);
    let Scratch { cancel, tiles, beam_margin, pool, tables, sphere_terms, around_eye, objects, .. } = scratch;
    if tables.generation != Some(scene.generation) {
        *tables = Tables::new(scene);
    }
    tables.set_unlit_gain(scene, scene.unlit_gain(settings.exposure));
    if pool.as_ref().is_none_or(|p| p.asked != settings.threads) {
        *pool = Some(Pool::new(settings.threads));
    }
    let Some(pool) = pool else { unreachable!("the pool was just made") };

    let plan = Plan::with_tables(scene, settings, tables);
    let at_eye = LightKind::Point { position: camera.eye };
    let headlight = [Light { name: None, kind: at_eye, color: Vec3::ONE, falloff: Falloff::None }];
    around_eye.clear();
    if plan.media {
        super::inside::bodies_around(scene, tables, camera.eye, around_eye);
    }
    if plan.sphere_cache != SphereCache::Off {
        let difference = plan.sphere_cache == SphereCache::Difference;
        dispatch!(token, simd => scene.geometry.fill_sphere_terms(simd, camera.eye, difference, sphere_terms));
    }
    let view = camera.frame(film.width(), film.height());
    let axes = [view.right.normalize(), view.up.normalize(), view.forward];
    let frame = Frame {
        scene,
        cancel,
        tiles,
        settings,
        plan,
        tables,
        camera: view,
        projection: Projection::new(view.eye, axes, false, scene.geometry.reach(), *beam_margin),
        half_picture: [view.right.length(), view.up.length()],
        beam_margin: *beam_margin,
        pixel_spread: 2.0 * view.up.length() / film.height() as f32,
        lights: if scene.headlight { &headlight } else { &scene.lights },
        sky: tables.sky.as_ref().map(|light| Sky::new(light, tables.unlit_gain())),
        ambient: scene.render.ambient,
        sphere_terms: match plan.sphere_cache {
            SphereCache::Off => SphereTerms::None,
            SphereCache::On => SphereTerms::Exact(sphere_terms),
            SphereCache::Difference => SphereTerms::Difference(sphere_terms),
        },
        around_eye,
        keeps_seen: film.planes().any_seen() || plan.trails || settings.supersample == Supersample::Adaptive,
        keeps_planes: film.planes().any_seen(),
        keeps_costs: film.planes().cost,
        keeps_normals: film.planes().normal || plan.trails,
        encoder: Encoder::new(scene, settings),
        progress: film.progress,
    };

    pool.for_each_tile(cancel, &mut film.tiles, |film_tile, worker| {
        dispatch!(token, simd => tile::render(simd, &frame, film_tile, worker));
        tiles.add();
    });
    film.assemble(pool.threads.as_ref());
    if settings.supersample == Supersample::Adaptive {
        adaptive::refine(token, &frame, pool, film, objects);
    }

    let mut stats = FrameStats { completed: !cancel.is_cancelled(), ..FrameStats::default() };
    // What was cancelled has its sample in some tiles only.
    film.progress = film.progress.map(|before| if stats.completed { before.next() } else { Progress::default() });
    pool.collect(&mut stats);
    stats.frame_ms = start.elapsed().as_secs_f64() * 1e3;
    stats
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Planes;
    use crate::scene::{LoadOptions, load_embedded};
    use std::time::Duration;

    /// Twelve panes of glass in a row, each a body of its own.
    fn panes() -> Scene {
        let pane =
            |i: i32| format!(r#"{{ "type": "box", "min": [-9, -9, {i}], "max": [9, 9, {i}.5], "material": "glass" }}"#);
        let panes: Vec<String> = (0..12).map(pane).collect();
        let text = format!(
            r#"{{ "version": 1, "camera": {{ "position": [0.3, 0.2, -3], "look_at": [0, 0, 0] }},
                  "materials": {{ "glass": {{ "transparency": 1, "absorption": [0.1, 0, 0] }} }},
                  "lights": [{{ "type": "point", "position": [0, 5, -5] }}], "objects": [{}] }}"#,
            panes.join(",")
        );
        let text: &'static [u8] = Box::leak(text.into_bytes().into_boxed_slice());
        let files = Box::leak(Box::new([("panes.json", text)]));
        load_embedded("panes.json", files, &LoadOptions::default()).expect("the panes are a valid scene")
    }

    fn deep() -> Settings {
        Settings { depth: Some(20), ..Settings::default() }
    }

    #[test]
    fn memory_grows_with_depth_and_not_with_the_number_of_paths() {
        let scene = panes();
        let mut scratch = Scratch::new();
        let mut film = Film::new(4, 4, Planes::default());
        let stats = render_frame(&scene, &scene.cameras[0].camera, &deep(), &mut scratch, &mut film);
        let rays = stats.rays.reflection + stats.rays.refraction;
        assert!(rays > 16 << 17, "{rays} rays are no test");
        for worker in &scratch.pool.expect("a frame was rendered").workers {
            let room = worker.lock().expect("no worker panicked").room();
            assert!(room < 21 * 2 * 64, "room for {room} rays and bodies after {rays} rays");
        }
    }

    #[test]
    fn tiles_are_counted_as_announced() {
        let scene = panes();
        for (supersample, render_scale) in [
            (Supersample::Off, 1.0),
            (Supersample::Off, 0.5),
            (Supersample::Adaptive, 1.0),
            (Supersample::Adaptive, 0.3),
        ] {
            let settings = Settings { depth: Some(2), supersample, render_scale, ..Settings::default() };
            let (mut scratch, mut film) = (Scratch::new(), Film::new(200, 130, Planes::default()));
            let tiles = scratch.tiles.clone();
            for frames in 1..3 {
                render_frame(&scene, &scene.cameras[0].camera, &settings, &mut scratch, &mut film);
                let announced = TileCount::of_frame(&settings, 200, 130);
                assert!(announced > 0 && tiles.finished() == frames * announced, "{settings:?}");
            }
        }
    }

    #[test]
    fn a_frame_stops_within_a_tile() {
        let scene = panes();
        let mut scratch = Scratch::new();
        let cancel = scratch.cancel.clone();
        let mut film = Film::new(64, 64, Planes::default());
        let start = Instant::now();
        let stats = std::thread::scope(|threads| {
            threads.spawn(|| {
                std::thread::sleep(Duration::from_millis(100));
                cancel.cancel();
            });
            render_frame(&scene, &scene.cameras[0].camera, &deep(), &mut scratch, &mut film)
        });
        assert!(!stats.completed && start.elapsed() < Duration::from_secs(60), "stopped after {:?}", start.elapsed());
        // The queues that were left do not reach the next frame.
        cancel.reset();
        let settings = Settings { depth: Some(3), ..Settings::default() };
        let after = render_frame(&scene, &scene.cameras[0].camera, &settings, &mut scratch, &mut film);
        let fresh = render_frame(&scene, &scene.cameras[0].camera, &settings, &mut Scratch::new(), &mut film);
        assert_eq!(after.rays, fresh.rays);
    }
}
