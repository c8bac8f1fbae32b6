//! All integration tests, in one binary: one module a subject.

mod blit;
mod cli;
mod imports;
mod our_scenes;
mod overlay;
mod readme;
mod scene_errors;
mod scene_files;
mod scene_loading;
mod temporary;
