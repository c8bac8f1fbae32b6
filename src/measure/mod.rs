//! How fast and how true: error metrics, difference pictures, timed runs and their records; benches.
//!
//! A bench goes `sweep` (what is measured) -> `bench` (measuring) -> `records` (on disk) -> `chart` and `page` (drawn
//! from the records alone). `tune` searches for the cheapest settings that are good enough.
//!
//! Architecture invariant: nothing here changes a frame; it only calls [`render_frame`](crate::render::render_frame)
//! and looks at what comes back.

pub mod bench;
pub mod chart;
pub mod colormap;
pub mod counts;
pub mod difference;
pub mod front;
pub mod metric;
pub mod motion;
pub mod page;
pub mod pops;
pub mod record;
pub mod records;
pub mod run;
pub mod stability;
pub mod statistics;
pub mod summary;
pub mod sweep;
pub mod system;
pub mod table;
pub mod thesis;
pub mod tune;
pub mod watch;

pub use motion::MotionMeter;
pub use record::Record;
pub use run::Run;
