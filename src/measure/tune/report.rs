//! What a search found, for people and for programs.

use super::{Trial, Tuning, Verdict};
use crate::measure::chart::short;
use crate::measure::record::settings_json;
use serde_json::{Map, Value, json};

/// The flags of a trial as they are typed on any command, whatever that starts from; `also` is a flag that all trials had.
fn typed(trial: &Trial, also: Option<&str>) -> String {
    let also = also.map_or_else(String::new, |flag| format!("{flag} "));
    format!("--preset exact {also}{}", trial.settings.flags()).trim_end().to_owned()
}

/// For people: what was tried, the front as a table, what was chosen and why, and at last the flags. `also` is a flag that all
/// trials had and that is no setting.
pub fn table(found: &Tuning, also: Option<&str>) -> String {
    let (width, height) = found.size;
    let mut lines = vec![format!(
        "tried {} settings on {} at {width}x{height}:",
        found.trials.len(),
        if found.frames == 1 { "one view".to_owned() } else { format!("{} views", found.frames) }
    )];
    lines.extend(found.varied.iter().map(|(name, values)| format!("  {name}: {}", values.join(", "))));
    if found.cut_short {
        lines.push("  the time was up before all of them were tried".to_owned());
    }
    lines.push("the best for their time (errors against full, those of the worst view):".to_owned());
    lines.extend(rows(found));
    if let Some(chosen) = found.chosen.map(|place| &found.trials[place]) {
        if let Some(faster) = found.passed_over.map(|place| &found.trials[place]) {
            lines.push(format!(
                "{} is {:.1} % faster, which is within the noise of {:.1} %: the simpler is taken",
                typed(faster, also),
                100.0 * (chosen.cost() / faster.cost() - 1.0),
                100.0 * found.noise
            ));
        }
        lines.push(typed(chosen, also));
    }
    lines.join("\n")
}

/// The front, a line each, under one of headings.
fn rows(found: &Tuning) -> Vec<String> {
    let mut cells = vec![vec![String::new(), "CPU ms".to_owned(), "median".to_owned()]];
    cells[0].extend(found.bounds.iter().map(|bound| bound.metric.name.to_owned()));
    cells[0].push("flags".to_owned());
    for &place in &found.front {
        let trial = &found.trials[place];
        let mark = match trial.verdict {
            _ if found.chosen == Some(place) => ">",
            Verdict::Holds => "",
            Verdict::Breaks | Verdict::Slow => "x",
        };
        let times = trial.cpu_ms().map_or([f64::NAN; 2], |time| [time.min, time.median]);
        let mut row = vec![mark.to_owned()];
        // Short times would be all zeros with one digit behind the point.
        row.extend(times.map(|time| if time < 1.0 { short(time) } else { format!("{time:.1}") }));
        row.extend(trial.scores.iter().map(|score| if score.is_finite() { short(*score) } else { "-".to_owned() }));
        row.push(if trial.changes() == 0 { "every default".to_owned() } else { trial.settings.flags() });
        cells.push(row);
    }
    let columns = cells[0].len();
    let widths: Vec<usize> =
        (0..columns).map(|i| cells.iter().map(|row| row[i].chars().count()).max().unwrap_or_default()).collect();
    let line = |row: &Vec<String>| {
        let mut line = format!("{:1}", row[0]);
        for (cell, width) in row[1..columns - 1].iter().zip(&widths[1..]) {
            line += &format!(" {cell:>width$}");
        }
        format!("{line}  {}", row[columns - 1])
    };
    let mut lines: Vec<String> = cells.iter().map(line).collect();
    lines.push("(> chosen, x breaks a bound)".to_owned());
    lines
}

/// For programs: one object. `also` as for [`table`].
pub fn json(found: &Tuning, also: Option<&str>) -> Value {
    let trial = |trial: &Trial| {
        json!({
            "flags": typed(trial, also),
            "error": scores(found, trial),
            "cpu_ms": trial.cpu_ms(),
            // Null where its picture was not judged, because it is no faster than what it approximates.
            "met": (trial.verdict != Verdict::Slow).then_some(trial.verdict == Verdict::Holds),
        })
    };
    let of = |places: &[usize]| places.iter().map(|&place| trial(&found.trials[place])).collect::<Vec<_>>();
    let chosen = found.chosen.map(|place| &found.trials[place]);
    let bounds: Map<_, _> = found.bounds.iter().map(|b| (b.metric.name.to_owned(), json!(b.limit))).collect();
    json!({
        "met": chosen.is_some(),
        "flags": chosen.map(|trial| typed(trial, also)),
        "settings": chosen.map(|trial| settings_json(&trial.settings)),
        "error": chosen.map(|trial| scores(found, trial)),
        "cpu_ms": chosen.and_then(Trial::cpu_ms),
        "max_error": bounds,
        "noise": found.noise,
        "passed_over": found.passed_over.map(|place| trial(&found.trials[place])),
        "frames": found.frames,
        "width": found.size.0,
        "height": found.size.1,
        "cut_short": found.cut_short,
        "front": of(&found.front),
        "tried": found.trials.iter().map(trial).collect::<Vec<_>>(),
    })
}

/// Errors by metric; `null` where one has no value, such as the psnr of equal pictures.
fn scores(found: &Tuning, trial: &Trial) -> Value {
    if trial.verdict == Verdict::Slow {
        return Value::Null;
    }
    found.bounds.iter().zip(&trial.scores).map(|(bound, score)| (bound.metric.name.to_owned(), json!(score))).collect()
}
