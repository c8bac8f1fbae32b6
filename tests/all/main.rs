//! Integration tests, in one binary: one module a subject. What breaks methods by design is in `stability.rs`.

mod accumulation;
mod adaptive;
mod adversary;
mod bench;
mod blit;
mod cli;
mod command_line;
mod contact_sheet;
mod contacts;
mod corpus;
mod crowds;
mod determinism;
mod entry;
mod environment;
mod exactness;
mod far_coordinates;
mod flat_mirrors;
#[path = "../common/flips.rs"]
mod flips;
mod formats;
mod gltf;
mod imports;
mod instancing;
mod interpolation;
mod lettering;
mod maps;
mod our_scenes;
mod overlay;
#[path = "../common/picture_bits.rs"]
mod picture_bits;
mod progress;
#[path = "../common/random.rs"]
mod random;
mod readme;
mod reference;
mod scene_errors;
mod scene_files;
mod scene_loading;
#[cfg(unix)]
mod signals;
mod sky_light;
mod stress;
mod subsampling;
mod surfaces;
mod temporary;
mod terminal;
#[path = "../common/tracer/mod.rs"]
mod tracer;
mod tune;
