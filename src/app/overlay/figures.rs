//! What the last frame cost: rays, pixels, stages.

use super::theme;
use crate::render::FrameStats;
use egui::{Grid, RichText, Ui};

/// A table of figures, empty ones left out.
pub fn show(ui: &mut Ui, stats: &FrameStats) {
    let (rays, pixels, stages) = (&stats.rays, &stats.pixels, &stats.stages_ms);
    let counts = |pairs: &[(&'static str, u64)]| -> Vec<(&'static str, String)> {
        pairs.iter().filter(|(_, count)| *count > 0).map(|&(name, count)| (name, grouped(count))).collect()
    };
    let groups = [
        (
            "rays",
            counts(&[
                ("primary", rays.primary),
                ("shadow", rays.shadow),
                ("reflection", rays.reflection),
                ("refraction", rays.refraction),
            ]),
        ),
        (
            "pixels",
            counts(&[
                ("traced", pixels.traced),
                ("resolved", pixels.resolved),
                ("certified", pixels.certified),
                ("interpolated", pixels.interpolated),
                ("supersampled", stats.supersampled),
            ]),
        ),
        (
            "CPU ms",
            [
                ("visibility", stages.visibility),
                ("certificate", stages.certificate),
                ("shadow", stages.shadow),
                ("shade", stages.shade),
                ("secondary", stages.secondary),
                ("resolve", stages.resolve),
                ("present", stages.present),
            ]
            .into_iter()
            .filter(|(_, milliseconds)| *milliseconds > 0.0)
            .map(|(name, milliseconds)| (name, format!("{milliseconds:.2}")))
            .collect(),
        ),
        ("shadow cache", cache(stats)),
    ];
    Grid::new("figures").num_columns(3).spacing([12.0, 2.0]).show(ui, |ui| {
        for (group, figures) in groups {
            for (i, (name, figure)) in figures.into_iter().enumerate() {
                ui.label(RichText::new(if i == 0 { group } else { "" }).color(theme::WEAK));
                ui.label(name);
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    ui.label(RichText::new(figure).monospace().color(theme::STRONG));
                });
                ui.end_row();
            }
        }
    });
}

fn cache(stats: &FrameStats) -> Vec<(&'static str, String)> {
    let cache = &stats.shadow_cache;
    if cache.queries == 0 {
        return Vec::new();
    }
    vec![("hits", format!("{:.1} %", 100.0 * cache.hits as f64 / cache.queries as f64))]
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
