//! Time against error of the settings measured on this view, and the search for the cheapest that are good enough.

use super::{Change, View, theme};
use crate::app::survey::{End, Survey, for_window};
use crate::measure::chart::short;
use crate::measure::metric::{METRICS, Metric};
use crate::measure::tune::Bound;
use crate::settings::Settings;
use egui::{Align2, Button, ComboBox, DragValue, ProgressBar, RichText, Ui, Vec2b};
use egui_plot::{GridMark, HLine, HoverPosition, Line, Plot, PlotPoint, PlotPoints, Points, Text};

/// Height of the plot in points.
const HEIGHT: f32 = 190.0;
/// How far below the least error the row for no error at all stands, in decades.
const EXACT_ROW: f64 = 0.7;

/// What the overlay shows of tuning.
#[derive(Clone, Copy, Debug)]
pub struct Tuning<'a> {
    /// What the next search has to keep.
    pub bound: Bound,
    /// The last search, if there was one.
    pub survey: Option<&'a Survey>,
    /// The settings of the picture on display.
    pub drawn: &'a Settings,
    /// The walker has left the place where the search looks from.
    pub is_elsewhere: bool,
}

impl Tuning<'_> {
    /// Whether a search is under way.
    pub fn is_measuring(&self) -> bool {
        self.survey.is_some_and(|survey| survey.end.is_none())
    }
}

/// The bound, the buttons, what was found, and the plot.
pub fn show(ui: &mut Ui, view: &View<'_>, changes: &mut Vec<Change>) {
    let Tuning { bound, survey, is_elsewhere, .. } = view.tuning;
    bound_row(ui, bound, changes);
    let running = survey.filter(|survey| survey.end.is_none());
    // What takes the place of another in a row must not be taken for it.
    ui.push_id(running.is_some(), |ui| {
        ui.horizontal(|ui| match running {
            Some(survey) => {
                if ui.button("Stop").clicked() {
                    changes.push(Change::StopSearch);
                }
                ui.add(ProgressBar::new(survey.share as f32).show_percentage());
            }
            None => {
                let tune = ui.button("Tune for this view");
                let what = "find the cheapest settings within the bound; you can walk on meanwhile";
                if tune.on_hover_text(what).clicked() {
                    changes.push(Change::Search(bound));
                }
                let front = ui.button("Plot speed against error");
                let what = "measure time against error on this view, without a bound";
                if front.on_hover_text(what).clicked() {
                    changes.push(Change::Search(Bound::none(bound.metric)));
                }
            }
        });
    });
    let Some(survey) = survey else { return };
    if is_elsewhere {
        ui.label(RichText::new("measured from another place").small().color(theme::WARNING));
    }
    outcome(ui, view, survey, changes);
    if !survey.points.is_empty() {
        plot(ui, survey, survey.place_of(view.tuning.drawn));
    }
}

fn bound_row(ui: &mut Ui, bound: Bound, changes: &mut Vec<Change>) {
    ui.horizontal(|ui| {
        let name = ui.label(RichText::new("error").color(theme::WEAK));
        let combo = ComboBox::from_id_salt("metric").width(84.0).selected_text(bound.metric.name);
        let shown = combo.show_ui(ui, |ui| {
            for metric in METRICS {
                let is_selected = metric.name == bound.metric.name;
                let entry = ui.add(Button::selectable(is_selected, metric.name)).on_hover_text(metric.help);
                if entry.clicked() && !is_selected {
                    changes.push(Change::Bound(usual_bound(metric)));
                }
            }
        });
        shown.response.labelled_by(name.id).on_hover_text(bound.metric.help);
        let sign = ui.label(RichText::new(if bound.metric.is_higher_better() { "at least" } else { "at most" }));
        let mut limit = bound.limit;
        let speed = 0.01 * limit.abs().max(1e-4);
        // Beyond what equal pictures have nothing could hold.
        let most = if bound.metric.is_higher_better() { bound.metric.best.min(f64::MAX) } else { f64::MAX };
        let drag = DragValue::new(&mut limit).speed(speed).range(0.0..=most);
        let drag = drag.custom_formatter(|limit, _| short(limit));
        if ui.add(drag).labelled_by(sign.id).changed() {
            changes.push(Change::Bound(Bound { limit, ..bound }));
        }
    });
}

/// A bound to begin with: a difference that is hard to see.
pub fn usual_bound(metric: &'static Metric) -> Bound {
    let limit = match metric.name {
        "psnr" => 40.0,
        "ssim" => 0.98,
        "max_abs" => 0.1,
        "p999_abs" => 0.05,
        "pixels_off" => 1000.0,
        _ => 0.01,
    };
    Bound { metric, limit }
}

