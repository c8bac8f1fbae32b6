//! The sky around the scene: which one, how it is turned, how bright it is and whether it is seen.

use super::{Change, View, theme};
use crate::app::surroundings::Change as Sky;
use egui::{Button, RichText, Slider, Ui};
use std::ops::RangeInclusive;

/// Degrees that a sky can be turned by.
const ROTATIONS: RangeInclusive<f32> = -180.0..=180.0;
/// Factors of its radiance.
const INTENSITIES: RangeInclusive<f32> = 0.01..=100.0;

/// The section of the panel.
pub fn show(ui: &mut Ui, view: &View<'_>, changes: &mut Vec<Change>) {
    let surroundings = view.surroundings;
    let mut ask = |change| changes.push(Change::Environment(change));
    ui.horizontal(|ui| {
        let own = Button::new("As in the file");
        if ui.add_enabled(!surroundings.is_untouched(), own).clicked() {
            ask(Sky::Reset);
        }
        if ui.button("Studio").on_hover_text("a neutral gradient with soft lights in it").clicked() {
            ask(Sky::Studio);
        }
        if ui.add_enabled(surroundings.current().is_some(), Button::new("None")).clicked() {
            ask(Sky::None);
        }
    });
    let Some(current) = surroundings.current() else {
        let text = "None: drop an .hdr or .exr picture of all directions on the window.";
        ui.label(RichText::new(text).color(theme::WEAK));
        return;
    };
    ui.label(RichText::new(current.to_string()).small().color(theme::WEAK));
    let (mut rotation, mut intensity, mut backdrop) = (current.rotation, current.intensity, current.backdrop);
    let name = ui.label("Rotation");
    // A file may say 270; only what is dragged is brought into the range.
    let slider = Slider::new(&mut rotation, ROTATIONS).clamping(egui::SliderClamping::Edits).step_by(1.0).suffix("°");
    ui.add(slider).labelled_by(name.id).on_hover_text("to the left");
    let name = ui.label("Intensity");
    let slider = Slider::new(&mut intensity, INTENSITIES).logarithmic(true).clamping(egui::SliderClamping::Edits);
    ui.add(slider.max_decimals(2).suffix(" x")).labelled_by(name.id);
    ui.checkbox(&mut backdrop, "Backdrop").on_hover_text("seen behind the scene; else its background is");
    if (rotation, intensity, backdrop) != (current.rotation, current.intensity, current.backdrop) {
        ask(Sky::Turn { rotation, intensity, backdrop });
    }
}
