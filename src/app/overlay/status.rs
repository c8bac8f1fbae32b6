//! The status line: frame rate, preset, way of moving and speed; what the picture is; the switches of panel and help.

use super::{Change, Showing, View, preset_name, theme};
use crate::app::at_rest::SAMPLES;
use crate::app::maps::Map;
use crate::app::walker::speed_in_words;
use egui::{RichText, Ui};

/// Size of the smaller text in points.
const SMALL: f32 = 12.0;

/// Draws the line; above the panel in two rows. A row breaks where it is longer than there is room, so that nothing of it
/// is cut off.
pub fn show(ui: &mut Ui, view: &View<'_>, panel_is_seen: bool, changes: &mut Vec<Change>) {
    if panel_is_seen {
        ui.horizontal_wrapped(|ui| line(ui, view));
        ui.horizontal_wrapped(|ui| {
            let (width, height) = view.size;
            let time = view.history.last().map_or_else(String::new, |ms| format!("{ms:.1} ms · "));
            ui.label(RichText::new(format!("{time}{width}x{height}")).size(SMALL).color(theme::WEAK));
            switches(ui, "Hide panel", changes);
        });
    } else {
        ui.horizontal_wrapped(|ui| {
            line(ui, view);
            switches(ui, "Show panel", changes);
        });
    }
}

fn line(ui: &mut Ui, view: &View<'_>) {
    let way = if view.walking { "walk" } else { "fly" };
    let line = [rate(view), preset_name(view.left, view.scene).to_owned(), way.to_owned(), speed_in_words(view.speed)];
    ui.label(RichText::new(line.join(" · ")).strong().color(theme::STRONG))
        .on_hover_text("frame rate, preset, walk or fly (G), speed (wheel)");
    ui.label(RichText::new(what_is_seen(view)).size(SMALL).color(theme::WEAK))
        .on_hover_text("what the picture is; see refine-at-rest and target-fps");
    if let Some(activity) = view.activity {
        ui.label(RichText::new(activity).size(SMALL).strong().color(theme::WARNING));
    }
}

/// The switches of help and panel.
fn switches(ui: &mut Ui, panel: &str, changes: &mut Vec<Change>) {
    if ui.small_button("Help").on_hover_text("F1: keys, settings, how it works").clicked() {
        changes.push(Change::ToggleHelp);
    }
    if ui.small_button(panel).on_hover_text("Tab; H hides everything").clicked() {
        changes.push(Change::TogglePanel);
    }
}

/// Frames a second, or what is done instead of tracing frames.
fn rate(view: &View<'_>) -> String {
    let is_refining = view.refining || matches!(view.showing, Showing::Refined(samples) if samples < SAMPLES);
    match view.history.rate() {
        _ if view.resting && (view.tuning.is_measuring() || view.methods.is_measuring()) => "measuring".to_owned(),
        _ if view.resting && is_refining => "refining".to_owned(),
        _ if view.resting => "idle".to_owned(),
        Some(rate) if rate < 9.95 => format!("{rate:.1} fps"),
        Some(rate) => format!("{rate:.0} fps"),
        None => "tracing".to_owned(),
    }
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
