//! What a first view is like, in figures: how dark, how bright, how flat, and how much of the picture it fills.

use raywalk::measure::table::Table;
use raywalk::render::Film;
use raywalk::scene::{Scene, start};
use serde::Serialize;
use std::ops::RangeInclusive;

/// A channel below this is dark, in 255ths.
const DARK: u8 = 5;
/// Greatest share of dark pixels.
const MOST_DARK: f64 = 0.02;
/// Mean luma of the subject.
const MEAN: RangeInclusive<f64> = 0.18..=0.85;
/// Least standard deviation of its luma.
const LEAST_SPREAD: f64 = 0.03;
/// Least share of the width or of the height.
const LEAST_FILL: f64 = 0.5;
/// Of the eye on foot, above the floor.
const EYE_HEIGHT: RangeInclusive<f32> = 1.2..=2.1;
/// Luma of an encoded pixel (ITU-R BT.709).
const LUMA: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// A file of the sheet.
#[derive(Debug, Serialize)]
pub struct Entry {
    /// Its path within the folder.
    pub file: String,
    /// Time to load and render it.
    pub seconds: f64,
    /// Why there is no picture of it.
    pub error: Option<String>,
    /// What its picture is like.
    pub figures: Option<Figures>,
}

/// Figures of a picture. The subject are the pixels whose primary ray hits an object.
#[derive(Debug, Serialize)]
pub struct Figures {
    /// Whether all figures are within their bounds.
    pub ok: bool,
    /// Those that are not; or `empty` for a scene without an object, `unseen` where none is in the picture.
    pub faults: Vec<&'static str>,
    /// Share of pixels of which every channel is dark.
    pub dark: f64,
    /// Mean of the subject's luma, from 0 to 1.
    pub mean: f64,
    /// Its standard deviation.
    pub spread: f64,
    /// Share of the picture's width that the subject's bounding box fills.
    pub width: f64,
    /// Share of its height.
    pub height: f64,
    /// Whether the camera is one of the file.
    pub own_camera: bool,
    /// Whether a walk starts on foot.
    pub on_foot: bool,
    /// On foot, the distance from the eye straight down to the floor, in units of the scene; none without a floor.
    pub eye_height: Option<f32>,
}

impl Figures {
    /// Figures of `film`, which keeps the plane of objects and shows `scene` from its first camera.
    pub fn of(scene: &Scene, film: &Film) -> Self {
        let (width, height) = (film.width(), film.height());
        let (pixels, _) = film.rgba().as_chunks::<4>();
        let dark = pixels.iter().filter(|[r, g, b, _]| [r, g, b].into_iter().all(|&channel| channel < DARK)).count();
        let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
        let (mut left, mut right, mut top, mut bottom) = (width, 0, height, 0);
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        for ((x, y), [r, g, b, _]) in places.zip(pixels) {
            if film.object(x, y).is_none_or(|object| object == u32::MAX) {
                continue;
            }
            let luma =
                LUMA.iter().zip([r, g, b]).map(|(weight, &value)| weight * f64::from(value) / 255.0).sum::<f64>();
            (count, sum, squares) = (count + 1.0, sum + luma, squares + luma * luma);
            (left, right, top, bottom) = (left.min(x), right.max(x + 1), top.min(y), bottom.max(y + 1));
        }
        let mean = sum / f64::max(count, 1.0);
        let camera = &scene.cameras[0].camera;
        let stands = scene.on_foot();
        let floor = stands.then(|| scene.pick(camera.eye, -camera.up.normalize_or(glam::Vec3::Y), 0.0));
        let mut figures = Self {
            ok: false,
            faults: Vec::new(),
            dark: dark as f64 / pixels.len() as f64,
            mean,
            spread: (squares / f64::max(count, 1.0) - mean * mean).max(0.0).sqrt(),
            width: f64::from(right.saturating_sub(left)) / f64::from(width),
            height: f64::from(bottom.saturating_sub(top)) / f64::from(height),
            own_camera: scene.start.entry == start::Entry::Camera,
            on_foot: stands,
            eye_height: floor.flatten().map(|floor| floor.distance / scene.start.unit.per_metre()),
        };
        figures.faults = match (scene.objects.is_empty(), count > 0.0) {
            (true, _) => vec!["empty"],
            (false, false) => vec!["unseen"],
            (false, true) => figures.faults(),
        };
        figures.ok = figures.faults.is_empty();
        figures
    }

    /// What of a subject that is seen is out of bounds.
    fn faults(&self) -> Vec<&'static str> {
        let checks = [
            (self.dark > MOST_DARK, "black"),
            (self.mean < *MEAN.start(), "dark"),
            (self.mean > *MEAN.end(), "bright"),
            (self.spread < LEAST_SPREAD, "flat"),
            (self.width.max(self.height) < LEAST_FILL, "small"),
            (self.on_foot && !self.eye_height.is_some_and(|height| EYE_HEIGHT.contains(&height)), "eye"),
        ];
        checks.iter().filter(|(is_so, _)| *is_so).map(|(_, name)| *name).collect()
    }
}

/// The figures as a table.
pub fn table(entries: &[Entry]) -> Table {
    let head = ["file", "dark", "mean", "spread", "width", "height", "camera", "eye height", "faults"];
    let row = |entry: &Entry| {
        let Some(figures) = &entry.figures else {
            let error = entry.error.clone().unwrap_or_default();
            let none = std::iter::repeat_n(String::new(), head.len() - 2);
            return std::iter::once(entry.file.clone()).chain(none).chain([error]).collect();
        };
        let shares = [figures.dark, figures.mean, figures.spread, figures.width, figures.height];
        let camera = match (figures.own_camera, figures.on_foot) {
            (true, _) => "file",
            (false, true) => "on foot",
            (false, false) => "framed",
        };
        let mut row = vec![entry.file.clone()];
        row.extend(shares.map(|share| format!("{share:.3}")));
        row.extend([camera.to_owned(), figures.eye_height.map(|height| format!("{height:.2}")).unwrap_or_default()]);
        row.push(if figures.ok { "ok".to_owned() } else { figures.faults.join(", ") });
        row
    };
    Table {
        caption: "First views".to_owned(),
        head: head.map(str::to_owned).into(),
        rows: entries.iter().map(row).collect(),
        note: summary(entries),
    }
}

/// How many pictures are as they should be.
pub fn summary(entries: &[Entry]) -> String {
    let figures: Vec<&Figures> = entries.iter().filter_map(|entry| entry.figures.as_ref()).collect();
    let count = |is_counted: &dyn Fn(&Figures) -> bool| figures.iter().filter(|figures| is_counted(figures)).count();
    format!(
        "{} files, {} drawn, {} ok; without a camera of their own {}, {} ok",
        entries.len(),
        figures.len(),
        count(&|figures| figures.ok),
        count(&|figures| !figures.own_camera),
        count(&|figures| !figures.own_camera && figures.ok)
    )
}
