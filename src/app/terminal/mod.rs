//! A walk without a window: the same walker and the same tracer, shown as half blocks in a terminal, over SSH too.
//!
//! A cell of the terminal is about twice as high as wide, so that it holds two pixels: `▀` in the colour of the upper one
//! on the colour of the lower. Only cells that changed are written, a frame at a time, and no frame is sent before the
//! terminal has shown those sent before ([`flow`]): over a slow line the walk gets jerky, never late.
//!
//! Termina speaks to the terminal. Unlike crossterm, it passes on what the terminal answers, which is what frames are
//! paced by, and it tells of a terminal that was closed, where crossterm 0.29 spins.
//!
//! | file | what |
//! |---|---|
//! | [`cells`] | a traced picture as cells |
//! | [`palette`] | the colours a terminal has |
//! | [`encoder`] | the bytes that turn one screen of cells into the next |
//! | [`flow`] | when the next frame may be sent |
//! | [`keys`] | what keys and the mouse ask for |
//! | [`status`] | the line below the picture |
//! | [`screen`] | the terminal taken over and given back |
//! | [`signals`] | requests to end from outside |
//! | [`session`] | the walk |

pub mod cells;
pub mod encoder;
pub mod flow;
pub mod keys;
pub mod palette;
pub mod status;

mod screen;
mod session;
mod signals;

use super::AppError;
use super::scenes::Arrival;
use crate::measure::Record;
use crate::settings::Settings;
use std::io::IsTerminal;

/// What ended the walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The user left.
    Quit,
    /// Ctrl-C.
    Interrupted,
    /// A signal from outside, by its number.
    Signal(i32),
}

/// Whether standard input and output are a terminal that can be drawn on.
pub fn is_there() -> bool {
    let is_dumb = std::env::var_os("TERM").map_or(cfg!(unix), |name| name == "dumb");
    std::io::stdin().is_terminal() && std::io::stdout().is_terminal() && !is_dumb
}

/// Walks through what was loaded until the user leaves, with `settings` at first. Returns what ended the walk, and where
/// it `tells` and there was one, what frames cost since settings or size changed last.
///
/// # Errors
/// [`AppError::Terminal`] when the terminal refuses or goes away; [`AppError::TracerGone`] and [`AppError::NoThread`] as
/// for a window. The terminal is given back as it was in any case.
pub fn run(arrival: &Arrival, settings: Settings, tells: bool) -> Result<(End, Option<Record>), AppError> {
    session::run(arrival, settings, tells)
}
