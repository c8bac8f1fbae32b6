//! The overlay: a pure function of what there is to see, answering with what the user asked to change.
//!
//! Architecture invariant: nothing here knows of a window, a device or a thread, so all of it is tested
//! without any of them.

mod bars;
mod controls;
mod divider;
mod dock;
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
mod status;
pub mod theme;
mod tuning;

pub use dock::{free_area, panel_pixels};
pub use notice::{Notice, Notices};
pub use tuning::{Tuning, usual_bound};

use super::at_rest::SAMPLES;
use super::hint;
use super::history::History;
use super::inspection::Inspection;
use super::labels::Labels;
use super::lighting::Dial;
use super::methods::{self as seen, Methods};
use super::scenes::{Report, Wish};
use super::surroundings::{self, Surroundings};
use crate::measure::tune::Bound;
use crate::render::FrameStats;
use crate::scene::{Camera, Scene};
use crate::settings::{PRESETS, Preset, Settings, row};
use egui::{CollapsingHeader, LayerId, Rect, RichText, Ui};

/// Width of the contents of a panel over the picture in points.
const WIDTH: f32 = 360.0;
/// Distance from the window's edge in points.
const MARGIN: f32 = 8.0;
/// Between the edge of the panel and what it holds, in points.
const PADDING: f32 = 10.0;

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
    /// Opacity of the hint on how to look and move, from 0 to 1.
    pub hint: f32,
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
            Self::AsSet if settings.supersample.rays() == 1 => "full quality, 1 sample".to_owned(),
            Self::AsSet => {
                let value = row("supersample").map_or_else(String::new, |row| (row.get)(settings));
                format!("full quality, supersample {value}")
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

/// Whether the panel is there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Panel {
    /// It is not.
    #[default]
    Closed,
    /// Beside the picture; collapsed in windows where it would take too much of the width.
    Open,
    /// It was asked for in such a window, and lies over the picture there.
    OverPicture,
}

/// What of the overlay is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shown {
    /// Anything at all.
    pub overlay: bool,
    /// The panel.
    pub panel: Panel,
    /// The help window.
    pub help: bool,
}

impl Default for Shown {
    fn default() -> Self {
        Self { overlay: true, panel: Panel::Closed, help: false }
    }
}

impl Shown {
    /// Whether the panel is seen; `fits` says whether there is room for it beside the picture.
    pub fn has_panel(self, fits: bool) -> bool {
        self.overlay && (self.panel == Panel::OverPicture || fits && self.panel == Panel::Open)
    }

    /// With the panel where it was not seen, and without it where it was.
    pub fn with_panel_toggled(self, fits: bool) -> Self {
        let panel = match (self.has_panel(fits), fits) {
            (true, _) => Panel::Closed,
            (false, true) => Panel::Open,
            (false, false) => Panel::OverPicture,
        };
        Self { overlay: true, panel, ..self }
    }

