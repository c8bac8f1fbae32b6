//! All integration tests, in one binary: one module a subject.

mod blit;
mod cli;
mod imports;
mod overlay;
mod scene_errors;
mod scene_files;
mod scene_loading;
mod temporary;
