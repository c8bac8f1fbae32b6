//! Beams: what a whole block of rays can meet, proven once for all of them.
//!
//! Rays of a block share an apex (the eye, a light) or a direction. A [`Beam`] holds them all; a walk through the tree
//! ([`collect`]) lists every primitive that any of them can hit as the per-ray kernels see it, and finds a primitive
//! that *covers* the block: whatever lies behind it is dropped. The list is handed down to smaller beams
//! ([`filter`](Candidates::filter)) and at last its few members are tested ray by ray ([`resolve`]), if a look at their
//! outlines does not tell that all rays pass them by. Beams choose
//! candidates; every number comes from the kernels, so that the result is that of tracing each ray on its own.
//!
//! Tried, and no faster: sifting once more for each packet of 4x4 pixels instead of looking at the outlines ray by ray.
//!
//! Margins: a kernel decides as if its primitive had been moved by some rounding errors, each at most 2^-24 of a
//! coordinate in play. A beam takes every primitive to be larger by [`SLACK`] of the largest coordinate when it looks
//! for what can be dropped, and smaller by as much when it looks for covers.

mod collect;
#[cfg(test)]
mod laws;
mod list;
mod outline;
mod projection;
mod resolve;

pub use list::Candidates;
pub use outline::Outline;
pub use projection::{Beam, Blocking, Cover, Points, Projection};

/// What a kernel's verdict can be off by, as a share of the largest coordinate in play: a hundred rounding errors.
/// The kernels' own paddings, the transformations into a beam's space, and the directions' rounding go into it.
pub const SLACK: f32 = 6e-6;
