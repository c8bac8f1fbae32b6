//! The help window: keys, settings with what they promise, and how the methods work. Keys, presets and settings come
//! from the lists that they are made from; only the topics are written here.

use super::{Change, theme};
use crate::app::history::ONE_PERCENT_LOW;
use crate::app::input::HELP;
use crate::app::labels::Labels;
use crate::settings::{Kind, PRESETS, Promise, ROWS, Row};
use egui::{Align2, CollapsingHeader, RichText, ScrollArea, Ui, Window};

/// Width of the text in points: some eighty characters.
const WIDTH: f32 = 560.0;
/// Most of the window's height that the help takes.
const SHARE: f32 = 0.86;
/// With less room than this, in points, keys stand above what they do and not beside it.
const TWO_COLUMNS: f32 = 300.0;
/// Room for the names of keys beside what they do, in points.
const KEY_COLUMN: f32 = 130.0;
/// In windows with less room than this, in points, there is nothing to read in.
const LEAST_ROOM: egui::Vec2 = egui::vec2(200.0, 140.0);

/// What each promise means.
const PROMISES: [(Promise, &str); 3] = [
    (Promise::SamePixels, "every value of every channel keeps its bits, against the preset exact"),
    (Promise::Approximate, "the same picture, with errors; Auto-tune in the panel measures them"),
    (Promise::Different, "another picture, by intent"),
];

/// How it works, in short.
const TOPICS: [(&str, &str); 8] = [
    (
        "What you see",
        "Every frame is ray-traced on the processor; the graphics adapter only shows it. While you move, frames are \
         traced one after the other, each from the newest place. When you stop, one more sample of each pixel is added \
         a pass until there are 16, and then nothing is computed until you move again.",
    ),
    (
        "Certified visibility",
        "A block of 32 x 32 pixels is asked once what it can see: its beam walks the tree and lists all that any of its \
         rays could hit. Quarters of the block sift the list, down to 8 x 8 pixels. Where one thing is left that covers \
         the cell, that is proven for all its pixels; else each ray is tested against the few that are left. The picture \
         is that of a ray for every pixel, bit for bit.",
    ),
    (
        "Subsampling",
        "A grid of rays every 2 to 16 pixels; a cell whose corners see the same thing is taken to see nothing else. \
         Whatever passes between the corners, such as a wire, is lost. fill hit computes the light of every pixel, fill \
         color blends that of the corners.",
    ),
    (
        "Blended light",
        "fill color with certified visibility, as in the preset balanced: within a cell that is proven to see one surface \
         in one state of light, light is computed on a grid and blended between. It loses no thing; a highlight smaller \
         than the cell it can miss.",
    ),
    (
        "Caches",
        "shadow-cache tests what blocked a light last time before anything else; sphere-cache computes once what all \
         rays from one place share. Both keep the pixels. sphere-cache difference subtracts the squared radius beforehand, \
         which cancels for spheres that are far away.",
    ),
    (
        "Supersampling",
        "Several rays a pixel on a regular grid, averaged in linear light. adaptive gives 16 where neighbours differ and \
         one elsewhere.",
    ),
    (
        "Speed while moving",
        "render-scale traces a smaller picture and enlarges it. target-fps lowers the preset, then the scale, for as \
         long as you move and frames take too long; the status line says what it does.",
    ),
    (
        "Figures",
        "Frame times are those of tracing. CPU ms are summed over all threads. Rays are those really traced; pixels are \
         traced by a ray of their own, resolved from a short list, certified with their block, or interpolated.",
    ),
];

