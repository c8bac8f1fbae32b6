//! Scenes in words: the one shown, how far the next has come, and what was wrong or odd.

use super::{Change, View, placing, theme};
use crate::app::scenes::{Failure, Loading, Oddities, Report, Wish, warnings};
use crate::scene::{Scene, Warning};
use egui::{Align2, Color32, LayerId, Order, ProgressBar, Rect, RichText, ScrollArea, Ui};
use std::path::Path;

/// Widest that a box of text is, in points.
const WIDTH: f32 = 520.0;
/// Distance from the window's sides in points, and from its lower edge, where notices come and go.
const MARGIN: f32 = 24.0;
const ABOVE_NOTICES: f32 = 96.0;
/// Most warnings of a scene that the panel lists.
const WARNINGS: usize = 5;
/// Most of the window's height that the list of all warnings takes.
const SHARE: f32 = 0.4;
/// Highest that the text of a failure is, in points.
const TALLEST: f32 = 160.0;

/// The boxes over the picture, which is `free` of the panel; gives their layer. They are there even where the overlay is
/// hidden.
pub fn boxes(ui: &Ui, view: &View<'_>, free: Rect, changes: &mut Vec<Change>) -> Option<LayerId> {
    let Report { loading, failure, odd, hint, folder, .. } = &view.scenes;
    if loading.is_none() && failure.is_none() && odd.is_none() && hint.is_none() {
        return None;
    }
    let width = WIDTH.min(free.width() - 2.0 * MARGIN).max(1.0);
    let id = egui::Id::unique("scenes");
    let area = egui::Area::new(id).constrain_to(free);
    let area = area.anchor(Align2::CENTER_BOTTOM, egui::vec2(0.0, -ABOVE_NOTICES));
    placing::show(ui.ctx(), id, area, |ui| {
        let is_line_alone = loading.is_none() && failure.is_none() && hint.is_none();
        if is_line_alone && odd.is_some_and(|odd| !odd.is_list) {
            // It is as wide as its words, in the middle.
            ui.set_max_width(width);
        } else {
            ui.set_width(width);
        }
        match odd {
            Some(Oddities { scene, is_list: true }) => {
                in_box(ui, theme::WARNING, |ui| warnings_box(ui, scene, *folder, SHARE * free.height(), changes));
            }
            Some(Oddities { scene, is_list: false }) => warnings_line(ui, scene, changes),
            None => {}
        }
        if let Some(failure) = failure {
            in_box(ui, theme::FAILURE, |ui| failure_box(ui, failure, changes));
        }
        if let Some(loading) = loading {
            in_box(ui, theme::ACCENT, |ui| loading_box(ui, loading, changes));
        }
        if let Some(hint) = hint {
            in_box(ui, theme::ACCENT, |ui| {
                ui.label(RichText::new(*hint).color(theme::STRONG));
            });
        }
    });
    Some(LayerId::new(Order::Middle, id))
}

fn in_box(ui: &mut Ui, edge: Color32, add_contents: impl FnOnce(&mut Ui)) {
    let frame = egui::Frame::new().fill(theme::BACKGROUND).stroke(egui::Stroke::new(1.0, edge));
    frame.inner_margin(10.0).corner_radius(6.0).show(ui, |ui| {
        ui.set_width(ui.available_width());
        add_contents(ui);
    });
}

fn loading_box(ui: &mut Ui, loading: &Loading, changes: &mut Vec<Change>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!("Loading {}", loading.name)).strong().color(theme::STRONG));
        ui.label(RichText::new(format!("{:.0} s", loading.seconds)).color(theme::WEAK));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.small_button("Cancel").on_hover_text("Esc").clicked() {
                changes.push(Change::Scenes(Wish::Cancel));
            }
        });
    });
    ui.label(RichText::new(loading.step.to_string()).color(theme::WEAK));
    if loading.step.of > 0 {
        ui.add(ProgressBar::new(loading.step.done as f32 / loading.step.of as f32).desired_height(6.0));
    }
}

