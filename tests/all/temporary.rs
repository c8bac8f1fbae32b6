//! A folder of files for one test.

use raywalk::scene::{LoadOptions, Scene, SceneError, load};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// A folder of its own that is removed at the end.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("raywalk-test-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Writes a file and gives its path.
    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, contents).unwrap();
        path
    }

    /// Loads a text as the scene `s.json` of this folder.
    pub fn load(&self, text: impl AsRef<[u8]>, options: &LoadOptions) -> Result<Scene, SceneError> {
        load(&self.write("s.json", text), options)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Loads a text as a scene in an empty folder.
pub fn load_text(text: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
    Folder::new().load(text, &LoadOptions::default())
}

/// Loads objects with nothing else around them.
pub fn load_objects(objects: &str) -> Scene {
    load_text(format!(r#"{{ "version": 1, "objects": [{objects}] }}"#)).unwrap()
}