/// Draws the window; asks to close it when its cross is clicked.
pub fn show(ui: &Ui, labels: &Labels, changes: &mut Vec<Change>) {
    let room = ui.ctx().content_rect().size();
    if room.x < LEAST_ROOM.x || room.y < LEAST_ROOM.y {
        return;
    }
    let mut open = true;
    Window::new("Help")
        .open(&mut open)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .collapsible(false)
        .resizable(false)
        .order(egui::Order::Foreground)
        .show(ui.ctx(), |ui| {
            ui.set_width(WIDTH.min(room.x - 48.0).max(1.0));
            // Without the height of the title and the frame.
            let height = (SHARE * room.y - 56.0).max(1.0);
            // Both ways: whatever does not wrap would make the window wider than there is room, and put its left edge
            // out of sight.
            ScrollArea::both().max_height(height).min_scrolled_height(height).auto_shrink([false, true]).show(
                ui,
                |ui| {
                    ui.set_max_width(ui.available_width());
                    contents(ui, labels);
                },
            );
        });
    if !open {
        changes.push(Change::ToggleHelp);
    }
}

fn contents(ui: &mut Ui, labels: &Labels) {
    section(ui, "Keys", |ui| keys(ui, labels));
    section(ui, "How it works", topics);
    section(ui, "What settings promise", promises);
    section(ui, "Presets", |ui| {
        for preset in PRESETS {
            entry(ui, preset.name, preset.help);
        }
    });
    section(ui, "Settings", |ui| ROWS.iter().for_each(|row| setting(ui, row)));
    ui.label(RichText::new("F1 or Esc closes this window.").color(theme::WEAK));
}

fn section(ui: &mut Ui, title: &'static str, add_contents: impl FnOnce(&mut Ui)) {
    let text = RichText::new(title).size(15.0).strong().color(theme::STRONG);
    // The panel has sections of the same names.
    CollapsingHeader::new(text).id_salt(("help", title)).default_open(true).show(ui, add_contents);
    ui.add_space(4.0);
}

/// Keys and what they do: in the help and in the panel.
pub fn keys(ui: &mut Ui, labels: &Labels) {
    if ui.available_width() < TWO_COLUMNS {
        HELP.iter().for_each(|(keys, what)| entry(ui, &labels.of(keys), what));
        return;
    }
    let widest = ui.available_width() - KEY_COLUMN;
    egui::Grid::new("keys").num_columns(2).spacing([16.0, 3.0]).max_col_width(widest).show(ui, |ui| {
        for (keys, what) in HELP {
            ui.label(RichText::new(labels.of(keys)).color(theme::STRONG));
            ui.add(egui::Label::new(RichText::new(*what).color(theme::WEAK)).wrap());
            ui.end_row();
        }
    });
}

fn topics(ui: &mut Ui) {
    for (title, text) in TOPICS {
        entry(ui, title, text);
    }
    entry(ui, "1 % low", ONE_PERCENT_LOW.trim_start_matches("1 % low: "));
}

fn promises(ui: &mut Ui) {
    for (promise, text) in PROMISES {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(promise.to_string()).color(theme::promise_color(promise)));
            ui.label(RichText::new(text).color(theme::WEAK));
        });
    }
}

/// A setting's name and help, and its values with what they promise.
fn setting(ui: &mut Ui, row: &Row) {
    entry(ui, row.name, row.help);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        match &row.kind {
            Kind::Choice(choices) => {
                for group in choices.chunk_by(|a, b| a.promise == b.promise) {
                    let values: Vec<&str> = group.iter().map(|choice| choice.value).collect();
                    value(ui, &values.join(", "), group[0].promise);
                }
            }
            Kind::Number { min, max, promise, .. } => value(ui, &format!("{min} to {max}"), *promise),
        }
    });
    ui.add_space(4.0);
}

fn value(ui: &mut Ui, values: &str, promise: Promise) {
    ui.label(RichText::new(values).monospace());
    ui.label(RichText::new(promise.to_string()).small().color(theme::promise_color(promise)));
}

fn entry(ui: &mut Ui, name: &str, text: &str) {
    ui.label(RichText::new(name).color(theme::STRONG));
    ui.label(RichText::new(text).color(theme::WEAK));
}
