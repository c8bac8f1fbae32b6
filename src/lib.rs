//! raywalk: a first-person walkthrough viewer that ray-traces every frame on CPU threads.

pub mod settings;

pub mod math;

pub mod geometry;
pub mod measure;
pub mod picture;
pub mod render;
pub mod scene;

pub mod app;
