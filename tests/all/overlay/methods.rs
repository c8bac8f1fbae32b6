//! Debug views, two settings side by side, errors and costs.

use super::*;
use raywalk::app::exam::{Exam, RowCost, Subject};
use raywalk::app::maps::{Class, Key, Legend, Map, Scale};
use raywalk::app::methods::{self, Side};
use raywalk::measure::metric::Score;

/// A panel with room for its section on what the methods do.
fn methods_panel(panel: Panel) -> Harness<'static, Panel> {
    let mut harness = panel.harness();
    for section in ["Settings", "Last frame"] {
        harness.get_by_label(section).click();
        harness.run();
    }
    harness
}

#[test]
fn every_map_can_be_chosen_and_the_status_line_says_which() {
    for map in Map::ALL.into_iter().skip(1) {
        let mut harness = methods_panel(Panel::new());
        harness.get_by_label("map").click();
        harness.run();
        harness.get_by_role_and_label(egui::accesskit::Role::Button, map.name()).click();
        harness.run();
        assert_eq!(harness.state().changes, [Change::Methods(methods::Change::Map(map))]);
        harness.get_by_label(&format!("map of {}, full quality, 1 sample", map.name()));
    }
}

#[test]
fn a_legend_says_what_colors_mean_and_goes_with_the_overlay() {
    let class = |name, share| Class { name, color: [200, 100, 0], shares: vec![share] };
    let classes = Key::Classes(vec![class("certified", 0.75), class("traced", 0.25)]);
    let marks = vec![(0.0, "0".to_owned()), (1.0, "255".to_owned())];
    let scale = Key::Scale(Scale { marks, unit: "steps of 255", sums: vec!["max 17, RMSE 0.31".to_owned()] });
    for (map, key, words) in [
        (Map::Decisions, classes, [" 75.0 %", "traced"]),
        (Map::Error, scale, ["error: steps of 255", "max 17, RMSE 0.31"]),
    ] {
        let mut panel = Panel::new();
        panel.methods.map = map;
        panel.methods.legend = Some(Legend { map, key });
        panel.shown.panel = PanelState::Closed;
        let mut harness = panel.harness();
        for words in words {
            harness.get_by_label(words);
        }
        harness.state_mut().showing = Showing::Exact(None);
        harness.run();
        assert!(harness.query_by_label(words[0]).is_none(), "it is not the map that is seen");
        harness.state_mut().showing = Showing::AsSet;
        harness.state_mut().shown.overlay = false;
        harness.run();
        assert!(harness.query_by_label(words[0]).is_none());
    }
}

#[test]
fn two_sides_are_edited_apart_and_told_at_the_divider() {
    let mut harness = methods_panel(Panel::new());
    harness.get_by_label("side by side").click();
    harness.run();
    harness.state_mut().methods.split.milliseconds = [14.24, 61.3];
    harness.get_by_label("Settings").click();
    harness.run();
    harness.get_by_label("balanced | 14.2 ms");
    harness.get_by_label("exact | 61.3 ms");
    harness.get_by_label("right").click();
    harness.run();
    harness.get_by_label("fast").click();
    harness.run();
    assert_eq!(harness.state().settings, Settings::balanced(), "the left side stays");
    assert_eq!(harness.state().methods.split.right, Settings::fast());
    harness.get_by_label("fast | 61.3 ms");
    harness.get_by_label("Copy left to right").click();
    harness.run();
    assert_eq!(harness.state().methods.split.right, Settings::balanced());
    assert_eq!(harness.state().methods.split.edited, Side::Right);
}

#[test]
fn the_divider_is_dragged_with_the_pointer() {
    let mut panel = Panel::new();
    panel.methods.split.is_on = true;
    panel.shown.panel = PanelState::Closed;
    let mut harness = panel.harness();
    harness.run();
    let drag = |harness: &mut Harness<'_, Panel>, from: f32, to: f32| {
        harness.drag_at(egui::pos2(from, 900.0));
        harness.run();
        harness.hover_at(egui::pos2(to, 940.0));
        harness.run();
        harness.drop_at(egui::pos2(to, 940.0));
        harness.run();
        harness.state().methods.split.share()
    };
    let share = drag(&mut harness, 0.5 * WIDTH, 0.7 * WIDTH);
    assert!((share - 0.7).abs() < 0.005, "{share}");
    // Beside the panel it is a share of what the picture has.
    harness.state_mut().shown.panel = PanelState::Open;
    harness.run();
    let at = |share: f32| 380.0 + share * (WIDTH - 380.0);
    let share = drag(&mut harness, at(0.7), at(0.25));
    assert!((share - 0.25).abs() < 0.005, "{share}");
}

#[test]
fn errors_and_costs_are_measured_on_demand() {
    let mut harness = methods_panel(Panel::new());
    harness.get_by_label("Measure errors").click();
    harness.run();
    harness.get_by_label("Measure costs").click();
    harness.run();
    let asked = [methods::Change::MeasureErrors, methods::Change::MeasureCosts].map(Change::Methods);
    assert_eq!(harness.state().changes, asked);

    let mut exam = Exam::new(Subject::Errors, Camera::default(), Settings::balanced(), (16, 9));
    exam.errors = vec![("psnr", Score::Number(47.123))];
    harness.state_mut().methods.exam = Some(exam.clone());
    harness.run();
    harness.get_by_label("47.12 dB");
    harness.get_by_label("Stop measuring").click();
    harness.run();
    assert_eq!(harness.state().changes[2..], [Change::Methods(methods::Change::Stop)]);
    exam.has_ended = true;
    harness.state_mut().methods.exam = Some(exam);
    harness.state_mut().settings = Settings::fast();
    harness.run();
    harness.get_by_label("measured with other settings");
}

#[test]
fn what_a_setting_saves_stands_beside_it_until_settings_change() {
    let mut panel = Panel::new();
    let mut exam = Exam::new(Subject::Costs, Camera::default(), panel.settings.clone(), (16, 9));
    let other = "off".to_owned();
    exam.costs = vec![RowCost { row: "shadow-cache", other, cpu_ms: 62.0, other_ms: 100.0, is_bound: false }];
    exam.has_ended = true;
    panel.methods.exam = Some(exam);
    let mut harness = panel.harness();
    harness.get_by_label("-38 %");
    harness.state_mut().settings.shadows = false;
    harness.run();
    assert!(harness.query_by_label("-38 %").is_none());
}
