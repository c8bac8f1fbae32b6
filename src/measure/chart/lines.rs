//! Lines of several methods over one axis, each named at its end.

use super::axis::{Area, Axis};
use super::labels::spread_out;
use super::palette::{DASHES, class};
use super::svg::{Anchor, Svg};

/// Room right of an area for the lines' names.
pub const ROOM_FOR_NAMES: f64 = 185.0;

/// One method's line.
#[derive(Clone, Debug)]
pub struct Line {
    pub family: String,
    pub name: String,
    /// From left to right: place, value, and what is told of it.
    pub points: Vec<(f64, f64, String)>,
}

impl Line {
    /// Adds a point to the line of a method, which is begun if it is new.
    pub fn add(lines: &mut Vec<Self>, family: &str, name: &str, point: (f64, f64, String)) {
        match lines.iter_mut().find(|line| line.name == name) {
            Some(line) => line.points.push(point),
            None => {
                lines.push(Self { family: family.to_owned(), name: name.to_owned(), points: vec![point] });
            }
        }
    }
}

/// Dashes that tell the lines of one family apart.
fn dashes(lines: &[Line], i: usize) -> &'static str {
    DASHES[lines[..i].iter().filter(|line| line.family == lines[i].family).count() % DASHES.len()]
}

/// Draws `lines` with the pixel of each value given by `y`, and their names at their right ends. Marks only where they
/// do not crowd.
pub fn draw(svg: &mut Svg, area: &Area, lines: &[Line], x: &Axis, y: &dyn Fn(usize, f64) -> f64) {
    let placed: Vec<Vec<(f64, f64)>> = lines
        .iter()
        .enumerate()
        .map(|(i, line)| line.points.iter().map(|(at, value, _)| (x.at(*at), y(i, *value))).collect())
        .collect();
    for (i, (line, points)) in lines.iter().zip(&placed).enumerate() {
        svg.polyline(points, &format!("{} line", class(&line.family)), dashes(lines, i));
    }
    for (line, points) in lines.iter().zip(&placed) {
        if line.points.len() <= 20 {
            for (&point, (.., told)) in points.iter().zip(&line.points) {
                svg.mark(point, &line.family, false, told, None);
            }
        }
    }
    let end = |points: &Vec<(f64, f64)>| points.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
    let ends: Vec<(f64, f64)> = placed.iter().map(end).collect();
    let wanted: Vec<f64> = ends.iter().map(|(_, y)| *y).collect();
    let heights = spread_out(&wanted, area.top + 4.0, area.bottom);
    for (i, ((line, &(from_x, from_y)), height)) in lines.iter().zip(&ends).zip(heights).enumerate() {
        let start = area.right + 16.0;
        svg.line((from_x + 6.0, from_y), (start - 3.0, height), "leader");
        svg.polyline(
            &[(start, height), (start + 22.0, height)],
            &format!("{} line", class(&line.family)),
            dashes(lines, i),
        );
        svg.mark((start + 11.0, height), &line.family, false, &line.name, None);
        svg.text(start + 28.0, height + 4.5, Anchor::Start, "", &line.name);
    }
}
