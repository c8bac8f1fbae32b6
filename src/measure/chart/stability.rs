//! Stability curves: error against difficulty.

use super::Chart;
use super::axis::{Area, Axis};
use super::lines::{self, Line, ROOM_FOR_NAMES};
use super::number::short;
use super::svg::{Anchor, Svg};
use crate::measure::records::{Part, Records, Row, WRONG_SHARE};
use crate::measure::stability::{DIFFICULTIES, Difficulty};

const SIZE: (f64, f64) = (1040.0, 600.0);
/// Height of one line within the rows for what is wrong nowhere.
const EXACT_LINE: f64 = 15.0;

/// One chart for every difficulty.
pub fn charts(records: &Records) -> Vec<Chart> {
    DIFFICULTIES.iter().filter_map(|difficulty| chart(records, difficulty)).collect()
}

fn chart(records: &Records, difficulty: &Difficulty) -> Option<Chart> {
    let mut rows: Vec<&Row> = records.of(Part::Stability).filter(|row| row.key.scene == difficulty.name).collect();
    rows.sort_by(|a, b| a.key.at.unwrap_or_default().total_cmp(&b.key.at.unwrap_or_default()));
    let first = *rows.first()?;
    let mut lines: Vec<Line> = Vec::new();
    for row in records.of(Part::Stability).filter(|row| row.key.scene == difficulty.name) {
        if lines.iter().all(|line| line.name != row.key.method) {
            let (family, name) = (row.family.clone(), row.key.method.clone());
            lines.push(Line { family, name, points: Vec::new() });
        }
    }
    for row in &rows {
        let Some((at, share)) = row.key.at.zip(row.error(WRONG_SHARE)) else { continue };
        let told = format!("{}: {} % wrong at {}", row.key.method, short(share), short(at));
        Line::add(&mut lines, &row.family, &row.key.method, (at, share, told));
    }
    lines.retain(|line| !line.points.is_empty());
    if difficulty.falls {
        lines.iter_mut().for_each(|line| line.points.reverse());
    }

    let title = format!("Error against difficulty: {}", difficulty.name);
    let note = format!(
        "{}x{}, visibly wrong (off by more than 2/255): the share of {}. Below: no pixel is wrong.",
        first.key.width, first.key.height, difficulty.share_of
    );
    let mut svg = Svg::on_paper(SIZE, &title, &note);
    let area = Area { left: 86.0, top: 72.0, right: SIZE.0 - ROOM_FOR_NAMES, bottom: SIZE.1 - 62.0 };
    let band = EXACT_LINE * (lines.len() as f64 + 1.0);
    let errors = Area { bottom: area.bottom - band, ..area };
    let (from, to) = (area.left + 8.0, area.right - 8.0);
    let (from, to) = if difficulty.falls { (to, from) } else { (from, to) };
    let points = || lines.iter().flat_map(|line| &line.points);
    let x = Axis::logarithmic(points().map(|(at, ..)| *at), from, to);
    let y =
        Axis::logarithmic(points().map(|(_, share, _)| *share), errors.bottom - 6.0, errors.top + 10.0).up_to(100.0);
    svg.rectangle(area.left, errors.bottom, area.right - area.left, band, "band");
    area.axis_below(&mut svg, &x, difficulty.axis);
    if points().any(|(_, share, _)| *share > 0.0) {
        errors.axis_left(&mut svg, &y, "visibly wrong pixels [%], logarithmic");
    }
    svg.text(area.left - 8.0, errors.bottom + band / 2.0 + 4.0, Anchor::End, "tick", "none");
    area.frame(&mut svg);
    // Lines without an error run side by side, so that each can be seen.
    let at = |i: usize, share: f64| {
        if share > 0.0 { y.at(share) } else { errors.bottom + EXACT_LINE * (i as f64 + 1.0) }
    };
    lines::draw(&mut svg, &area, &lines, &x, &at);
    Some(Chart {
        name: format!("stability-{}", difficulty.name),
        section: "Stability".to_owned(),
        title,
        size: SIZE,
        body: svg.0,
    })
}
