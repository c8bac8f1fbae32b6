//! The options that view and render share: from what was typed to what is meant.

use super::Failure;
use super::values::Size;
use clap::ArgMatches;
use glam::DVec3;
use raywalk::app::maps::Map;
use raywalk::app::scenes::scene_file;
use raywalk::render::Planes;
use raywalk::scene::limits::exceeded;
use raywalk::scene::{EnvironmentChoice, Limits, Progress};
use raywalk::settings::{PRESETS, Preset, ROWS, Settings, Visibility};
use std::ops::Range;
use std::path::PathBuf;

/// How a scene is read, by any command.
#[derive(Clone, Debug)]
pub struct Reading {
    /// The file; `None` for the built-in scene.
    pub scene: Option<PathBuf>,
    pub limits: Limits,
    pub environment: EnvironmentChoice,
    pub strict: bool,
    pub quiet: bool,
    /// Is told how far that has come.
    pub progress: Progress,
}

/// What of a camera the command line changes.
#[derive(Clone, Debug)]
pub struct View {
    /// Name or index of a camera of the scene.
    pub camera: Option<String>,
    /// In the coordinates of the scene's file.
    pub eye: Option<DVec3>,
    pub look_at: Option<DVec3>,
    pub up: Option<DVec3>,
    pub fov: Option<f32>,
    pub size: Option<Size>,
}

/// Everything that view and render share.
#[derive(Clone, Debug)]
pub struct Options {
    pub reading: Reading,
    pub view: View,
    pub path: Option<PathBuf>,
    pub frames: Option<Range<u64>>,
    pub planes: Planes,
    /// File for the record of the run, or `-`.
    pub stats: Option<String>,
    /// How the frames are found that the record compares with.
    pub reference: Option<Visibility>,
    /// What is written of the frames; of `render` alone.
    pub map: Map,
    pub settings: Settings,
}

impl Reading {
    /// The meaning of `asked`.
    pub fn of(asked: &ArgMatches) -> Result<Self, Failure> {
        // A bench has any number of scenes instead.
        let scene = asked.try_get_one::<PathBuf>("scene").ok().flatten();
        Ok(Self {
            scene: scene.map(|path| scene_file(path)).transpose()?,
            limits: limits(asked)?,
            environment: environment(asked),
            strict: asked.get_flag("strict"),
            quiet: asked.get_flag("quiet"),
            progress: Progress::default(),
        })
    }
}

/// The environment asked for, else the scene's.
fn environment(asked: &ArgMatches) -> EnvironmentChoice {
    let named = asked.get_one::<PathBuf>("environment").map(|name| EnvironmentChoice::named(name.as_os_str()));
    named.unwrap_or_default()
}

/// The limits with what `asked` changes.
pub fn limits(asked: &ArgMatches) -> Result<Limits, Failure> {
    let mut limits = Limits::default();
    for (name, value) in asked.get_many::<(String, String)>("limit").into_iter().flatten() {
        limits.set(name, value).map_err(Failure::Usage)?;
    }
    Ok(limits)
}

impl Options {
    /// The meaning of `asked`, settings starting from `preset` unless another is named.
    pub fn of(asked: &ArgMatches, preset: fn() -> Settings) -> Result<Self, Failure> {
        let reading = Reading::of(asked)?;
        let view = View {
            camera: asked.get_one("camera").cloned(),
            eye: asked.get_one("eye").copied(),
            look_at: asked.get_one("look-at").copied(),
            up: asked.get_one("up").copied(),
            fov: asked.get_one("fov").copied(),
            size: asked.get_one("size").copied(),
        };
        if let Some(size) = view.size {
            check_size(size, &reading.limits).map_err(Failure::Usage)?;
        }
        let mut planes = Planes::default();
        for plane in asked.get_many::<String>("aov").into_iter().flatten() {
            match plane.as_str() {
                "depth" => planes.depth = true,
                "normal" => planes.normal = true,
                "object" => planes.object = true,
                _ => planes.primitive = true,
            }
        }
        Ok(Self {
            reading,
            view,
            path: asked.get_one("path").cloned(),
            frames: asked.get_one("frames").cloned(),
            planes,
            stats: asked.get_one("stats").cloned(),
            // Of `render` alone, which has one value for it.
            reference: asked.try_contains_id("reference").is_ok_and(|given| given).then_some(Visibility::Full),
            map: map(asked),
            settings: with_flags(asked, named_preset(asked).map_or(preset, |preset| preset.settings)())?,
        })
    }
}

