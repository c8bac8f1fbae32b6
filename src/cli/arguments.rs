//! What can be typed. Every setting is a flag, made from the list of settings; formats, presets, limits and metrics
//! show in the help from their lists as well.

use super::values;
use clap::{Arg, ArgAction, Command, crate_version, value_parser};
use raywalk::app::maps::Map;
use raywalk::app::screenshot;
use raywalk::math::simd;
use raywalk::measure::metric::METRICS;
use raywalk::measure::tune::Bound;
use raywalk::picture::FORMATS;
use raywalk::scene::desc::suggest::nearest;
use raywalk::scene::{Format, Limits};
use raywalk::settings::{Kind, PRESETS, ROWS, Row, Settings};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The whole command line.
pub fn command() -> Command {
    let about = "A first-person walkthrough viewer that ray-traces every frame on CPU threads";
    let view = Command::new("raywalk")
        .version(crate_version!())
        .about(about)
        .after_help(
            "Without a command: opens a window on SCENE, or on the built-in scene. With no display, walks in the \
             terminal; without a terminal, renders one frame to raywalk.png in the current folder.\n\nExit codes: 0 \
             done, 1 the input or the run failed, 2 wrong usage, 130 after Ctrl-C, 128 + N after \
             signal N.",
        )
        .args_conflicts_with_subcommands(true)
        .subcommand_precedence_over_arg(true)
        .max_term_width(120);
    let view = view.arg(switch("no-config", "Ignore and do not save window settings (settings, size, place)")).arg(
        Arg::new("screenshots")
            .long("screenshots")
            .value_name("NAME.png")
            .value_parser(|name: &str| screenshot::name(Path::new(name)))
            .help("Where F12 puts pictures; %04d stands for their number [default: raywalk-%04d.png]"),
    );
    let terminal = switch("terminal", "Walk in the terminal, not in a window: WASD, arrows, Q to quit");
    with_shared(view.arg(terminal)).subcommands([render(), bench(), tune(), info(), compare()])
}

fn render() -> Command {
    let formats: Vec<String> =
        FORMATS.iter().map(|format| format!(".{}: {}", format.extensions.join(" ."), format.help)).collect();
    let maps = Map::ALL.map(|map| format!("{}: {}", map.name(), map.help()));
    let command = Command::new("render")
        .about("Renders one or many frames, without window or GPU")
        .after_help("Starts from the preset exact. Without -o no picture is written: the run is timed (see --stats).")
        .arg(
            Arg::new("output")
                .short('o')
                .long("output")
                .value_name("OUT")
                .value_parser(value_parser!(PathBuf))
                .help("Picture to write, its format by the extension; %04d stands for the frame's number")
                .long_help(format!(
                    "Picture to write, its format by the extension; %04d stands for the frame's number\n{}",
                    formats.join("\n")
                )),
        )
        .arg(switch("binary", "Write .ppm as raw bytes (P6), not text (P3)"))
        .arg(
            Arg::new("reference")
                .long("reference")
                .value_name("VISIBILITY")
                .value_parser(["full"])
                .requires("stats")
                .help("Trace each frame once more, untimed, with a ray for every pixel; --stats tells the difference"),
        )
        .arg(
            Arg::new("map")
                .long("map")
                .value_name("MAP")
                .value_parser(Map::ALL.map(Map::name))
                .help("Write what a method does instead of the picture; not as .exr")
                .long_help(format!(
                    "Write what a method does instead of the picture; not as .exr\n{}",
                    maps.join("\n")
                )),
        );
    with_shared(command)
}

fn bench() -> Command {
    let folder = Arg::new("output")
        .short('o')
        .long("output")
        .value_name("DIR")
        .required(true)
        .value_parser(value_parser!(PathBuf))
        .help("Folder for records.json, records.csv, charts and index.html; a run that was stopped goes on from there");
    let scenes = Arg::new("scenes")
        .value_name("SCENE")
        .num_args(0..)
        .value_parser(value_parser!(PathBuf))
        .help("Scene files, or folders with one each [default: the built-in scene]");
    let command = Command::new("bench")
        .about("Measures how fast and how true every method is, and draws it")
        .after_help(
            "Starts from the preset exact; flags hold for every method, those that approximate for all but full and exact. Without --stability or --thesis: a sweep over \
             settings, optimisations, a walk (--path, or steps aside), and sizes. Reference: --visibility full, \
             without approximations.",
        )
        .arg(scenes)
        .arg(folder)
        .arg(
            switch("quick", "Fewer methods, pictures of half the size: under 30 seconds a scene")
                .conflicts_with("thesis"),
        )
        .arg(
            switch("stability", "Error against difficulty instead: thin wires, far spheres, scales")
                .conflicts_with_all(["thesis", "scenes", "size", "camera", "eye", "look-at", "up", "fov", "path"]),
        )
        .arg(switch("thesis", "The thesis's table instead: its methods at 1, 4, 16 and 25 rays a pixel, 640x360"))
        .arg(switch("redraw", "Measure nothing; draw what the folder's records hold").conflicts_with("scenes"));
    let again = |help: &'static str| move |arg: Arg| arg.action(ArgAction::Append).help(help);
    with_options(command)
        .mut_arg("camera", again("A camera of the scene, or all of them; may be given again [default: the first]"))
        .mut_arg("path", again("Move the camera along a path; may be given again"))
        .mut_arg("frames", |arg| arg.requires("path").help("Frames A to B-1 of the path [default: all of it]"))
}

