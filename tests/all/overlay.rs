//! The overlay, driven like a user would: no window, no GPU.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use raywalk::app::history::History;
use raywalk::app::input::HELP;
use raywalk::app::overlay::{self, Change, Notices, Showing, Shown, Tuning, View, theme};
use raywalk::app::survey::{End, Point, Survey};
use raywalk::geometry::Geometry;
use raywalk::math::simd;
use raywalk::measure::metric::{METRICS, metric};
use raywalk::measure::tune::Bound;
use raywalk::render::FrameStats;
use raywalk::scene::{Camera, Material, NamedCamera, RenderDefaults, Scene};
use raywalk::settings::{Kind, PRESETS, ROWS, Settings, Supersample, row};
use std::time::{Duration, Instant};

fn scene() -> Scene {
    let named = |name: &str| NamedCamera { name: name.to_owned(), camera: Camera::default() };
    Scene {
        name: "room".to_owned(),
        format: "JSON",
        generation: 1,
        geometry: Geometry::build(Vec::new()),
        build_ms: 0.0,
        objects: Vec::new(),
        materials: vec![Material::default_phong()],
        textures: Vec::new(),
        lights: Vec::new(),
        headlight: true,
        cameras: vec![named("default"), named("door")],
        render: RenderDefaults::default(),
        auto_exposure: 0.0,
        warnings: Vec::new(),
    }
}

/// An overlay with what it shows, and everything that was asked for.
struct Panel {
    scene: Scene,
    settings: Settings,
    history: History,
    stats: FrameStats,
    shown: Shown,
    showing: Showing,
    bound: Bound,
    survey: Option<Survey>,
    notices: Notices,
    changes: Vec<Change>,
}

impl Panel {
    fn new() -> Self {
        let settings = Settings::balanced();
        let shown = Shown::default();
        let (history, showing) = (History::default(), Showing::AsSet);
        let bound = Bound::parse("flip=0.01").expect("right");
        let (stats, notices, changes) = (FrameStats::default(), Notices::default(), Vec::new());
        Self { scene: scene(), settings, history, stats, shown, showing, bound, survey: None, notices, changes }
    }

    fn show(&mut self, ui: &mut egui::Ui) {
        let view = View {
            scene: &self.scene,
            settings: &self.settings,
            stats: &self.stats,
            history: &self.history,
            resting: false,
            size: (1280, 720),
            showing: self.showing,
            speed: 1.5,
            fov: 60.0,
            sensitivity: 0.12,
            invert_look: false,
            ui_scale: 1.0,
            tuning: Tuning {
                bound: self.bound,
                survey: self.survey.as_ref(),
                drawn: &self.settings,
                is_elsewhere: false,
            },
            notices: self.notices.current(),
        };
        let changes = overlay::show(ui, &view, self.shown);
        for change in &changes {
            match change {
                Change::Settings(settings) => self.settings = settings.clone(),
                Change::Bound(bound) => self.bound = *bound,
                _ => {}
            }
        }
        self.changes.extend(changes);
    }

    fn harness(self) -> Harness<'static, Self> {
        Harness::builder()
            .with_size(egui::vec2(800.0, 1400.0))
            .with_context_setup(theme::apply)
            .build_ui_state(|ui, panel: &mut Self| panel.show(ui), self)
    }
}

#[test]
fn showing_changes_nothing() {
    for preset in PRESETS {
        let mut panel = Panel::new();
        panel.settings = (preset.settings)();
        let mut harness = panel.harness();
        harness.run();
        assert_eq!(harness.state().changes, [], "{}", preset.name);
    }
}

#[test]
fn every_setting_has_a_control_that_shows_its_promise() {
    let harness = Panel::new().harness();
    for row in ROWS {
        // What the name labels, and not the name itself; getting it panics when there is none.
        harness.get_all_by_label(row.name).next();
        assert!(row.promise(&(row.get)(&harness.state().settings)).is_some(), "{}", row.name);
    }
    let promises = ["same pixels", "approximate", "different picture"];
    let shown: usize = promises.iter().map(|promise| harness.query_all_by_label(promise).count()).sum();
    assert_eq!(shown, ROWS.len());
}

#[test]
fn every_setting_tells_its_help_where_it_is_pointed_at() {
    for row in ROWS {
        let mut harness = Panel::new().harness();
        let control = harness.get_all_by_label(row.name).next_back().expect("a control");
        control.hover();
        harness.run_steps(30);
        harness.get_by_label(row.help);
    }
}

