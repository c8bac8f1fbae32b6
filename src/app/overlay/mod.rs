//! The overlay: a pure function of what there is to see, answering with what the user asked to change.
//!
//! Architecture invariant: nothing here knows of a window, a device or a thread, so all of it is tested
//! without any of them.

mod bars;
mod controls;
mod divider;
mod environment;
mod figures;
mod graph;
mod help;
mod inspection;
mod legend;
mod lights;
mod methods;
pub mod notice;
mod placing;
mod scenes;
pub mod theme;
mod tuning;

pub use notice::{Notice, Notices};
pub use tuning::{Tuning, usual_bound};

use super::at_rest::SAMPLES;
use super::history::History;
use super::inspection::Inspection;
use super::labels::Labels;
use super::lighting::Dial;
use super::maps::Map;
use super::methods::{self as seen, Methods};
use super::scenes::{Report, Wish};
use super::surroundings::{self, Surroundings};
use crate::measure::tune::Bound;
use crate::render::FrameStats;
use crate::scene::{Camera, Scene};
use crate::settings::{PRESETS, Preset, Settings, row};
use egui::{CollapsingHeader, RichText, Ui};

/// Width of the panel's contents in points.
const WIDTH: f32 = 336.0;
/// Distance from the window's edge in points.
const MARGIN: f32 = 8.0;

/// Everything the overlay shows.
#[derive(Debug)]
pub struct View<'a> {
    /// What is walked through.
    pub scene: &'a Scene,
    /// How frames are traced.
    pub settings: &'a Settings,
    /// What the last frame cost.
    pub stats: &'a FrameStats,
    /// Frame times.
    pub history: &'a History,
    /// Nothing was traced for a while.
    pub resting: bool,
    /// The view at rest is being refined.
    pub refining: bool,
    /// Size of the traced picture in pixels.
    pub size: (u32, u32),
    /// What the picture is.
    pub showing: Showing,
    /// On foot and not flying.
    pub walking: bool,
    /// Height of the eye above the floor in metres, on foot.
    pub eye_height: f64,
    /// Speed in metres a second.
    pub speed: f64,
    /// Vertical field of view in degrees.
    pub fov: f32,
    /// Degrees of turn per count of the mouse.
    pub sensitivity: f64,
    /// Mouse forward looks down.
    pub invert_look: bool,
    /// How many times as large as usual panel and text are.
    pub ui_scale: f32,
    /// What is to be seen of the methods; the settings are those of the side that is edited.
    pub methods: &'a Methods,
    /// The settings of the left side, or of all of the picture.
    pub left: &'a Settings,
    /// What is known of other settings.
    pub tuning: Tuning<'a>,
    /// What there is to say of scenes.
    pub scenes: Report<'a>,
    /// How each light is turned.
    pub lights: &'a [Dial],
    /// What surrounds the scene.
    pub surroundings: &'a Surroundings,
    /// What was pointed at.
    pub inspection: Option<&'a Inspection>,
    /// From where the picture is seen, unless that is changing.
    pub stands: Option<Camera>,
    /// Whether the pointer is captured, and what it points at is in the middle.
    pub crosshair: bool,
    /// What was just done or went wrong.
    pub notices: &'a [Notice],
    /// How keys are called on the user's keyboard.
    pub labels: &'a Labels,
    /// What goes on beside: "recording", "replaying".
    pub activity: Option<&'a str>,
}

/// What the picture is, against what the settings ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Showing {
    /// As the settings say.
    AsSet,
    /// Lowered while moving.
    Moving {
        /// The preset in place of the settings.
        preset: Option<&'static str>,
        /// Edge of the traced picture as a share of the window's.
        scale: f32,
    },
    /// At rest, with so many samples a pixel of 16.
    Refined(u32),
    /// The exact picture, refined or not.
    Exact(Option<u32>),
    /// The exact picture will be shown.
    ExactSoon,
}

impl Showing {
    /// Whether it is, or will be, the exact picture.
    fn is_exact(self) -> bool {
        matches!(self, Self::Exact(_) | Self::ExactSoon)
    }

