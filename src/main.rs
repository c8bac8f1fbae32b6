//! The front door: read the command line, run one command, print a failure once, return the exit code.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | the input or the run failed |
//! | 2 | wrong usage |
//! | 130 | stopped by Ctrl-C |
//! | 128 + n | stopped by signal n |

mod cli;

use raywalk::scene::guard;
use std::panic;
use std::process::ExitCode;

fn main() -> ExitCode {
    let tell = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        // What is guarded becomes an error, which is told of once.
        if !guard::is_guarded() {
            tell(panic);
        }
    }));
    if let Some(message) = std::env::args_os().nth(1).and_then(|word| cli::mistyped_command(&word)) {
        cli::note(&format!("error: {message}"));
        return ExitCode::from(cli::Failure::WRONG_USAGE);
    }
    let asked = match cli::command().try_get_matches() {
        Ok(asked) => asked,
        Err(answer) => return print_answer(&answer),
    };
    match cli::run(&asked) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            cli::note(&format!("error: {failure}"));
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Prints help or the version on stdout, or on stderr what is wrong with the command line.
fn print_answer(answer: &clap::Error) -> ExitCode {
    // A pager that was closed early is no failure.
    let _ = answer.print();
    ExitCode::from(u8::try_from(answer.exit_code()).unwrap_or(cli::Failure::WRONG_USAGE))
}
