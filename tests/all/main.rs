//! All integration tests, in one binary: one module a subject.

mod cli;
mod imports;
mod scene_errors;
mod scene_files;
mod scene_loading;
mod temporary;
