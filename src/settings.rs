//! Every switch and knob of the tracer, as plain data, in one list.
//!
//! [`ROWS`] is the single source of the command-line flags, the overlay's controls, the axes of the
//! bench, the README's table and the test that flips each row alone and checks its promise.
//! Architecture invariant: this module imports nothing of the crate.

use std::fmt;

/// How the thing seen by each pixel is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Visibility {
    /// What a block of pixels can see is proven once for all of them, and rays are tested against that alone.
    Certified,
    /// One ray a pixel against the scene: the reference.
    Full,
    /// A coarse grid of rays; cells whose corners match are filled in (approximate).
    Subsample,
}

/// How a cell whose corners match is filled by [`Visibility::Subsample`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// Intersect only the primitive of the corners, then shade.
    Hit,
    /// Interpolate the corner colours bilinearly.
    Color,
}

/// What of a sphere is computed once per common ray origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SphereCache {
    /// Nothing.
    Off,
    /// Centre minus origin, and the squared radius: the same values as computing them per ray.
    On,
    /// The difference |C-O|² - r²: fewer operations, but in single precision it cancels for distant spheres.
    Difference,
}

/// The instruction set the kernels run on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimdLevel {
    /// The best that the machine has.
    Auto,
    /// Scalar code.
    Off,
    /// SSE 4.2, 4 lanes.
    Sse4,
    /// AVX2, 8 lanes.
    Avx2,
    /// AVX-512 (Ice Lake's set), 16 lanes.
    Avx512,
}

/// How many rays a pixel gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Supersample {
    /// One ray through the pixel's centre.
    Off,
    /// A grid of 4 x 4 where neighbours differ, one ray through the centre elsewhere.
    Adaptive,
    /// A regular grid of `side` x `side` rays inside the pixel, averaged in linear light.
    Grid {
        /// Rays along one side of the pixel: 2, 3, 4 or 5.
        side: u32,
    },
}

impl Supersample {
    /// Rays along one side of a pixel that is refined, where neighbours differ or at rest.
    pub const REFINED_SIDE: u32 = 4;

    /// Rays through such a pixel.
    pub const REFINED: u32 = Self::REFINED_SIDE * Self::REFINED_SIDE;

    /// Most rays through one pixel.
    pub fn rays(self) -> u32 {
        match self {
            Self::Off => 1,
            Self::Adaptive => Self::REFINED,
            Self::Grid { side } => side * side,
        }
    }
}

/// The curve between linear light and the 8-bit picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToneMap {
    /// Clamp to [0, 1].
    None,
    /// Khronos PBR Neutral.
    Neutral,
}

/// How many stops brighter the 8-bit picture is than the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// As the scene says: as for `Auto` where its lights are in physical units, else none.
    Scene,
    /// What makes the surfaces in the scene's first view neither dark nor blinding, whatever its lights; the same for
    /// every frame.
    Auto,
    /// So many.
    Stops(f32),
}

/// How the window shows a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Present {
    /// Directly on a software adapter, by the blit else.
    Auto,
    /// Through `shaders/blit.wgsl`.
    Blit,
    /// Copied to the surface, where it can be copied to.
    Direct,
}

/// All settings of one frame. Plain data: `Settings::default()` is the preset `exact`.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// How visible surfaces are found.
    pub visibility: Visibility,
    /// Grid spacing of `subsample`, in pixels: 2, 4, 8 or 16.
    pub stride: u32,
    /// How a cell that sees one thing is filled.
    pub fill: Fill,
    /// Largest difference of any channel between corner colours that `Fill::Color` interpolates over.
    pub match_threshold: f32,
    /// Test the last blocker of a light first.
    pub shadow_cache: bool,
    /// Use the bounding volume hierarchy; off is brute force.
    pub bvh: bool,
    /// Cached sphere terms.
    pub sphere_cache: SphereCache,
    /// Instruction set.
    pub simd: SimdLevel,
    /// Worker threads: 0 all cores, n > 0 that many, -n leaves n cores free.
    pub threads: i32,
    /// Rays a pixel.
    pub supersample: Supersample,
    /// Edge of the traced picture as a share of the whole one, which it is enlarged to.
    pub render_scale: f32,
    /// Trace shadow rays.
    pub shadows: bool,
    /// Trace reflected rays.
    pub reflections: bool,
    /// Trace refracted rays.
    pub refractions: bool,
    /// Most rays on a path, the primary included; `None` is the scene's own.
    pub depth: Option<u32>,
    /// Secondary rays whose largest weight is below this are not traced.
    pub min_weight: f32,
    /// Tone curve of the 8-bit picture; `None` is the scene's own.
    pub tone_map: Option<ToneMap>,
    /// Exposure, applied before the tone curve.
    pub exposure: Exposure,
    /// The window goes on to 16 rays a pixel when motion stops; nothing else looks at it.
    pub refine_at_rest: bool,
    /// Frames a second for which the window gives up quality while moving; nothing else looks at it.
    pub target_fps: Option<u32>,
    /// How the window shows frames; nothing else looks at it.
    pub present: Present,
}

