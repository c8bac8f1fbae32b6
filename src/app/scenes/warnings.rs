//! A scene's warnings in short: one line of what they are mostly about, and each without the scene's own folder.

use crate::scene::Warning;
use std::path::Path;

/// What some warnings are about: how their messages are recognised, and one and many of it in words.
struct Kind {
    parts: &'static [&'static str],
    one: &'static str,
    many: &'static str,
}

/// A message is of the first kind that has a part of it.
const KINDS: &[Kind] = &[
    Kind {
        parts: &["cannot read image", "textures missing", "maps other than colours missing"],
        one: "texture missing",
        many: "textures missing",
    },
    Kind {
        parts: &["cannot decode image", "textures cannot be decoded", "maps other than colours cannot be decoded"],
        one: "texture not decoded",
        many: "textures not decoded",
    },
    Kind { parts: &["cannot read the materials of"], one: "material file missing", many: "material files missing" },
    Kind {
        parts: &["is not supported", "is not drawn", "unknown statement"],
        one: "feature not supported",
        many: "features not supported",
    },
];

/// All warnings in a few words: "35 textures missing", "2 warnings". Empty without any.
pub fn summary(warnings: &[Warning]) -> String {
    let mut counts = vec![0; KINDS.len()];
    let (mut lines_of_kind, mut total) = (vec![0; KINDS.len()], 0);
    for warning in warnings {
        let count = count(&warning.message);
        total += count;
        let kind = KINDS.iter().position(|kind| kind.parts.iter().any(|part| warning.message.contains(part)));
        if let Some(kind) = kind {
            counts[kind] += count;
            lines_of_kind[kind] += 1;
        }
    }
    let most = (0..KINDS.len()).max_by_key(|&kind| counts[kind]).filter(|&kind| 2 * counts[kind] > total);
    let Some(kind) = most else { return numbered(warnings.len(), "warning", "warnings") };
    let line = numbered(counts[kind], KINDS[kind].one, KINDS[kind].many);
    match warnings.len() - lines_of_kind[kind] {
        0 => line,
        rest => format!("{line}, {}", numbered(rest, "other warning", "other warnings")),
    }
}

/// How many cases a warning stands for: equal ones are merged to "35 textures missing: first a.png".
fn count(message: &str) -> usize {
    let (number, rest) = message.split_once(' ').unwrap_or_default();
    let merged = if rest.contains(": first ") { number.parse().ok() } else { times(message) };
    merged.unwrap_or(1)
}

/// The number of "... (4 times, the first here)".
fn times(message: &str) -> Option<usize> {
    let before = message.strip_suffix(" times, the first here)")?;
    before[before.rfind('(')? + 1..].parse().ok()
}

fn numbered(count: usize, one: &str, many: &str) -> String {
    match count {
        0 => String::new(),
        1 => format!("1 {one}"),
        _ => format!("{count} {many}"),
    }
}

/// A warning with paths relative to `folder`, the scene's.
pub fn relative(warning: &Warning, folder: Option<&Path>) -> String {
    let text = warning.to_string();
    let Some(folder) = folder.filter(|folder| !folder.as_os_str().is_empty()) else { return text };
    let with_end = |folder: &Path| format!("{}{}", folder.display(), std::path::MAIN_SEPARATOR);
    let absolute = std::path::absolute(folder).ok();
    let longer_first = absolute.as_deref().into_iter().chain([folder]);
    longer_first.fold(text, |text, folder| text.replace(&with_end(folder), ""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::error::Place;

    fn warnings(messages: &[&str]) -> Vec<Warning> {
        let warning = |message: &&str| {
            let place = Place { file: "scenes/room.obj".into(), line_column: Some((3, 1)), pointer: String::new() };
            Warning { place, message: (*message).to_owned() }
        };
        messages.iter().map(warning).collect()
    }

    #[test]
    fn warnings_of_mostly_one_kind_are_counted_by_it() {
        let missing = "cannot read image \"a.png\": No such file or directory (os error 2); a placeholder is shown";
        for (messages, line) in [
            (&[][..], ""),
            (&["node 7 does not exist; left out"], "1 warning"),
            (&[missing], "1 texture missing"),
            (&[missing, missing, "node 7 does not exist"], "2 textures missing, 1 other warning"),
            (&["35 textures missing: first a.png"], "35 textures missing"),
            (
                &["30 textures missing: first a.png", "5 maps other than colours missing: first b.png"],
                "35 textures missing",
            ),
            (&["a position that is no number (4 times, the first here)", missing], "2 warnings"),
            (&["KHR_xmp is not supported; what it says is left out"], "1 feature not supported"),
            (&["map_Ns is not drawn", "unknown statement \"vw\" is ignored"], "2 features not supported"),
            (&["a", "b", missing, "12 objects hold triangles without area, which are left out: first c"], "4 warnings"),
        ] {
            assert_eq!(summary(&warnings(messages)), line, "{messages:?}");
        }
    }

    #[test]
    fn paths_are_relative_to_the_scene() {
        let warning = &warnings(&["cannot read image \"scenes/maps/a.png\""])[0];
        let short = "room.obj:3:1: cannot read image \"maps/a.png\"";
        assert_eq!(relative(warning, Some(Path::new("scenes"))), short);
        assert_eq!(relative(warning, None), warning.to_string());
        assert_eq!(relative(warning, Some(Path::new(""))), warning.to_string());
        let folder = std::path::absolute("scenes").expect("there is a current folder");
        let place = Place { file: folder.join("room.obj"), ..warning.place.clone() };
        let absolute = Warning { place, ..warning.clone() };
        assert!(relative(&absolute, Some(Path::new("scenes"))).starts_with("room.obj:3:1: "));
    }
}
