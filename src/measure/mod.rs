//! x
pub mod difference;
pub mod metric;
pub mod statistics;