impl Default for Settings {
    fn default() -> Self {
        Self::exact()
    }
}

impl Settings {
    /// The preset `exact`: the reference picture, every exact optimisation on.
    pub fn exact() -> Self {
        Self {
            visibility: Visibility::Certified,
            stride: 8,
            fill: Fill::Hit,
            match_threshold: 16.0 / 255.0,
            shadow_cache: true,
            bvh: true,
            sphere_cache: SphereCache::On,
            simd: SimdLevel::Auto,
            threads: 0,
            supersample: Supersample::Off,
            render_scale: 1.0,
            shadows: true,
            reflections: true,
            refractions: true,
            depth: None,
            min_weight: 0.0,
            tone_map: None,
            exposure: Exposure::Scene,
            refine_at_rest: false,
            target_fps: None,
            present: Present::Auto,
        }
    }

    /// The preset `balanced`: where the window starts. What is seen is proven; light is interpolated where it is smooth.
    pub fn balanced() -> Self {
        Self { fill: Fill::Color, min_weight: 1.0 / 512.0, ..Self::exact() }
    }

    /// The preset `fast`: as `balanced`, on every other pixel in each direction.
    pub fn fast() -> Self {
        Self { render_scale: 0.5, ..Self::balanced() }
    }
}

impl Settings {
    /// The flags that make these settings out of the preset `exact`, as they are typed; empty for `exact` itself.
    pub fn flags(&self) -> String {
        let flags: Vec<String> = self.changed().map(|row| format!("--{} {}", row.name, (row.get)(self))).collect();
        flags.join(" ")
    }

    /// The rows that are not as in the preset `exact`.
    pub fn changed(&self) -> impl Iterator<Item = &'static Row> + '_ {
        let exact = Self::exact();
        ROWS.iter().filter(move |row| (row.get)(self) != (row.get)(&exact))
    }

    /// The same picture without what approximates it.
    pub fn without_approximations(&self) -> Self {
        let exact = Self::exact();
        let mut settings = self.clone();
        for row in ROWS {
            if row.promise(&(row.get)(self)) == Some(Promise::Approximate) {
                row.copy(&exact, &mut settings);
            }
        }
        settings
    }

    /// The same, in the place of `others`: threads, instruction set, presentation and what the window does at rest and in
    /// motion stay as they are there, of which a preset says nothing.
    pub fn in_place_of(self, others: &Self) -> Self {
        let Self { threads, simd, refine_at_rest, target_fps, present, .. } = *others;
        Self { threads, simd, refine_at_rest, target_fps, present, ..self }
    }

    /// The same, by a ray for every pixel: what errors are held against.
    pub fn reference(&self) -> Self {
        Self { visibility: Visibility::Full, ..self.without_approximations() }
    }

    /// Changes what `preset` changes of the preset `exact`, in the rows that are `free`.
    pub fn take_changes(&mut self, preset: &Self, free: impl Fn(&Row) -> bool) {
        preset.changed().filter(|row| free(row)).for_each(|row| row.copy(preset, self));
    }
}

/// A named set of settings.
pub struct Preset {
    /// Name on the command line and in the overlay.
    pub name: &'static str,
    /// One line of help.
    pub help: &'static str,
    /// Makes the settings.
    pub settings: fn() -> Settings,
}

