//! The divider between two settings side by side: a line to drag, with what each side is and how long its frame took.

use super::{Change, View, preset_name};
use crate::app::methods;
use egui::{Align2, Color32, CursorIcon, FontId, Order, Rect, Sense, Stroke, Ui, pos2, vec2};

/// Width of what can be taken hold of, in points.
const GRIP: f32 = 14.0;
/// Distance of the words from the line and from the picture's lower edge, in points.
const GAP: f32 = 10.0;

/// Draws the divider, if there are two sides.
pub fn show(ui: &Ui, view: &View<'_>, available: Rect, changes: &mut Vec<Change>) {
    let split = &view.methods.split;
    if !split.is_on {
        return;
    }
    let x = available.left() + split.share() * available.width();
    let grip = Rect::from_x_y_ranges(x - 0.5 * GRIP..=x + 0.5 * GRIP, available.y_range());
    egui::Area::new(egui::Id::unique("divider")).order(Order::Middle).fixed_pos(grip.min).constrain(false).show(
        ui.ctx(),
        |ui| {
            let (_, response) = ui.allocate_exact_size(grip.size(), Sense::drag());
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Splitter, true, "divider of the sides"));
            if let Some(pointer) = response.interact_pointer_pos() {
                let share = (pointer.x - available.left()) / available.width();
                if response.dragged() && share != split.share() {
                    changes.push(Change::Methods(methods::Change::Divider(share)));
                }
            }
            let is_used = response.hovered() || response.dragged();
            if is_used {
                ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
            }
            line(ui, grip, is_used);
        },
    );
    let [left, right] = [view.left, &split.right].map(|settings| preset_name(settings, view.scene));
    let [left_ms, right_ms] = split.milliseconds;
    let y = available.bottom() - GAP;
    // Each within its own side, as far as there is room.
    let [left_side, right_side] = [available.with_max_x(x), available.with_min_x(x)];
    words(ui, left_side, pos2(x - GAP, y), Align2::RIGHT_BOTTOM, &format!("{left} | {left_ms:.1} ms"));
    words(ui, right_side, pos2(x + GAP, y), Align2::LEFT_BOTTOM, &format!("{right} | {right_ms:.1} ms"));
}

/// The line, dark beside light so that it shows on anything, and a knob.
fn line(ui: &Ui, grip: Rect, is_used: bool) {
    let painter = ui.painter();
    let light = if is_used { super::theme::ACCENT } else { Color32::from_gray(235) };
    painter.vline(grip.center().x, grip.y_range(), Stroke::new(4.0, Color32::from_black_alpha(150)));
    painter.vline(grip.center().x, grip.y_range(), Stroke::new(2.0, light));
    let knob = Rect::from_center_size(grip.center(), vec2(8.0, 36.0));
    painter.rect_filled(knob, 4.0, light);
}

/// Words on a plate of their own, of which only what lies within `side` is seen.
fn words(ui: &Ui, side: Rect, at: egui::Pos2, align: Align2, text: &str) {
    let id = egui::Id::unique(("side", align.x()));
    let plate = egui::Area::new(id).order(Order::Middle).pivot(align).fixed_pos(at).constrain(false);
    plate.interactable(false).show(ui.ctx(), |ui| {
        ui.set_clip_rect(side);
        let frame = egui::Frame::new().fill(super::theme::BACKGROUND).inner_margin(5.0).corner_radius(4.0);
        frame.show(ui, |ui| {
            let text = egui::RichText::new(text).font(FontId::proportional(13.0)).color(super::theme::STRONG);
            ui.add(egui::Label::new(text).extend());
        });
    });
}
