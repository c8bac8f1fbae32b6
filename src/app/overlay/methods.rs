//! Controls of what is to be seen of the methods: maps, two sides, errors and costs.

use super::{View, theme};
use crate::app::exam::{Exam, Subject};
use crate::app::maps::Map;
use crate::app::methods::{Change, Side};
use crate::measure::chart::short;
use crate::measure::metric::{Score, metric};
use egui::{Button, ComboBox, Grid, ProgressBar, RichText, Slider, Ui};

/// The choice of a map, the divider, and what can be measured of the settings.
pub fn show(ui: &mut Ui, view: &View<'_>, changes: &mut Vec<super::Change>) {
    let mut ask = |change| changes.push(super::Change::Methods(change));
    maps(ui, view.methods.map, &mut ask);
    let split = &view.methods.split;
    ui.horizontal(|ui| {
        let mut is_on = split.is_on;
        if ui.checkbox(&mut is_on, "side by side").on_hover_text("two settings on one view (B)").changed() {
            ask(Change::Split(is_on));
        }
        let mut percent = split.share() * 100.0;
        let name = ui.label(RichText::new("divider").color(theme::WEAK));
        let slider = Slider::new(&mut percent, 0.0..=100.0).integer().suffix(" %");
        let slider = ui.add_enabled(split.is_on, slider).labelled_by(name.id);
        if slider.on_hover_text("drag it in the picture, or use the arrow keys here").changed() {
            ask(Change::Divider(percent / 100.0));
        }
    });
    ui.label(RichText::new("Hold X for the exact picture").small().color(theme::WEAK))
        .on_hover_text("the same picture without what approximates it, by a ray for every pixel");
    measure(ui, view, &mut ask);
}

fn maps(ui: &mut Ui, current: Map, ask: &mut dyn FnMut(Change)) {
    ui.horizontal(|ui| {
        let name = ui.label(RichText::new("map").color(theme::WEAK));
        let combo = ComboBox::from_id_salt("map").selected_text(current.name());
        let shown = combo.show_ui(ui, |ui| {
            for map in Map::ALL {
                let entry = ui.add(Button::selectable(map == current, map.name())).on_hover_text(map.help());
                if entry.clicked() && map != current {
                    ask(Change::Map(map));
                }
            }
        });
        shown.response.labelled_by(name.id).on_hover_text(format!("{} (V for the next)", current.help()));
    });
}

/// Which side the settings are of, where there are two.
pub fn sides(ui: &mut Ui, view: &View<'_>, changes: &mut Vec<super::Change>) {
    let split = &view.methods.split;
    if !split.is_on {
        return;
    }
    let mut ask = |change| changes.push(super::Change::Methods(change));
    ui.horizontal(|ui| {
        ui.label(RichText::new("Side").color(theme::WEAK));
        for (side, name) in [(Side::Left, "left"), (Side::Right, "right")] {
            let entry = ui.selectable_label(split.edited == side, name);
            if entry.on_hover_text("the settings below are of this side").clicked() && split.edited != side {
                ask(Change::Edit(side));
            }
        }
        let copy = ui.add_enabled(split.right != *view.left, Button::new("Copy left to right").small());
        if copy.clicked() {
            ask(Change::CopyLeft);
        }
    });
}

/// The buttons for errors and costs, and the errors that were found.
fn measure(ui: &mut Ui, view: &View<'_>, ask: &mut dyn FnMut(Change)) {
    if let Some(exam) = view.methods.exam.as_ref().filter(|exam| !exam.has_ended) {
        ui.horizontal(|ui| {
            if ui.button("Stop measuring").clicked() {
                ask(Change::Stop);
            }
            ui.add(ProgressBar::new(exam.share as f32).show_percentage());
        });
    } else {
        ui.horizontal(|ui| {
            let errors = ui.button("Measure errors");
            if errors.on_hover_text("how far the picture is off the exact one, by every metric").clicked() {
                ask(Change::MeasureErrors);
            }
            let costs = ui.button("Measure costs");
            let help = "what each setting costs or saves on this view, against its other value: shown beside it";
            if costs.on_hover_text(help).clicked() {
                ask(Change::MeasureCosts);
            }
        });
    }
    let Some(exam) = &view.methods.exam else { return };
    if view.methods.is_elsewhere {
        ui.label(RichText::new("measured from another place").small().color(theme::WARNING));
    }
    if exam.subject == Subject::Costs && exam.has_ended {
        let words =
            if exam.costs.is_empty() { "no costs measured" } else { "Costs are shown next to each setting above" };
        ui.label(RichText::new(words).small().color(theme::WEAK));
    }
    errors(ui, view, exam);
}

fn errors(ui: &mut Ui, view: &View<'_>, exam: &Exam) {
    if exam.errors.is_empty() {
        return;
    }
    if exam.settings != *view.settings {
        ui.label(RichText::new("measured with other settings").small().color(theme::WARNING));
    }
    Grid::new("errors").num_columns(2).spacing([16.0, 2.0]).show(ui, |ui| {
        for &(name, score) in &exam.errors {
            let help = metric(name).map_or("", |metric| metric.help);
            ui.label(RichText::new(name).color(theme::WEAK)).on_hover_text(help);
            ui.label(RichText::new(words(name, score)).monospace().color(theme::STRONG));
            ui.end_row();
        }
    });
}

/// A score with its unit.
fn words(metric: &str, score: Score) -> String {
    match (metric, score) {
        ("psnr", Score::Undefined) => "equal pictures".to_owned(),
        ("psnr", Score::Number(decibels)) => format!("{decibels:.2} dB"),
        // What matters of it is how far it is from 1.
        ("ssim", Score::Number(share)) => format!("{share:.6}"),
        (_, Score::Number(number)) => short((number * 1e6).round() / 1e6),
        (_, score) => score.to_string(),
    }
}
