//! How fast and how true: error metrics, difference pictures, timed runs and their records.
//!
//! Architecture invariant: nothing here changes a frame; it only calls [`render_frame`](crate::render::render_frame)
//! and looks at what comes back.

pub mod counts;
pub mod difference;
pub mod metric;
pub mod motion;
pub mod record;
pub mod run;
pub mod statistics;
pub mod system;

pub use motion::MotionMeter;
pub use record::Record;
pub use run::Run;
