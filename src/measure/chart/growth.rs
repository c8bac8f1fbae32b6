//! How time grows with pixels and with primitives.

use super::axis::{Area, Axis};
use super::lines::{self, Line, ROOM_FOR_NAMES};
use super::number::short;
use super::svg::Svg;
use super::{Chart, by_view, file_name, view_title};
use crate::measure::records::{Part, Records, Row};

const SIZE: (f64, f64) = (880.0, 500.0);

/// One chart for every view over pixels, one over primitives.
pub fn charts(records: &Records) -> Vec<Chart> {
    let kinds = [
        (Part::Pixels, "pixels", "pixels of the picture, logarithmic"),
        (Part::Primitives, "primitives", "primitives of the scene, logarithmic"),
    ];
    let charts = |(part, kind, axis): (Part, &'static str, &'static str)| {
        by_view(records, part).into_iter().filter_map(move |(view, rows)| chart(view, &rows, kind, axis))
    };
    kinds.into_iter().flat_map(charts).collect()
}

fn chart(view: (&str, &str), rows: &[&Row], kind: &str, axis: &str) -> Option<Chart> {
    let mut lines: Vec<Line> = Vec::new();
    let mut timed: Vec<&&Row> = rows.iter().filter(|row| !row.frame_ms.is_empty()).collect();
    timed.sort_by(|a, b| a.key.at.unwrap_or_default().total_cmp(&b.key.at.unwrap_or_default()));
    for row in &timed {
        let at = row.key.at?;
        let told = format!("{}: {} ms for {} {kind}", row.key.method, short(row.frame_ms.median), short(at));
        Line::add(&mut lines, &row.family, &row.key.method, (at, row.frame_ms.median, told));
    }
    let first = timed.first()?;
    let title = format!("Time against {kind}: {}", view_title(view));
    let size = format!("{}x{}, ", first.key.width, first.key.height);
    let note = format!("{}median frame time by the clock.", if kind == "pixels" { "" } else { &size });
    let mut svg = Svg::on_paper(SIZE, &title, &note);
    let area = Area { left: 86.0, top: 72.0, right: SIZE.0 - ROOM_FOR_NAMES, bottom: SIZE.1 - 62.0 };
    let points = || lines.iter().flat_map(|line| &line.points);
    let x = Axis::logarithmic(points().map(|(at, ..)| *at), area.left + 6.0, area.right - 6.0);
    let y = Axis::logarithmic(points().map(|(_, ms, _)| *ms), area.bottom - 6.0, area.top + 6.0);
    area.axis_below(&mut svg, &x, axis);
    area.axis_left(&mut svg, &y, "median time of a frame [ms], logarithmic");
    area.frame(&mut svg);
    lines::draw(&mut svg, &area, &lines, &x, &|_, ms| y.at(ms));
    Some(Chart {
        name: file_name(&format!("growth-{kind}"), view),
        section: view_title(view),
        title,
        size: SIZE,
        body: svg.0,
    })
}
