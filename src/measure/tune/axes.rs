//! What a search may vary: the rows of the list of settings that approximate or only cost time, each with its values.

use crate::settings::{Kind, Promise, ROWS, Row, Settings};
use std::cmp::Reverse;

/// Rows whose values mean little without each other: how pixels are found and filled.
const TOGETHER: [&str; 4] = ["visibility", "stride", "fill", "match-threshold"];

/// Whether a search varies this row at all. It leaves alone what no speed is to be had from, and the SIMD level: `auto` is
/// the best of them.
pub fn is_varied(row: &Row) -> bool {
    row.name != "simd" && !matches!(row.kind, Kind::Number { tries: [], .. })
}

/// Rows that are varied together; mostly one.
pub struct Axis(Vec<&'static Row>);

/// The axes of a search from `base`, without the rows that are `fixed`. First come those that keep every pixel: they are
/// settled while there is only one candidate. Rows whose value is another picture by intent are left alone.
pub fn axes(base: &Settings, fixed: &[&str]) -> Vec<Axis> {
    let free = |row: &&'static Row| {
        let asked = row.promise(&(row.get)(base));
        is_varied(row)
            && !fixed.contains(&row.name)
            && asked != Some(Promise::Different)
            && !alternatives(row, base).is_empty()
    };
    let (together, alone): (Vec<_>, Vec<_>) = ROWS.iter().filter(free).partition(|row| TOGETHER.contains(&row.name));
    let (same, approximate): (Vec<_>, Vec<_>) = alone.into_iter().partition(|row| keeps_pixels(row));
    let one = |row| Axis(vec![row]);
    let mut axes: Vec<Axis> = same.into_iter().map(one).collect();
    axes.push(Axis(together));
    let mut approximate: Vec<Axis> = approximate.into_iter().map(one).collect();
    // Should the time be up, the shortest are missed.
    approximate.sort_by_key(|axis| Reverse(axis.products(base).len()));
    axes.append(&mut approximate);
    axes.retain(|axis| axis.products(base).len() > 1);
    axes
}

/// What a row can be besides what it is in `base`.
fn alternatives(row: &Row, base: &Settings) -> Vec<String> {
    let values: Vec<String> = match &row.kind {
        Kind::Choice(choices) => {
            let kept = choices.iter().filter(|choice| choice.promise != Promise::Different);
            kept.map(|choice| choice.value.to_owned()).collect()
        }
        Kind::Number { tries, .. } => tries.iter().map(|value| (*value as f32).to_string()).collect(),
    };
    let now = (row.get)(base);
    values.into_iter().filter(|value| *value != now && with(row, value, base).is_some()).collect()
}

fn keeps_pixels(row: &Row) -> bool {
    matches!(&row.kind, Kind::Choice(choices) if choices.iter().all(|choice| choice.promise != Promise::Approximate))
}

/// `base` with another value; `None` where the row does not take it.
fn with(row: &Row, value: &str, base: &Settings) -> Option<Settings> {
    let mut settings = base.clone();
    (row.set)(&mut settings, value).ok()?;
    Some(settings)
}

/// `settings` with each of its changes to `base` undone, one at a time. Rows that lose their effect by that are undone with it.
pub fn with_one_change_undone(settings: &Settings, base: &Settings) -> Vec<Settings> {
    let differs = |row: &&Row, settings: &Settings| (row.get)(settings) != (row.get)(base);
    let undone = |row: &Row| {
        let mut settings = settings.clone();
        row.copy(base, &mut settings);
        for row in ROWS {
            if !row.has_effect(&settings) {
                row.copy(base, &mut settings);
            }
        }
        settings
    };
    ROWS.iter().filter(|row| differs(row, settings)).map(undone).collect()
}

impl Axis {
    /// All that the axis makes of `base`, which comes first. A row without effect on what the rows before it have become
    /// stays as it is.
    pub fn products(&self, base: &Settings) -> Vec<Settings> {
        let mut all = vec![base.clone()];
        for row in &self.0 {
            let varied = all.iter().filter(|settings| row.has_effect(settings)).flat_map(|settings| {
                alternatives(row, settings).into_iter().filter_map(move |value| with(row, &value, settings))
            });
            let varied: Vec<Settings> = varied.collect();
            all.extend(varied);
        }
        all
    }

    /// Whether it is one number, whose values go further and further from the default.
    pub fn is_ladder(&self) -> bool {
        matches!(self.0[..], [Row { kind: Kind::Number { .. }, .. }])
    }

    /// Each row that it varies, with the values that are tried, as they are typed, that of `base` first.
    pub fn values(&self, base: &Settings) -> Vec<(&'static str, Vec<String>)> {
        let products = self.products(base);
        let of_row = |row: &&'static Row| {
            let mut values = Vec::new();
            for value in products.iter().map(row.get) {
                if !values.contains(&value) {
                    values.push(value);
                }
            }
            (row.name, values)
        };
        self.0.iter().map(of_row).filter(|(_, values)| values.len() > 1).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Visibility;

    fn names(base: &Settings, fixed: &[&str]) -> Vec<&'static str> {
        axes(base, fixed).iter().flat_map(|axis| axis.values(base)).map(|(name, _)| name).collect()
    }

    #[test]
    fn rows_of_another_picture_and_of_the_window_are_never_varied() {
        let names = names(&Settings::exact(), &[]);
        for row in ["shadows", "reflections", "refractions", "depth", "tone-map", "exposure", "supersample", "threads"]
        {
            assert!(!names.contains(&row), "{row}");
        }
        for row in ["refine-at-rest", "target-fps", "present", "simd"] {
            assert!(!names.contains(&row), "{row}");
        }
        for row in ["visibility", "stride", "fill", "min-weight", "render-scale", "bvh", "shadow-cache", "sphere-cache"]
        {
            assert!(names.contains(&row), "{row}");
        }
    }

    #[test]
    fn changes_are_undone_one_by_one_with_what_hangs_on_them() {
        let base = Settings::exact();
        let changed = Settings { visibility: Visibility::Subsample, stride: 2, min_weight: 0.5, ..base.clone() };
        let undone = with_one_change_undone(&changed, &base);
        let expected = [
            Settings { min_weight: 0.5, ..base.clone() },
            Settings { stride: base.stride, ..changed.clone() },
            Settings { min_weight: base.min_weight, ..changed },
        ];
        assert_eq!(undone, expected);
        assert!(with_one_change_undone(&base, &base).is_empty());
    }

    #[test]
    fn what_is_fixed_stays() {
        let base = Settings { visibility: Visibility::Full, ..Settings::exact() };
        let names = names(&base, &["visibility", "render-scale"]);
        assert!(!names.contains(&"visibility") && !names.contains(&"render-scale") && !names.contains(&"stride"));
    }

    #[test]
    fn products_differ_in_what_has_an_effect() {
        let base = Settings::exact();
        for axis in axes(&base, &[]) {
            let products = axis.products(&base);
            assert_eq!(products[0], base);
            for (i, settings) in products.iter().enumerate() {
                assert!(!products[..i].contains(settings), "{} twice", settings.flags());
                let idle = settings.changed().find(|row| !row.has_effect(settings));
                assert!(idle.is_none(), "{}", settings.flags());
            }
        }
    }
}
