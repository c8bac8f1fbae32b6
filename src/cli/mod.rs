//! The command line: one file a command, and what the commands share.

mod arguments;
mod bench;
mod compare;
mod failure;
mod frames;
mod info;
mod interrupt;
mod options;
mod output;
mod progress;
mod record;
mod render;
mod stage;
mod stdout;
mod terminal;
mod tune;
mod values;
mod view;

pub use arguments::{command, mistyped_command};
pub use failure::Failure;
pub use stdout::note;

use clap::ArgMatches;
use interrupt::Interrupt;

/// Runs the command that was asked for.
///
/// # Errors
/// [`Failure`] with the exit code and one line of text.
pub fn run(asked: &ArgMatches) -> Result<(), Failure> {
    let interrupt = Interrupt::listen()?;
    let ended = match asked.subcommand() {
        Some(("render", asked)) => render::run(asked, &interrupt),
        Some(("bench", asked)) => bench::run(asked, &interrupt),
        Some(("tune", asked)) => tune::run(asked, &interrupt),
        Some(("info", asked)) => info::run(asked),
        Some(("compare", asked)) => compare::run(asked),
        _ => view::run(asked, &interrupt),
    };
    interrupt.name(ended)
}
