//! What the last frame cost: rays, pixels, stages.

use super::{bars, theme};
use crate::render::FrameStats;
use egui::{Grid, RichText, Ui};

/// A line of the table: the place of its colour where it is part of a bar, its name, its figure.
type Line = (Option<usize>, &'static str, String);

/// Bars of the stages and of the rays by kind, and a table of all figures, empty ones left out.
pub fn show(ui: &mut Ui, stats: &FrameStats) {
    let (rays, pixels, stages) = (&stats.rays, &stats.pixels, &stats.stages_ms);
    let stages = [
        ("visibility", stages.visibility),
        ("certificate", stages.certificate),
        ("shadow", stages.shadow),
        ("shade", stages.shade),
        ("secondary", stages.secondary),
        ("resolve", stages.resolve),
        ("present", stages.present),
    ];
    let rays = [
        ("primary", rays.primary),
        ("shadow", rays.shadow),
        ("reflection", rays.reflection),
        ("refraction", rays.refraction),
    ];
    let pixels = [
        ("traced", pixels.traced),
        ("resolved", pixels.resolved),
        ("certified", pixels.certified),
        ("interpolated", pixels.interpolated),
        ("supersampled", stats.supersampled),
    ];
    let stages = used(stages);
    let rays = used(rays.map(|(name, count)| (name, count as f64)));
    bars::stacked(ui, "CPU time", &stages, |milliseconds| format!("{milliseconds:.2} ms"));
    bars::stacked(ui, "rays", &rays, |count| grouped(count as u64));
    let groups: [(&str, Vec<Line>); 4] = [
        ("CPU ms", stages.iter().map(|&(color, name, ms)| (Some(color), name, format!("{ms:.2}"))).collect()),
        ("rays", rays.iter().map(|&(color, name, count)| (Some(color), name, grouped(count as u64))).collect()),
        ("pixels", pixels.into_iter().filter(|(_, n)| *n > 0).map(|(name, n)| (None, name, grouped(n))).collect()),
        ("shadow cache", cache(stats)),
    ];
    Grid::new("figures").num_columns(3).spacing([12.0, 2.0]).show(ui, |ui| {
        for (group, figures) in groups {
            for (i, (color, name, figure)) in figures.into_iter().enumerate() {
                ui.label(RichText::new(if i == 0 { group } else { "" }).color(theme::WEAK));
                ui.horizontal(|ui| {
                    if let Some(color) = color {
                        bars::swatch(ui, color);
                    }
                    ui.label(name);
                });
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    ui.label(RichText::new(figure).monospace().color(theme::STRONG));
                });
                ui.end_row();
            }
        }
    });
}

/// The parts that are there, each with the place of its colour, which is the same in every frame.
fn used<const N: usize>(parts: [(&'static str, f64); N]) -> Vec<(usize, &'static str, f64)> {
    let parts = parts.into_iter().enumerate().map(|(color, (name, part))| (color, name, part));
    parts.filter(|(_, _, part)| *part > 0.0).collect()
}

fn cache(stats: &FrameStats) -> Vec<Line> {
    let cache = &stats.shadow_cache;
    if cache.queries == 0 {
        return Vec::new();
    }
    vec![(None, "hits", format!("{:.1} %", 100.0 * cache.hits as f64 / cache.queries as f64))]
}

/// A count with its thousands apart.
fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::grouped;

    #[test]
    fn thousands_stand_apart() {
        for (count, text) in [(0, "0"), (999, "999"), (1000, "1 000"), (921_600, "921 600"), (1_234_567, "1 234 567")] {
            assert_eq!(grouped(count), text);
        }
    }
}