    /// In a window of another size: what lies over the picture collapses.
    pub fn resized(self) -> Self {
        let panel = if self.panel == Panel::OverPicture { Panel::Open } else { self.panel };
        Self { panel, ..self }
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
    let window = ui.ctx().content_rect();
    let pixels_per_point = ui.ctx().pixels_per_point();
    let size = (window.size() * pixels_per_point).round();
    let [left, ..] = free_area((size.x as u32, size.y as u32), pixels_per_point, shown);
    let free = window.with_min_x(window.left() + left as f32 / pixels_per_point);
    above.extend(scenes::boxes(ui, view, free, &mut changes));
    let hint = hint::text(view.labels);
    // Two sides have their own words there.
    let hint = (view.hint > 0.0 && shown.overlay && !view.methods.split.is_on).then_some((hint.as_str(), view.hint));
    // They answer what was just asked for: whoever hides the rest wants to know all the same.
    notice::show(ui, view.notices, hint, free);
    if !shown.overlay {
        return changes;
    }
    above.extend(inspection::show(ui, view, free, &mut changes));
    if !view.showing.is_exact() {
        divider::show(ui, view, free, &mut changes);
        above.extend(legend::show(ui, view, free));
    }
    let layer = if left > 0 {
        beside_picture(ui, view, window.with_max_x(free.left()), &mut changes)
    } else {
        over_picture(ui, view, window, shown.panel == Panel::OverPicture, &mut changes)
    };
    if shown.help {
        help::show(ui, view.labels, &mut changes);
    }
    if view.methods.split.is_on {
        // Where they meet, the divider lies under everything else, though it was used last.
        above.push(layer);
        above.into_iter().for_each(|layer| ui.ctx().move_to_top(layer));
    }
    changes
}

/// Draws status line and panel over all of `strip`, and gives their layer.
fn beside_picture(ui: &Ui, view: &View<'_>, strip: Rect, changes: &mut Vec<Change>) -> LayerId {
    let area = egui::Area::new(egui::Id::unique("panel")).fixed_pos(strip.min).constrain(false);
    let area = area.default_size(strip.size()).show(ui.ctx(), |ui| {
        ui.set_clip_rect(strip);
        ui.painter().rect_filled(strip, 0.0, theme::BACKGROUND);
        let frame = egui::Frame::new().inner_margin(PADDING);
        frame.show(ui, |ui| {
            ui.set_width((strip.width() - 2.0 * PADDING).max(1.0));
            ui.set_height((strip.height() - 2.0 * PADDING).max(1.0));
            status::show(ui, view, true, changes);
            scrolled_panel(ui, view, strip.bottom() - PADDING, changes);
        });
    });
    area.response.layer_id
}

/// Draws the status line over the picture, and the panel below it if it was asked for; gives their layer.
fn over_picture(ui: &Ui, view: &View<'_>, window: Rect, has_panel: bool, changes: &mut Vec<Change>) -> LayerId {
    let area = egui::Area::new(egui::Id::unique("overlay"))
        .fixed_pos(window.min + egui::vec2(MARGIN, MARGIN))
        .default_size(window.size())
        .constrain(false)
        .show(ui.ctx(), |ui| {
            let frame = egui::Frame::new().fill(theme::BACKGROUND).inner_margin(PADDING).corner_radius(6.0);
            frame.show(ui, |ui| {
                let room = window.size() - egui::Vec2::splat(2.0 * (MARGIN + PADDING));
                ui.set_max_width(if has_panel { room.x.min(WIDTH) } else { room.x }.max(1.0));
                // Without this an area that was small, its sections closed, would never grow again.
                ui.set_max_height(room.y.max(1.0));
                status::show(ui, view, has_panel, changes);
                if has_panel {
                    scrolled_panel(ui, view, window.bottom() - MARGIN - PADDING, changes);
                }
            });
        });
    area.response.layer_id
}

/// The panel, from here to `bottom`. It scrolls both ways: in a narrow one whatever does not wrap would be cut off.
fn scrolled_panel(ui: &mut Ui, view: &View<'_>, bottom: f32, changes: &mut Vec<Change>) {
    let height = (bottom - ui.cursor().top()).max(1.0);
    egui::ScrollArea::both().max_height(height).auto_shrink([false, true]).show(ui, |ui| {
        ui.set_max_width(ui.available_width());
        panel(ui, view, changes);
    });
}

fn panel(ui: &mut Ui, view: &View<'_>, changes: &mut Vec<Change>) {
    graph::show(ui, view.history);
    section(ui, "Settings", true, |ui| {
        methods::sides(ui, view, changes);
        presets(ui, view, changes);
        controls::settings(ui, view, changes);
    });
    section(ui, "Last frame", true, |ui| figures::show(ui, view.stats));
    section(ui, "Compare and debug views", true, |ui| methods::show(ui, view, changes));
    section(ui, "View", true, |ui| controls::view(ui, view, changes));
    section(ui, "Auto-tune", false, |ui| tuning::show(ui, view, changes));
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

/// The preset that draws the same frames, or that there is none.
fn preset_name(settings: &Settings, scene: &Scene) -> &'static str {
    let preset = PRESETS.iter().find(|preset| of_preset(preset, settings, scene) == *settings);
    preset.map_or("own settings", |preset| preset.name)
}

#[cfg(test)]
mod tests {
    use super::{Panel, Shown};

    #[test]
    fn the_panel_opens_where_there_is_room_for_it_and_over_the_picture_where_it_is_asked_for() {
        let shown = Shown::default();
        assert!(!shown.has_panel(true) && !shown.has_panel(false), "closed at first");
        let beside = shown.with_panel_toggled(true);
        assert_eq!(beside.panel, Panel::Open);
        assert!(beside.has_panel(true) && !beside.has_panel(false), "collapsed in a narrow window");
        assert_eq!(beside.with_panel_toggled(true), shown);
        let over = beside.with_panel_toggled(false);
        assert_eq!(over.panel, Panel::OverPicture);
        assert!(over.has_panel(false));
        assert_eq!(over.with_panel_toggled(false), shown);
        assert_eq!(over.resized(), beside);
        let hidden = Shown { overlay: false, ..beside };
        assert!(!hidden.has_panel(true));
        assert_eq!(hidden.with_panel_toggled(true), beside);
    }
}
