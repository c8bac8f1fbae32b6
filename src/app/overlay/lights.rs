//! A switch, a dimmer and a warmth for every light.

use super::{Change, View, theme};
use crate::app::lighting::{Dial, NEUTRAL};
use egui::{RichText, ScrollArea, Slider, Ui};
use std::ops::RangeInclusive;

/// How many times as bright or dark a light can be made.
const INTENSITIES: RangeInclusive<f32> = 0.01..=100.0;
/// Temperatures in kelvin, from candles to the sky in shade.
const TEMPERATURES: RangeInclusive<f32> = 1500.0..=12000.0;
/// Highest that the list is, in points.
const TALLEST: f32 = 260.0;

/// The section of the panel.
pub fn show(ui: &mut Ui, view: &View<'_>, changes: &mut Vec<Change>) {
    if view.lights.is_empty() {
        let text =
            if view.scene.headlight { "A light at the eye: the scene has none of its own." } else { "No light." };
        ui.label(RichText::new(text).color(theme::WEAK));
        return;
    }
    let is_turned = !view.lights.iter().all(Dial::is_untouched);
    if ui.add_enabled(is_turned, egui::Button::new("As in the file")).clicked() {
        changes.push(Change::ResetLights);
    }
    // Within the panel's own no height counts as free.
    let list = ScrollArea::vertical().id_salt("lights").max_height(TALLEST).min_scrolled_height(TALLEST);
    list.show(ui, |ui| {
        for (number, dial) in view.lights.iter().enumerate() {
            let mut turned = dial.clone();
            ui.push_id(number, |ui| one(ui, &mut turned));
            if turned != *dial {
                changes.push(Change::Light(number, turned));
            }
        }
    });
}

fn one(ui: &mut Ui, dial: &mut Dial) {
    let name = ui.checkbox(&mut dial.on, dial.name.clone());
    ui.add_enabled_ui(dial.on, |ui| {
        ui.horizontal(|ui| {
            let intensity = Slider::new(&mut dial.intensity, INTENSITIES).logarithmic(true).suffix(" x");
            ui.add(intensity.max_decimals(2)).labelled_by(name.id).on_hover_text("times as bright as in the file");
            let kelvin = Slider::new(&mut dial.kelvin, TEMPERATURES).step_by(100.0).suffix(" K");
            ui.add(kelvin)
                .labelled_by(name.id)
                .on_hover_text(format!("warm to cold; {NEUTRAL} K leaves the colour as in the file"));
        });
    });
}
