//! A walk in the terminal: `raywalk --terminal`, or where there is no display.

use super::Failure;
use super::interrupt::Interrupt;
use super::options::Options;
use super::view::tell;
use clap::ArgMatches;
use raywalk::app::scenes::Arrival;
use raywalk::app::terminal::{self, End};
use raywalk::settings::{Settings, Supersample};

/// Walks through what was loaded until the user leaves.
pub fn walk(
    asked: &ArgMatches,
    arrival: &Arrival,
    mut settings: Settings,
    options: &Options,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    // So few pixels can do with more rays each.
    if asked.value_source("supersample").is_none() {
        settings.supersample = Supersample::Grid { side: 2 };
    }
    // The walk listens itself, and gives the terminal back before it ends.
    interrupt.careful();
    let (end, record) = terminal::run(arrival, settings, options.stats.is_some())?;
    interrupt.check()?;
    tell(options, record.as_ref())?;
    match end {
        End::Quit => Ok(()),
        End::Interrupted => Err(Failure::Interrupted),
        End::Signal(number) => Err(Failure::Signal(number)),
    }
}
