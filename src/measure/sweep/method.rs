//! The methods that benches compare: settings with a name.

use crate::settings::{Fill, Settings, SimdLevel, SphereCache, Visibility};

/// Settings with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// Methods of one family share a colour and a mark in charts.
    pub family: &'static str,
    /// Unique within its chart.
    pub name: String,
    /// The settings.
    pub settings: Settings,
}

impl Method {
    /// Whether others are held against it: such a frame is waited for, however long it takes.
    pub fn is_measure(&self) -> bool {
        matches!(self.name.as_str(), "full" | "exact")
    }
}

/// Changes settings.
pub type Change = fn(&mut Settings);

/// A family, a name, and what is changed; the last column says whether a quick sweep has it.
type Entry = (&'static str, &'static str, Change, bool);

/// What a sweep tries, the reference first.
const SWEEP: &[Entry] = &[
    ("full", "full", full, true),
    ("exact", "exact", exact, true),
    ("exact", "min-weight 1/512", |s| s.min_weight = 1.0 / 512.0, false),
    ("exact", "min-weight 1/64", |s| s.min_weight = 1.0 / 64.0, false),
    ("exact", "min-weight 1/16", |s| s.min_weight = 1.0 / 16.0, false),
    ("difference cache", "difference cache", |s| s.sphere_cache = SphereCache::Difference, true),
    ("balanced", "balanced", balanced, true),
    ("balanced", "interpolated light", |s| s.fill = Fill::Color, false),
    ("hit", "hit 2", |s| subsample(s, Fill::Hit, 2), true),
    ("hit", "hit 4", |s| subsample(s, Fill::Hit, 4), false),
    ("hit", "hit 8", |s| subsample(s, Fill::Hit, 8), true),
    ("hit", "hit 16", |s| subsample(s, Fill::Hit, 16), true),
    ("color", "color 2", |s| subsample(s, Fill::Color, 2), true),
    ("color", "color 4", |s| subsample(s, Fill::Color, 4), false),
    ("color", "color 8", |s| subsample(s, Fill::Color, 8), true),
    ("color", "color 16", |s| subsample(s, Fill::Color, 16), true),
    ("fast", "fast", fast, true),
];

/// What stability curves show.
const STABILITY: &[Entry] = &[
    ("full", "full", full, true),
    ("exact", "exact", exact, true),
    ("balanced", "balanced", balanced, true),
    ("hit", "hit 2", |s| subsample(s, Fill::Hit, 2), true),
    ("hit", "hit 4", |s| subsample(s, Fill::Hit, 4), false),
    ("hit", "hit 8", |s| subsample(s, Fill::Hit, 8), true),
    ("hit", "hit 16", |s| subsample(s, Fill::Hit, 16), false),
    ("color", "color 2", |s| subsample(s, Fill::Color, 2), false),
    ("color", "color 8", |s| subsample(s, Fill::Color, 8), true),
    ("fast", "fast", fast, true),
    ("difference cache", "difference cache", |s| s.sphere_cache = SphereCache::Difference, true),
];

/// What is followed along a path.
const WALK: &[Entry] = &[
    ("exact", "exact", exact, true),
    ("balanced", "balanced", balanced, true),
    ("hit", "hit 8", |s| subsample(s, Fill::Hit, 8), true),
    ("color", "color 8", |s| subsample(s, Fill::Color, 8), true),
    ("fast", "fast", fast, true),
];

/// An optimisation that keeps the picture: its name, and how it is taken away.
pub const OPTIMISATIONS: &[(&str, Change)] = &[
    ("certified visibility", |s| s.visibility = Visibility::Full),
    ("bounding volumes", |s| s.bvh = false),
    ("shadow-object cache", |s| s.shadow_cache = false),
    ("cached sphere terms", |s| s.sphere_cache = SphereCache::Off),
    ("SIMD", |s| s.simd = SimdLevel::Off),
    ("threads", |s| s.threads = 1),
];

fn subsample(settings: &mut Settings, fill: Fill, stride: u32) {
    settings.visibility = Visibility::Subsample;
    settings.fill = fill;
    settings.stride = stride;
}

/// What errors are held against.
fn full(settings: &mut Settings) {
    *settings = settings.reference();
}

