//! What is known of a thing that was pointed at, and where it is in the picture.

use super::{Change, View, theme};
use crate::app::inspection::Inspection;
use crate::scene::Camera;
use egui::{Align2, Grid, LayerId, Order, Pos2, Rect, RichText, Stroke, Ui};
use glam::DVec2;

/// Width of the box in points.
const WIDTH: f32 = 300.0;
/// Distance from the window's edge in points.
const MARGIN: f32 = 8.0;
/// Half the length of the crosshair's lines in points.
const CROSSHAIR: f32 = 6.0;
/// Radius of the ring around what was pointed at, in points.
const RING: f32 = 5.0;

/// Draws the crosshair, the outline of the object, and the box that tells of it, whose layer it gives. The picture has the
/// part of the window that is `available`.
pub fn show(ui: &Ui, view: &View<'_>, available: Rect, changes: &mut Vec<Change>) -> Option<LayerId> {
    let painter = ui.ctx().layer_painter(LayerId::new(Order::Background, egui::Id::unique("marks")));
    let painter = painter.with_clip_rect(available);
    if view.crosshair {
        let center = available.center();
        for arm in [egui::vec2(CROSSHAIR, 0.0), egui::vec2(0.0, CROSSHAIR)] {
            painter.line_segment([center - arm, center + arm], Stroke::new(3.0, theme::BACKGROUND));
            painter.line_segment([center - arm, center + arm], Stroke::new(1.0, theme::STRONG));
        }
    }
    let inspection = view.inspection?;
    if let Some(camera) = &view.stands {
        let place = |at: DVec2| available.min + available.size() * egui::vec2(at.x as f32, at.y as f32);
        for ends in inspection.outline(camera, view.size) {
            let ends: [Pos2; 2] = ends.map(place);
            painter.line_segment(ends, Stroke::new(3.0, theme::BACKGROUND));
            painter.line_segment(ends, Stroke::new(1.0, theme::ACCENT));
        }
        if let Some(at) = inspection.place(camera, view.size) {
            painter.circle_stroke(place(at), RING, Stroke::new(3.0, theme::BACKGROUND));
            painter.circle_stroke(place(at), RING, Stroke::new(1.0, theme::STRONG));
        }
    }
    let area = egui::Area::new(egui::Id::unique("inspection")).anchor(Align2::RIGHT_TOP, egui::vec2(-MARGIN, MARGIN));
    let shown = area.show(ui.ctx(), |ui| {
        let frame = egui::Frame::new().fill(theme::BACKGROUND).inner_margin(10.0).corner_radius(6.0);
        frame.show(ui, |ui| {
            ui.set_width(WIDTH.min(available.width() - 4.0 * MARGIN).max(1.0));
            facts(ui, inspection, view.stands.as_ref(), changes);
        });
    });
    Some(shown.response.layer_id)
}

fn facts(ui: &mut Ui, inspection: &Inspection, stands: Option<&Camera>, changes: &mut Vec<Change>) {
    ui.horizontal(|ui| {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Min), |ui| {
            if ui.small_button("Close").clicked() {
                changes.push(Change::CloseInspection);
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Min), |ui| {
                let title = RichText::new(&inspection.title).size(15.0).strong().color(theme::STRONG);
                ui.add(egui::Label::new(title).truncate());
            });
        });
    });
    Grid::new("inspection").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let distance = stands.map_or_else(|| "changing".to_owned(), |camera| inspection.distance(camera));
        for (name, value) in [("distance", distance)].iter().chain(&inspection.facts) {
            ui.label(RichText::new(*name).color(theme::WEAK));
            ui.add(egui::Label::new(RichText::new(value).color(theme::STRONG)).wrap());
            ui.end_row();
        }
    });
}
