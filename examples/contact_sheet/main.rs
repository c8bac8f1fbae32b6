//! Renders the first view of every scene file in a folder into one picture, each with its name under it.
//!
//! `cargo run --release --example contact_sheet DIR -o sheet.png`. Every view is what `raywalk render FILE` draws at the size
//! of a thumbnail. With `--figures FILE|-` it also measures them, to find those that are dark, flat or small.

mod program;

use std::process::ExitCode;

fn main() -> ExitCode {
    match program::run(&program::command().get_matches()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            program::note(&format!("error: {error:#}"));
            ExitCode::FAILURE
        }
    }
}
