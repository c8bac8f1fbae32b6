//! The frame-time graph: one bar a frame, newest on the right, and the percentiles below.

use super::theme;
use crate::app::history::{History, ONE_PERCENT_LOW, Summary};
use crate::measure::statistics::Spread;
use egui::{Align2, Color32, FontId, Mesh, Pos2, Rect, RichText, Sense, Shape, Stroke, Ui, vec2};

/// Height in points.
const HEIGHT: f32 = 64.0;
/// Width of a bar in points, its gap included.
const BAR: f32 = 2.0;
/// Marks in milliseconds: 60, 30, 20 and so on frames a second. The highest two that fit are drawn.
const MARKS: [f64; 10] = [1.0, 5.0, 16.7, 33.3, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0];
/// Least distance between the words of two marks, and from the lower edge, as a share of the height.
const APART: f64 = 0.2;

/// Draws the graph.
pub fn show(ui: &mut Ui, history: &History) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "frame times"));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, Color32::from_rgb(10, 11, 15));
    let bars = (rect.width() / BAR) as usize;
    let shown: Vec<f64> = history.milliseconds().skip(history.milliseconds().len().saturating_sub(bars)).collect();
    let top = scale(&shown);
    let y = |milliseconds: f64| rect.bottom() - rect.height() * (milliseconds / top).clamp(0.0, 1.0) as f32;
    // One mesh for all bars: a shape each would cost the tessellator more than the rest of the panel.
    let mut mesh = Mesh::default();
    for (i, &milliseconds) in shown.iter().rev().enumerate() {
        let right = rect.right() - i as f32 * BAR;
        let bar = Rect::from_min_max(Pos2::new(right - BAR + 0.5, y(milliseconds)), Pos2::new(right, rect.bottom()));
        mesh.add_colored_rect(bar, theme::ACCENT);
    }
    painter.add(Shape::mesh(mesh));
    for mark in marks(top) {
        let height = y(mark);
        painter.hline(rect.x_range(), height, Stroke::new(1.0, Color32::from_rgba_premultiplied(60, 60, 60, 60)));
        let place = Pos2::new(rect.left() + 4.0, height);
        painter.text(place, Align2::LEFT_CENTER, format!("{mark} ms"), FontId::proportional(10.0), theme::STRONG);
    }
    let (times, low) = history.summary().map_or_else(|| ("no frame yet".to_owned(), String::new()), words);
    for (line, told) in [(times, SPREAD), (low, ONE_PERCENT_LOW)].into_iter().filter(|(line, _)| !line.is_empty()) {
        ui.label(RichText::new(line).small().color(theme::WEAK)).on_hover_text(told);
    }
}

/// What the line of percentiles means.
const SPREAD: &str = "of the last 1000 frames: half take no longer than the median, 95 % no longer than p95, 99 % no \
                      longer than p99";

/// "median 8.0   p95 8.0   p99 8.0   max 200.0 ms" and "1 % low 36.8 fps".
fn words(Summary { spread, one_percent_low }: Summary) -> (String, String) {
    let Spread { median, p95, p99, max, .. } = spread;
    let times = format!("median {median:.1}   p95 {p95:.1}   p99 {p99:.1}   max {max:.1} ms");
    (times, format!("1 % low {one_percent_low:.1} fps"))
}

/// The milliseconds at the top: room for the highest bar, and no lower than a display's frame.
fn scale(shown: &[f64]) -> f64 {
    let highest = shown.iter().copied().fold(0.0, f64::max);
    (1.15 * highest).max(20.0)
}

/// The marks that are drawn in a graph up to `top`, from the upper one down.
fn marks(top: f64) -> impl Iterator<Item = f64> {
    let mut above = 0.95 * top;
    let fitting = MARKS.into_iter().rev().filter(move |&mark| {
        let fits = mark < above && mark > APART * top;
        if fits {
            above = mark - APART * top;
        }
        fits
    });
    fitting.take(2)
}

#[cfg(test)]
mod tests {
    use super::{marks, scale};

    #[test]
    fn marks_do_not_cover_each_other() {
        for (top, shown) in
            [(20.0, &[16.7, 5.0][..]), (57.0, &[50.0, 33.3]), (476.0, &[200.0, 100.0]), (2200.0, &[2000.0, 1000.0])]
        {
            assert_eq!(marks(top).collect::<Vec<_>>(), shown, "{top}");
        }
        assert!((1..5000).all(|top| marks(f64::from(top).max(20.0)).count() > 0));
    }

    #[test]
    fn the_highest_bar_fits() {
        assert_eq!(scale(&[]), 20.0);
        assert_eq!(scale(&[3.0, 7.0]), 20.0);
        assert!(scale(&[10.0, 200.0]) > 200.0);
    }
}
