//! Names of files as other programs write them, and the files that they mean.
//!
//! A name comes from another system, or from the machine where a model was made: with backslashes, as an absolute path,
//! in another letter case, with accents as marks of their own. What it can lead to lies in the scene's folder.

use std::collections::HashMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use unicode_normalization::UnicodeNormalization;

/// Most folders, and most entries of all of them together, that are listed for one scene.
const MOST_FOLDERS: usize = 1024;
const MOST_ENTRIES: usize = 1 << 18;
/// How many folders above a file count of an absolute path.
const MOST_ABOVE: usize = 3;

/// The ways to take a name, as parts of a path, the likeliest first.
pub fn spellings(name: &str) -> impl Iterator<Item = Vec<String>> {
    let name = without_scheme(name).replace('\\', "/");
    let drive = name.as_bytes().get(1) == Some(&b':');
    let is_absolute = name.starts_with('/') || drive;
    let parts: Vec<String> =
        name.split('/').filter(|part| !part.is_empty() && *part != ".").map(String::from).collect();
    // The file beside the scene, else in the folders that the path ends with.
    let lengths = if is_absolute { 1..=parts.len().min(1 + MOST_ABOVE) } else { parts.len()..=parts.len() };
    lengths.filter(|length| *length > 0).map(move |length| parts[parts.len() - length..].to_vec())
}

/// A `file:` URI is the path that it holds.
fn without_scheme(name: &str) -> &str {
    match name.get(..5) {
        Some(scheme) if scheme.eq_ignore_ascii_case("file:") => {
            let path = name[5..].trim_start_matches('/');
            // All but the slash of a rooted path.
            if path.is_empty() || path.as_bytes().get(1) == Some(&b':') {
                path
            } else {
                &name[name.len() - path.len() - 1..]
            }
        }
        _ => name,
    }
}

/// What is in the folders where names were looked for, listed once each.
#[derive(Debug, Default)]
pub struct Folders {
    /// Names by what they have in common with other spellings.
    listed: HashMap<PathBuf, HashMap<String, Vec<OsString>>>,
    entries: usize,
}

impl Folders {
    /// The path that `parts` lead to from `folder`, without leaving `top` on the way.
    pub fn find(&mut self, folder: &Path, top: &Path, parts: &[String]) -> Option<PathBuf> {
        let mut path = folder.to_owned();
        for part in parts {
            if part == ".." {
                path = path.canonicalize().ok()?;
                path = path.parent()?.to_owned();
            } else {
                path = self.child(&path, part)?;
            }
            if !path.starts_with(top) {
                return None;
            }
        }
        Some(path)
    }

    /// The entry of a folder that a name means: of that very name, else of the same letters, else in any letter case.
    fn child(&mut self, folder: &Path, name: &str) -> Option<PathBuf> {
        if name.contains('\0') {
            return None;
        }
        let own = folder.join(name);
        if own.symlink_metadata().is_ok() {
            return Some(own);
        }
        let alike = self.list(folder)?.get(&folded(name))?;
        let same = |other: &&OsString| other.to_string_lossy().nfc().eq(name.nfc());
        alike.iter().find(same).or(alike.first()).map(|other| folder.join(other))
    }

    fn list(&mut self, folder: &Path) -> Option<&HashMap<String, Vec<OsString>>> {
        if !self.listed.contains_key(folder) {
            if self.listed.len() >= MOST_FOLDERS {
                return None;
            }
            let mut names: Vec<OsString> = Vec::new();
            for entry in folder.read_dir().into_iter().flatten().flatten() {
                self.entries += 1;
                if self.entries > MOST_ENTRIES {
                    break;
                }
                names.push(entry.file_name());
            }
            // The order that a disk lists them in tells nothing.
            names.sort_unstable();
            let mut listed: HashMap<String, Vec<OsString>> = HashMap::new();
            for name in names {
                listed.entry(folded(&name.to_string_lossy())).or_default().push(name);
            }
            self.listed.insert(folder.to_owned(), listed);
        }
        self.listed.get(folder)
    }
}

/// What names have in common that differ in letter case or Unicode form.
fn folded(name: &str) -> String {
    name.nfd().flat_map(char::to_lowercase).nfc().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::temporary::Folder;

    fn spelled(name: &str) -> Vec<String> {
        spellings(name).map(|parts| parts.join("/")).collect()
    }

    #[test]
    fn paths_of_other_machines_end_beside_the_scene() {
        assert_eq!(spelled(r"textures\.\a.png"), ["textures/a.png"]);
        assert_eq!(
            spelled(r"C:\work\my room\t\a.png"),
            ["a.png", "t/a.png", "my room/t/a.png", "work/my room/t/a.png"]
        );
        for absolute in ["/home/a.png", "file:///home/a.png", "FILE:/home/a.png", "//home/a.png"] {
            assert_eq!(spelled(absolute), ["a.png", "home/a.png"], "{absolute}");
        }
        assert_eq!(spelled("file:///C:/a.png"), ["a.png", "C:/a.png"]);
        assert!(spelled("").is_empty() && spelled("/").is_empty() && spelled("file:").is_empty());
    }

    #[test]
    fn names_are_found_in_another_letter_case_and_unicode_form() {
        let folder = Folder::new();
        let at = |name: &str| folder.write(name, "");
        std::fs::create_dir(folder.path().join("Textures")).unwrap();
        let (wood, cafe, same) = (at("Textures/Wood.png"), at("cafe\u{301}.png"), [at("a.PNG"), at("A.png")]);
        let mut folders = Folders::default();
        let mut find = |name: &str| {
            let parts: Vec<String> = name.split('/').map(String::from).collect();
            folders.find(folder.path(), folder.path(), &parts)
        };
        assert_eq!(find("textures/WOOD.PNG"), Some(wood.clone()));
        assert_eq!(
            find("textures/../textures/wood.png").map(|path| path.canonicalize().unwrap()),
            wood.canonicalize().ok()
        );
        assert_eq!(find("caf\u{e9}.png"), Some(cafe.clone()));
        assert_eq!(find("CAF\u{c9}.png"), Some(cafe));
        let [lower, upper] = same;
        assert_eq!([find("a.PNG"), find("A.png")], [Some(lower), Some(upper.clone())], "of that very name");
        assert_eq!(find("A.PNG"), Some(upper), "the first by its bytes");
        for outside in ["../Textures", "nowhere.png", "nul\0.png", "Textures/Wood.png/a"] {
            assert_eq!(find(outside), None, "{outside}");
        }
    }
}
