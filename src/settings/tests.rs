//! Tests of the list of settings.

use super::*;

#[test]
fn names_are_unique_and_every_value_survives_a_round_trip() {
    for (i, row) in ROWS.iter().enumerate() {
        assert!(ROWS[..i].iter().all(|r| r.name != row.name), "{} twice", row.name);
        for preset in PRESETS {
            let settings = (preset.settings)();
            let text = (row.get)(&settings);
            let mut copy = settings.clone();
            (row.set)(&mut copy, &text).expect("a printed value can be typed");
            assert_eq!(copy, settings, "{} = {text}", row.name);
        }
        if let Kind::Choice(choices) = &row.kind {
            for choice in *choices {
                let mut settings = Settings::default();
                (row.set)(&mut settings, choice.value).expect("a listed value is accepted");
                assert_eq!((row.get)(&settings), choice.value);
            }
        }
        assert!((row.set)(&mut Settings::default(), "nonsense").is_err());
    }
}

#[test]
fn numbers_outside_their_range_are_refused() {
    let threshold = row("match-threshold").expect("it is listed");
    let mut settings = Settings::default();
    assert!((threshold.set)(&mut settings, "16/255").is_ok());
    for bad in ["-1", "2", "nan", "1/0", "inf", ""] {
        assert!((threshold.set)(&mut settings, bad).is_err(), "{bad}");
    }
}

#[test]
fn former_names_of_values_still_set_them_and_are_not_shown() {
    let row = row("sphere-cache").expect("it is listed");
    let mut settings = Settings::default();
    (row.set)(&mut settings, "thesis").expect("the former name of difference");
    assert_eq!(settings.sphere_cache, SphereCache::Difference);
    assert_eq!((row.get)(&settings), "difference");
    let error = (row.set)(&mut settings, "nonsense").expect_err("no value");
    assert!(error.contains("difference") && !error.contains("thesis"), "{error}");
}
