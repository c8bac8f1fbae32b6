//! The overlay, driven like a user would: no window, no GPU.

mod methods;
mod tuning;
mod window;

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use raywalk::app::history::History;
use raywalk::app::input::HELP;
use raywalk::app::inspection::Inspection;
use raywalk::app::labels::Labels;
use raywalk::app::lighting::Dial;
use raywalk::app::methods::Methods;
use raywalk::app::overlay::{self, Change, Notices, Panel as PanelState, Showing, Shown, Tuning, View, theme};
use raywalk::app::scenes::{Failure, Loading, Report, Wish};
use raywalk::app::surroundings::{self, Surroundings};
use raywalk::app::survey::Survey;
use raywalk::geometry::{Aabb, Geometry};
use raywalk::math::simd;
use raywalk::measure::tune::Bound;
use raywalk::render::FrameStats;
use raywalk::scene::progress::Step;
use raywalk::scene::{Camera, Material, NamedCamera, RenderDefaults, Scene};
use raywalk::settings::{Kind, PRESETS, ROWS, Settings, Supersample, row};
use std::sync::Arc;
use std::time::{Duration, Instant};

fn scene() -> Scene {
    let named = |name: &str| NamedCamera { name: name.to_owned(), camera: Camera::default() };
    Scene {
        name: "room".to_owned(),
        format: "JSON",
        generation: 1,
        start: raywalk::scene::Start::AT_CAMERA,
        geometry: Arc::new(Geometry::build(Vec::new())),
        contacts: Arc::default(),
        build_ms: 0.0,
        origin: glam::DVec3::ZERO,
        objects: Vec::new().into(),
        materials: vec![Material::default_phong()],
        textures: Vec::new(),
        lights: Vec::new(),
        headlight: true,
        cameras: vec![named("default"), named("door")],
        environment: None,
        render: RenderDefaults::default(),
        auto_exposure: 0.0,
        warnings: Vec::new(),
    }
}

/// Width of the window in points: there is room for the panel beside the picture.
const WIDTH: f32 = 1280.0;

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
    report: Report<'static>,
    lights: Vec<Dial>,
    surroundings: Surroundings,
    inspection: Option<Inspection>,
    notices: Notices,
    hint: f32,
    labels: Labels,
    methods: Methods,
    changes: Vec<Change>,
}

impl Panel {
    fn new() -> Self {
        let settings = Settings::balanced();
        let shown = Shown { panel: PanelState::Open, ..Shown::default() };
        let (history, showing) = (History::default(), Showing::AsSet);
        let bound = Bound::parse("flip=0.01").expect("right");
        let methods = Methods::new(&settings);
        Self {
            scene: scene(),
            settings,
            history,
            stats: FrameStats::default(),
            shown,
            showing,
            bound,
            survey: None,
            report: Report::default(),
            lights: Vec::new(),
            surroundings: Surroundings::default(),
            inspection: None,
            notices: Notices::default(),
            hint: 0.0,
            labels: Labels::default(),
            methods,
            changes: Vec::new(),
        }
    }

    fn show(&mut self, ui: &mut egui::Ui) {
        let view = View {
            scene: &self.scene,
            settings: self.methods.edited(&self.settings),
            stats: &self.stats,
            history: &self.history,
            resting: false,
            refining: false,
            size: (1280, 720),
            showing: self.showing,
            walking: false,
            eye_height: 1.6,
            speed: 1.5,
            fov: 60.0,
            sensitivity: 0.12,
            invert_look: false,
            ui_scale: 1.0,
            methods: &self.methods,
            left: &self.settings,
            tuning: Tuning {
                bound: self.bound,
                survey: self.survey.as_ref(),
                drawn: &self.settings,
                is_elsewhere: false,
            },
            scenes: self.report.clone(),
            lights: &self.lights,
            surroundings: &self.surroundings,
            inspection: self.inspection.as_ref(),
            stands: Some(Camera::default()),
            crosshair: true,
            notices: self.notices.current(),
            hint: self.hint,
            labels: &self.labels,
            activity: None,
        };
        let changes = overlay::show(ui, &view, self.shown);
        for change in &changes {
            match change {
                Change::Settings(settings) if self.methods.edits_right() => self.methods.split.right = settings.clone(),
                Change::Methods(change) => self.methods.apply(change, &self.settings),
                Change::Settings(settings) => self.settings = settings.clone(),
                Change::Bound(bound) => self.bound = *bound,
                _ => {}
            }
        }
        self.changes.extend(changes);
    }

