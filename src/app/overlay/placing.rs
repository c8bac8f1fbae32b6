//! Boxes that hang on an edge of the window, placed by the size they have.

use egui::{Area, Context, Id, Ui};

/// Shows the anchored `area` of this `id`.
///
/// egui places it by its size in the pass before. While nothing else changes there is no pass after this one to put that
/// right, so a change of its size asks for another at once.
pub fn show(ctx: &Context, id: Id, area: Area, add_contents: impl FnOnce(&mut Ui)) {
    let size = || ctx.memory(|memory| memory.area_rect(id)).map(|rect| rect.size());
    let before = size();
    area.show(ctx, add_contents);
    if size() != before {
        ctx.request_discard("an anchored area is of another size");
        if !ctx.will_discard() {
            ctx.request_repaint();
        }
    }
}
