//! The table, in the thesis's layout: a row a scene, a column a method, four densities in a cell.

use super::{COLUMNS, DENSITIES, PUBLISHED};
use crate::measure::chart::{section_of, short};
use crate::measure::records::{Part, Records, Row};
use crate::measure::table::Table;

/// The table of what was measured; `None` where nothing was.
pub fn table(records: &Records) -> Option<Table> {
    let mut views: Vec<View> = Vec::new();
    for row in records.of(Part::Thesis) {
        if !views.iter().any(|view| view.shows(row)) {
            views.push(View(row));
        }
    }
    let first = records.of(Part::Thesis).next()?;
    let densities = DENSITIES.map(|density| density.to_string()).join(" / ");
    let headings = COLUMNS.iter().map(|column| format!("{} [ms]", column.heading));
    let errors = ["error against 25 rays: mean FLIP", "pictures that differ from plain's"].map(str::to_owned);
    let theirs = PUBLISHED.iter().map(|(scene, methods)| {
        let times = methods.iter().map(|times| times.map(|ms| ms.to_string()).join(" / "));
        let missing = std::iter::repeat_n("-".to_owned(), 3);
        [format!("published: {scene}")].into_iter().chain(times).chain(missing).collect()
    });
    // Each of ours above one of theirs, for the eye alone: they are other scenes.
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut ours = views.iter().map(|view| measured(records, view, &views));
    for published in theirs {
        rows.extend(ours.next());
        rows.push(published);
    }
    rows.extend(ours);
    Some(Table {
        caption: format!(
            "Milliseconds a frame (median, by the clock) at {densities} rays a pixel, {}x{}, {}",
            first.key.width,
            first.key.height,
            records.environment.line()
        ),
        head: ["scene".to_owned()].into_iter().chain(headings).chain(errors).collect(),
        rows,
        note: "The published times are those of table 5.1 of S. A. Kovalchuk's thesis (2022), on an i5-6198DU with two cores. \
               Its scenes and picture sizes are not known, so they stand beside ours as text and compare with nothing. Of the \
               scenes measured here by default, base is built from the thesis's text; the other three, mirrors, cornell and \
               gallery, are ours. 92087 three times in scene 2 and 12065 in two scenes are probably slips of the pen. All of \
               our methods use the SIMD level named above."
            .to_owned(),
    })
}

/// A scene from one camera, by one of its rows.
struct View<'a>(&'a Row);

impl View<'_> {
    fn shows(&self, row: &Row) -> bool {
        (&self.0.key.scene, &self.0.key.camera) == (&row.key.scene, &row.key.camera)
    }

    /// What it is called among `all`: the scene, and the camera where it is seen from several.
    fn name(&self, all: &[Self]) -> String {
        let scene = &self.0.key.scene;
        let is_alone = all.iter().filter(|view| view.0.key.scene == *scene).count() == 1;
        if is_alone { scene.clone() } else { section_of(self.0) }
    }
}

/// The row of one view among `all`.
fn measured(records: &Records, view: &View<'_>, all: &[View<'_>]) -> Vec<String> {
    let find = |method: &str, density: u32| {
        let is_it = |row: &&Row| view.shows(row) && row.key.method == method && row.key.at == Some(f64::from(density));
        records.of(Part::Thesis).find(is_it)
    };
    let time = |row: Option<&Row>| match row {
        Some(Row { cut_off_ms: Some(ms), .. }) => format!("> {}", short(*ms)),
        Some(row) if !row.frame_ms.is_empty() => short(row.frame_ms.median),
        _ => "-".to_owned(),
    };
    let each = |cell: &dyn Fn(u32) -> String| DENSITIES.map(cell).join(" / ");
    let mut cells = vec![view.name(all)];
    cells.extend(COLUMNS.iter().map(|column| each(&|density| time(find(column.name, density)))));
    let error = |row: Option<&Row>, metric: &str| row.and_then(|row| row.error(metric));
    let by_method =
        COLUMNS.map(|column| each(&|density| error(find(column.name, density), "flip").map_or("-".to_owned(), short)));
    let all_alike = by_method.iter().all(|errors| *errors == by_method[0]);
    cells.push(if all_alike {
        format!("every method: {}", by_method[0])
    } else {
        let named = COLUMNS.iter().zip(&by_method).map(|(column, errors)| format!("{}: {errors}", column.name));
        named.collect::<Vec<_>>().join("; ")
    });
    // Pictures that err alike by every metric are the same picture, as far as figures can tell.
    let unlike = |density: u32| {
        let plain = find(COLUMNS[0].name, density).map(|row| &row.error);
        let differs = |name: &str| find(name, density).map(|row| &row.error) != plain;
        COLUMNS.iter().any(|column| differs(column.name))
    };
    cells.push(if DENSITIES.iter().any(|density| unlike(*density)) { "some" } else { "none" }.to_owned());
    cells
}
