//! One frame from scene, camera and settings. No window, no file.
//!
//! `frame` makes the plan and hands tiles to workers; `tile` runs one tile: `visibility` finds what each sample sees,
//! then queue by queue `shade` adds local light and queues rays, `shadow`, `mirror` and `trace` trace them, `secondary`
//! follows mirrors and glass; `resolve` encodes the result. Then `adaptive` gives pixels more samples where neighbours
//! differ. All of it runs in lanes, a packet of rays at a time.

mod absorption;
mod accumulate;
mod adaptive;
mod brdf;
mod contact;
mod direct;
mod enlarge;
mod extent;
pub mod film;
mod frame;
mod gather;
mod inside;
mod leave;
pub mod ledger;
mod materials;
mod media;
mod mirror;
pub mod plan;
mod queue;
mod relief;
mod resolve;
mod samples;
mod secondary;
mod shade;
mod shadow;
mod skin;
mod sky;
pub mod stats;
mod tables;
mod texture_place;
mod tile;
mod trace;
mod trail;
mod visibility;

pub use film::{Film, Planes};
pub use frame::{CancelToken, Scratch, TileCount, render_frame, thread_count};
pub use ledger::{Decision, Obtained};
pub use plan::Plan;
pub use stats::FrameStats;
