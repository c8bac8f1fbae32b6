//! Where the time of a frame goes: stages, stacked.

use super::axis::{Area, Axis};
use super::number::short;
use super::svg::{Anchor, Svg, text_width};
use super::{Chart, by_view, file_name, view_title};
use crate::measure::records::{Part, Records, Row};

const WIDTH: f64 = 980.0;
const BAR: f64 = 24.0;
/// The stages in the order of a frame.
const STAGES: [&str; 7] = ["visibility", "certificate", "shadow", "shade", "secondary", "resolve", "present"];

/// One chart for every view that settings were swept on.
pub fn charts(records: &Records) -> Vec<Chart> {
    let views = by_view(records, Part::Settings).into_iter();
    views.filter_map(|(view, rows)| chart(view, &rows)).collect()
}

fn chart(view: (&str, &str), rows: &[&Row]) -> Option<Chart> {
    let rows: Vec<&&Row> = rows.iter().filter(|row| !row.cpu_ms.is_empty()).collect();
    let first = rows.first()?;
    let size = (WIDTH, 156.0 + BAR * rows.len() as f64);
    let title = format!("Where the time goes: {}", view_title(view));
    let note = format!(
        "{}x{}, mean of all timed frames, each thread by its own clock: what else the machine did meanwhile counts, too.",
        first.key.width, first.key.height
    );
    let mut svg = Svg::on_paper(size, &title, &note);
    let area = Area { left: 170.0, top: 96.0, right: WIDTH - 80.0, bottom: size.1 - 56.0 };
    // The sum stands behind its bar.
    let room = |row| 1.08 * parts(row).iter().map(|(_, ms)| ms).sum::<f64>();
    let x = Axis::linear(rows.iter().map(|row| room(row)), area.left, area.right);
    area.axis_below(&mut svg, &x, "time of a frame, summed over threads [ms]");
    let used: Vec<usize> = (0..=STAGES.len())
        .filter(|i| rows.iter().any(|row| parts(row).iter().any(|(stage, ms)| stage == i && *ms > 0.0)))
        .collect();
    let mut legend = area.left;
    for i in used {
        svg.rectangle(legend, 72.0, 12.0, 12.0, &format!("part s{i}"));
        svg.text(legend + 17.0, 83.0, Anchor::Start, "", stage_name(i));
        legend += 17.0 + text_width(stage_name(i), 13.0) + 18.0;
    }
    for (i, row) in rows.iter().enumerate() {
        let top = area.top + BAR * i as f64 + 3.0;
        svg.text(area.left - 8.0, top + 13.5, Anchor::End, "", &row.key.method);
        let mut sum = 0.0;
        for (stage, ms) in parts(row) {
            let (from, to) = (x.at(sum), x.at(sum + ms));
            let told = format!("{}: {} {} ms", row.key.method, stage_name(stage), short(ms));
            svg.part(from, top, to - from, BAR - 6.0, &format!("part s{stage}"), &told);
            sum += ms;
        }
        svg.text(x.at(sum) + 6.0, top + 13.5, Anchor::Start, "tick", &short(sum));
    }
    area.frame(&mut svg);
    Some(Chart { name: file_name("stages", view), section: view_title(view), title, size, body: svg.0 })
}

/// Milliseconds by stage, and what no stage accounts for.
fn parts(row: &Row) -> Vec<(usize, f64)> {
    let staged = STAGES.iter().enumerate();
    let mut parts: Vec<(usize, f64)> =
        staged.map(|(i, stage)| (i, row.stages_ms.get(*stage).copied().unwrap_or_default())).collect();
    let known: f64 = parts.iter().map(|(_, ms)| ms).sum();
    let mean = row.cpu_ms.samples.iter().sum::<f64>() / row.cpu_ms.len().max(1) as f64;
    parts.push((STAGES.len(), (mean - known).max(0.0)));
    parts
}

fn stage_name(i: usize) -> &'static str {
    STAGES.get(i).copied().unwrap_or("the rest")
}