/// Every pixel as `full` has it, whatever else is approximated.
fn exact(settings: &mut Settings) {
    *settings = settings.without_approximations();
}

fn balanced(settings: &mut Settings) {
    settings.take_changes(&Settings::balanced(), |_| true);
}

fn fast(settings: &mut Settings) {
    settings.take_changes(&Settings::fast(), |_| true);
}

fn made_of(entries: &[Entry], base: &Settings, quick: bool) -> Vec<Method> {
    let wanted = entries.iter().filter(|(.., in_quick)| *in_quick || !quick);
    let method = |&(family, name, change, _): &Entry| {
        let mut settings = base.clone();
        change(&mut settings);
        Method { family, name: name.to_owned(), settings }
    };
    wanted.map(method).collect()
}

/// The methods of a sweep over settings, each `base` with a change; `full` and `exact` without what `base` approximates.
pub fn sweep_methods(base: &Settings, quick: bool) -> Vec<Method> {
    made_of(SWEEP, base, quick)
}

/// The methods of stability curves.
pub fn stability_methods(base: &Settings, quick: bool) -> Vec<Method> {
    made_of(STABILITY, base, quick)
}

/// The methods of a walk.
pub fn walk_methods(base: &Settings) -> Vec<Method> {
    made_of(WALK, base, false)
}

/// `base` with the optimisations that are `kept`, by their places in the list.
fn with_optimisations(base: &Settings, name: String, kept: impl Fn(usize) -> bool) -> Method {
    let mut settings = base.clone();
    OPTIMISATIONS.iter().enumerate().filter(|(i, _)| !kept(*i)).for_each(|(_, (_, off))| off(&mut settings));
    Method { family: "exact", name, settings }
}

/// No optimisation, then each alone.
pub fn optimisations_alone(base: &Settings) -> Vec<Method> {
    let none = with_optimisations(base, "none".to_owned(), |_| false);
    let each = OPTIMISATIONS.iter().enumerate();
    let only = each.map(|(i, (name, _))| with_optimisations(base, format!("only {name}"), |other| other == i));
    [none].into_iter().chain(only).collect()
}

/// All optimisations, then all but each.
pub fn optimisations_taken_away(base: &Settings) -> Vec<Method> {
    let all = with_optimisations(base, "all".to_owned(), |_| true);
    let each = OPTIMISATIONS.iter().enumerate();
    let without = each.map(|(i, (name, _))| with_optimisations(base, format!("without {name}"), |other| other != i));
    [all].into_iter().chain(without).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_settings_differ() {
        let base = Settings::exact();
        for methods in [sweep_methods(&base, false), stability_methods(&base, false), walk_methods(&base)] {
            for (i, method) in methods.iter().enumerate() {
                for other in &methods[..i] {
                    assert_ne!(method.name, other.name);
                    assert_ne!(method.settings, other.settings, "{} and {}", method.name, other.name);
                }
            }
        }
        let (alone, taken_away) = (optimisations_alone(&base), optimisations_taken_away(&base));
        assert_eq!((alone.len(), taken_away.len()), (1 + OPTIMISATIONS.len(), 1 + OPTIMISATIONS.len()));
        assert_eq!(taken_away[0].settings, base);
    }

    #[test]
    fn presets_are_what_they_are_elsewhere_and_keep_what_was_asked_for() {
        let base = Settings { shadows: false, ..Settings::exact() };
        let methods = sweep_methods(&base, false);
        let fast = methods.iter().find(|method| method.name == "fast").expect("listed");
        assert_eq!(fast.settings, Settings { shadows: false, ..Settings::fast() });
        assert_eq!(base.flags(), "--shadows off");
    }

    #[test]
    fn full_and_exact_are_what_they_are_called_whatever_they_begin_from() {
        let base = Settings { shadows: false, ..Settings::fast() };
        let exact = Settings { shadows: false, ..Settings::exact() };
        for methods in [sweep_methods(&base, true), stability_methods(&base, true), walk_methods(&base)] {
            for method in methods {
                match method.name.as_str() {
                    "full" => assert_eq!(method.settings, exact.reference()),
                    "exact" => assert_eq!(method.settings, exact),
                    _ => {}
                }
            }
        }
    }
}
