//! `raywalk [SCENE]`: the window; where there is no display a walk in the terminal, or one picture.

use super::frames::Frames;
use super::interrupt::Interrupt;
use super::options::{Options, named_preset, with_flags};
use super::output::{self, Output};
use super::record::RecordTarget;
use super::stage::{DEFAULT_SIZE, Loaded, Stage};
use super::values::Size;
use super::{Failure, render, stdout};
use clap::ArgMatches;
use raywalk::app::config::{Config, Store, usual_settings};
use raywalk::app::scenes::{Arrival, Failed, Load, Outcome, place_of};
use raywalk::app::{self, AppError, AppOptions, Opening, screenshot, terminal};
use raywalk::measure::Record;
use raywalk::picture::{NumberedName, WriteOptions};
use raywalk::scene::LoadOptions;
use raywalk::settings::Settings;
use std::path::Path;
use std::time::Duration;

/// What is written where no window can be opened.
const PICTURE: &str = "raywalk.png";
/// A scene that is loaded sooner needs no window to wait in.
const PATIENCE: Duration = Duration::from_millis(300);

/// Opens the window, or else walks in the terminal, or else renders one frame.
pub fn run(asked: &ArgMatches, interrupt: &Interrupt) -> Result<(), Failure> {
    let in_terminal = asked.get_flag("terminal");
    if in_terminal && !terminal::is_there() {
        let what = "standard input and output must be a terminal, and TERM must name it";
        return Err(Failure::Usage(format!("--terminal: {what}; without one, raywalk render draws a picture")));
    }
    let mut options = Options::of(asked, Settings::balanced)?;
    let (config, store) = config(asked, &options);
    options.settings = settings(asked, &config.start_settings())?;
    let screenshots = screenshots(asked, &config, options.reading.quiet);
    output::check_planes(Some(Path::new(PICTURE)), options.planes)?;
    let frames = Frames::of(&options)?;
    // Better known now than after the walk.
    options.stats.as_deref().map(RecordTarget::prepare).transpose()?;
    let load = load(&options)?;
    let size = options.view.size.unwrap_or(DEFAULT_SIZE);
    let file = options.reading.scene.clone().unwrap_or_default();
    let (opening, size) = match load.wait(PATIENCE) {
        Some(outcome) => {
            let arrival = arrived(outcome)?;
            let size = arrival.size.unwrap_or((size.width, size.height));
            (Opening::Scene(arrival), size)
        }
        None => (Opening::Loading(load.clone(), file), (size.width, size.height)),
    };
    let window = AppOptions {
        opening: opening.clone(),
        load: LoadOptions {
            strict: options.reading.strict,
            limits: options.reading.limits.clone(),
            environment: options.reading.environment.clone(),
            ..LoadOptions::default()
        },
        settings: options.settings.clone(),
        size,
        as_before: options.view.size.is_none(),
        config,
        store,
        screenshots,
        tells: options.stats.is_some(),
    };
    // No window wanted, or none to be had.
    let reason = if in_terminal {
        None
    } else {
        match app::run(window, |closer| interrupt.closes(closer)) {
            Err(AppError::NoDisplay(reason)) => {
                interrupt.check()?;
                Some(reason)
            }
            Err(AppError::NoScene(failed)) => return Err(failure(failed)),
            Err(error) => return Err(error.into()),
            Ok(end) => {
                if !options.reading.quiet {
                    end.notes.iter().for_each(|text| stdout::note(text));
                    end.warnings.iter().for_each(|warning| stdout::note(&format!("warning: {warning}")));
                }
                tell(&options, end.record.as_ref())?;
                return interrupt.check();
            }
        }
    };
    let arrival = match opening {
        Opening::Scene(arrival) => arrival,
        Opening::Loading(load, _) => arrived(load.wait_to_the_end())?,
    };
    match reason.filter(|_| !terminal::is_there()) {
        None => {
            let settings = settings(asked, &usual_settings())?;
            super::terminal::walk(asked, &arrival, settings, &options, interrupt)
        }
        Some(reason) => {
            // A still picture has no hurry: it is what `render` makes of the same words.
            let options = Options::of(asked, Settings::exact)?;
            picture(&stage_of(arrival, &options), &frames.first(), &options, interrupt)?;
            let reason = reason.trim_end_matches('.');
            stdout::note(&format!("no window ({reason}): rendered one frame to {PICTURE}"));
            Ok(())
        }
    }
}

