//! The thesis's table: its base scene and three richer ones of ours, by its three methods, at its densities of rays.
//!
//! S. A. Kovalchuk, 2022, table 5.1. Its scenes and picture sizes are not published, so its times stand beside ours as
//! text. What the table lacked is added: the certified method, and the error of each density.

mod table;

pub use table::table;

use super::records::Part;
use super::sweep::{Comparison, Job, Judge, Method, Reference, View};
use crate::scene::{LoadOptions, Scene, SceneError, builtin, load_text};
use crate::settings::{Settings, SphereCache, Supersample, Visibility};
use std::sync::Arc;
use std::time::Duration;

/// Size of the pictures.
pub const SIZE: (u32, u32) = (640, 360);

/// Rays a pixel.
pub const DENSITIES: [u32; 4] = [1, 4, 16, 25];

/// One method: its name in records, its heading, and what it is.
pub struct Column {
    /// Its name in records.
    pub name: &'static str,
    /// What it is, for people.
    pub heading: &'static str,
    settings: fn(&mut Settings),
}

/// The methods: three of the thesis's, and ours.
pub const COLUMNS: [Column; 4] = [
    Column { name: "plain", heading: "plain: one thread, no tree, no caches", settings: plain },
    Column {
        name: "with bounding volumes",
        heading: "with bounding volumes",
        settings: |s| {
            plain(s);
            s.bvh = true;
        },
    },
    Column {
        name: "with bounding volumes, threads, shadow cache",
        heading: "with bounding volumes, threads and shadow cache",
        settings: |s| {
            s.visibility = Visibility::Full;
            s.sphere_cache = SphereCache::Off;
        },
    },
    Column { name: "certified", heading: "certified (exact)", settings: |s| *s = s.without_approximations() },
];

/// What the thesis printed: a scene's name, and for each of its three methods the milliseconds at each density, on an
/// i5-6198DU with two cores.
pub const PUBLISHED: [(&str, [[f64; 4]; 3]); 4] = [
    ("base, one sphere", [[87.0, 104.0, 389.0, 526.0], [43.0, 80.7, 211.0, 267.0], [17.0, 29.0, 100.3, 153.0]]),
    (
        "scene 1",
        [[10967.0, 12065.0, 58269.0, 183_561.0], [4265.0, 6928.0, 17301.0, 90879.0], [763.0, 4801.0, 11448.0, 20444.0]],
    ),
    (
        "scene 2",
        [[7594.0, 12065.0, 49007.0, 92087.0], [2042.0, 5803.0, 22801.0, 92087.0], [561.0, 2007.0, 13684.0, 92087.0]],
    ),
    (
        "scene 3",
        [[6985.0, 19664.0, 84051.0, 119_034.0], [2863.0, 9094.0, 33754.0, 42806.0], [896.0, 6859.0, 10089.0, 18074.0]],
    ),
];

fn plain(settings: &mut Settings) {
    settings.visibility = Visibility::Full;
    settings.bvh = false;
    settings.shadow_cache = false;
    settings.sphere_cache = SphereCache::Off;
    settings.threads = 1;
}

/// The scenes of the table.
///
/// # Errors
/// None that the scenes that come along could cause.
pub fn views() -> Result<Vec<View>, SceneError> {
    let options = LoadOptions::default();
    let text = |name: &str, text: &str| load_text(name, text, &options);
    let scenes = [
        ("base", text("base.json", include_str!("../../../scenes/base.json"))?),
        ("mirrors", text("mirrors.json", include_str!("../../../scenes/mirrors.json"))?),
        ("cornell", text("cornell.json", include_str!("../../../scenes/cornell.json"))?),
        ("gallery", builtin(&options)?),
    ];
    let view = |(name, scene): (&str, Scene)| {
        let (camera, camera_name) = (scene.cameras[0].camera, scene.cameras[0].name.clone());
        View { name: name.to_owned(), scene: Arc::new(scene), camera_name, camera, path: Vec::new(), size: SIZE }
    };
    Ok(scenes.into_iter().map(view).collect())
}

/// The rows of one scene: every method at every density, held against 25 rays a pixel.
pub fn jobs(view: &View, base: &Settings) -> Vec<Job> {
    let at_density = |density: u32, settings: &Settings| Settings {
        supersample: match density {
            4 => Supersample::Grid { side: 2 },
            16 => Supersample::Grid { side: 4 },
            25 => Supersample::Grid { side: 5 },
            _ => Supersample::Off,
        },
        ..settings.clone()
    };
    let full = base.reference();
    let reference = Reference { scene: view.scene.clone(), camera: view.camera, settings: at_density(25, &full) };
    let method = |density, column: &Column| {
        let mut settings = base.clone();
        (column.settings)(&mut settings);
        Method { family: column.name, name: column.name.to_owned(), settings: at_density(density, &settings) }
    };
    let job = |density: u32| {
        Job::Compare(Comparison {
            part: Part::Thesis,
            view: view.clone().still(),
            at: Some(f64::from(density)),
            reference: reference.clone(),
            judge: Judge::Metrics,
            keeps_pictures: false,
            methods: COLUMNS.iter().map(|column| method(density, column)).collect(),
            rounds: 3,
            budget: Duration::from_secs(20),
            longest_frame: Duration::from_secs(120),
        })
    };
    DENSITIES.map(job).into()
}
