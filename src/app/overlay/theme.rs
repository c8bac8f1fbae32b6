//! Colours and spacings of the overlay: legible over any picture, and cheap to draw.

use crate::settings::Promise;
use egui::{Color32, CornerRadius, Stroke};

/// Behind everything. Opaque, so that text is legible over any scene, and because what shines through would have to be
/// mixed anew for every pixel of every frame.
pub const BACKGROUND: Color32 = Color32::from_rgb(16, 18, 24);
/// Figures and whatever deserves a look.
pub const STRONG: Color32 = Color32::from_rgb(236, 240, 247);
/// Names of figures and controls.
pub const WEAK: Color32 = Color32::from_rgb(150, 160, 178);
/// Selected things and the graph.
pub const ACCENT: Color32 = Color32::from_rgb(94, 170, 255);
/// Lines between things.
pub const LINE: Color32 = Color32::from_rgb(52, 58, 70);
/// Something went wrong.
pub const FAILURE: Color32 = Color32::from_rgb(240, 120, 110);
/// Something to mind.
pub const WARNING: Color32 = Color32::from_rgb(240, 178, 84);

/// The parts of a bar, in order: viridis from dark to light, so that neighbours differ in lightness.
pub const PARTS: [Color32; 7] = [
    Color32::from_rgb(0x6b, 0x2a, 0x86),
    Color32::from_rgb(0x5d, 0x55, 0xb0),
    Color32::from_rgb(0x31, 0x68, 0x8e),
    Color32::from_rgb(0x21, 0x91, 0x8c),
    Color32::from_rgb(0x35, 0xb7, 0x79),
    Color32::from_rgb(0x90, 0xd7, 0x43),
    Color32::from_rgb(0xfd, 0xe7, 0x25),
];

/// The colour of a promise: the calmer, the nearer to the reference picture.
pub fn promise_color(promise: Promise) -> Color32 {
    match promise {
        Promise::SamePixels => Color32::from_rgb(104, 190, 128),
        Promise::Approximate => WARNING,
        Promise::Different => Color32::from_rgb(226, 122, 122),
    }
}

/// Sets the looks. No shadows: on a software adapter they cost more than everything else.
pub fn apply(context: &egui::Context) {
    context.set_theme(egui::Theme::Dark);
    context.all_styles_mut(|style| {
        let visuals = &mut style.visuals;
        visuals.window_shadow = egui::Shadow::NONE;
        visuals.popup_shadow = egui::Shadow::NONE;
        visuals.window_fill = BACKGROUND;
        visuals.panel_fill = BACKGROUND;
        visuals.window_stroke = Stroke::new(1.0, LINE);
        visuals.window_corner_radius = CornerRadius::same(4);
        visuals.menu_corner_radius = CornerRadius::same(4);
        visuals.override_text_color = None;
        visuals.selection.bg_fill = Color32::from_rgb(38, 84, 140);
        visuals.selection.stroke = Stroke::new(1.0, STRONG);
        visuals.slider_trailing_fill = true;
        visuals.indent_has_left_vline = false;
        visuals.widgets.noninteractive.fg_stroke = Stroke::new(1.0, Color32::from_rgb(196, 203, 216));
        visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
        visuals.widgets.inactive.bg_fill = Color32::from_rgb(44, 50, 62);
        visuals.widgets.inactive.weak_bg_fill = Color32::from_rgb(38, 43, 54);
        visuals.widgets.hovered.weak_bg_fill = Color32::from_rgb(56, 64, 80);
        // Every blink would be a picture.
        visuals.text_cursor.blink = false;
        style.spacing.item_spacing = egui::vec2(8.0, 5.0);
        style.spacing.slider_width = 84.0;
        style.spacing.combo_width = 132.0;
        style.spacing.indent = 16.0;
        // Room for the scroll bar, which else lies on what is scrolled.
        style.spacing.scroll.floating_allocated_width = 8.0;
        style.interaction.tooltip_delay = 0.3;
    });
}