#[test]
fn the_help_names_every_key_setting_value_and_preset() {
    let mut panel = Panel::new();
    (panel.shown.panel, panel.shown.help) = (false, true);
    let mut harness = panel.harness();
    for (keys, what) in HELP {
        assert!(harness.query_all_by_label(keys).count() > 0 && harness.query_all_by_label(what).count() > 0, "{keys}");
    }
    for row in ROWS {
        harness.get_by_label(row.help);
        assert!(harness.query_all_by_label(row.name).count() > 0, "{}", row.name);
        if let Kind::Choice(choices) = &row.kind {
            for group in choices.chunk_by(|a, b| a.promise == b.promise) {
                let values: Vec<&str> = group.iter().map(|choice| choice.value).collect();
                assert!(harness.query_all_by_label(&values.join(", ")).count() > 0, "{} {values:?}", row.name);
            }
        }
    }
    for preset in PRESETS {
        harness.get_by_label(preset.help);
    }
    for word in ["Certified visibility", "Subsampling", "Caches", "1 % low"] {
        harness.get_by_label(word);
    }
    harness.get_by_label("Close window").click();
    harness.run();
    assert_eq!(harness.state().changes, [Change::ToggleHelp]);
}

#[test]
fn the_help_fits_in_small_windows() {
    for size in [egui::vec2(60.0, 60.0), egui::vec2(200.0, 140.0), egui::vec2(300.0, 200.0), egui::vec2(1280.0, 720.0)]
    {
        let mut panel = Panel::new();
        panel.shown.help = true;
        let mut harness = Harness::builder()
            .with_size(size)
            .with_context_setup(theme::apply)
            .build_ui_state(|ui, panel: &mut Panel| panel.show(ui), panel);
        harness.run();
        let Some(cross) = harness.query_by_label("Close window").map(|cross| cross.rect()) else {
            assert!(size.x < 200.0, "no help in {size}");
            continue;
        };
        assert!(egui::Rect::from_min_size(egui::Pos2::ZERO, size).contains_rect(cross), "{cross:?} in {size}");
    }
}

#[test]
fn panel_and_text_can_be_made_larger() {
    let mut harness = Panel::new().harness();
    let slider = harness.get_all_by_label("panel size").next_back().expect("a slider");
    slider.set_value_accesskit(1.5);
    harness.run();
    assert_eq!(harness.state().changes, [Change::UiScale(1.5)]);
}

#[test]
fn the_slowest_frames_are_told_of() {
    let mut panel = Panel::new();
    let start = Instant::now();
    for i in 0..1000 {
        panel.history.record(start + Duration::from_millis(8) * i, if i == 500 { 200.0 } else { 8.0 });
    }
    let harness = panel.harness();
    harness.get_by_label("median 8.0   p95 8.0   p99 8.0   max 200.0 ms");
    harness.get_by_label("1 % low 36.8 fps");
}

#[test]
fn stages_and_rays_are_bars_that_tell_their_parts() {
    let mut panel = Panel::new();
    panel.stats.stages_ms.visibility = 3.0;
    panel.stats.stages_ms.shadow = 1.0;
    panel.stats.rays.primary = 1000;
    panel.stats.rays.shadow = 3000;
    let mut harness = panel.harness();
    for (bar, told) in
        [("CPU time", "visibility: 3.00 ms, 75 % of the CPU time"), ("rays", "shadow: 3 000, 75 % of the rays")]
    {
        harness.get_by_role_and_label(egui::accesskit::Role::Image, bar).hover();
        harness.run_steps(30);
        harness.get_by_label(told);
    }
}

#[test]
fn every_switch_switches_and_every_choice_can_be_chosen() {
    for row in ROWS {
        let Kind::Choice(choices) = &row.kind else { continue };
        for choice in *choices {
            let panel = Panel::new();
            let mut expected = panel.settings.clone();
            (row.set)(&mut expected, choice.value).expect("a listed value is allowed");
            if expected == panel.settings || !simd::is_available(expected.simd) {
                continue;
            }
            let mut harness = panel.harness();
            harness.get_by_label(row.name).click();
            harness.run();
            if harness.state().changes.is_empty() {
                harness.get_by_role_and_label(egui::accesskit::Role::Button, choice.value).click();
                harness.run();
            }
            assert_eq!(harness.state().changes, [Change::Settings(expected)], "{} {}", row.name, choice.value);
        }
    }
}

#[test]
fn every_number_can_be_set() {
    for row in ROWS {
        let Kind::Number { max, .. } = row.kind else { continue };
        let mut harness = Panel::new().harness();
        let control = harness.get_all_by_label(row.name).next_back().expect("a control");
        control.set_value_accesskit(max);
        harness.run();
        let text = (row.get)(&harness.state().settings);
        assert_eq!(text.parse::<f64>().ok(), Some(max), "{}", row.name);
    }
}

#[test]
fn a_preset_sets_everything() {
    for preset in PRESETS {
        let mut harness = Panel::new().harness();
        harness.get_by_label(preset.name).click();
        harness.run();
        assert_eq!(harness.state().settings, (preset.settings)(), "{}", preset.name);
    }
}

