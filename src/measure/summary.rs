//! What each method gains, what it loses and where it fails, in one short table: the README's.

use super::chart::short;
use super::records::{Part, Records, Row, WRONG_SHARE};
use super::stability::{DIFFICULTIES, Difficulty};
use super::table::Table;
use serde::{Deserialize, Serialize};

/// Less than this more of pixels visibly wrong than by a ray for every pixel, in per cent, is no failure.
const TOLERATED: f64 = 0.1;

/// The figures of one view's methods.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The scene.
    pub scene: String,
    /// Width and height of its pictures in pixels.
    pub size: (u32, u32),
    /// Where and with what it was measured, in one line.
    pub environment: String,
    /// The methods that both a sweep and stability curves have.
    pub methods: Vec<MethodSummary>,
}

/// The figures of one method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MethodSummary {
    /// Its name.
    pub name: String,
    /// What it changes of the preset `exact`, as it is typed.
    pub flags: String,
    /// Least CPU time of a frame, all threads together, in milliseconds.
    pub cpu_ms: f64,
    /// How many times faster that is than a ray for every pixel.
    pub speed_up: f64,
    /// Visibly wrong pixels in per cent.
    pub pixels_off: f64,
    /// Mean FLIP, 0 to 1.
    pub flip: f64,
    /// The greatest error of any channel, 0 to 1.
    pub max_abs: f64,
    /// Where it fails.
    pub failures: Vec<Failure>,
}

/// How a method fails as scenes of one kind get harder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// The difficulty's name.
    pub difficulty: String,
    /// The unit of its numbers.
    pub unit: String,
    /// The first number at which it fails, and the share of pixels visibly wrong in per cent.
    pub first: (f64, f64),
    /// The same where most are.
    pub worst: (f64, f64),
}

impl Summary {
    /// What stands around the table in README.md.
    pub const MARKS: (&str, &str) = ("<!-- methods -->", "<!-- end of methods -->");

    /// The figures of the first view that settings were swept on; `None` where none was, or not with `full`.
    pub fn of(records: &Records) -> Option<Self> {
        let first = records.of(Part::Settings).next()?;
        let is_here = |row: &&Row| row.key.scene == first.key.scene && row.key.camera == first.key.camera;
        let rows = || records.of(Part::Settings).filter(is_here);
        let full = rows().find(|row| row.key.method == "full")?.cpu_ms.min;
        let pixels = f64::from(first.key.width) * f64::from(first.key.height);
        let method = |row: &Row| MethodSummary {
            name: row.key.method.clone(),
            flags: row.flags.clone(),
            cpu_ms: row.cpu_ms.min,
            speed_up: full / row.cpu_ms.min,
            pixels_off: 100.0 * row.error("pixels_off").unwrap_or_default() / pixels,
            flip: row.error("flip").unwrap_or_default(),
            max_abs: row.error("max_abs").unwrap_or_default(),
            failures: DIFFICULTIES.iter().filter_map(|kind| failure(records, kind, &row.key.method)).collect(),
        };
        let is_in_both = |row: &&Row| {
            !row.cpu_ms.is_empty() && records.of(Part::Stability).any(|other| other.key.method == row.key.method)
        };
        Some(Self {
            scene: first.key.scene.clone(),
            size: (first.key.width, first.key.height),
            environment: records.environment.line(),
            methods: rows().filter(is_in_both).map(method).collect(),
        })
    }

    /// The table.
    pub fn table(&self) -> Table {
        let head = [
            "method",
            "flags",
            "CPU [ms]",
            "times as fast as `full`",
            "wrong pixels [%]",
            "mean FLIP",
            "greatest error",
            "where it fails",
        ];
        let line = |method: &MethodSummary| {
            let failures: Vec<String> = method.failures.iter().map(Failure::text).collect();
            vec![
                format!("`{}`", method.name),
                if method.flags.is_empty() { "every default".to_owned() } else { format!("`{}`", method.flags) },
                short(method.cpu_ms),
                format!("{:.2}", method.speed_up),
                short(method.pixels_off),
                short(method.flip),
                short(method.max_abs),
                if failures.is_empty() { "nowhere that was tried".to_owned() } else { failures.join("; ") },
            ]
        };
        let (width, height) = self.size;
        Table {
            caption: format!("{}, {width}x{height}. {}.", self.scene, self.environment),
            head: head.map(str::to_owned).to_vec(),
            rows: self.methods.iter().map(line).collect(),
            note: "CPU: the least time of a frame, all threads together. Wrong: off by more than 2/255 in any channel, against \
                   `full`. Where it fails: the share of such pixels among those that show a wire (`wires`), of all others \
                   (`spheres`, `scales`), where it is greater than with `full`: where it begins and where it is worst."
                .to_owned(),
        }
    }
}

impl Failure {
    fn text(&self) -> String {
        let Self { difficulty, unit, first, worst } = self;
        let at = |(at, share): (f64, f64)| format!("{} % at {}", short(share), short(at));
        if first == worst {
            format!("{difficulty}: {} {unit}", at(*first))
        } else {
            format!("{difficulty}: {} {unit}, {}", at(*first), at(*worst))
        }
    }
}

/// How a method fails at a difficulty; `None` where it does not, or not more than `full`.
fn failure(records: &Records, kind: &Difficulty, method: &str) -> Option<Failure> {
    let shares = |method: &str| -> Vec<(f64, f64)> {
        let rows = records.of(Part::Stability).filter(|row| row.key.scene == kind.name && row.key.method == method);
        let mut shares: Vec<(f64, f64)> = rows.filter_map(|row| row.key.at.zip(row.error(WRONG_SHARE))).collect();
        shares.sort_by(|a, b| a.0.total_cmp(&b.0));
        if kind.falls {
            shares.reverse();
        }
        shares
    };
    let full = shares("full");
    let inevitable = |at: f64| full.iter().find(|(other, _)| *other == at).map_or(0.0, |(_, share)| *share);
    let mut failing = shares(method).into_iter().filter(|(at, share)| *share > inevitable(*at) + TOLERATED);
    let first = failing.next()?;
    let worst = failing.fold(first, |worst, next| if next.1 > worst.1 { next } else { worst });
    Some(Failure { difficulty: kind.name.to_owned(), unit: kind.unit.to_owned(), first, worst })
}
