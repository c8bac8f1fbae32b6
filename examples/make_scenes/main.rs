//! Writes what in `scenes/` is computed rather than typed: the textures, the sphereflake and the tiny spheres.
//!
//! `cargo run --release --example make_scenes [FOLDER]` (default `scenes`) writes the same bytes on every machine:
//! the noise is a hash of whole numbers, and the functions that differ between systems come from `libm`.

mod canvas;
mod noise;
mod paintings;
mod sphereflake;
mod surfaces;
mod tiny_spheres;

use anyhow::Context;
use canvas::Paint;
use std::path::PathBuf;

/// Every picture: file name, edge in pixels, and what is on it.
const PICTURES: &[(&str, u32, Paint)] = &[
    ("marble_tiles", 512, surfaces::marble_tiles),
    ("parquet", 512, surfaces::parquet),
    ("paving", 256, surfaces::paving),
    ("plaster", 256, surfaces::plaster),
    ("rug", 512, surfaces::rug),
    ("wood", 256, surfaces::wood),
    ("squares", 256, paintings::squares),
    ("sunset", 256, paintings::sunset),
    ("julia", 384, paintings::julia),
    ("waves", 384, paintings::waves),
    ("night", 256, paintings::night),
    ("circles", 256, paintings::circles),
    ("arcs", 256, paintings::arcs),
    ("poppies", 384, paintings::poppies),
    ("birches", 384, paintings::birches),
];

fn main() -> anyhow::Result<()> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("scenes"), PathBuf::from);
    let textures = folder.join("textures");
    std::fs::create_dir_all(&textures).with_context(|| format!("cannot make {}", textures.display()))?;
    for &(name, edge, paint) in PICTURES {
        let file = textures.join(name).with_extension("png");
        canvas::picture(edge, paint).save(&file).with_context(|| format!("cannot write {}", file.display()))?;
    }
    let stress = folder.join("stress");
    std::fs::create_dir_all(&stress).with_context(|| format!("cannot make {}", stress.display()))?;
    let written = [
        (folder.join("sphereflake.json"), sphereflake::scene(sphereflake::GENERATIONS)),
        (stress.join("tiny_spheres.json"), tiny_spheres::scene()),
    ];
    for (file, text) in written {
        std::fs::write(&file, text).with_context(|| format!("cannot write {}", file.display()))?;
    }
    Ok(())
}