    /// In words: "moving: fast, scale 0.7", "refined 9/16", "at rest: 16 samples".
    fn words(self, settings: &Settings) -> String {
        match self {
            Self::AsSet if settings.supersample.rays() == 1 => "as set: 1 sample".to_owned(),
            Self::AsSet => {
                let value = row("supersample").map_or_else(String::new, |row| (row.get)(settings));
                format!("as set: supersample {value}")
            }
            Self::Moving { preset, scale } => {
                let scale = (scale < 1.0).then(|| format!("scale {scale}"));
                let lowered: Vec<String> = preset.map(str::to_owned).into_iter().chain(scale).collect();
                format!("moving: {}", lowered.join(", "))
            }
            Self::Exact(Some(samples)) => format!("the exact picture, {samples} samples, while X is held"),
            Self::Exact(None) => "the exact picture, while X is held".to_owned(),
            Self::ExactSoon => "tracing the exact picture".to_owned(),
            Self::Refined(SAMPLES) => format!("at rest: {SAMPLES} samples"),
            Self::Refined(samples) => format!("refined {samples}/{SAMPLES}"),
        }
    }
}

/// What of the overlay is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shown {
    /// Anything at all.
    pub overlay: bool,
    /// The panel below the status line.
    pub panel: bool,
    /// The help window.
    pub help: bool,
}

impl Default for Shown {
    fn default() -> Self {
        Self { overlay: true, panel: true, help: false }
    }
}

impl Shown {
    /// With the panel where it was not seen, and without it where it was.
    pub fn with_panel_toggled(self) -> Self {
        Self { overlay: true, panel: !(self.overlay && self.panel), ..self }
    }

    /// With the help where it was not seen, and without it where it was.
    pub fn with_help_toggled(self) -> Self {
        Self { overlay: true, help: !(self.overlay && self.help), ..self }
    }
}

/// What the user asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Trace with these settings.
    Settings(Settings),
    /// Go to the scene's camera of this index.
    Camera(usize),
    /// Go back to the start.
    Home,
    /// Whether to walk; else fly.
    Walking(bool),
    /// Walk with the eye at this height, metres.
    EyeHeight(f64),
    /// Go at this speed, metres a second.
    Speed(f64),
    /// See this vertical field of view, degrees.
    Fov(f32),
    /// Turn by this many degrees per count of the mouse.
    Sensitivity(f64),
    /// Whether mouse forward looks down.
    InvertLook(bool),
    /// Have the next search keep this bound.
    Bound(Bound),
    /// Search for the cheapest settings that keep this bound.
    Search(Bound),
    /// End the search.
    StopSearch,
    /// Panel and text this many times as large as usual.
    UiScale(f32),
    /// Something of what is to be seen of the methods.
    Methods(seen::Change),
    /// Open or close the panel.
    TogglePanel,
    /// Something about scenes.
    Scenes(Wish),
    /// Turn the light of this index.
    Light(usize, Dial),
    /// Turn all lights back.
    ResetLights,
    /// Something about what surrounds the scene.
    Environment(surroundings::Change),
    /// Tell no longer of what was pointed at.
    CloseInspection,
    /// Open or close the help.
    ToggleHelp,
}

/// Draws the overlay and returns what was asked for, in order.
pub fn show(ui: &mut Ui, view: &View<'_>, shown: Shown) -> Vec<Change> {
    let mut changes = Vec::new();
    let mut above = Vec::new();
    above.extend(scenes::boxes(ui, view, &mut changes));
    // They answer what was just asked for: whoever hides the rest wants to know all the same.
    notice::show(ui, view.notices);
    if !shown.overlay {
        return changes;
    }
    above.extend(inspection::show(ui, view, &mut changes));
    let available = ui.ctx().content_rect();
    if !view.showing.is_exact() {
        divider::show(ui, view, available, &mut changes);
        above.extend(legend::show(ui, view, available));
    }
    let area = egui::Area::new(egui::Id::unique("overlay"))
        .fixed_pos(available.min + egui::vec2(MARGIN, MARGIN))
        .default_size(available.size())
        .constrain(false)
        .show(ui.ctx(), |ui| {
            let frame = egui::Frame::new().fill(theme::BACKGROUND).inner_margin(10.0).corner_radius(6.0);
            frame.show(ui, |ui| {
                ui.set_max_width(WIDTH.min(available.width() - 4.0 * MARGIN).max(1.0));
                // Without this an area that was small, its sections closed, would never grow again.
                ui.set_max_height((available.height() - 4.0 * MARGIN).max(1.0));
                status_line(ui, view, shown, &mut changes);
                if shown.panel {
                    let height = available.bottom() - ui.cursor().top() - 3.0 * MARGIN;
                    egui::ScrollArea::vertical().max_height(height.max(1.0)).show(ui, |ui| {
                        ui.set_width(ui.available_width());
                        panel(ui, view, &mut changes);
                    });
                }
            });
        });
    if shown.help {
        help::show(ui, view.labels, &mut changes);
    }
    if view.methods.split.is_on {
        // Where they meet, the divider lies under everything else, though it was used last.
        above.push(area.response.layer_id);
        above.into_iter().for_each(|layer| ui.ctx().move_to_top(layer));
    }
    changes
}