#[test]
fn a_preset_is_marked_even_where_the_scene_or_the_machine_decides() {
    let mut panel = Panel::new();
    panel.settings = Settings { depth: Some(panel.scene.render.max_depth), threads: 3, ..Settings::balanced() };
    let marked = |harness: &Harness<'_, Panel>, name| {
        harness.get_by_label(name).accesskit_node().toggled() == Some(egui::accesskit::Toggled::True)
    };
    let mut harness = panel.harness();
    assert!(marked(&harness, "balanced") && !marked(&harness, "exact"));
    harness.get_by_label("exact").click();
    harness.run();
    assert!(marked(&harness, "exact") && !marked(&harness, "balanced"));
    assert_eq!(harness.state().settings.threads, 3, "the machine's share stays");
}

#[test]
fn cameras_speed_and_view_answer() {
    let mut harness = Panel::new().harness();
    harness.get_by_label("door").click();
    harness.run();
    harness.get_by_label("start").click();
    harness.run();
    harness.get_by_label("invert look").click();
    harness.run();
    harness.get_by_label("Hide panel").click();
    harness.run();
    let expected = [Change::Camera(1), Change::Home, Change::InvertLook(true), Change::TogglePanel];
    assert_eq!(harness.state().changes, expected);
}

#[test]
fn the_status_line_says_rate_time_and_size() {
    let mut panel = Panel::new();
    let start = Instant::now();
    for i in 0..100 {
        panel.history.record(start + Duration::from_millis(16) * i, 14.2);
    }
    panel.shown.panel = false;
    let mut harness = panel.harness();
    harness.get_by_label("62 fps | 14.2 ms | 1280x720");
    assert!(harness.query_by_label(ROWS[0].name).is_none(), "the panel is closed");
    harness.state_mut().shown.overlay = false;
    harness.run();
    assert!(harness.query_by_label_contains("1280x720").is_none(), "everything is hidden");
}

#[test]
fn notices_are_read_even_when_all_else_is_hidden() {
    let mut panel = Panel::new();
    panel.shown.overlay = false;
    panel.notices.tell(Instant::now(), "camera copied");
    panel.notices.warn(Instant::now(), "what was pasted is no camera: ".repeat(12));
    let harness = panel.harness();
    harness.get_by_label("camera copied");
    let long = harness.get_by_label_contains("what was pasted").rect();
    assert!(long.width() < 700.0 && long.height() > 30.0, "it breaks into lines: {long:?}");
    assert!(long.bottom() < 1400.0);
}

#[test]
fn what_the_picture_is_stands_below_the_status_line() {
    let sixteen = Settings { supersample: Supersample::Grid { side: 4 }, ..Settings::exact() };
    for (showing, settings, words) in [
        (Showing::AsSet, Settings::exact(), "as set: 1 sample"),
        (Showing::AsSet, sixteen.clone(), "as set: supersample 16"),
        (Showing::Moving { preset: Some("fast"), scale: 0.7 }, sixteen, "moving: fast, scale 0.7"),
        (Showing::Moving { preset: Some("balanced"), scale: 1.0 }, Settings::exact(), "moving: balanced"),
        (Showing::Moving { preset: None, scale: 0.5 }, Settings::fast(), "moving: scale 0.5"),
        (Showing::Refined(9), Settings::exact(), "refined 9/16"),
        (Showing::Refined(16), Settings::exact(), "at rest: 16 samples"),
    ] {
        let mut panel = Panel::new();
        (panel.showing, panel.settings, panel.shown.panel) = (showing, settings, false);
        panel.harness().get_by_label(words);
    }
}

#[test]
fn a_preset_keeps_what_is_the_windows_own() {
    let mut panel = Panel::new();
    let (refine_at_rest, target_fps) = (true, Some(30));
    panel.settings = Settings { refine_at_rest, target_fps, ..Settings::balanced() };
    let mut harness = panel.harness();
    harness.get_by_label("exact").click();
    harness.run();
    assert_eq!(harness.state().settings, Settings { refine_at_rest, target_fps, ..Settings::exact() });
}

#[test]
fn an_approximate_value_is_told_from_an_exact_one() {
    let visibility = row("visibility").expect("it is listed");
    let count = |harness: &Harness<'_, Panel>| harness.query_all_by_label("approximate").count();
    let mut panel = Panel::new();
    panel.settings = Settings::exact();
    let mut harness = panel.harness();
    let before = count(&harness);
    (visibility.set)(&mut harness.state_mut().settings, "subsample").expect("a listed value is allowed");
    harness.run();
    assert_eq!(count(&harness), before + 1);
}

/// A panel with its section on time and error open.
fn tuning(survey: Option<Survey>) -> Harness<'static, Panel> {
    let mut panel = Panel::new();
    panel.survey = survey;
    let mut harness = panel.harness();
    assert!(harness.query_by_label("Measure front").is_none(), "closed at first");
    // What is above is closed, so that there is room.
    for section in ["Settings", "Last frame", "Time against error"] {
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
    harness.get_by_label("Measure front").click();
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
    harness.get_by_label("nothing keeps the bound");
    harness.state_mut().settings = Settings { stride: 2, ..Settings::balanced() };
    harness.run();
    harness.get_by_label("the settings on display are not measured");
}