/// The presets, best picture first.
pub const PRESETS: &[Preset] = &[
    Preset {
        name: "exact",
        help: "the reference picture; every optimisation that keeps its bits",
        settings: Settings::exact,
    },
    Preset {
        name: "balanced",
        help: "what is seen is proven; light is interpolated where it is smooth",
        settings: Settings::balanced,
    },
    Preset { name: "fast", help: "as balanced, a quarter of the pixels, enlarged", settings: Settings::fast },
];

/// What a value of a setting promises about the picture, against the default of `exact`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Promise {
    /// Every value of every channel keeps its bits.
    SamePixels,
    /// An approximation of the same picture.
    Approximate,
    /// Another picture by intent.
    Different,
}

impl fmt::Display for Promise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SamePixels => "same pixels",
            Self::Approximate => "approximate",
            Self::Different => "different picture",
        })
    }
}

/// One value that a choice row can take.
pub struct Choice {
    /// Its name on the command line.
    pub value: &'static str,
    /// What it promises.
    pub promise: Promise,
}

/// What values a row takes.
pub enum Kind {
    /// One of a few names; `on`/`off` rows are shown as a check box.
    Choice(&'static [Choice]),
    /// A number within a range.
    Number {
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
        /// Only whole numbers.
        integer: bool,
        /// What changing it promises.
        promise: Promise,
        /// Values that a search for cheap settings tries, besides the default; none where speed is not to be had.
        tries: &'static [f64],
    },
}

/// One setting: its name, its help, the values it takes, and how to read and write it as text.
pub struct Row {
    /// Name of the flag, without dashes.
    pub name: &'static str,
    /// One line of help.
    pub help: &'static str,
    /// Allowed values.
    pub kind: Kind,
    /// The current value as it would be typed.
    pub get: fn(&Settings) -> String,
    /// Sets the value from text; the error says what is allowed.
    pub set: fn(&mut Settings, &str) -> Result<(), String>,
}

impl Row {
    /// Whether a frame depends on this row at all, the others being as in `settings`.
    pub fn has_effect(&self, settings: &Settings) -> bool {
        let subsamples = settings.visibility == Visibility::Subsample;
        match self.name {
            "stride" => subsamples,
            "fill" => settings.visibility != Visibility::Full,
            "match-threshold" => subsamples && settings.fill == Fill::Color,
            // Only the window looks at these.
            "refine-at-rest" | "target-fps" | "present" => false,
            _ => true,
        }
    }

    /// Makes this row of `to` what it is in `from`.
    pub fn copy(&self, from: &Settings, to: &mut Settings) {
        // What a row prints it also reads.
        let _ = (self.set)(to, &(self.get)(from));
    }

    /// The promise of `value`; `None` when the row does not know the value.
    pub fn promise(&self, value: &str) -> Option<Promise> {
        match &self.kind {
            Kind::Choice(choices) => choices.iter().find(|c| c.value == value).map(|c| c.promise),
            Kind::Number { promise, .. } => Some(*promise),
        }
    }
}

/// Looks a row up by its flag name.
pub fn row(name: &str) -> Option<&'static Row> {
    ROWS.iter().find(|r| r.name == name)
}

const fn same(value: &'static str) -> Choice {
    Choice { value, promise: Promise::SamePixels }
}
const fn approximate(value: &'static str) -> Choice {
    Choice { value, promise: Promise::Approximate }
}
const fn different(value: &'static str) -> Choice {
    Choice { value, promise: Promise::Different }
}

const ON_OFF_SAME: Kind = Kind::Choice(&[same("on"), same("off")]);
const ON_OFF_DIFFERENT: Kind = Kind::Choice(&[same("on"), different("off")]);

/// A row whose values are the variants of an enum; former names of values still set them.
macro_rules! choice_row {
    ($name:literal, $help:literal, $field:ident,
     [$($value:literal $(formerly $old:literal)? => $variant:expr, $promise:ident);+ $(;)?]) => {
        Row {
            name: $name,
            help: $help,
            kind: Kind::Choice(&[$($promise($value)),+]),
            get: |s| {
                $(if s.$field == $variant { return $value.to_owned(); })+
                unreachable!("every variant has a name")
            },
            set: |s, text| {
                $(if text == $value $(|| text == $old)? { s.$field = $variant; return Ok(()); })+
                Err(format!("expected one of {}", [$($value),+].join(", ")))
            },
        }
    };
}

