//! The scene shown when none is named, embedded in the program.

use super::format::{LoadOptions, load_embedded};
use super::{Scene, SceneError};

/// The built-in scene's file and, after it, the textures it names. The one place to edit when they change.
const FILES: &[(&str, &[u8])] = &[("base.json", include_bytes!("../../scenes/base.json"))];

/// Loads the built-in scene.
///
/// # Errors
/// Only what `options` ask for beyond the defaults, such as lower limits.
pub fn builtin(options: &LoadOptions) -> Result<Scene, SceneError> {
    load_embedded(FILES[0].0, FILES, options)
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
