//! Records as comma-separated values (RFC 4180), one line a row.

use super::{Records, Row};
use crate::measure::metric::METRICS;

/// The share of visibly wrong pixels, which no metric of pictures tells.
pub const WRONG_SHARE: &str = "wrong_share";

/// A column: its name and what it holds.
type Column = (&'static str, fn(&Row) -> String);

const COLUMNS: &[Column] = &[
    ("part", |r| serde_json::to_value(r.key.part).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()),
    ("scene", |r| r.key.scene.clone()),
    ("camera", |r| r.key.camera.clone()),
    ("method", |r| r.key.method.clone()),
    ("flags", |r| r.flags.clone()),
    ("width", |r| r.key.width.to_string()),
    ("height", |r| r.key.height.to_string()),
    ("at", |r| optional(r.key.at)),
    ("primitives", |r| r.primitives.to_string()),
    ("frames", |r| r.frame_ms.len().to_string()),
    ("frame_ms_median", |r| milliseconds(r.frame_ms.median)),
    ("frame_ms_p5", |r| milliseconds(r.frame_ms.p5)),
    ("frame_ms_p95", |r| milliseconds(r.frame_ms.p95)),
    ("cpu_ms_min", |r| milliseconds(r.cpu_ms.min)),
    ("cpu_ms_median", |r| milliseconds(r.cpu_ms.median)),
    ("cut_off_ms", |r| optional(r.cut_off_ms)),
];

/// All rows under one line of names; lines end with CR LF.
pub fn table(records: &Records) -> String {
    let metrics: Vec<&str> = METRICS.iter().map(|metric| metric.name).chain([WRONG_SHARE]).collect();
    let names = COLUMNS.iter().map(|(name, _)| (*name).to_owned()).chain(metrics.iter().map(|&m| m.to_owned()));
    let environment = ["machine", "build", "simd"].map(str::to_owned);
    let mut text = line(names.chain(environment));
    for row in &records.rows {
        let cells =
            COLUMNS.iter().map(|(_, cell)| cell(row)).chain(metrics.iter().map(|name| optional(row.error(name))));
        let here = &records.environment;
        text += &line(cells.chain([&here.machine, &here.build, &here.simd].map(Clone::clone)));
    }
    text
}

fn line(cells: impl Iterator<Item = String>) -> String {
    let quoted = |cell: String| {
        if cell.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell }
    };
    cells.map(quoted).collect::<Vec<_>>().join(",") + "\r\n"
}

fn optional(number: Option<f64>) -> String {
    number.map(|number| number.to_string()).unwrap_or_default()
}

fn milliseconds(number: f64) -> String {
    if number > 0.0 { format!("{number:.4}") } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_and_quotes_are_quoted() {
        let cells = ["plain", "a,b", "say \"x\""].map(str::to_owned);
        assert_eq!(line(cells.into_iter()), "plain,\"a,b\",\"say \"\"x\"\"\"\r\n");
    }
}