/// A row that is on or off.
macro_rules! switch_row {
    ($name:literal, $help:literal, $field:ident, $kind:expr) => {
        Row {
            name: $name,
            help: $help,
            kind: $kind,
            get: |s| (if s.$field { "on" } else { "off" }).to_owned(),
            set: |s, text| {
                s.$field = match text {
                    "on" => true,
                    "off" => false,
                    _ => return Err("expected on or off".to_owned()),
                };
                Ok(())
            },
        }
    };
}

/// A row that takes a number within a range.
macro_rules! number_row {
    ($name:literal, $help:literal, $field:ident, $min:literal, $max:literal, $promise:ident, $tries:expr) => {
        Row {
            name: $name,
            help: $help,
            kind: Kind::Number { min: $min, max: $max, integer: false, promise: Promise::$promise, tries: &$tries },
            get: |s| s.$field.to_string(),
            set: |s, text| number(text, $min, $max).map(|v| s.$field = v as f32),
        }
    };
}

/// Every setting, in the order in which people meet them.
pub const ROWS: &[Row] = &[
    choice_row!("visibility", "how visible surfaces are found: certified proves for blocks of pixels what they can see, full traces every pixel, subsample a grid whose matching cells are filled in",
        visibility, ["certified" => Visibility::Certified, same; "full" => Visibility::Full, same; "subsample" => Visibility::Subsample, approximate]),
    choice_row!("stride", "grid of subsample, in pixels",
        stride, ["8" => 8, approximate; "2" => 2, approximate; "4" => 4, approximate; "16" => 16, approximate]),
    choice_row!("fill", "how a cell that sees one thing is filled: hit shades every pixel, color interpolates (if certified, light alone)",
        fill, ["hit" => Fill::Hit, approximate; "color" => Fill::Color, approximate]),
    number_row!(
        "match-threshold",
        "corner colours farther apart than this split a cell of fill color; a number or a fraction such as 16/255",
        match_threshold,
        0.0,
        1.0,
        Approximate,
        [4.0 / 255.0, 48.0 / 255.0]
    ),
    switch_row!("shadow-cache", "test the last blocker of a light before anything else", shadow_cache, ON_OFF_SAME),
    switch_row!("bvh", "bounding volume hierarchy; off tests every primitive", bvh, ON_OFF_SAME),
    choice_row!("sphere-cache", "sphere terms computed once per common ray origin; difference caches |C-O|^2 - r^2 in single precision, which cancels far away",
        sphere_cache, ["on" => SphereCache::On, same; "off" => SphereCache::Off, same; "difference" formerly "thesis" => SphereCache::Difference, approximate]),
    choice_row!("simd", "instruction set of the kernels",
        simd, ["auto" => SimdLevel::Auto, same; "off" => SimdLevel::Off, same; "sse4" => SimdLevel::Sse4, same;
               "avx2" => SimdLevel::Avx2, same; "avx512" => SimdLevel::Avx512, same]),
    Row {
        name: "threads",
        help: "worker threads: 0 all cores, N that many, -N leaves N cores free",
        kind: Kind::Number { min: -1024.0, max: 1024.0, integer: true, promise: Promise::SamePixels, tries: &[] },
        get: |s| s.threads.to_string(),
        set: |s, text| integer(text, -1024, 1024).map(|v| s.threads = v as i32),
    },
    choice_row!("supersample", "rays a pixel, on a regular grid; adaptive gives 16 where neighbours differ and one elsewhere, within 1.5/255 RMSE of 16 on the scenes that come along",
        supersample, ["off" => Supersample::Off, same; "adaptive" => Supersample::Adaptive, different; "4" => Supersample::Grid { side: 2 }, different;
                      "9" => Supersample::Grid { side: 3 }, different; "16" => Supersample::Grid { side: 4 }, different;
                      "25" => Supersample::Grid { side: 5 }, different]),
    switch_row!("shadows", "shadow rays", shadows, ON_OFF_DIFFERENT),
    switch_row!("reflections", "mirror rays", reflections, ON_OFF_DIFFERENT),
    switch_row!("refractions", "rays through transparent things", refractions, ON_OFF_DIFFERENT),
    Row {
        name: "depth",
        help: "most rays on a path, the primary included (default: the scene's, else 5)",
        kind: Kind::Number { min: 1.0, max: 64.0, integer: true, promise: Promise::Different, tries: &[] },
        get: |s| s.depth.map_or_else(|| "scene".to_owned(), |d| d.to_string()),
        set: |s, text| {
            s.depth = if text == "scene" { None } else { Some(integer(text, 1, 64)? as u32) };
            Ok(())
        },
    },
    number_row!(
        "min-weight",
        "secondary rays that weigh less are not traced",
        min_weight,
        0.0,
        1.0,
        Approximate,
        [1.0 / 512.0, 1.0 / 64.0, 1.0 / 16.0]
    ),
    choice_row!("tone-map", "curve between linear light and the 8-bit picture: none clamps, neutral is Khronos PBR Neutral, scene is neutral for glTF and none else",
        tone_map, ["scene" => None, same; "none" => Some(ToneMap::None), different; "neutral" => Some(ToneMap::Neutral), different]),
    number_row!(
        "render-scale",
        "edge of the traced picture as a share of the whole, which it is enlarged to (at rest it is 1)",
        render_scale,
        0.1,
        1.0,
        Approximate,
        [0.85, 0.7, 0.6, 0.5, 0.35, 0.25]
    ),
    Row {
        name: "exposure",
        help: "stops of exposure before the tone curve; auto finds them from the scene, the same for every frame (default: auto for glTF, else 0)",
        kind: Kind::Number { min: -20.0, max: 20.0, integer: false, promise: Promise::Different, tries: &[] },
        get: |s| match s.exposure {
            Exposure::Scene => "scene".to_owned(),
            Exposure::Auto => "auto".to_owned(),
            Exposure::Stops(stops) => stops.to_string(),
        },
        set: |s, text| {
            s.exposure = match text {
                "scene" => Exposure::Scene,
                "auto" => Exposure::Auto,
                _ => {
                    Exposure::Stops(number(text, -20.0, 20.0).map_err(|message| format!("{message}, or auto"))? as f32)
                }
            };
            Ok(())
        },
    },
    switch_row!(
        "refine-at-rest",
        "when motion stops, the window gathers samples up to the picture of supersample 16, then rests; on by default in the window, without effect elsewhere",
        refine_at_rest,
        Kind::Choice(&[same("off"), different("on")])
    ),
    Row {
        name: "target-fps",
        help: "frames a second for which the window lowers the preset, then the render scale, while moving; off or 0 lowers nothing",
        kind: Kind::Number { min: 0.0, max: 240.0, integer: true, promise: Promise::Approximate, tries: &[] },
        get: |s| s.target_fps.map_or_else(|| "off".to_owned(), |fps| fps.to_string()),
        set: |s, text| {
            let fps = if text == "off" { 0 } else { integer(text, 0, 240)? as u32 };
            s.target_fps = (fps > 0).then_some(fps);
            Ok(())
        },
    },
    choice_row!("present", "how the window shows a frame: auto copies it directly where the adapter is software, else blits",
        present, ["auto" => Present::Auto, same; "blit" => Present::Blit, same; "direct" => Present::Direct, same]),
];

/// A number, or a fraction `a/b`, within `[min, max]`.
fn number(text: &str, min: f64, max: f64) -> Result<f64, String> {
    let value = match text.split_once('/') {
        Some((a, b)) => a.trim().parse::<f64>().ok().zip(b.trim().parse::<f64>().ok()).map(|(a, b)| a / b),
        None => text.parse::<f64>().ok(),
    };
    value.filter(|v| (min..=max).contains(v)).ok_or_else(|| format!("expected a number from {min} to {max}"))
}

/// A whole number within `[min, max]`.
fn integer(text: &str, min: i64, max: i64) -> Result<i64, String> {
    text.parse::<i64>()
        .ok()
        .filter(|v| (min..=max).contains(v))
        .ok_or_else(|| format!("expected a whole number from {min} to {max}"))
}

#[cfg(test)]
mod tests;