    fn harness(self) -> Harness<'static, Self> {
        Harness::builder()
            .with_size(egui::vec2(WIDTH, 1400.0))
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
    (panel.shown.panel, panel.shown.help) = (PanelState::Closed, true);
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
fn the_keys_can_be_read_in_narrow_windows_and_at_every_size_of_the_text() {
    for (size, scale) in [((640.0, 420.0), 1.0), ((640.0, 420.0), 2.0), ((640.0, 420.0), 3.0), ((320.0, 400.0), 1.0)] {
        let mut panel = Panel::new();
        (panel.shown.panel, panel.shown.help) = (PanelState::Closed, true);
        let size = egui::Vec2::from(size) / scale;
        let mut harness = Harness::builder()
            .with_size(size)
            .with_pixels_per_point(scale)
            .with_context_setup(theme::apply)
            .build_ui_state(|ui, panel: &mut Panel| panel.show(ui), panel);
        harness.run();
        let window = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
        let (keys, what) = HELP[0];
        for label in [keys, what, "Close window"] {
            let place = harness.get_all_by_label(label).next_back().expect("it is there").rect();
            assert!(window.contains_rect(place), "{label}: {place:?} in {size}");
        }
        for (keys, what) in HELP {
            for label in [keys, what] {
                // Further ones are below: they are scrolled to.
                let place = harness.get_all_by_label(label).next_back().expect("it is there").rect();
                assert!(place.left() >= 0.0 && place.right() <= size.x, "{label}: {place:?} in {size}");
            }
        }
    }
}

#[test]
fn notices_are_whole_however_many_there_are() {
    let mut harness = Panel::new().harness();
    let window = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(WIDTH, 1400.0));
    // The picture is right of the panel.
    let middle = 0.5 * (380.0 + WIDTH);
    let mut lowest = f32::NAN;
    for text in ["There is no bookmark 5", "There is no bookmark 6, and that takes more words than the first"] {
        harness.state_mut().notices.warn(Instant::now(), text);
        // One drawing, after which nothing else happens.
        harness.step();
        let place = harness.get_by_label(text).rect();
        assert!(window.contains_rect(place) && (place.center().x - middle).abs() < 300.0, "{text}: {place:?}");
        assert!(lowest.is_nan() || (place.bottom() - lowest).abs() < 1.0, "{text}: {place:?}, the first at {lowest}");
        lowest = place.bottom();
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
fn the_status_line_says_rate_preset_way_and_speed_and_the_panel_time_and_size() {
    let mut panel = Panel::new();
    let start = Instant::now();
    for i in 0..100 {
        panel.history.record(start + Duration::from_millis(16) * i, 14.2);
    }
    let mut harness = panel.harness();
    harness.get_by_label("62 fps · balanced · fly · 1.5 m/s");
    harness.get_by_label("14.2 ms · 1280x720");
    harness.state_mut().shown.panel = PanelState::Closed;
    harness.run();
    harness.get_by_label("62 fps · balanced · fly · 1.5 m/s");
    assert!(harness.query_by_label(ROWS[0].name).is_none(), "the panel is closed");
    harness.state_mut().shown.overlay = false;
    harness.run();
    assert!(harness.query_by_label_contains("62 fps").is_none(), "everything is hidden");
}

#[test]
fn walking_is_switched_and_keys_have_the_users_names() {
    let mut panel = Panel::new();
    let z = winit::keyboard::Key::Character("z".into());
    panel.labels.learn(winit::keyboard::PhysicalKey::Code(winit::keyboard::KeyCode::KeyW), &z);
    let mut harness = panel.harness();
    harness.get_by_label("walk").click();
    harness.run();
    assert_eq!(harness.state().changes, [Change::Walking(true)]);
    for section in ["Settings", "Last frame", "Keys"] {
        harness.get_by_label(section).click();
        harness.run();
    }
    harness.get_by_label("Z A S D, arrows");
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
        (Showing::AsSet, Settings::exact(), "full quality, 1 sample"),
        (Showing::AsSet, sixteen.clone(), "full quality, supersample 16"),
        (Showing::Moving { preset: Some("fast"), scale: 0.7 }, sixteen, "moving: fast, scale 0.7"),
        (Showing::Moving { preset: Some("balanced"), scale: 1.0 }, Settings::exact(), "moving: balanced"),
        (Showing::Moving { preset: None, scale: 0.5 }, Settings::fast(), "moving: scale 0.5"),
        (Showing::Refined(9), Settings::exact(), "refined 9/16"),
        (Showing::Refined(16), Settings::exact(), "at rest: 16 samples"),
        (Showing::Exact(None), Settings::fast(), "the exact picture, while X is held"),
        (Showing::Exact(Some(16)), Settings::fast(), "the exact picture, 16 samples, while X is held"),
        (Showing::ExactSoon, Settings::fast(), "tracing the exact picture"),
    ] {
        let mut panel = Panel::new();
        (panel.showing, panel.settings, panel.shown.panel) = (showing, settings, PanelState::Closed);
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

/// What clicking on something asks for.
fn wish(harness: &mut Harness<'_, Panel>, label: &str) -> Option<Wish> {
    harness.get_by_label(label).click();
    harness.run();
    match harness.state_mut().changes.pop() {
        Some(Change::Scenes(wish)) => Some(wish),
        _ => None,
    }
}

#[test]
fn a_load_is_shown_and_can_be_stopped_even_where_the_overlay_is_hidden() {
    let mut panel = Panel::new();
    panel.shown.overlay = false;
    let step = Step { what: "decoding textures".to_owned(), done: 3, of: 15 };
    panel.report.loading = Some(Loading { name: "helmet.gltf".to_owned(), step, seconds: 2.0 });
    let mut harness = panel.harness();
    harness.run();
    harness.get_by_label("Loading helmet.gltf");
    harness.get_by_label("decoding textures: 3 of 15");
    assert_eq!(wish(&mut harness, "Cancel"), Some(Wish::Cancel));
}

#[test]
fn a_failure_says_where_and_stays_until_it_is_dismissed() {
    let failure: &'static Failure = Box::leak(Box::new(Failure {
        title: "room.json could not be opened".to_owned(),
        message: "scenes/room.json:3:7 (/objects/0): missing radius".to_owned(),
        file: Some("scenes/room.json".into()),
    }));
    let mut panel = Panel::new();
    panel.report.failure = Some(failure);
    let mut harness = panel.harness();
    harness.run();
    harness.get_by_label(&failure.title);
    harness.get_by_label(&failure.message);
    assert_eq!(wish(&mut harness, "Try again"), Some(Wish::OpenFile("scenes/room.json".into())));
    assert_eq!(wish(&mut harness, "Dismiss"), Some(Wish::DismissFailure));
}

