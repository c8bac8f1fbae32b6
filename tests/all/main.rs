//! All integration tests, in one binary: one module a subject.

mod accumulation;
mod adversary;
mod blit;
mod cli;
mod determinism;
mod exactness;
mod flat_mirrors;
mod imports;
mod our_scenes;
mod overlay;
mod picture_bits;
mod random;
mod readme;
mod reference;
mod scene_errors;
mod scene_files;
mod scene_loading;
mod stress;
mod subsampling;
mod temporary;
