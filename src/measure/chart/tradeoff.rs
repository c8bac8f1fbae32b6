//! Time against error, a panel a metric: the choice that a user of the program has.

use super::axis::{Area, Axis};
use super::labels::spread_out;
use super::lines::ROOM_FOR_NAMES;
use super::number::short;
use super::palette::class;
use super::svg::{Anchor, Svg};
use super::{Chart, by_view, file_name, view_title};
use crate::measure::front::front;
use crate::measure::records::{Part, Records, Row};

const WIDTH: f64 = 880.0;
/// Height of a panel, without its axis.
const PANEL: f64 = 380.0;
/// From the top of a panel to that of the next.
const STRIDE: f64 = 490.0;
/// Height of one line within the rows for what has no error at all.
const EXACT_LINE: f64 = 17.0;

/// A metric's panel.
struct Panel {
    metric: &'static str,
    /// The title of its axis.
    title: &'static str,
    /// The greatest error there can be.
    most: f64,
    /// What an error of 0 is called.
    none: &'static str,
}

const PANELS: [Panel; 2] = [
    Panel { metric: "flip", title: "mean FLIP [0 to 1, logarithmic]", most: 1.0, none: "exact" },
    Panel { metric: "pixels_off", title: "visibly wrong pixels [%, logarithmic]", most: 100.0, none: "none" },
];

/// One chart for every view that settings were swept on.
pub fn charts(records: &Records) -> Vec<Chart> {
    let views = by_view(records, Part::Settings).into_iter();
    let chart = |(view, rows): ((&str, &str), Vec<&Row>)| {
        let first = rows.first()?;
        let title = format!("Time against error: {}", view_title(view));
        let places = if first.views > 1 { format!(" from {} places of the path", first.views) } else { String::new() };
        let note = format!(
            "{}x{}, median of {} frames or more{places}; whiskers: 5 % to 95 % of frames; dashed: the best error for the time; \
             faint: something else is faster and no worse; visibly wrong: off by more than 2/255.",
            first.key.width,
            first.key.height,
            rows.iter().filter(|row| row.cut_off_ms.is_none()).map(|row| row.frame_ms.len()).min().unwrap_or_default()
        );
        let size = (WIDTH, 108.0 + STRIDE * PANELS.len() as f64 - 48.0);
        let mut svg = Svg::on_paper(size, &title, &note);
        for (i, panel) in PANELS.iter().enumerate() {
            let top = 108.0 + STRIDE * i as f64;
            let area = Area { left: 86.0, top, right: WIDTH - ROOM_FOR_NAMES, bottom: top + PANEL };
            draw_panel(&mut svg, area, records, &rows, panel);
        }
        Some(Chart { name: file_name("tradeoff", view), section: view_title(view), title, size, body: svg.0 })
    };
    views.filter_map(chart).collect()
}

/// A row's error in the panel's unit, where it was compared and timed.
fn error_of(row: &Row, metric: &str) -> Option<f64> {
    let error = row.error(metric).filter(|_| !row.frame_ms.is_empty())?;
    let pixels = f64::from(row.key.width) * f64::from(row.key.height);
    Some(if metric == "pixels_off" { 100.0 * error / pixels } else { error })
}

