//! What stands where in windows of any size.

use super::*;
use raywalk::app::maps::Map;
use raywalk::app::scenes::Oddities;
use raywalk::scene::Warning;
use raywalk::scene::error::Place;

/// A panel in a window of a size in pixels, and of some scale.
fn in_window(panel: Panel, size: [f32; 2], scale: f32) -> Harness<'static, Panel> {
    let mut harness = Harness::builder()
        .with_size(egui::Vec2::from(size) / scale)
        .with_pixels_per_point(scale)
        .with_context_setup(theme::apply)
        .build_ui_state(|ui, panel: &mut Panel| panel.show(ui), panel);
    harness.run();
    harness
}

#[test]
fn the_status_line_is_never_cut_off() {
    for (size, scale) in
        [([640.0, 480.0], 1.0), ([640.0, 480.0], 2.0), ([3840.0, 2160.0], 1.0), ([3840.0, 2160.0], 2.0)]
    {
        for state in [PanelState::Closed, PanelState::Open, PanelState::OverPicture] {
            let mut panel = Panel::new();
            panel.shown.panel = state;
            (panel.methods.split.is_on, panel.methods.map) = (true, Map::Decisions);
            let harness = in_window(panel, size, scale);
            let window = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::Vec2::from(size) / scale);
            let words = "map of decisions, two settings side by side, left full quality, 1 sample";
            for label in ["tracing · balanced · fly · 1.5 m/s", words, "Help"] {
                let place = harness.get_all_by_label(label).next().expect("it is there").rect();
                assert!(window.contains_rect(place), "{label}: {place:?} in {size:?} at {scale}, {state:?}");
            }
        }
    }
}

#[test]
fn the_panel_is_beside_the_picture_where_it_takes_30_percent_of_the_width_at_most() {
    for (size, scale, is_seen) in [
        ([1280.0, 720.0], 1.0, true),
        ([2560.0, 1440.0], 2.0, true),
        ([960.0, 600.0], 1.0, true),
        ([640.0, 480.0], 1.0, false),
        ([1280.0, 720.0], 2.0, false),
    ] {
        let mut harness = in_window(Panel::new(), size, scale);
        let name = "Compare and debug views";
        let section = harness.query_by_label(name).map(|section| section.rect());
        assert_eq!(section.is_some(), is_seen, "{size:?} at {scale}");
        if let Some(section) = section {
            assert!(section.right() <= 0.3 * size[0] / scale, "{section:?} in {size:?} at {scale}");
        }
        harness.state_mut().shown.panel = PanelState::OverPicture;
        harness.run();
        assert!(harness.query_by_label(name).is_some(), "it was asked for");
    }
}

#[test]
fn what_lies_over_the_picture_is_in_its_middle_beside_the_panel() {
    let mut panel = Panel::new();
    panel.hint = 1.0;
    let mut harness = in_window(panel, [1280.0, 720.0], 1.0);
    let middle = |harness: &Harness<'_, Panel>| harness.get_by_label_contains("Click to look").rect().center().x;
    assert!((middle(&harness) - 0.5 * (380.0 + 1280.0)).abs() < 2.0, "{}", middle(&harness));
    harness.state_mut().shown.panel = PanelState::Closed;
    harness.run();
    assert!((middle(&harness) - 640.0).abs() < 2.0, "{}", middle(&harness));
    harness.state_mut().hint = 0.0;
    harness.run();
    assert!(harness.query_by_label_contains("Click to look").is_none());
    (harness.state_mut().hint, harness.state_mut().shown.overlay) = (1.0, false);
    harness.run();
    assert!(harness.query_by_label_contains("Click to look").is_none(), "everything is hidden");
}

#[test]
fn warnings_are_one_line_and_a_list_with_short_paths() {
    let mut odd = scene();
    let place = Place { file: "models/town/town.obj".into(), line_column: Some((3, 1)), pointer: String::new() };
    let message = "cannot read image \"models/town/maps/wall.png\"; a placeholder is shown".to_owned();
    odd.warnings = vec![Warning { place, message }; 7];
    let odd: &'static Scene = Box::leak(Box::new(odd));
    let mut panel = Panel::new();
    panel.report.folder = Some(std::path::Path::new("models/town"));
    panel.report.odd = Some(Oddities { scene: odd, is_list: false });
    let mut harness = in_window(panel, [640.0, 480.0], 1.0);
    let line = harness.get_by_label("7 textures missing ·").rect();
    assert!(line.height() < 24.0, "{line:?}");
    assert!(harness.query_by_label_contains("wall.png").is_none());
    assert_eq!(wish(&mut harness, "Details"), Some(Wish::ToggleWarnings));
    harness.state_mut().report.odd = Some(Oddities { scene: odd, is_list: true });
    harness.run();
    let listed = "town.obj:3:1: cannot read image \"maps/wall.png\"; a placeholder is shown";
    assert_eq!(harness.query_all_by_label(listed).count(), 7);
    assert_eq!(wish(&mut harness, "Dismiss"), Some(Wish::DismissWarnings));
}
