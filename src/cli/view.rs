//! `raywalk [SCENE]`: the window, or one picture where there is no display.

use super::frames::Frames;
use super::interrupt::Interrupt;
use super::options::Options;
use super::output::{self, Output};
use super::stage::Stage;
use super::{Failure, render, stdout};
use clap::ArgMatches;
use raywalk::app::{self, AppError, AppOptions};
use raywalk::picture::WriteOptions;
use raywalk::settings::Settings;
use std::path::Path;
use std::sync::Arc;

/// What is written where no window can be opened.
const PICTURE: &str = "raywalk.png";

/// Opens the window, or else renders one frame.
pub fn run(asked: &ArgMatches) -> Result<(), Failure> {
    let mut options = Options::of(asked, Settings::balanced)?;
    // A preset says nothing of it, and only a window can rest.
    if asked.value_source("refine-at-rest").is_none() {
        options.settings.refine_at_rest = true;
    }
    output::check_planes(Some(Path::new(PICTURE)), options.planes)?;
    let frames = Frames::of(&options)?;
    let interrupt = Interrupt::listen()?;
    let stage = Stage::set(&options)?;
    let window = AppOptions {
        scene: Arc::clone(&stage.loaded.scene),
        camera: frames.camera(frames.range.start, &stage.camera)?,
        settings: stage.settings.clone(),
        size: (stage.size.width, stage.size.height),
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
        Ok(_) => {
            if options.stats.is_some() && !options.reading.quiet {
                stdout::note("warning: a walk has no --stats; raywalk render writes them");
            }
            Ok(())
        }
    }
}

fn picture(stage: &Stage, frames: &Frames, options: &Options, interrupt: &Interrupt) -> Result<(), Failure> {
    let output = Output::new(Path::new(PICTURE), WriteOptions::default(), frames)?;
    render::render(stage, frames, options, Some(output), interrupt)
}
