//! Stacked bars: what shares a whole has.

use super::theme;
use egui::{Mesh, Pos2, Rect, Sense, Shape, Ui, vec2};

/// Height of a bar and the side of a swatch, in points.
const HEIGHT: f32 = 12.0;
const SWATCH: f32 = 8.0;

/// Draws `parts`, each with its colour's place in [`theme::PARTS`], as shares of their sum. Pointed at, a part tells its
/// name, its share and what `told` makes of it.
pub fn stacked(ui: &mut Ui, name: &str, parts: &[(usize, &str, f64)], told: impl Fn(f64) -> String) {
    let sum: f64 = parts.iter().map(|(_, _, part)| part).sum();
    if sum <= 0.0 {
        return;
    }
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
    let pointed_at = response.hover_pos().map(|position| f64::from((position.x - rect.left()) / rect.width()) * sum);
    let x = |part: f64| rect.left() + rect.width() * (part / sum) as f32;
    let mut mesh = Mesh::default();
    let mut words = None;
    let mut before = 0.0;
    for &(color, part_name, part) in parts {
        let after = before + part;
        let place = Rect::from_min_max(Pos2::new(x(before), rect.top()), Pos2::new(x(after), rect.bottom()));
        mesh.add_colored_rect(place, theme::PARTS[color % theme::PARTS.len()]);
        if pointed_at.is_some_and(|at| (before..after).contains(&at)) {
            words = Some(format!("{part_name}: {}, {:.0} % of the {name}", told(part), 100.0 * part / sum));
        }
        before = after;
    }
    ui.painter_at(rect).add(Shape::mesh(mesh));
    if let Some(words) = words {
        response.on_hover_text(words);
    }
}

/// A square in a part's colour, to stand before its name.
pub fn swatch(ui: &mut Ui, color: usize) {
    let (rect, _) = ui.allocate_exact_size(vec2(SWATCH, SWATCH), Sense::hover());
    let mut mesh = Mesh::default();
    mesh.add_colored_rect(rect, theme::PARTS[color % theme::PARTS.len()]);
    ui.painter().add(Shape::mesh(mesh));
}
