//! What each optimisation gains alone, and what is lost when it alone is taken away: in CPU time, which other work of the
//! machine disturbs least; threads, which save no CPU time, by the clock.

use super::axis::{Area, Axis};
use super::number::short;
use super::svg::{Anchor, Svg};
use super::{Chart, by_view, file_name, view_title};
use crate::measure::records::{Part, Records, Row, Samples};
use crate::measure::statistics::percentile;
use crate::measure::sweep::OPTIMISATIONS;

const WIDTH: f64 = 980.0;
const GROUP: f64 = 54.0;
const ROOM_FOR_FACTOR: f64 = 64.0;

/// How many times slower one run is than another: by the medians, and the range that their spread leaves open.
struct Factor {
    median: f64,
    low: f64,
    high: f64,
    /// The slower one was cut off: it is at least that.
    at_least: bool,
}

/// One chart for every view.
pub fn charts(records: &Records) -> Vec<Chart> {
    by_view(records, Part::Optimisations).into_iter().filter_map(|(view, rows)| chart(view, &rows)).collect()
}

fn chart(view: (&str, &str), rows: &[&Row]) -> Option<Chart> {
    let named = |name: &str| rows.iter().copied().find(|row| row.key.method == name);
    let (all, none) = (named("all")?, named("none")?);
    let bars: Vec<(&str, [Result<Factor, &str>; 2])> = OPTIMISATIONS
        .iter()
        .map(|(name, _)| {
            let time =
                if *name == "threads" { |row: &Row| row.frame_ms.clone() } else { |row: &Row| row.cpu_ms.clone() };
            let alone = named(&format!("only {name}")).ok_or(NOT_MEASURED).and_then(|only| factor(none, only, time));
            let without =
                named(&format!("without {name}")).ok_or(NOT_MEASURED).and_then(|without| factor(without, all, time));
            (*name, [alone, without])
        })
        .collect();
    let size = (WIDTH, 164.0 + GROUP * bars.len() as f64);
    let title = format!("What each optimisation is worth: {}", view_title(view));
    let note = format!(
        "Median CPU time of a frame, for threads the time by the clock; all on: {} ms at {}x{}, all off: {} ms at {}x{}. \
         Whiskers: what the spread of frames (25 to 75 %) leaves open.",
        time_text(all),
        all.key.width,
        all.key.height,
        time_text(none),
        none.key.width,
        none.key.height,
    );
    let mut svg = Svg::on_paper(size, &title, &note);
    let area = Area { left: 190.0, top: 102.0, right: WIDTH - 90.0, bottom: size.1 - 56.0 };
    let factors = bars.iter().flat_map(|(_, pair)| pair.iter().flatten());
    let ends = factors.flat_map(|factor| [factor.low, factor.high, factor.median]).chain([0.8, 2.0]);
    // The factor stands behind its bar.
    let x = Axis::logarithmic(ends, area.left, area.right - ROOM_FOR_FACTOR);
    area.axis_below(&mut svg, &x, "times as fast, logarithmic (1: makes no difference)");
    for (i, (class, text)) in
        [("part s2", "gained by it alone, all others off"), ("part s4", "lost without it, all others on")]
            .into_iter()
            .enumerate()
    {
        let left = area.left + 300.0 * i as f64;
        svg.rectangle(left, 76.0, 12.0, 12.0, class);
        svg.text(left + 18.0, 87.0, Anchor::Start, "", text);
    }
    for (i, (name, pair)) in bars.iter().enumerate() {
        let top = area.top + GROUP * i as f64 + 7.0;
        svg.text(area.left - 10.0, top + 24.0, Anchor::End, "", name);
        for (j, factor) in pair.iter().enumerate() {
            let top = top + 21.0 * j as f64;
            let factor = match factor {
                Ok(factor) => factor,
                Err(reason) => {
                    svg.text(x.at(1.0) + 6.0, top + 14.0, Anchor::Start, "tick", reason);
                    continue;
                }
            };
            let (one, end) = (x.at(1.0), x.at(factor.median));
            let sign = if factor.at_least { "> " } else { "" };
            let text = format!("{sign}{}", short(factor.median));
            let what = if j == 0 { "alone" } else { "taken away" };
            svg.part(
                one.min(end),
                top,
                (end - one).abs(),
                18.0,
                if j == 0 { "part s2" } else { "part s4" },
                &format!("{name}, {what}: {text}"),
            );
            svg.line((x.at(factor.low), top + 9.0), (x.at(factor.high), top + 9.0), "f0 whisker");
            svg.text(x.at(factor.high.max(factor.median).max(1.0)) + 7.0, top + 14.0, Anchor::Start, "tick", &text);
        }
    }
    svg.line((x.at(1.0), area.top), (x.at(1.0), area.bottom), "axis");
    area.frame(&mut svg);
    Some(Chart { name: file_name("optimisations", view), section: view_title(view), title, size, body: svg.0 })
}

/// Why there is no factor.
const NOT_MEASURED: &str = "not measured";
const TOO_SLOW: &str = "took too long to tell";

fn factor(slow: &Row, fast: &Row, time: fn(&Row) -> Samples) -> Result<Factor, &'static str> {
    let (slow_ms, fast_ms) = (time(slow), time(fast));
    if fast_ms.is_empty() {
        return Err(if fast.cut_off_ms.is_some() { TOO_SLOW } else { NOT_MEASURED });
    }
    if let Some(cut_off) = slow.cut_off_ms {
        // Of what was cut off only the clock is known, which is no more than the CPU time of a frame on one thread.
        let least = cut_off / fast_ms.median;
        return Ok(Factor { median: least, low: least, high: least, at_least: true });
    }
    let quartile = |samples: &Samples, q: f64| {
        let mut sorted = samples.samples.clone();
        sorted.sort_by(f64::total_cmp);
        percentile(&sorted, q).unwrap_or_default()
    };
    if slow_ms.is_empty() {
        return Err(NOT_MEASURED);
    }
    Ok(Factor {
        median: slow_ms.median / fast_ms.median,
        low: quartile(&slow_ms, 0.25) / quartile(&fast_ms, 0.75),
        high: quartile(&slow_ms, 0.75) / quartile(&fast_ms, 0.25),
        at_least: false,
    })
}

fn time_text(row: &Row) -> String {
    row.cut_off_ms.map_or_else(|| short(row.cpu_ms.median), |ms| format!("more than {}", short(ms)))
}
