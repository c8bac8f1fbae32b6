//! A control for every setting, made from the list of settings, and the controls of the view.

use super::{Change, View, theme};
use crate::app::UI_SCALES;
use crate::app::walker::{EYE_HEIGHT_RANGE, FOV_RANGE};
use crate::math::simd;
use crate::settings::{Choice, Kind, ROWS, Row, Settings};
use egui::{ComboBox, DragValue, Grid, Response, RichText, Slider, SliderClamping, Ui};

/// Whole-number ranges wider than this get a number to drag: on a slider every pixel would be a leap.
const WIDEST_SLIDER: f64 = 128.0;

/// One row per setting: name, control, what the value promises, and what it costs or saves once that is measured.
pub fn settings(ui: &mut Ui, view: &View<'_>, changes: &mut Vec<Change>) {
    let mut settings = view.settings.clone();
    Grid::new("settings").num_columns(4).spacing([8.0, 4.0]).show(ui, |ui| {
        for row in ROWS {
            let value = (row.get)(&settings);
            let name = ui.label(RichText::new(row.name).color(theme::WEAK)).on_hover_text(row.help);
            let (response, wanted) = control(ui, row, &value, view);
            response.labelled_by(name.id).on_hover_text(row.help);
            if let Some(promise) = row.promise(&value) {
                ui.label(RichText::new(promise.to_string()).small().color(theme::promise_color(promise)));
            }
            if let Some(cost) = view.methods.cost(row.name, view.settings) {
                let color = if cost.change() < 0.0 { theme::ACCENT } else { theme::WEAK };
                ui.label(RichText::new(cost.short()).small().color(color)).on_hover_text(cost.words());
            }
            ui.end_row();
            if let Some(wanted) = wanted {
                // The control offers allowed values only; should the row still refuse, the value stays.
                let _ = (row.set)(&mut settings, &wanted);
            }
        }
    });
    if settings != *view.settings {
        changes.push(Change::Settings(settings));
    }
}

/// Whether this machine can do a value of a row.
fn is_possible(row: &Row, value: &str, settings: &Settings) -> bool {
    let mut settings = settings.clone();
    (row.set)(&mut settings, value).is_ok() && simd::is_available(settings.simd)
}

/// The control of a row, and the value that was asked for, as it would be typed.
fn control(ui: &mut Ui, row: &Row, value: &str, view: &View<'_>) -> (Response, Option<String>) {
    match &row.kind {
        Kind::Choice(
            [Choice { value: "on", .. }, Choice { value: "off", .. }]
            | [Choice { value: "off", .. }, Choice { value: "on", .. }],
        ) => {
            let mut on = value == "on";
            let response = ui.checkbox(&mut on, "");
            let wanted = response.changed().then(|| if on { "on" } else { "off" }.to_owned());
            (response, wanted)
        }
        Kind::Choice(choices) => choice(ui, row, choices, value, view.settings),
        &Kind::Number { min, max, integer, .. } => number(ui, row, value, [min, max], integer, view),
    }
}

fn choice(ui: &mut Ui, row: &Row, choices: &[Choice], value: &str, settings: &Settings) -> (Response, Option<String>) {
    let mut wanted = None;
    let combo = ComboBox::from_id_salt(row.name).selected_text(value);
    let shown = combo.show_ui(ui, |ui| {
        for choice in choices {
            let selected = choice.value == value;
            let entry = egui::Button::selectable(selected, choice.value);
            let entry = ui.add_enabled(is_possible(row, choice.value, settings), entry);
            if entry.on_disabled_hover_text("this machine lacks it").on_hover_text(choice.promise.to_string()).clicked()
                && !selected
            {
                wanted = Some(choice.value.to_owned());
            }
        }
    });
    (shown.response, wanted)
}

fn number(
    ui: &mut Ui,
    row: &Row,
    value: &str,
    [min, max]: [f64; 2],
    integer: bool,
    view: &View<'_>,
) -> (Response, Option<String>) {
    let before = match (row.name, value) {
        (_, "off") => min,
        ("exposure", _) => f64::from(view.scene.stops(view.settings.exposure)),
        // Else the one value that is no number is the depth "scene".
        _ => value.parse().unwrap_or_else(|_| f64::from(view.scene.render.max_depth)),
    };
    let mut after = before;
    let response = if integer && max - min > WIDEST_SLIDER {
        let drag = DragValue::new(&mut after).range(min..=max).speed(0.05).fixed_decimals(0);
        ui.add(if value == "off" { drag.custom_formatter(|_, _| "off".to_owned()) } else { drag })
    } else {
        let slider = Slider::new(&mut after, min..=max);
        // Ranges from zero are those of thresholds and weights, where the small values matter.
        let slider = if integer { slider.integer() } else { slider.logarithmic(min == 0.0).smallest_positive(1e-4) };
        ui.add(slider.custom_formatter(|value, _| rounded(value)))
    };
    let wanted = (response.changed() && after != before).then(|| after.to_string());
    (response, wanted)
}

