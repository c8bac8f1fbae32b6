//! The scene shown when none is named, embedded in the program.

use super::format::{LoadOptions, load_embedded, load_text};
use super::{Scene, SceneError};

/// A file of `scenes/` under its name there.
macro_rules! embed {
    ($name:literal) => {
        ($name, include_bytes!(concat!("../../scenes/", $name)))
    };
}

/// The built-in scene's file and, after it, the textures it names. The one place to edit when they change.
const FILES: &[(&str, &[u8])] = &[
    embed!("gallery.json"),
    embed!("textures/arcs.png"),
    embed!("textures/birches.png"),
    embed!("textures/circles.png"),
    embed!("textures/julia.png"),
    embed!("textures/marble_tiles.png"),
    embed!("textures/night.png"),
    embed!("textures/parquet.png"),
    embed!("textures/paving.png"),
    embed!("textures/plaster.png"),
    embed!("textures/poppies.png"),
    embed!("textures/rug.png"),
    embed!("textures/squares.png"),
    embed!("textures/sunset.png"),
    embed!("textures/waves.png"),
    embed!("textures/wood.png"),
];

/// Loads the built-in scene.
///
/// # Errors
/// Only what `options` ask for beyond the defaults, such as lower limits.
pub fn builtin(options: &LoadOptions) -> Result<Scene, SceneError> {
    load_embedded(FILES[0].0, FILES, options)
}

/// An empty scene, to be shown where there is none yet.
///
/// # Errors
/// None, unless the program has a fault.
pub fn nothing() -> Result<Scene, SceneError> {
    let text = r#"{ "version": 1, "render": { "background": 0.012 } }"#;
    let scene = load_text("nothing.json", text, &LoadOptions::default())?;
    Ok(Scene { name: "nothing".to_owned(), warnings: Vec::new(), ..scene })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_without_warnings() {
        let scene = builtin(&LoadOptions { strict: true, ..LoadOptions::default() }).unwrap();
        assert!(!scene.objects.is_empty() && !scene.lights.is_empty());
    }
}