fn tune() -> Command {
    let metrics: Vec<String> = METRICS.iter().map(|metric| format!("{}: {}", metric.name, metric.help)).collect();
    let command = Command::new("tune")
        .about("Finds the cheapest settings whose errors stay within bounds")
        .after_help(format!(
            "Starts from the preset exact and keeps every flag that is given. Varied are settings that keep the pixels \
             or approximate them, never those of another picture. Errors are those of the 8-bit picture of the worst \
             frame against --visibility full. Prints what was tried, the best for their time, the flags found, and \
             all of it as JSON. Exit code 1 when nothing keeps the bounds.\n\n{}",
            metrics.join("\n")
        ))
        .arg(
            Arg::new("max-error")
                .long("max-error")
                .value_name("METRIC=VALUE")
                .required(true)
                .value_parser(Bound::parse)
                .action(ArgAction::Append)
                .help("The greatest error, the least value for psnr and ssim; of several all hold"),
        )
        .arg(switch("json", "One JSON object and nothing else"));
    with_shared(command)
}

fn info() -> Command {
    Command::new("info")
        .about("Says what a scene holds and what it needs to be drawn")
        .arg(scene())
        .arg(switch("json", "One JSON object instead of text"))
        .args(reading())
}

fn compare() -> Command {
    let metrics: Vec<String> = METRICS.iter().map(|metric| format!("{}: {}", metric.name, metric.help)).collect();
    let picture = |name: &'static str| Arg::new(name).required(true).value_parser(value_parser!(PathBuf));
    Command::new("compare")
        .about("Measures how two pictures differ")
        .after_help(format!(
            "Pictures: PNG of 8 or 16 bits (JPEG and BMP too; alpha is left out), or OpenEXR. Values are fractions of \
             a channel's range.\n\n{}",
            metrics.join("\n")
        ))
        .arg(picture("A").help("A picture, such as the reference"))
        .arg(picture("B").help("Another of the same size"))
        .arg(switch("json", "One JSON object instead of text; a metric without a value is null"))
        .arg(Arg::new("diff").long("diff").value_name("OUT").value_parser(value_parser!(PathBuf)).help(
            "Write the difference picture: each pixel's greatest channel difference, dark violet for none to \
                 yellow for the greatest of the pair",
        ))
        .arg(switch("hdr", "Compare linear light, unclamped, instead of what a display shows"))
        .arg(limit().help("Change a limit: picture-pixels bounds the pixels of each picture"))
}

/// The options of every command that renders one scene.
fn with_shared(command: Command) -> Command {
    with_options(command.arg(scene()))
}

/// The options of every command that renders.
fn with_options(command: Command) -> Command {
    let option = |name: &'static str, value: &'static str| Arg::new(name).long(name).value_name(value);
    let signed = |name, value| option(name, value).allow_hyphen_values(true);
    let presets: Vec<String> = PRESETS.iter().map(|preset| format!("{}: {}", preset.name, preset.help)).collect();
    command
        .next_help_heading("View")
        .arg(
            option("size", "WxH").value_parser(values::size).help("Picture size [default: the scene's, else 1280x720]"),
        )
        .arg(option("camera", "NAME|INDEX").help("A camera of the scene [default: the first]"))
        .arg(signed("eye", "x,y,z").value_parser(values::vector).help("Position of the eye"))
        .arg(signed("look-at", "x,y,z").value_parser(values::vector).help("A point to look at"))
        .arg(signed("up", "x,y,z").value_parser(values::vector).help("Which way is up"))
        .arg(signed("fov", "DEG").value_parser(values::field_of_view).help("Vertical field of view in degrees"))
        .next_help_heading("Run")
        .arg(
            option("path", "FILE.json")
                .value_parser(value_parser!(PathBuf))
                .conflicts_with_all(["eye", "look-at"])
                .help("Move the camera along a path"),
        )
        .arg(option("frames", "A..B").value_parser(values::frames).help(
            "Frames A to B-1 of the path; without one, the same view B-A times, the last one written [default: all \
             of the path, else one]",
        ))
        .arg(
            option("aov", "LIST")
                .value_delimiter(',')
                .value_parser(["depth", "normal", "object", "primitive"])
                .action(ArgAction::Append)
                .help("Planes to write beside the colour, separated by commas; needs .exr"),
        )
        .arg(option("stats", "FILE|-").help("Write figures of the run as JSON, after two untimed warm-up frames"))
        .args(reading())
        .next_help_heading("Settings (a flag beats the preset, whatever their order)")
        .arg(
            option("preset", "NAME")
                .value_parser(PRESETS.iter().map(|preset| preset.name).collect::<Vec<_>>())
                .help("Where the settings start from")
                .long_help(format!("Where the settings start from\n{}", presets.join("\n"))),
        )
        .args(ROWS.iter().map(setting))
}