/// What was found, and the button that applies it.
fn outcome(ui: &mut Ui, view: &View<'_>, survey: &Survey, changes: &mut Vec<Change>) {
    let note = |ui: &mut Ui, text: &str| ui.label(RichText::new(text).color(theme::WEAK));
    match &survey.end {
        None => {}
        Some(End::Stopped) => {
            note(ui, "stopped");
        }
        Some(End::Nothing) => {
            note(ui, "No settings met this limit");
        }
        Some(End::Found { .. }) if survey.bound == Bound::none(survey.bound.metric) => {}
        Some(End::Found { place, simpler }) => {
            let Some(found) = survey.points.get(*place) else { return };
            ui.label(RichText::new(flags(&found.settings)).monospace().color(theme::STRONG));
            if *simpler {
                note(ui, "something else is faster, but only within noise; this is simpler");
            }
            let wanted = for_window(&found.settings, view.settings);
            let is_set = wanted == *view.settings;
            if ui.add_enabled(!is_set, Button::new(if is_set { "Applied" } else { "Apply" })).clicked() {
                changes.push(Change::Settings(wanted));
            }
        }
    }
}

fn flags(settings: &Settings) -> String {
    let flags = settings.flags();
    if flags.is_empty() { "every default".to_owned() } else { flags }
}

/// Time against error, both logarithmic; what is exact stands in a row of its own. The settings of the picture on display
/// are at `drawn`.
fn plot(ui: &mut Ui, survey: &Survey, drawn: Option<usize>) {
    let least =
        survey.points.iter().map(|point| point.error).filter(|error| *error > 0.0).fold(f64::INFINITY, f64::min);
    let exact_row = if least.is_finite() { libm::log10(least) - EXACT_ROW } else { -3.0 };
    let place = |place: usize| {
        let point = &survey.points[place];
        let error = if point.error > 0.0 { libm::log10(point.error) } else { exact_row };
        [libm::log10(point.cpu_ms), error]
    };
    let front = survey.front();
    let steps: Vec<[f64; 2]> = front.iter().map(|&i| place(i)).collect();
    let told = |position: &HoverPosition<'_>| match position {
        HoverPosition::NearDataPoint { plot_name, .. } if !plot_name.is_empty() => Some((*plot_name).to_owned()),
        _ => None,
    };
    let plot = Plot::new("front")
        .height(HEIGHT)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .allow_double_click_reset(false)
        .show_crosshair(false)
        .auto_bounds(Vec2b::TRUE)
        .set_margin_fraction(egui::vec2(0.08, 0.1))
        .x_axis_label("CPU ms")
        .y_axis_label(axis_name(&survey.bound))
        .x_grid_spacer(|input| ticks(input.bounds))
        .y_grid_spacer(|input| ticks(input.bounds))
        .x_axis_formatter(|mark, _| short(libm::pow(10.0, mark.value)))
        .y_axis_formatter(move |mark, _| {
            if mark.value < exact_row + 0.3 * EXACT_ROW { String::new() } else { short(libm::pow(10.0, mark.value)) }
        })
        .label_formatter(told);
    let response = plot.show(ui, |plot| {
        plot.hline(HLine::new("", exact_row).color(theme::LINE).allow_hover(false));
        plot.line(
            Line::new("", PlotPoints::from(steps)).color(theme::ACCENT).width(1.5).allow_band(false).allow_hover(false),
        );
        for (i, point) in survey.points.iter().enumerate() {
            let is_best = front.contains(&i);
            let color = if is_best { theme::ACCENT } else { theme::WEAK.gamma_multiply(0.6) };
            let name = format!(
                "{}\n{} CPU ms, {} {}",
                flags(&point.settings),
                short(point.cpu_ms),
                survey.bound.metric.name,
                if point.score.is_finite() { short(point.score) } else { "infinite".to_owned() }
            );
            plot.points(Points::new(name, vec![place(i)]).id(i).color(color).radius(if is_best { 4.0 } else { 2.5 }));
        }
        if let Some(drawn) = drawn {
            let dot = Points::new("", vec![place(drawn)]).id("drawn").color(theme::WARNING).radius(7.0).filled(false);
            plot.points(dot.allow_hover(false));
        }
        // Where a point is: text beyond them would widen the plot, frame by frame.
        let left = survey.points.iter().map(|point| libm::log10(point.cpu_ms)).fold(f64::INFINITY, f64::min);
        let exact = Text::new("", PlotPoint::new(left, exact_row), " exact").color(theme::WEAK);
        plot.text(exact.anchor(Align2::LEFT_BOTTOM).allow_hover(false));
    });
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "time against error"));
    let words =
        if drawn.is_some() { "ring: the settings on display" } else { "the settings on display are not measured" };
    ui.label(RichText::new(words).small().color(theme::WEAK));
}

/// What the vertical axis shows.
fn axis_name(bound: &Bound) -> String {
    let name = bound.metric.name;
    match bound.metric.best {
        best if best.is_infinite() => format!("RMSE of {name}"),
        best if best > 0.0 => format!("{best} - {name}"),
        _ => name.to_owned(),
    }
}

/// Lines at 1, 2 and 5 times powers of ten, on an axis of logarithms.
fn ticks((first, last): (f64, f64)) -> Vec<GridMark> {
    // Far apart, only the powers themselves.
    let digits: &[f64] = if last - first > 2.5 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let powers = (first.floor() as i32)..=(last.ceil() as i32);
    let marks = powers.flat_map(|power| digits.iter().map(move |digit| f64::from(power) + libm::log10(*digit)));
    let inside = marks.filter(|value| (first..=last).contains(value));
    inside.map(|value| GridMark { value, step_size: 1.0 }).collect()
}