fn draw_panel(svg: &mut Svg, area: Area, records: &Records, rows: &[&Row], panel: &Panel) {
    let Panel { metric, title, most, none } = *panel;
    let points: Vec<(&Row, f64)> = rows.iter().filter_map(|row| Some((*row, error_of(row, metric)?))).collect();
    let times = points.iter().flat_map(|(row, _)| [row.frame_ms.p5, row.frame_ms.median, row.frame_ms.p95]);
    let x = Axis::logarithmic(times, area.left + 8.0, area.right - 8.0);
    // What is exact stands line by line, so that each can be read.
    let exact: Vec<&Row> = points.iter().filter(|(_, error)| *error == 0.0).map(|(row, _)| *row).collect();
    let band = EXACT_LINE * (exact.len() as f64 + 1.0);
    let errors = Area { bottom: area.bottom - band, ..area };
    let y =
        Axis::logarithmic(points.iter().map(|(_, error)| *error), errors.bottom - 10.0, errors.top + 10.0).up_to(most);
    let place = |row: &Row, error: f64| {
        let line = exact.iter().position(|other| std::ptr::eq(*other, row)).unwrap_or_default() as f64;
        let height = if error > 0.0 { y.at(error) } else { errors.bottom + EXACT_LINE * (line + 1.0) };
        (x.at(row.frame_ms.median), height)
    };

    svg.rectangle(area.left, errors.bottom, area.right - area.left, band, "band");
    area.axis_below(svg, &x, "median time of a frame [ms], logarithmic");
    if exact.len() < points.len() {
        errors.axis_left(svg, &y, title);
    }
    svg.text(area.left - 8.0, errors.bottom + band / 2.0 + 4.0, Anchor::End, "tick", none);
    speed_ups(svg, &area, &x, rows);
    area.frame(svg);

    let front = front(&points.iter().map(|(row, error)| (row.frame_ms.median, *error)).collect::<Vec<_>>());
    let corners: Vec<(f64, f64)> = front.iter().map(|&i| place(points[i].0, points[i].1)).collect();
    svg.polyline(&corners, "front", "none");
    let places: Vec<(f64, f64)> = points.iter().map(|&(row, error)| place(row, error)).collect();
    // Names stand in a column, so that none covers another whatever the points do.
    let wanted: Vec<f64> = places.iter().map(|(_, y)| *y).collect();
    let heights = spread_out(&wanted, area.top + 4.0, area.bottom - 4.0);
    for ((row, _), (at, height)) in points.iter().zip(places.iter().zip(&heights)) {
        // Clear of the whisker, so that none seems to reach to the name.
        svg.line((x.at(row.frame_ms.p95).max(at.0) + 7.0, at.1), (area.right + 14.0, *height), "leader");
    }
    for (i, (&(row, _), (&at, height))) in points.iter().zip(places.iter().zip(heights)).enumerate() {
        let faint = !front.contains(&i);
        let family = class(&row.family);
        let shade = if faint { " faint" } else { "" };
        let ends = (x.at(row.frame_ms.p5), x.at(row.frame_ms.p95));
        svg.line((ends.0, at.1), (ends.1, at.1), &format!("{family} whisker{shade}"));
        let number = records.rows.iter().position(|other| std::ptr::eq(other, row));
        svg.mark(at, &row.family, faint, &told(row), number);
        svg.named_mark((area.right + 22.0, height), &row.family, faint, &told(row), number, &row.key.method);
    }
}

/// A second row of ticks, above: how many times faster than a ray for every pixel.
fn speed_ups(svg: &mut Svg, area: &Area, x: &Axis, rows: &[&Row]) {
    let Some(full) = rows.iter().find(|row| row.key.method == "full" && !row.frame_ms.is_empty()) else { return };
    let full_at = x.at(full.frame_ms.median);
    svg.text(area.left, area.top - 26.0, Anchor::Start, "note", "times as fast as a ray for every pixel (full):");
    let mut last = f64::INFINITY;
    for factor in [0.2, 0.25, 0.33, 0.5, 0.7, 1.0, 1.4, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0] {
        let time = full.frame_ms.median / factor;
        let at = x.at(time);
        let inside = at > area.left + 12.0 && at < area.right - 12.0;
        // Factors rise to the left. What would crowd is left out, but never the place of full itself.
        let clears_full = factor == 1.0 || (at - full_at).abs() > 34.0;
        if inside && clears_full && last - at > 34.0 {
            svg.line((at, area.top - 4.0), (at, area.top), "axis");
            svg.text(at, area.top - 8.0, Anchor::Middle, "tick", &format!("{factor}x"));
            last = at;
        }
    }
}

/// What is told of a point.
pub fn told(row: &Row) -> String {
    let flags = if row.flags.is_empty() { "every default".to_owned() } else { row.flags.clone() };
    let score = |name: &str| row.error(name).map_or("-".to_owned(), short);
    let shown = match row.views {
        0 | 1 => String::new(),
        views => {
            format!("\nerrors of {views} places along the path; the picture is of place {}, the worst", row.shown + 1)
        }
    };
    format!(
        "{}\n{flags}\nframe {} ms ({} to {}), CPU {} ms\nFLIP {}, RMSE {}, PSNR {}, greatest error {}\n{} pixels visibly wrong{shown}",
        row.key.method,
        short(row.frame_ms.median),
        short(row.frame_ms.p5),
        short(row.frame_ms.p95),
        short(row.cpu_ms.min),
        score("flip"),
        score("rmse"),
        row.error("psnr").map_or("without end".to_owned(), |psnr| format!("{} dB", short(psnr))),
        score("max_abs"),
        score("pixels_off"),
    )
}