/// Options of every command that reads a scene.
fn reading() -> [Arg; 4] {
    let limits: Vec<String> = Limits::help().collect();
    [
        limit()
            .help("Change a limit on what a scene may ask of the machine")
            .long_help(format!("Change a limit on what a scene may ask of the machine\n{}", limits.join("\n"))),
        Arg::new("environment")
            .long("environment")
            .value_name("FILE|studio|none")
            .value_parser(value_parser!(PathBuf))
            .help("What surrounds the scene: an equirectangular picture (.hdr, .exr), studio, none [default: the scene's]"),
        switch("strict", "Treat the scene's warnings as errors"),
        switch("quiet", "No progress bar and no warnings"),
    ]
}

fn limit() -> Arg {
    Arg::new("limit").long("limit").value_name("NAME=VALUE").value_parser(values::limit).action(ArgAction::Append)
}

fn scene() -> Arg {
    Arg::new("scene")
        .value_name("SCENE")
        .value_parser(value_parser!(PathBuf))
        .help("Scene file, or a folder with one [default: the built-in scene]")
}

/// What was probably meant by the first word of the command line, where that is neither a command nor the path of anything,
/// but close to a command's name.
pub fn mistyped_command(word: &OsStr) -> Option<String> {
    let text = word.to_str().filter(|text| text.chars().next().is_some_and(char::is_alphabetic))?;
    let command = command();
    let known: Vec<&str> = command.get_subcommands().map(Command::get_name).chain(["help"]).collect();
    if known.contains(&text) || Path::new(word).exists() || Format::of(Path::new(word)).is_some() {
        return None;
    }
    let begins = |name: &&&str| text.len() > 1 && (name.starts_with(text) || text.starts_with(**name));
    let meant = known.iter().find(begins).copied().or_else(|| nearest(text, &known))?;
    Some(format!("{text} is neither a command nor a file; did you mean raywalk {meant}?"))
}

fn switch(name: &'static str, help: &'static str) -> Arg {
    Arg::new(name).long(name).action(ArgAction::SetTrue).help(help)
}

/// The flag of a setting.
fn setting(row: &'static Row) -> Arg {
    let help = capitalized(row.help);
    let arg = Arg::new(row.name).long(row.name).value_parser(move |text: &str| checked(row, text));
    match &row.kind {
        Kind::Choice(choices) => {
            let values: Vec<&str> = choices.iter().map(|choice| choice.value).collect();
            let promises: Vec<String> =
                choices.iter().map(|choice| format!("{}: {}", choice.value, choice.promise)).collect();
            arg.value_name("VALUE").help(format!("{} [{}]", row.help, values.join("|"))).long_help(format!(
                "{}\n{}",
                row.help,
                promises.join("\n")
            ))
        }
        Kind::Number { min, max, promise, .. } => arg
            .value_name("N")
            .help(help.clone())
            .allow_negative_numbers(true)
            .long_help(format!("{help}\n{min} to {max}: {promise}")),
    }
}

/// The sentence with a capital first letter, as help is written.
fn capitalized(sentence: &str) -> String {
    let (first, rest) = sentence.split_at(sentence.chars().next().map_or(0, char::len_utf8));
    first.to_uppercase() + rest
}

/// The text of a setting, if this machine can do it.
fn checked(row: &Row, text: &str) -> Result<String, String> {
    let mut settings = Settings::default();
    (row.set)(&mut settings, text)?;
    if !simd::is_available(settings.simd) {
        return Err("this machine lacks it; auto takes the best it has".to_owned());
    }
    Ok(text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        command().debug_assert();
    }

    #[test]
    fn every_setting_is_a_flag_with_its_values_and_promises_in_the_help() {
        let help = render().render_long_help().to_string();
        for row in ROWS {
            assert!(help.contains(&format!("--{}", row.name)), "{}", row.name);
            if let Kind::Choice(choices) = &row.kind {
                for choice in *choices {
                    assert!(help.contains(&format!("{}: {}", choice.value, choice.promise)), "{}", row.name);
                }
            }
        }
    }
}
