//! The comparison: brute force against everything that promises its pixels.

use crate::flips::{flipped, same_pixels};
use crate::picture_bits::{PictureBits, film};
use crate::random::Random;
use crate::temporary::load_text;
use raywalk::math::simd::is_available;
use raywalk::render::{Film, Scratch, render_frame};
use raywalk::scene::Scene;
use raywalk::settings::{ROWS, Settings, Supersample};
use serde_json::Value;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Settings with what they change, as flags.
pub type Named = (String, Settings);

/// Renders scenes with one scratch for all, as a window does: nothing in it may carry from one picture to the next.
pub struct Judge {
    scratch: Scratch,
    film: Film,
}

impl Judge {
    /// A judge of beams with a share of their margins.
    pub fn new(beam_margin: f32) -> Self {
        let mut scratch = Scratch::new();
        scratch.beam_margin = beam_margin;
        Self { scratch, film: film((1, 1)) }
    }

    /// What is wrong with the picture of a scene file under some settings. `None` also where the file does not load.
    pub fn complaint(&mut self, file: &Value, candidate: &Named) -> Option<String> {
        let scene = load_text(file.to_string()).ok()?;
        self.complaints(&scene, std::slice::from_ref(candidate)).pop().map(|(_, complaint)| complaint)
    }

    /// What is wrong with the pictures of a scene: one differs from that of brute force, holds something that is no
    /// number, or there is none. Which of the candidates it was, and the complaint in words.
    pub fn complaints<'c>(&mut self, scene: &Scene, candidates: &'c [Named]) -> Vec<(&'c Named, String)> {
        let mut found = Vec::new();
        let mut expected: Option<(Supersample, PictureBits)> = None;
        for candidate @ (name, settings) in candidates {
            if expected.as_ref().is_none_or(|(supersample, _)| *supersample != settings.supersample) {
                match self.render(scene, &brute_force(settings)) {
                    Ok(picture) => {
                        let wrong = picture.not_a_number();
                        if wrong > 0 {
                            found.push((candidate, format!("brute force gives {wrong} pixels that are not numbers")));
                        }
                        expected = Some((settings.supersample, picture));
                    }
                    Err(panic) => found.push((candidate, format!("brute force: {panic}"))),
                }
            }
            let complaint = match self.render(scene, settings) {
                Ok(picture) => expected.as_ref().and_then(|(_, expected)| expected.difference(&picture)),
                Err(panic) => Some(panic),
            };
            found.extend(complaint.map(|complaint| (candidate, format!("{name}: {complaint}"))));
        }
        found
    }

    fn render(&mut self, scene: &Scene, settings: &Settings) -> Result<PictureBits, String> {
        let (width, height) = (scene.render.width.unwrap_or(64), scene.render.height.unwrap_or(64));
        if (self.film.width(), self.film.height()) != (width, height) {
            self.film = film((width, height));
        }
        let Self { scratch, film } = self;
        let camera = &scene.cameras[0].camera;
        let rendered = catch_unwind(AssertUnwindSafe(|| render_frame(scene, camera, settings, scratch, film)));
        if rendered.is_err() {
            *self = Self::new(self.scratch.beam_margin);
            return Err("it panicked".to_owned());
        }
        Ok(PictureBits::of(&self.film))
    }
}

/// Every pixel, every primitive, one thread; the picture of `settings` else.
fn brute_force(settings: &Settings) -> Settings {
    let mut judge = Settings {
        bvh: false,
        threads: 1,
        supersample: settings.supersample,
        shadows: settings.shadows,
        reflections: settings.reflections,
        ..Settings::exact()
    };
    set(&mut judge, "visibility", "full");
    judge
}

fn set(settings: &mut Settings, name: &str, value: &str) {
    let row = ROWS.iter().find(|row| row.name == name).unwrap();
    (row.set)(settings, value).unwrap();
}

/// The settings that are compared with brute force: what is timed, tracing all with the tree, and a few others that
/// promise the same pixels.
pub fn candidates(random: &mut Random) -> Vec<Named> {
    let one_thread = Settings { threads: 1, ..Settings::exact() };
    let mut full = one_thread.clone();
    set(&mut full, "visibility", "full");
    let mut all = vec![("exact".to_owned(), one_thread), ("--visibility full".to_owned(), full)];
    if random.chance(0.3) {
        all.push(any_switches(random, Settings::exact()));
    }
    if random.chance(0.05) {
        let finer = Settings { supersample: Supersample::Grid { side: 2 }, ..Settings::exact() };
        all.push(any_switches(random, finer));
    }
    all
}

/// Every candidate that a kept scene is rendered with.
pub fn all_candidates() -> Vec<Named> {
    let mut all = flipped();
    all.push(("exact".to_owned(), Settings::exact()));
    let finer = Settings { supersample: Supersample::Grid { side: 2 }, ..Settings::exact() };
    all.push(("--supersample 4".to_owned(), finer));
    all
}

/// Flips some of the switches that promise the same pixels.
fn any_switches(random: &mut Random, mut settings: Settings) -> Named {
    let mut name = String::new();
    if settings.supersample != Supersample::Off {
        name += "--supersample 4 ";
    }
    for row in ROWS.iter().filter(|row| row.name != "supersample" && row.name != "present") {
        let values = same_pixels(row);
        if values.is_empty() || random.chance(0.6) {
            continue;
        }
        let value = random.pick(&values);
        let before = settings.clone();
        set(&mut settings, row.name, value);
        if is_available(settings.simd) {
            name += &format!("--{} {value} ", row.name);
        } else {
            settings = before;
        }
    }
    (name.trim_end().to_owned(), settings)
}
