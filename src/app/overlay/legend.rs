//! The legend of a map: what its colours mean, in the picture's lower right corner.

use super::{MARGIN, View, theme};
use crate::app::maps::{Class, Key, Legend, Scale};
use crate::measure::colormap::viridis;
use egui::{Align2, Color32, FontId, Grid, LayerId, Mesh, Pos2, Rect, RichText, Sense, Shape, Ui, vec2};

/// Width and height of a scale's colours in points, and room below for its numbers.
const BAR: [f32; 2] = [300.0, 14.0];
const NUMBERS: f32 = 14.0;
/// Room below for what the sides of a divider are, in points.
const SIDES: f32 = 32.0;
/// Steps of the colours of a scale.
const STEPS: usize = 48;

/// Draws the legend of the map on display, if it is one, and gives its layer.
pub fn show(ui: &Ui, view: &View<'_>, available: Rect) -> Option<LayerId> {
    let legend = view.methods.legend.as_ref()?;
    let room = if view.methods.split.is_on { SIDES } else { 0.0 };
    // Each has a size of its own, by which its corner is placed.
    let area = egui::Area::new(egui::Id::unique(("legend", legend.map.name())))
        .pivot(Align2::RIGHT_BOTTOM)
        .fixed_pos(available.max - vec2(MARGIN, MARGIN + room))
        .interactable(false);
    let shown = area.show(ui.ctx(), |ui| {
        let frame = egui::Frame::new().fill(theme::BACKGROUND).inner_margin(10.0).corner_radius(6.0);
        frame.show(ui, |ui| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
            contents(ui, legend);
        });
    });
    Some(shown.response.layer_id)
}

fn contents(ui: &mut Ui, legend: &Legend) {
    let title = match &legend.key {
        Key::Scale(scale) => format!("{}: {}", legend.map.name(), scale.unit),
        _ => legend.map.name().to_owned(),
    };
    ui.label(RichText::new(title).strong().color(theme::STRONG)).on_hover_text(legend.map.help());
    match &legend.key {
        Key::Classes(classes) => self::classes(ui, classes),
        Key::Scale(scale) => self::scale(ui, scale),
        Key::Words(words) => {
            ui.label(RichText::new(words).small().color(theme::WEAK));
        }
    }
}

fn classes(ui: &mut Ui, classes: &[Class]) {
    Grid::new("classes").spacing([10.0, 3.0]).show(ui, |ui| {
        if classes.iter().any(|class| class.shares.len() > 1) {
            for heading in ["", "", "left", "right"] {
                ui.label(RichText::new(heading).small().color(theme::WEAK));
            }
            ui.end_row();
        }
        for class in classes {
            let (rect, _) = ui.allocate_exact_size(vec2(14.0, 14.0), Sense::hover());
            let [r, g, b] = class.color;
            ui.painter().rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
            ui.label(class.name);
            for share in &class.shares {
                let percent = RichText::new(format!("{:5.1} %", 100.0 * share)).monospace();
                ui.label(percent.color(theme::STRONG));
            }
            ui.end_row();
        }
    });
}

fn scale(ui: &mut Ui, scale: &Scale) {
    let [width, height] = BAR;
    let (rect, response) = ui.allocate_exact_size(vec2(width, height + NUMBERS), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, scale.unit));
    let x = |place: f64| rect.left() + width * place as f32;
    let mut bar = Mesh::default();
    for step in 0..STEPS {
        let [from, to] = [step, step + 1].map(|step| step as f64 / STEPS as f64);
        let [r, g, b] = viridis(0.5 * (from + to));
        let part = Rect::from_min_max(Pos2::new(x(from), rect.top()), Pos2::new(x(to), rect.top() + height));
        bar.add_colored_rect(part, Color32::from_rgb(r, g, b));
    }
    ui.painter().add(Shape::mesh(bar));
    for (place, number) in &scale.marks {
        let align = match *place {
            0.0 => Align2::LEFT_BOTTOM,
            1.0 => Align2::RIGHT_BOTTOM,
            _ => Align2::CENTER_BOTTOM,
        };
        let at = Pos2::new(x(*place), rect.bottom());
        ui.painter().text(at, align, number, FontId::proportional(10.0), theme::STRONG);
    }
    match &scale.sums[..] {
        [] => {}
        [left, right] => {
            ui.label(RichText::new(format!("left {left}   right {right}")).small().color(theme::WEAK));
        }
        sums => {
            ui.label(RichText::new(sums.join("   ")).small().color(theme::WEAK));
        }
    }
}