/// Cameras of the scene, speed, field of view and mouse.
pub fn view(ui: &mut Ui, view: &View<'_>, changes: &mut Vec<Change>) {
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new("Camera").color(theme::WEAK));
        if ui.button("start").on_hover_text("where the walk started (Home)").clicked() {
            changes.push(Change::Home);
        }
        for (index, camera) in view.scene.cameras.iter().enumerate() {
            if ui.button(&camera.name).on_hover_text("a camera of the scene").clicked() {
                changes.push(Change::Camera(index));
            }
        }
    });
    Grid::new("view").num_columns(2).spacing([8.0, 4.0]).show(ui, |ui| {
        let mut walking = view.walking;
        labelled(ui, "walk", "on your feet: floors, walls and stairs count (G)", |ui| ui.checkbox(&mut walking, ""))
            .then(|| changes.push(Change::Walking(walking)));
        let mut height = view.eye_height;
        let drag = DragValue::new(&mut height).range(EYE_HEIGHT_RANGE).speed(view.eye_height * 0.01).suffix(" m");
        labelled(ui, "eye height", "above the floor, in metres; steps and jumps grow with it", |ui| {
            ui.add(drag.custom_formatter(|height, _| significant(height)))
        })
        .then(|| changes.push(Change::EyeHeight(height)));
        let mut speed = view.speed;
        let drag = DragValue::new(&mut speed).range(0.0..=f64::MAX).speed(view.speed * 0.01).suffix(" m/s");
        labelled(ui, "speed", "metres a second; the wheel changes it by a tenth", |ui| {
            ui.add(drag.custom_formatter(|speed, _| significant(speed)))
        })
        .then(|| changes.push(Change::Speed(speed)));
        let mut fov = view.fov;
        labelled(ui, "field of view", "vertical, in degrees", |ui| {
            ui.add(
                Slider::new(&mut fov, FOV_RANGE)
                    .clamping(SliderClamping::Edits)
                    .custom_formatter(|fov, _| rounded(fov))
                    .suffix("°"),
            )
        })
        .then(|| changes.push(Change::Fov(fov)));
        let mut sensitivity = view.sensitivity;
        labelled(ui, "mouse", "degrees of turn per count of the mouse", |ui| {
            let slider = Slider::new(&mut sensitivity, 0.01..=1.0).logarithmic(true).suffix("°");
            ui.add(slider.custom_formatter(|sensitivity, _| rounded(sensitivity)))
        })
        .then(|| changes.push(Change::Sensitivity(sensitivity)));
        let mut invert = view.invert_look;
        labelled(ui, "invert look", "mouse forward looks down", |ui| ui.checkbox(&mut invert, ""))
            .then(|| changes.push(Change::InvertLook(invert)));
        ui_scale(ui, view.ui_scale, changes);
    });
}

/// The size of panel and text. It is let stand until the slider is let go, which else would move away from the pointer.
fn ui_scale(ui: &mut Ui, scale: f32, changes: &mut Vec<Change>) {
    let label = ui.label(RichText::new("panel size").color(theme::WEAK));
    let id = ui.scope_id().with("panel size");
    let mut wanted = ui.data(|data| data.get_temp(id)).unwrap_or(scale);
    let slider = Slider::new(&mut wanted, UI_SCALES).step_by(0.05).custom_formatter(|scale, _| rounded(scale));
    let response = ui.add(slider).labelled_by(label.id);
    let held = response.dragged();
    response.on_hover_text("of panel and text alone (Ctrl with +, - and 0); render-scale is the picture's");
    ui.end_row();
    if held {
        ui.data_mut(|data| data.insert_temp(id, wanted));
    } else {
        ui.data_mut(|data| data.remove_temp::<f32>(id));
        if wanted != scale {
            changes.push(Change::UiScale(wanted));
        }
    }
}

/// A named control; true when it was changed.
fn labelled(ui: &mut Ui, name: &str, help: &str, add: impl FnOnce(&mut Ui) -> Response) -> bool {
    let label = ui.label(RichText::new(name).color(theme::WEAK));
    let response = add(ui).labelled_by(label.id).on_hover_text(help);
    ui.end_row();
    response.changed()
}

/// At most four decimals. A formatter and not the widget's own rounding, which would change a value by showing it.
fn rounded(value: f64) -> String {
    ((value * 1e4).round() / 1e4).to_string()
}

/// Three significant figures, whatever the size of the scene.
fn significant(value: f64) -> String {
    let digits = if value > 0.0 { (2.0 - value.log10().floor()).clamp(0.0, 9.0) as usize } else { 2 };
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::{rounded, significant};

    #[test]
    fn values_show_four_decimals_at_most() {
        for (value, text) in [(16.0 / 255.0, "0.0627"), (1.0 / 512.0, "0.002"), (60.0, "60"), (-0.5, "-0.5")] {
            assert_eq!(rounded(value), text);
        }
    }

    #[test]
    fn speeds_show_three_figures() {
        for (speed, text) in [(1234.0, "1234"), (12.34, "12.3"), (1.5, "1.50"), (0.001234, "0.00123"), (0.0, "0.00")] {
            assert_eq!(significant(speed), text);
        }
    }
}