/// The map asked for, else the picture.
fn map(asked: &ArgMatches) -> Map {
    let name = asked.try_get_one::<String>("map").ok().flatten();
    name.and_then(|name| Map::ALL.into_iter().find(|map| map.name() == name)).unwrap_or_default()
}

/// The preset that was named.
pub fn named_preset(asked: &ArgMatches) -> Option<&'static Preset> {
    asked.get_one::<String>("preset").and_then(|name| PRESETS.iter().find(|preset| preset.name == name))
}

/// `settings` with every flag that was given: a flag beats the preset, whatever their order.
pub fn with_flags(asked: &ArgMatches, mut settings: Settings) -> Result<Settings, Failure> {
    for row in ROWS {
        if let Some(text) = asked.get_one::<String>(row.name) {
            (row.set)(&mut settings, text).map_err(|message| Failure::Usage(format!("--{}: {message}", row.name)))?;
        }
    }
    Ok(settings)
}

/// Refuses pictures that no machine should be asked for.
pub fn check_size(Size { width, height }: Size, limits: &Limits) -> Result<(), String> {
    let exceeds = |name, limit| Err(format!("{width}x{height}: {}", exceeded(name, limit)));
    if u64::from(width.max(height)) > limits.picture_edge {
        return exceeds("picture-edge", limits.picture_edge);
    }
    if u64::from(width) * u64::from(height) > limits.picture_pixels {
        return exceeds("picture-pixels", limits.picture_pixels);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::command;
    use super::*;
    use raywalk::settings::{Exposure, Fill};

    fn options(line: &[&str]) -> Result<Options, Failure> {
        let asked = command().try_get_matches_from(line).expect("it can be typed");
        Options::of(asked.subcommand_matches("render").unwrap_or(&asked), Settings::exact)
    }

    #[test]
    fn a_flag_beats_the_preset_in_either_order() {
        for line in [["--preset=fast", "--fill=hit"], ["--fill=hit", "--preset=fast"]] {
            let settings = options(&["raywalk", "render", line[0], line[1]]).expect("right").settings;
            assert_eq!((settings.render_scale, settings.fill), (0.5, Fill::Hit));
        }
        assert_eq!(options(&["raywalk", "render"]).expect("right").settings, Settings::exact());
    }

    #[test]
    fn negative_numbers_are_values() {
        let line = ["raywalk", "render", "--eye", "-7,10,-10", "--threads", "-1", "--exposure", "-0.5"];
        let options = options(&line).expect("right");
        assert_eq!(options.view.eye, Some(DVec3::new(-7.0, 10.0, -10.0)));
        assert_eq!((options.settings.threads, options.settings.exposure), (-1, Exposure::Stops(-0.5)));
    }

    #[test]
    fn planes_and_limits_add_up() {
        let line = ["raywalk", "render", "--aov", "depth,object", "--aov", "normal", "--limit", "objects=7"];
        let options = options(&line).expect("right");
        assert_eq!(options.planes, Planes { depth: true, normal: true, object: true, ..Planes::default() });
        assert_eq!(options.reading.limits.objects, 7);
    }

    #[test]
    fn an_environment_is_a_word_or_a_file() {
        let chosen = |line: &[&str]| {
            let asked = command().try_get_matches_from(line).expect("it can be typed");
            Reading::of(asked.subcommand().expect("a command").1).expect("right").environment
        };
        assert_eq!(chosen(&["raywalk", "render"]), EnvironmentChoice::Scene);
        assert_eq!(chosen(&["raywalk", "render", "--environment", "none"]), EnvironmentChoice::None);
        assert_eq!(chosen(&["raywalk", "info", "--environment=studio"]), EnvironmentChoice::Studio);
        let file = |name: &str| EnvironmentChoice::File(name.into());
        assert_eq!(chosen(&["raywalk", "bench", "-o", "d", "--environment", "a b.hdr"]), file("a b.hdr"));
        assert_eq!(chosen(&["raywalk", "info", "--environment", "./studio"]), file("./studio"));
        assert!(command().try_get_matches_from(["raywalk", "--environment", ""]).is_err());
    }

    #[test]
    fn monstrous_pictures_are_refused() {
        for size in ["100000x100000", "32768x32768", "1x100000"] {
            let failure = options(&["raywalk", "render", "--size", size]).expect_err(size);
            assert_eq!(failure.exit_code(), Failure::WRONG_USAGE);
            assert!(failure.to_string().starts_with(size) && failure.to_string().contains("--limit picture-"));
        }
        assert!(options(&["raywalk", "render", "--size", "8192x8192"]).is_ok());
        let raised = ["raywalk", "render", "--size", "32768x32768", "--limit", "picture-pixels=1073741824"];
        assert!(options(&raised).is_ok());
    }
}
