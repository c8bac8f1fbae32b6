//! `raywalk compare`: how two pictures differ.

use super::options::limits;
use super::{Failure, stdout};
use clap::ArgMatches;
use raywalk::measure::difference::difference_picture;
use raywalk::measure::metric::{METRICS, Pair};
use raywalk::picture::{self, Encoding, Format, PendingFile};
use serde_json::{Map, json};
use std::path::{Path, PathBuf};

/// Compares what `asked` names.
pub fn run(asked: &ArgMatches) -> Result<(), Failure> {
    let difference = asked.get_one::<PathBuf>("diff").map(|path| Difference::new(path)).transpose()?;
    let encoding = if asked.get_flag("hdr") { Encoding::Linear } else { Encoding::Srgb };
    let pair = Pair::new(read(asked, "A")?, read(asked, "B")?, encoding)?;
    let scores: Vec<_> = METRICS.iter().map(|metric| (metric.name, (metric.score)(&pair))).collect();
    let text = if asked.get_flag("json") {
        let object: Map<_, _> = scores.iter().map(|(name, score)| ((*name).to_owned(), json!(score))).collect();
        stdout::json(&object)?
    } else {
        let lines: Vec<_> = scores.iter().map(|(name, score)| format!("{name:<12}{score}")).collect();
        lines.join("\n")
    };
    if let Some(difference) = difference {
        difference.write(&pair)?;
    }
    stdout::print(&text)
}

fn read(asked: &ArgMatches, name: &str) -> Result<picture::Picture, Failure> {
    let path = asked.get_one::<PathBuf>(name).ok_or_else(|| Failure::Usage(format!("{name} is missing")))?;
    Ok(picture::read(path, &limits(asked)?)?)
}

/// The difference picture to write.
struct Difference<'a> {
    path: &'a Path,
    format: &'static Format,
}

impl<'a> Difference<'a> {
    fn new(path: &'a Path) -> Result<Self, Failure> {
        let format = Format::of(path)?;
        if format.keeps_planes() {
            return Err(Failure::Usage(format!("{}: a difference picture has 8 bits; choose .png", path.display())));
        }
        Ok(Self { path, format })
    }

    fn write(&self, pair: &Pair) -> Result<(), Failure> {
        let picture = difference_picture(pair);
        self.format.check_size(self.path, picture.width, picture.height)?;
        Ok(PendingFile::create(self.path)?.commit(|sink| self.format.write_eight_bit(&picture, sink))?)
    }
}
