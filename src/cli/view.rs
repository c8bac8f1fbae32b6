//! `raywalk [SCENE]`: the window; where there is no display a walk in the terminal, or one picture.

use super::frames::Frames;
use super::interrupt::Interrupt;
use super::options::Options;
use super::output::{self, Output};
use super::stage::Stage;
use super::{Failure, render, stdout};
use clap::ArgMatches;
use raywalk::app::terminal::{self, End};
use raywalk::app::{self, AppError, AppOptions};
use raywalk::picture::WriteOptions;
use raywalk::settings::{Settings, Supersample};
use std::path::Path;
use std::sync::Arc;

/// What is written where no window can be opened.
const PICTURE: &str = "raywalk.png";

/// Opens the window, or else walks in the terminal, or else renders one frame.
pub fn run(asked: &ArgMatches) -> Result<(), Failure> {
    let in_terminal = asked.get_flag("terminal");
    if in_terminal && !terminal::is_there() {
        let what = "standard input and output must be a terminal, and TERM must name it";
        return Err(Failure::Usage(format!("--terminal: {what}; without one, raywalk render draws a picture")));
    }
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
    let walked =
        if in_terminal { walk_in_terminal(asked, window, &interrupt) } else { walk(asked, window, &interrupt) };
    match walked {
        Err(Failure::Window(AppError::NoDisplay(reason))) => {
            // A still picture has no hurry: it is what `render` makes of the same words.
            let options = Options::of(asked, Settings::exact)?;
            picture(&stage.with_settings(&options.settings), &frames.first(), &options, &interrupt)?;
            let reason = reason.trim_end_matches('.');
            stdout::note(&format!("no window ({reason}): rendered one frame to {PICTURE}"));
            Ok(())
        }
        Err(failure) => Err(failure),
        Ok(()) => {
            if options.stats.is_some() && !options.reading.quiet {
                stdout::note("warning: a walk has no --stats; raywalk render writes them");
            }
            Ok(())
        }
    }
}

/// Walks in the window; with no display, in the terminal where there is one.
fn walk(asked: &ArgMatches, options: AppOptions, interrupt: &Interrupt) -> Result<(), Failure> {
    match app::run(options.clone()) {
        Err(AppError::NoDisplay(_)) if terminal::is_there() => walk_in_terminal(asked, options, interrupt),
        walked => walked.map(|_| ()).map_err(Failure::from),
    }
}

fn walk_in_terminal(asked: &ArgMatches, mut options: AppOptions, interrupt: &Interrupt) -> Result<(), Failure> {
    // So few pixels can do with more rays each.
    if asked.value_source("supersample").is_none() {
        options.settings.supersample = Supersample::Grid { side: 2 };
    }
    // The walk listens itself, and gives the terminal back before it ends.
    interrupt.careful();
    let (_, end) = terminal::run(&options)?;
    interrupt.check()?;
    match end {
        End::Quit => Ok(()),
        End::Interrupted => Err(Failure::Interrupted),
        End::Signal(number) => Err(Failure::Signal(number)),
    }
}

fn picture(stage: &Stage, frames: &Frames, options: &Options, interrupt: &Interrupt) -> Result<(), Failure> {
    let output = Output::new(Path::new(PICTURE), WriteOptions::default(), frames)?;
    render::render(stage, frames, options, Some(output), interrupt)
}