#[test]
fn scenes_opened_before_are_opened_again() {
    let recent: &'static [std::path::PathBuf] = Box::leak(Box::new(["/scenes/hall.glb".into(), "/b.obj".into()]));
    let mut panel = Panel::new();
    panel.report.recent = recent;
    panel.report.blind = Some("changes in /scenes are not noticed: too many watches");
    let mut harness = panel.harness();
    harness.get_by_label("Scene").click();
    harness.run();
    harness.get_by_label("changes in /scenes are not noticed: too many watches");
    assert_eq!(wish(&mut harness, "hall.glb"), Some(Wish::OpenFile("/scenes/hall.glb".into())));
    assert_eq!(wish(&mut harness, "Open..."), Some(Wish::Open));
    assert_eq!(wish(&mut harness, "Reload"), Some(Wish::Reload));
}

#[test]
fn an_environment_is_chosen_turned_and_hidden() {
    let ask = |harness: &mut Harness<'_, Panel>| match harness.state_mut().changes.pop() {
        Some(Change::Environment(change)) => change,
        other => panic!("{other:?}"),
    };
    let mut harness = Panel::new().harness();
    harness.get_by_label("Environment").click();
    harness.run();
    harness.get_by_label_contains("drop an .hdr or .exr picture");
    harness.get_by_label("Studio").click();
    harness.run();
    assert_eq!(ask(&mut harness), surroundings::Change::Studio);
    let mut panel = Panel::new();
    panel.surroundings.apply(surroundings::Change::Studio);
    let (rotation, intensity) = (270.0, 250.0);
    panel.surroundings.apply(surroundings::Change::Turn { rotation, intensity, backdrop: true });
    let mut harness = panel.harness();
    harness.get_by_label("Environment").click();
    harness.run();
    harness.get_by_label("studio, rotation 270, intensity 250");
    assert_eq!(harness.state().changes, [], "showing turns nothing, even what no slider reaches");
    harness.get_by_role_and_label(egui::accesskit::Role::CheckBox, "Backdrop").click();
    harness.run();
    assert_eq!(ask(&mut harness), surroundings::Change::Turn { rotation, intensity, backdrop: false });
    for (button, change) in [("None", surroundings::Change::None), ("As in the file", surroundings::Change::Reset)] {
        harness.get_by_label(button).click();
        harness.run();
        assert_eq!(ask(&mut harness), change);
    }
}

#[test]
fn lights_are_switched_one_by_one() {
    let dial = |name: &str| Dial { name: name.to_owned(), on: true, intensity: 1.0, kelvin: 6500.0 };
    let mut panel = Panel::new();
    panel.lights = vec![dial("key"), Dial { intensity: 2.0, ..dial("fill") }];
    let mut harness = panel.harness();
    harness.get_by_label("Lights").click();
    harness.run();
    assert_eq!(harness.state().changes, [], "showing turns nothing");
    harness.get_by_role_and_label(egui::accesskit::Role::CheckBox, "fill").click();
    harness.run();
    let off = Dial { on: false, intensity: 2.0, ..dial("fill") };
    assert_eq!(harness.state_mut().changes.pop(), Some(Change::Light(1, off)));
    harness.get_by_label("As in the file").click();
    harness.run();
    assert_eq!(harness.state_mut().changes.pop(), Some(Change::ResetLights));
}

#[test]
fn a_thing_that_was_pointed_at_is_told_of() {
    let mut panel = Panel::new();
    panel.inspection = Some(Inspection {
        title: "ball".to_owned(),
        facts: vec![("material", "gold".to_owned())],
        point: glam::Vec3::Z,
        bounds: Aabb { min: glam::Vec3::NEG_ONE, max: glam::Vec3::ONE },
    });
    let mut harness = panel.harness();
    harness.run();
    for label in ["ball", "distance", "4 m", "material", "gold"] {
        harness.get_by_label(label);
    }
    harness.get_by_label("Close").click();
    harness.run();
    assert_eq!(harness.state_mut().changes.pop(), Some(Change::CloseInspection));
}
