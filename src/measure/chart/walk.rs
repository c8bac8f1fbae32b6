//! Errors from frame to frame along a walk: the flicker strip.

use super::axis::{Area, Axis};
use super::lines::{self, Line, ROOM_FOR_NAMES};
use super::number::short;
use super::svg::Svg;
use super::{Chart, by_view, file_name, view_title};
use crate::measure::records::{FrameError, Part, Records, Row};

const SIZE: (f64, f64) = (1040.0, 706.0);
const STRIP: f64 = 160.0;
const STRIDE: f64 = 194.0;

/// A strip: its axis title, the frame it starts from, its greatest value, and what it shows of a frame with so many pixels.
type Strip = (&'static str, usize, f64, fn(&FrameError, f64) -> f64);

const STRIPS: [Strip; 3] = [
    ("RMSE [1/255]", 0, 255.0, |frame, _| 255.0 * frame.rmse),
    ("99.9 % error [1/255]", 0, 255.0, |frame, _| 255.0 * frame.p999_abs),
    ("pops [% of pixels]", 1, 100.0, |frame, pixels| 100.0 * frame.pops / pixels),
];

/// One chart for every walk.
pub fn charts(records: &Records) -> Vec<Chart> {
    by_view(records, Part::Walk).into_iter().filter_map(|(view, rows)| chart(view, &rows)).collect()
}

fn chart(view: (&str, &str), rows: &[&Row]) -> Option<Chart> {
    let rows: Vec<&&Row> = rows.iter().filter(|row| row.frames.len() > 1).collect();
    let first = rows.first()?;
    let pixels = f64::from(first.key.width) * f64::from(first.key.height);
    let title = format!("Error from frame to frame: {}", view_title(view));
    let note = format!(
        "{}x{}, against a ray for every pixel of the same frame. Pops: pixels that came to be visibly wrong, or ceased to, since \
         the frame before.",
        first.key.width, first.key.height
    );
    let mut svg = Svg::on_paper(SIZE, &title, &note);
    let frames = rows.iter().map(|row| row.frames.len()).max().unwrap_or_default();
    for (i, (unit, start, most, value)) in STRIPS.iter().enumerate() {
        let top = 82.0 + STRIDE * i as f64;
        let area = Area { left: 86.0, top, right: SIZE.0 - ROOM_FOR_NAMES, bottom: top + STRIP };
        let x = Axis::range(0.0, frames as f64 - 1.0, area.left + 6.0, area.right - 6.0);
        let line = |row: &&Row| Line {
            family: row.family.clone(),
            name: row.key.method.clone(),
            points: row
                .frames
                .iter()
                .enumerate()
                .skip(*start)
                .map(|(n, frame)| {
                    let value = value(frame, pixels);
                    (n as f64, value, format!("{}, frame {n}: {}", row.key.method, short(value)))
                })
                .collect(),
        };
        let drawn: Vec<Line> = rows.iter().map(|row| line(row)).collect();
        let values = drawn.iter().flat_map(|line| line.points.iter().map(|(_, value, _)| *value));
        let y = Axis::linear(values, area.bottom, area.top + 6.0).up_to(*most);
        area.axis_left(&mut svg, &y, unit);
        if i + 1 == STRIPS.len() {
            area.axis_below(&mut svg, &x, "frame");
        } else {
            area.ticks_below(&mut svg, &x);
        }
        area.frame(&mut svg);
        targets(&mut svg, &area, &x, unit, &drawn);
        lines::draw(&mut svg, &area, &named_with_means(drawn), &x, &|_, value| y.at(value));
    }
    Some(Chart { name: file_name("walk", view), section: view_title(view), title, size: SIZE, body: svg.0 })
}

/// What is not seen, but tells the values of a frame wherever it is pointed at. All lines begin at the same frame.
fn targets(svg: &mut Svg, area: &Area, x: &Axis, unit: &str, lines: &[Line]) {
    let Some(longest) = lines.iter().max_by_key(|line| line.points.len()) else { return };
    let width = x.at(1.0) - x.at(0.0);
    for (i, (n, ..)) in longest.points.iter().enumerate() {
        let values = lines.iter().filter_map(|line| Some(format!("\n{}: {}", line.name, short(line.points.get(i)?.1))));
        let told = format!("frame {n}, {unit}{}", values.collect::<String>());
        svg.part(x.at(*n) - width / 2.0, area.top, width, area.bottom - area.top, "hit", &told);
    }
}

/// Lines whose names tell their means.
fn named_with_means(lines: Vec<Line>) -> Vec<Line> {
    let mean =
        |line: &Line| line.points.iter().map(|(_, value, _)| value).sum::<f64>() / line.points.len().max(1) as f64;
    lines.into_iter().map(|line| Line { name: format!("{}: {}", line.name, short(mean(&line))), ..line }).collect()
}