fn failure_box(ui: &mut Ui, failure: &Failure, changes: &mut Vec<Change>) {
    ui.label(RichText::new(&failure.title).strong().color(theme::FAILURE));
    ScrollArea::vertical().max_height(TALLEST).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.label(RichText::new(&failure.message).color(theme::STRONG));
    });
    ui.horizontal(|ui| {
        if let Some(file) = &failure.file
            && ui.small_button("Try again").clicked()
        {
            changes.push(Change::Scenes(Wish::OpenFile(file.clone())));
        }
        if ui.small_button("Dismiss").clicked() {
            changes.push(Change::Scenes(Wish::DismissFailure));
        }
    });
}

/// What warnings are about, in one line, and the switch of their list.
fn warnings_line(ui: &mut Ui, scene: &Scene, changes: &mut Vec<Change>) {
    let frame = egui::Frame::new().fill(theme::BACKGROUND).stroke(egui::Stroke::new(1.0, theme::WARNING));
    frame.inner_margin(8.0).corner_radius(6.0).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let summary = warnings::summary(&scene.warnings);
            ui.label(RichText::new(format!("{summary} ·")).color(theme::WARNING));
            if ui.link("Details").on_hover_text("F2; the panel lists them, too").clicked() {
                changes.push(Change::Scenes(Wish::ToggleWarnings));
            }
        });
    });
}

/// All warnings, no higher than `tallest`.
fn warnings_box(ui: &mut Ui, scene: &Scene, folder: Option<&Path>, tallest: f32, changes: &mut Vec<Change>) {
    let title = format!("{}: {}", scene.name, warnings::summary(&scene.warnings));
    ui.label(RichText::new(title).strong().color(theme::WARNING));
    ScrollArea::vertical().max_height(tallest.max(1.0)).show(ui, |ui| {
        ui.set_width(ui.available_width());
        list(ui, &scene.warnings, folder);
    });
    if ui.small_button("Dismiss").on_hover_text("F2 lists them again").clicked() {
        changes.push(Change::Scenes(Wish::DismissWarnings));
    }
}

fn list(ui: &mut Ui, warnings: &[Warning], folder: Option<&Path>) {
    for warning in warnings {
        ui.label(RichText::new(warnings::relative(warning, folder)).color(theme::WARNING));
    }
}

/// The section of the panel: what is shown, and what else could be.
pub fn section(ui: &mut Ui, view: &View<'_>, changes: &mut Vec<Change>) {
    let scene = view.scene;
    let count = |number: usize, one: &str, many: &str| format!("{number} {}", if number == 1 { one } else { many });
    ui.label(RichText::new(&scene.name).color(theme::STRONG));
    let lights = if scene.headlight { "headlight".to_owned() } else { count(scene.lights.len(), "light", "lights") };
    ui.label(format!("{}, {lights}", count(scene.objects.len(), "object", "objects")));
    list(ui, &scene.warnings[..scene.warnings.len().min(WARNINGS)], view.scenes.folder);
    if scene.warnings.len() > WARNINGS {
        let all = format!("All {} warnings", scene.warnings.len());
        if ui.button(all).on_hover_text("F2").clicked() {
            changes.push(Change::Scenes(Wish::ToggleWarnings));
        }
    }
    ui.horizontal(|ui| {
        if ui.button("Open...").on_hover_text("Ctrl+O; or drop a file or folder on the window").clicked() {
            changes.push(Change::Scenes(Wish::Open));
        }
        if ui.button("Reload").on_hover_text("F5; it is reloaded by itself when its files change").clicked() {
            changes.push(Change::Scenes(Wish::Reload));
        }
    });
    if let Some(told) = view.scenes.blind {
        ui.label(RichText::new(told).color(theme::WARNING));
    }
    if !view.scenes.recent.is_empty() {
        ui.label(RichText::new("opened before").color(theme::WEAK));
    }
    for file in view.scenes.recent {
        let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
        if ui.link(name).on_hover_text(file.display().to_string()).clicked() {
            changes.push(Change::Scenes(Wish::OpenFile(Path::to_owned(file))));
        }
    }
}
