//! Where pictures go: names with or without a frame number, checked before the work starts.

use super::Failure;
use super::frames::Frames;
use raywalk::app::maps::Map;
use raywalk::picture::{Format, NumberedName, PendingFile, WriteOptions};
use raywalk::render::{Film, Planes};
use std::path::Path;

/// The pictures of a run.
pub struct Output {
    name: NumberedName,
    format: &'static Format,
    options: WriteOptions,
    /// One picture a frame; else only the last is written.
    each: bool,
    /// Made as soon as the run starts: the proof that pictures can be written.
    next: Option<PendingFile>,
}

/// Refuses planes for a file that cannot hold them; `output` is `None` where nothing is written.
pub fn check_planes(output: Option<&Path>, planes: Planes) -> Result<(), Failure> {
    let holds = output.map(Format::of).transpose()?.is_some_and(Format::keeps_planes);
    if planes != Planes::default() && !holds {
        return Err(Failure::Usage("--aov needs an output that ends in .exr".to_owned()));
    }
    Ok(())
}

/// Refuses a map for a file that keeps linear colour.
pub fn check_map(output: Option<&Path>, map: Map) -> Result<(), Failure> {
    if map != Map::Picture && output.map(Format::of).transpose()?.is_some_and(Format::keeps_planes) {
        return Err(Failure::Usage(
            "--map paints 8-bit pictures, such as .png; the planes themselves are --aov".to_owned(),
        ));
    }
    Ok(())
}

impl Output {
    /// Checks that `path` names a known format, and a picture for each frame where the frames differ.
    pub fn new(path: &Path, options: WriteOptions, frames: &Frames) -> Result<Self, Failure> {
        let (format, name) = (Format::of(path)?, NumberedName::new(path));
        if frames.differ() && !name.has_number() {
            let message = format!("{}: many frames need a number in the name, such as walk-%04d.png", path.display());
            return Err(Failure::Usage(message));
        }
        Ok(Self { name, format, options, each: frames.differ(), next: None })
    }

    /// Checks that pictures of this size can be written where they are to go.
    pub fn prepare(&mut self, width: u32, height: u32, frames: &Frames) -> Result<(), Failure> {
        let first = if self.each { frames.range.start } else { frames.range.end - 1 };
        let path = self.name.of(first);
        self.format.check_size(&path, width, height)?;
        self.next = Some(PendingFile::create(&path)?);
        Ok(())
    }

    /// Writes frame `frame`, if it is one that is kept.
    pub fn write(&mut self, frame: u64, frames: &Frames, film: &Film) -> Result<(), Failure> {
        if !self.each && frame + 1 != frames.range.end {
            return Ok(());
        }
        let file = match self.next.take() {
            Some(file) => file,
            None => PendingFile::create(&self.name.of(frame))?,
        };
        Ok(file.commit(|sink| self.format.write_film(film, self.options, sink))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_need_an_exr() {
        let planes = Planes { depth: true, ..Planes::default() };
        assert!(check_planes(Some(Path::new("a.exr")), planes).is_ok());
        for wrong in [Some(Path::new("a.png")), None] {
            assert_eq!(check_planes(wrong, planes).expect_err("no plane").exit_code(), Failure::WRONG_USAGE);
            assert!(check_planes(wrong, Planes::default()).is_ok());
        }
    }

    #[test]
    fn maps_need_eight_bits() {
        assert!(check_map(Some(Path::new("a.png")), Map::Cost).is_ok() && check_map(None, Map::Cost).is_ok());
        assert!(check_map(Some(Path::new("a.exr")), Map::Picture).is_ok());
        let refused = check_map(Some(Path::new("a.exr")), Map::Cost).expect_err("a map is no light");
        assert_eq!(refused.exit_code(), Failure::WRONG_USAGE);
    }
}
