//! The command line, and what becomes of it.

pub mod figures;
mod files;
pub mod sheet;

use anyhow::{Context, ensure};
use clap::{Arg, ArgMatches, Command, value_parser};
use raywalk::picture::{Format, PendingFile};
use sheet::{Layout, Sheet};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Side by side unless told otherwise.
const COLUMNS: &str = "8";
/// Seconds after which a file is given up.
const PATIENCE: &str = "60";

/// What can be typed.
pub fn command() -> Command {
    let number = |name, default, help| {
        let positive = value_parser!(u32).range(1..);
        Arg::new(name).long(name).value_name("N").default_value(default).value_parser(positive).help(help)
    };
    Command::new("contact_sheet")
        .about("Renders the first view of every scene file in a folder into one picture")
        .arg(Arg::new("folder").value_name("DIR").required(true).value_parser(value_parser!(PathBuf)))
        .arg(
            Arg::new("output")
                .short('o')
                .long("output")
                .value_name("SHEET.png")
                .required(true)
                .value_parser(value_parser!(PathBuf))
                .help("Picture to write, its format by the extension"),
        )
        .arg(
            Arg::new("size")
                .long("size")
                .value_name("WxH")
                .default_value("320x180")
                .value_parser(size)
                .help("Size of a thumbnail"),
        )
        .arg(number("columns", COLUMNS, "Thumbnails in a row"))
        .arg(number("limit-seconds", PATIENCE, "Longest time that a file may take"))
        .arg(
            Arg::new("figures")
                .long("figures")
                .value_name("FILE.json|-")
                .help("Write what the pictures are like; - prints a table"),
        )
}

/// `320x180`.
fn size(text: &str) -> Result<(u32, u32), String> {
    let side = |text: &str| text.parse::<u32>().ok().filter(|side| (1..=4096).contains(side));
    let sides = text.split_once(['x', 'X']).and_then(|(width, height)| side(width).zip(side(height)));
    sides.ok_or_else(|| "expected width x height in pixels, each from 1 to 4096, such as 320x180".to_owned())
}

/// Prints a line on stderr.
pub fn note(text: &str) {
    // Whoever closed stderr does not want to know.
    let _ = writeln!(io::stderr(), "{text}");
}

/// Draws the sheet that `asked` describes.
pub fn run(asked: &ArgMatches) -> anyhow::Result<()> {
    let path = |name| asked.get_one::<PathBuf>(name).map(PathBuf::as_path).context("required");
    let (folder, output) = (path("folder")?, path("output")?);
    let number = |name| asked.get_one::<u32>(name).copied().context("has a default");
    let layout = Layout {
        thumbnail: *asked.get_one("size").context("has a default")?,
        columns: number("columns")?,
        limit: Duration::from_secs(number("limit-seconds")?.into()),
    };
    let format = Format::of(output)?;
    let files = files::scenes_in(folder)?;
    // What cannot be written is better known now than after minutes.
    ensure!(!format.keeps_planes(), "{}: a sheet has 8 bits a channel; choose .png", output.display());
    let (width, height) = layout.size(files.len())?;
    format.check_size(output, width, height)?;
    let file = PendingFile::create(output)?;
    let Sheet { picture, entries } = sheet::draw(folder, &files, &layout, &note)?;
    file.commit(|sink| format.write_eight_bit(&picture, sink))?;
    match asked.get_one::<String>("figures").map(String::as_str) {
        Some("-") => writeln!(io::stdout(), "{}", figures::table(&entries).markdown())?,
        Some(file) => {
            let text = serde_json::to_string_pretty(&entries)? + "\n";
            PendingFile::create(Path::new(file))?.commit(|sink| Ok(sink.write_all(text.as_bytes())?))?;
        }
        None => {}
    }
    note(&figures::summary(&entries));
    Ok(())
}