/// "62 fps | 14.2 ms | 1280x720", the switch of the panel, and what the picture is.
fn status_line(ui: &mut Ui, view: &View<'_>, shown: Shown, changes: &mut Vec<Change>) {
    ui.horizontal(|ui| {
        let is_refining = view.refining || matches!(view.showing, Showing::Refined(samples) if samples < SAMPLES);
        let rate = match view.history.rate() {
            _ if view.resting && (view.tuning.is_measuring() || view.methods.is_measuring()) => "measuring".to_owned(),
            _ if view.resting && is_refining => "refining".to_owned(),
            _ if view.resting => "idle".to_owned(),
            Some(rate) if rate < 9.95 => format!("{rate:.1} fps"),
            Some(rate) => format!("{rate:.0} fps"),
            None => "tracing".to_owned(),
        };
        let time = view.history.last().map_or_else(String::new, |ms| format!(" | {ms:.1} ms"));
        let (width, height) = view.size;
        let line = format!("{rate}{time} | {width}x{height}");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let name = if shown.panel { "Hide panel" } else { "Show panel" };
            if ui.small_button(name).on_hover_text("Tab; H hides everything").clicked() {
                changes.push(Change::TogglePanel);
            }
            if ui.small_button("Help").on_hover_text("F1: keys, settings, how it works").clicked() {
                changes.push(Change::ToggleHelp);
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                let line = RichText::new(line).size(15.0).strong().color(theme::STRONG);
                ui.add(egui::Label::new(line).truncate());
            });
        });
    });
    ui.horizontal(|ui| {
        ui.label(RichText::new(what_is_seen(view)).small().color(theme::WEAK))
            .on_hover_text("what the picture is; see refine-at-rest and target-fps");
        if let Some(activity) = view.activity {
            ui.label(RichText::new(activity).small().strong().color(theme::WARNING));
        }
    });
}

/// What one is looking at: the map if it is one, the sides, and how the picture was made.
fn what_is_seen(view: &View<'_>) -> String {
    let words = view.showing.words(view.left);
    if view.showing.is_exact() {
        return words;
    }
    let map = match view.methods.map {
        Map::Picture => String::new(),
        map => format!("map of {}, ", map.name()),
    };
    let sides = if view.methods.split.is_on { "two settings side by side, left " } else { "" };
    format!("{map}{sides}{words}")
}

fn panel(ui: &mut Ui, view: &View<'_>, changes: &mut Vec<Change>) {
    graph::show(ui, view.history);
    section(ui, "Settings", true, |ui| {
        methods::sides(ui, view, changes);
        presets(ui, view, changes);
        controls::settings(ui, view, changes);
    });
    section(ui, "Last frame", true, |ui| figures::show(ui, view.stats));
    section(ui, "What the methods do", true, |ui| methods::show(ui, view, changes));
    section(ui, "View", true, |ui| controls::view(ui, view, changes));
    section(ui, "Time against error", false, |ui| tuning::show(ui, view, changes));
    section(ui, "Lights", false, |ui| lights::show(ui, view, changes));
    section(ui, "Environment", false, |ui| environment::show(ui, view, changes));
    section(ui, "Scene", false, |ui| scenes::section(ui, view, changes));
    section(ui, "Keys", false, |ui| help::keys(ui, view.labels));
}

fn section(ui: &mut Ui, title: &str, open: bool, add_contents: impl FnOnce(&mut Ui)) {
    CollapsingHeader::new(RichText::new(title).strong().color(theme::STRONG)).default_open(open).show(ui, add_contents);
}

fn presets(ui: &mut Ui, view: &View<'_>, changes: &mut Vec<Change>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new("Preset").color(theme::WEAK));
        for preset in PRESETS {
            let settings = of_preset(preset, view.settings, view.scene);
            let selected = *view.settings == settings;
            if ui.selectable_label(selected, preset.name).on_hover_text(preset.help).clicked() && !selected {
                changes.push(Change::Settings(settings));
            }
        }
    });
}

/// The settings of a preset, as this scene is drawn by this machine in this window.
fn of_preset(preset: &Preset, current: &Settings, scene: &Scene) -> Settings {
    // The depth "scene" and the scene's own number are the same.
    let depth = current.depth.filter(|depth| *depth == scene.render.max_depth);
    Settings { depth, ..(preset.settings)() }.in_place_of(current)
}
