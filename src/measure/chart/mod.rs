//! Charts, drawn from records alone.
//!
//! Each is one SVG; its PNG is that SVG rasterised, and the page shows it as it is. To add a chart, add its file and one
//! line to [`CHARTS`].

mod axis;
mod growth;
mod labels;
mod lines;
mod number;
mod optimisations;
mod palette;
mod png;
mod stability;
mod stages;
mod svg;
mod tradeoff;
mod walk;

pub use number::short;
pub use palette::{DARK, STYLE};
pub use png::rasterised;
pub use svg::{escaped, text_width, wrapped};
pub use tradeoff::told;

use super::records::{self, Part, Records, RecordsError, Row};
use crate::picture::{PendingFile, PictureError};
use std::path::Path;

/// Pixels a unit of a chart.
const SCALE: f32 = 1.5;

/// One chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// The name of its files, without extension.
    pub name: String,
    /// The heading of its section on the page: the scene, or what it is about.
    pub section: String,
    /// What it shows, in a few words; it also stands on the chart.
    pub title: String,
    /// Width and height in pixels.
    pub size: (f64, f64),
    /// Its SVG elements.
    pub body: String,
}

/// Every kind of chart: what it makes of records, which may be nothing.
const CHARTS: &[fn(&Records) -> Vec<Chart>] =
    &[tradeoff::charts, stages::charts, optimisations::charts, walk::charts, growth::charts, stability::charts];

/// All charts that `records` have figures for.
pub fn of(records: &Records) -> Vec<Chart> {
    CHARTS.iter().flat_map(|charts| charts(records)).collect()
}

impl Chart {
    /// The chart as an SVG file, light or dark as its viewer prefers.
    pub fn document(&self) -> String {
        svg::document(self.size, &self.title, &self.body)
    }

    /// Writes `NAME.svg` and `NAME.png` in `folder`.
    ///
    /// # Errors
    /// [`RecordsError::Write`].
    pub fn write(&self, folder: &Path) -> Result<(), RecordsError> {
        let document = self.document();
        let file = PendingFile::create(&folder.join(format!("{}.svg", self.name)))?;
        file.commit(|sink| Ok(sink.write_all(document.as_bytes())?))?;
        let named = |message| PictureError::Encode(format!("{}: {message}", self.name));
        let picture = rasterised(&document, SCALE).map_err(named)?;
        let path = folder.join(format!("{}.png", self.name));
        let format = crate::picture::Format::of(&path)?;
        Ok(PendingFile::create(&path)?.commit(|sink| format.write_eight_bit(&picture, sink))?)
    }
}

/// The scenes and cameras that a part has rows of, in order, each with its rows.
fn by_view(records: &Records, part: Part) -> Vec<((&str, &str), Vec<&Row>)> {
    let mut views: Vec<((&str, &str), Vec<&Row>)> = Vec::new();
    for row in records.of(part) {
        let view = (row.key.scene.as_str(), row.key.camera.as_str());
        match views.iter_mut().find(|(known, _)| *known == view) {
            Some((_, rows)) => rows.push(row),
            None => views.push((view, vec![row])),
        }
    }
    views
}

/// A scene with its camera, for titles.
fn view_title((scene, camera): (&str, &str)) -> String {
    if camera == "default" { scene.to_owned() } else { format!("{scene}, camera {camera}") }
}

/// The section of the page that a row's charts stand in.
pub fn section_of(row: &Row) -> String {
    view_title((&row.key.scene, &row.key.camera))
}

/// A file name for a chart of a view.
fn file_name(kind: &str, (scene, camera): (&str, &str)) -> String {
    records::file_name(&if camera == "default" { vec![kind, scene] } else { vec![kind, scene, camera] })
}
