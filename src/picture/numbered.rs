//! File names with a number in them.

use std::path::{Path, PathBuf};

/// A file name in which `%04d`, or `%d`, stands for a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NumberedName {
    asked: PathBuf,
    /// Text before the number, digits, text after it, all of the last component; `None` for a plain name.
    number: Option<(String, usize, String)>,
}

impl NumberedName {
    /// The name as it was typed.
    pub fn new(asked: &Path) -> Self {
        let name = asked.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        Self { asked: asked.to_owned(), number: Self::split(name) }
    }

    fn split(name: &str) -> Option<(String, usize, String)> {
        name.match_indices('%').find_map(|(start, _)| {
            let (digits, rest) = name[start + 1..].split_once('d')?;
            let width = match digits.strip_prefix('0') {
                _ if digits.is_empty() => 1,
                Some(width) => width.parse().ok().filter(|width| (1..=20).contains(width))?,
                None => return None,
            };
            Some((name[..start].to_owned(), width, rest.to_owned()))
        })
    }

    /// Whether there is a place for a number.
    pub fn has_number(&self) -> bool {
        self.number.is_some()
    }

    /// The file of this number; always the same for a plain name.
    pub fn of(&self, number: u64) -> PathBuf {
        match &self.number {
            Some((before, width, after)) => self.asked.with_file_name(format!("{before}{number:0width$}{after}")),
            None => self.asked.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_take_the_number() {
        let name = |asked: &str| NumberedName::new(Path::new(asked)).of(7).display().to_string();
        assert_eq!(name("walk-%04d.png"), "walk-0007.png");
        assert_eq!(name("a%d/walk%d.png"), "a%d/walk7.png");
        assert_eq!(name("100%/%03d.exr"), "100%/007.exr");
        for plain in ["walk.png", "100%.png", "%4d.png", "%0d.png", "%099d.png"] {
            assert_eq!(name(plain), plain);
        }
        assert_eq!(name("5%_%02d.png"), "5%_07.png");
    }
}
