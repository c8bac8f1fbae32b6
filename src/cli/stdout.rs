//! What was asked for, on standard output.

use super::Failure;
use serde::Serialize;
use std::io::{self, Write};

/// Prints `text` and a line end. A reader that has gone away is no failure.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::Stdout(error)),
        _ => Ok(()),
    }
}

/// Prints a note for people on stderr, as one line: names of files may hold anything.
pub fn note(text: &str) {
    // Whoever closed stderr does not want to know.
    let _ = writeln!(io::stderr(), "{}", one_line(text));
}

/// A text without line ends and other characters that a terminal obeys.
fn one_line(text: &str) -> String {
    let shown = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    text.trim_end().chars().map(shown).collect()
}

/// `value` as one line of JSON, its fields in their own order.
pub fn json(value: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|error| Failure::Run(format!("cannot write JSON: {error}")))
}
