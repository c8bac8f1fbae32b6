//! The search for the cheapest settings that are good enough.

use super::*;
use raywalk::app::survey::{End, Point};
use raywalk::measure::metric::{METRICS, metric};

/// A panel with its section on time and error open.
fn tuning(survey: Option<Survey>) -> Harness<'static, Panel> {
    let mut panel = Panel::new();
    panel.survey = survey;
    let mut harness = panel.harness();
    assert!(harness.query_by_label("Plot speed against error").is_none(), "closed at first");
    // What is above is closed, so that there is room.
    for section in ["Settings", "Last frame", "Compare and debug views", "Auto-tune"] {
        harness.get_by_label(section).click();
        harness.run();
    }
    harness
}

fn survey(share: f64, end: Option<End>) -> Survey {
    let point = |settings, cpu_ms, error| Point { settings, cpu_ms, score: error, error };
    let mut survey = Survey::new(Camera::default(), Bound::parse("flip=0.05").expect("right"));
    (survey.share, survey.end) = (share, end);
    survey.points = vec![point(Settings::exact(), 80.0, 0.0), point(Settings::fast(), 40.0, 0.04)];
    survey
}

#[test]
fn a_search_is_asked_for_with_a_bound_and_without() {
    let mut harness = tuning(None);
    harness.get_by_label("Tune for this view").click();
    harness.run();
    harness.get_by_label("Plot speed against error").click();
    harness.run();
    let flip = metric("flip").expect("listed");
    let expected = [Change::Search(harness.state().bound), Change::Search(Bound::none(flip))];
    assert_eq!(harness.state().changes, expected);
}

#[test]
fn every_metric_can_be_the_bound() {
    for metric in METRICS.iter().filter(|metric| metric.name != "flip") {
        let mut harness = tuning(None);
        harness.get_by_label("error").click();
        harness.run();
        harness.get_by_role_and_label(egui::accesskit::Role::Button, metric.name).click();
        harness.run();
        let bound = harness.state().bound;
        assert_eq!(bound.metric.name, metric.name);
        assert!(bound.can_hold() && bound.limit.is_finite());
    }
}

#[test]
fn a_search_under_way_can_be_stopped() {
    let mut harness = tuning(Some(survey(0.4, None)));
    assert!(harness.query_by_label("Tune for this view").is_none());
    harness.get_by_label("Stop").click();
    harness.run();
    assert_eq!(harness.state().changes, [Change::StopSearch]);
}

#[test]
fn what_was_found_can_be_applied_and_keeps_what_is_the_windows_own() {
    let mut harness = tuning(Some(survey(1.0, Some(End::Found { place: 1, simpler: true }))));
    harness.state_mut().settings = Settings { refine_at_rest: true, target_fps: Some(30), ..Settings::exact() };
    harness.run();
    harness.get_by_label(&Settings::fast().flags());
    harness.get_by_label_contains("within noise");
    harness.get_by_label("time against error");
    harness.get_by_label("Apply").click();
    harness.run();
    let applied = Settings { refine_at_rest: true, target_fps: Some(30), ..Settings::fast() };
    assert_eq!(harness.state().changes, [Change::Settings(applied)]);
    harness.get_by_label("Applied");
    harness.get_by_label("ring: the settings on display");
}

#[test]
fn a_front_without_a_find_says_so() {
    let mut harness = tuning(Some(survey(1.0, Some(End::Nothing))));
    harness.get_by_label("No settings met this limit");
    harness.state_mut().settings = Settings { stride: 2, ..Settings::balanced() };
    harness.run();
    harness.get_by_label("the settings on display are not measured");
}
