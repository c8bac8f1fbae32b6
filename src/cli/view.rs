//! `raywalk [SCENE]`: the window, or one picture where there is no display.

use super::frames::Frames;
use super::interrupt::Interrupt;
use super::options::{Options, named_preset, with_flags};
use super::output::{self, Output};
use super::stage::Stage;
use super::{Failure, render, stdout};
use clap::ArgMatches;
use raywalk::app::config::{Config, Store};
use raywalk::app::{self, AppError, AppOptions, screenshot};
use raywalk::picture::{NumberedName, WriteOptions};
use raywalk::settings::Settings;
use std::path::Path;
use std::sync::Arc;

/// What is written where no window can be opened.
const PICTURE: &str = "raywalk.png";

/// Opens the window, or else renders one frame.
pub fn run(asked: &ArgMatches) -> Result<(), Failure> {
    let mut options = Options::of(asked, Settings::balanced)?;
    let (config, store) = config(asked, &options);
    let own = config.start_settings();
    let start = named_preset(asked).map_or_else(|| own.clone(), |preset| (preset.settings)().in_place_of(&own));
    options.settings = with_flags(asked, start)?;
    let screenshots = screenshots(asked, &config, options.reading.quiet);
    output::check_planes(Some(Path::new(PICTURE)), options.planes)?;
    let frames = Frames::of(&options)?;
    let interrupt = Interrupt::listen()?;
    let stage = Stage::set(&options)?;
    let window = AppOptions {
        scene: Arc::clone(&stage.loaded.scene),
        camera: frames.camera(frames.range.start, &stage.camera)?,
        settings: stage.settings.clone(),
        file: options.reading.scene.clone(),
        size: (stage.size.width, stage.size.height),
        as_before: options.view.size.is_none(),
        config,
        store,
        screenshots,
    };
    match app::run(window) {
        Err(AppError::NoDisplay(reason)) => {
            // A still picture has no hurry: it is what `render` makes of the same words.
            let options = Options::of(asked, Settings::exact)?;
            picture(&stage.with_settings(&options.settings), &frames.first(), &options, &interrupt)?;
            let reason = reason.trim_end_matches('.');
            stdout::note(&format!("no window ({reason}): rendered one frame to {PICTURE}"));
            Ok(())
        }
        Err(error) => Err(error.into()),
        Ok(end) => {
            if !options.reading.quiet {
                end.warnings.iter().for_each(|warning| stdout::note(&format!("warning: {warning}")));
            }
            if options.stats.is_some() && !options.reading.quiet {
                stdout::note("warning: a walk has no --stats; raywalk render writes them");
            }
            Ok(())
        }
    }
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