/// What a walk starts with: the preset named, or else what the user has of old, and every flag.
fn settings(asked: &ArgMatches, own: &Settings) -> Result<Settings, Failure> {
    let start = named_preset(asked).map_or_else(|| own.clone(), |preset| (preset.settings)().in_place_of(own));
    with_flags(asked, start)
}

/// Writes the record of a walk, if it was asked for.
pub fn tell(options: &Options, record: Option<&Record>) -> Result<(), Failure> {
    match (&options.stats, record) {
        (Some(name), Some(record)) => RecordTarget::prepare(name)?.write(record),
        (Some(_), None) if !options.reading.quiet => {
            stdout::note("warning: no --stats: the walk ended before the first frame");
            Ok(())
        }
        _ => Ok(()),
    }
}

/// Starts to load what the window opens on.
fn load(options: &Options) -> Result<Load, Failure> {
    let (options, frames) = (options.clone(), Frames::of(options)?);
    let progress = options.reading.progress.clone();
    let files = progress.clone();
    Ok(Load::start(progress, move || {
        let stage = Stage::set(&options)?;
        let Size { width, height } = stage.size;
        Ok(Arrival {
            camera: frames.camera(frames.range.start, &stage.camera, &stage.loaded.scene)?,
            scene: stage.loaded.scene,
            place: options.reading.scene.as_deref().map(place_of),
            file: options.reading.scene,
            files: files.files(),
            load_ms: stage.loaded.total_ms,
            size: Some((width, height)),
        })
    }))
}

fn arrived(outcome: Outcome) -> Result<Arrival, Failure> {
    outcome.map_err(failure)
}

/// What a load says that failed, with its exit code.
fn failure(failed: Failed) -> Failure {
    failed.downcast::<Failure>().map_or_else(|other| Failure::Run(other.to_string()), |failure| *failure)
}

/// What the window would have shown, to be rendered.
fn stage_of(arrival: Arrival, options: &Options) -> Stage {
    let (width, height) = arrival.size.unwrap_or((DEFAULT_SIZE.width, DEFAULT_SIZE.height));
    let loaded = Loaded { scene: arrival.scene, total_ms: arrival.load_ms };
    let size = Size { width, height };
    let stage = Stage { loaded, camera: arrival.camera, size, settings: Settings::default() };
    stage.with_settings(&options.settings)
}

/// What the last window left, and where this one's is kept; a file that cannot be read is told of.
fn config(asked: &ArgMatches, options: &Options) -> (Config, Option<Store>) {
    let path = Store::usual_path().filter(|_| !asked.get_flag("no-config"));
    let Some((store, config, warning)) = path.map(Store::open) else { return (Config::default(), None) };
    if let (Some(warning), false) = (warning, options.reading.quiet) {
        stdout::note(&format!("warning: {warning}"));
    }
    (config, Some(store))
}

/// Where screenshots go: as typed, else as kept, else the usual name in the current folder.
fn screenshots(asked: &ArgMatches, config: &Config, quiet: bool) -> NumberedName {
    let kept = config.screenshots.as_deref().map(|name| screenshot::name(Path::new(name)));
    if let (Some(Err(message)), false) = (&kept, quiet) {
        stdout::note(&format!("warning: screenshots in the kept settings: {message}"));
    }
    let usual = || NumberedName::new(Path::new(screenshot::USUAL_NAME));
    asked.get_one::<NumberedName>("screenshots").cloned().or(kept.and_then(Result::ok)).unwrap_or_else(usual)
}

fn picture(stage: &Stage, frames: &Frames, options: &Options, interrupt: &Interrupt) -> Result<(), Failure> {
    let output = Output::new(Path::new(PICTURE), WriteOptions::default(), frames)?;
    render::render(stage, frames, options, Some(output), interrupt)
}
