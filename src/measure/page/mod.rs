//! The page of a bench: all charts, what is told of each point, pictures and maps of errors, in one file that loads
//! nothing.

mod thumbnail;

use super::chart::{self, Chart, STYLE, escaped, short};
use super::records::{Part, Records, RecordsError, Row};
use super::table::Table;
use super::thesis;
use crate::picture::PendingFile;
use serde_json::{Map, Value, json};
use std::path::Path;
use thumbnail::Reduce;

const CSS: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Draws everything that `records` hold into `folder`: charts, tables, and `index.html`.
///
/// # Errors
/// [`RecordsError::Write`]: the first, when all else is drawn. Pictures that are missing are left out of the page.
pub fn draw(records: &Records, folder: &Path) -> Result<(), RecordsError> {
    let charts = chart::of(records);
    let written: Vec<_> = charts.iter().map(|chart| chart.write(folder)).collect();
    if let Some(table) = thesis::table(records) {
        write(&folder.join("thesis.md"), &table.markdown())?;
    }
    records.save_csv(folder)?;
    write(&folder.join("index.html"), &html(records, &charts, folder))?;
    written.into_iter().collect()
}

fn write(path: &Path, text: &str) -> Result<(), RecordsError> {
    Ok(PendingFile::create(path)?.commit(|sink| Ok(sink.write_all(text.as_bytes())?))?)
}

fn html(records: &Records, charts: &[Chart], folder: &Path) -> String {
    let mut sections: Vec<&str> = Vec::new();
    for chart in charts {
        if !sections.contains(&chart.section.as_str()) {
            sections.push(&chart.section);
        }
    }
    let mut body = String::new();
    for section in sections {
        body += &format!("<section><h2>{}</h2>\n", escaped(section));
        for chart in charts.iter().filter(|chart| chart.section == section) {
            body += &figure(chart);
            if chart.name.starts_with("tradeoff") {
                body += VIEWER;
                body +=
                    &format!("<details><summary>The figures</summary>{}</details>\n", figures(records, chart).html());
            }
        }
        body += "</section>\n";
    }
    if let Some(table) = thesis::table(records) {
        body += &format!("<section><h2>The thesis's table</h2>\n{}</section>\n", table.html());
    }
    // A script ends at the first "</", whatever stands around it.
    let data = pictures(records, folder).to_string().replace("</", "<\\/");
    let dark = chart::DARK;
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>raywalk bench</title>\n\
         <style>\n{CSS}\nsvg.chart{{{STYLE}}}\n:root[data-theme=dark] svg.chart{{{dark}}}\n\
         @media (prefers-color-scheme: dark){{:root:not([data-theme=light]) svg.chart{{{dark}}}}}\n</style>\n</head>\n<body>\n\
         <header><h1>Speed and accuracy</h1><button id=\"theme\" type=\"button\">light / dark</button></header>\n\
         <p>{}</p>\n<p>Point at anything to read its values; press a point of time against error to see its picture.</p>\n\
         {body}<div id=\"told\" role=\"status\" hidden></div>\n\
         <script type=\"application/json\" id=\"pictures\">{data}</script>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        escaped(&records.environment.line()),
    )
}

fn figure(chart: &Chart) -> String {
    let (width, height) = chart.size;
    format!(
        "<figure><svg class=\"chart\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {width} {height}\" style=\"max-width:{width}px\">\n{}</svg>\
         </figure>\n",
        escaped(&chart.title),
        chart.body
    )
}

/// Where the picture of a point is shown.
const VIEWER: &str = "<div class=\"viewer\" hidden><p class=\"told\"></p><div class=\"pictures\">\
    <figure><img class=\"picture\" alt=\"\"><figcaption>the picture</figcaption></figure>\
    <figure><img class=\"map\" alt=\"\"><figcaption></figcaption></figure></div></div>\n";

/// The pictures of all points, each file once: `{ "points": { row: [picture, map, told] }, "files": { name: data } }`.
fn pictures(records: &Records, folder: &Path) -> Value {
    let (mut points, mut files) = (Map::new(), Map::new());
    for (number, row) in records.rows.iter().enumerate().filter(|(_, row)| row.key.part == Part::Settings) {
        for (name, kind) in [(&row.picture, Reduce::Picture), (&row.map, Reduce::Map)] {
            if let Some(name) = name
                && !files.contains_key(name)
                && let Some(data) = thumbnail::of(folder, name, kind)
            {
                files.insert(name.clone(), data.into());
            }
        }
        points.insert(number.to_string(), json!([row.picture, row.map, chart::told(row)]));
    }
    json!({ "points": points, "files": files })
}

/// The rows of a chart of time against error.
fn figures(records: &Records, chart: &Chart) -> Table {
    let head = [
        "method",
        "flags",
        "frame [ms]",
        "5 % to 95 %",
        "CPU [ms]",
        "FLIP",
        "RMSE",
        "PSNR [dB]",
        "greatest error",
        "pixels off",
    ];
    let line = |row: &Row| {
        let score = |name: &str| row.error(name).map_or("-".to_owned(), short);
        let time = |ms: f64| if ms > 0.0 { short(ms) } else { "-".to_owned() };
        let spread = format!("{} to {}", time(row.frame_ms.p5), time(row.frame_ms.p95));
        let frame = row.cut_off_ms.map_or_else(|| time(row.frame_ms.median), |ms| format!("> {}", short(ms)));
        let texts = [row.key.method.clone(), row.flags.clone(), frame, spread, time(row.cpu_ms.min)];
        texts.into_iter().chain(["flip", "rmse", "psnr", "max_abs", "pixels_off"].map(score)).collect()
    };
    let rows = records.of(Part::Settings).filter(|row| chart::section_of(row) == chart.section);
    Table {
        caption: "Median frame time by the clock, its spread, and the least CPU time of all threads together"
            .to_owned(),
        head: head.map(str::to_owned).to_vec(),
        rows: rows.map(line).collect(),
        note: String::new(),
    }
}
