//! `map_Kd -s 2 2 1 -clamp on bricks.png`: a texture of a material library, and its options.

use super::statement::{Statement, bare};
use crate::scene::desc::problem::{At, Outcome, Problem};
use crate::scene::desc::{ImageDesc, ImageSource, NameRef, TextureDesc, TextureKind};
use crate::scene::format::words::{Word, Words};
use crate::scene::material::Lookup;
use crate::scene::texture::{Sampler, Wrap};
use glam::{Affine2, Vec2};
use std::collections::HashSet;

/// A texture as a statement names it.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The image's file, with forward slashes.
    pub file: String,
    /// What texture coordinates go through first: `-s` scales them, `-o` moves them.
    pub transform: Affine2,
    /// `-clamp on`: it is not repeated.
    pub is_clamped: bool,
    /// `-bm`: what heights are multiplied by.
    pub bump: f32,
}

/// Options with as many values as this; those of the three that end the list may leave out the last two. Programs do not
/// agree on capitals.
const OPTIONS: [(&[u8], usize); 15] = [
    (b"-blendu", 1),
    (b"-blendv", 1),
    (b"-bm", 1),
    (b"-boost", 1),
    (b"-cc", 1),
    (b"-clamp", 1),
    (b"-colorspace", 1),
    (b"-imfchan", 1),
    (b"-mm", 2),
    (b"-texres", 1),
    (b"-texopt", 1),
    (b"-type", 1),
    (b"-o", 3),
    (b"-s", 3),
    (b"-t", 3),
];

/// The option that a word is, and how many values it has.
fn option(word: Word) -> Option<(&'static [u8], usize)> {
    OPTIONS.into_iter().find(|(name, _)| name.eq_ignore_ascii_case(word.bytes))
}

/// What the options of a statement say.
struct Options {
    scale: Vec2,
    offset: Vec2,
    is_clamped: bool,
    bump: f32,
}

impl Options {
    /// Reads the values of an option that stand next, and the options behind them. Those that change how an image is blended,
    /// sharpened or reduced are read and left.
    fn read(&mut self, words: &mut Words, odd: &mut Vec<Problem>) {
        while let Some((name, values)) = words.peek().and_then(option) {
            words.next();
            match name {
                b"-bm" => match words.next().map(|word| word.number()) {
                    Some(Ok(bump)) => self.bump = bump as f32,
                    Some(Err(problem)) => odd.push(left_out(&problem)),
                    None => {}
                },
                b"-clamp" => self.is_clamped = words.next().is_some_and(|word| word.bytes.eq_ignore_ascii_case(b"on")),
                b"-o" | b"-s" | b"-t" => {
                    let default = if name == b"-s" { Vec2::ONE } else { Vec2::ZERO };
                    let mut numbers = [None; 3];
                    for number in &mut numbers {
                        let Some(value) =
                            words.peek().filter(|word| word.parsed().is_some() || is_no_number(word.bytes))
                        else {
                            break;
                        };
                        words.next();
                        *number = value
                            .number()
                            .map_err(|problem| odd.push(left_out(&problem)))
                            .ok()
                            .map(|value| value as f32);
                    }
                    let pair = Vec2::new(numbers[0].unwrap_or(default.x), numbers[1].unwrap_or(default.y));
                    match name {
                        b"-o" => self.offset = pair,
                        b"-s" => self.scale = pair,
                        _ => {}
                    }
                }
                _ => drop(words.by_ref().take(values).last()),
            }
        }
    }
}

/// Whether a word is how programs write a number that is none.
fn is_no_number(word: &[u8]) -> bool {
    let word = word.strip_prefix(b"-").or_else(|| word.strip_prefix(b"+")).unwrap_or(word).to_ascii_lowercase();
    let is_of = |kind: &[u8]| word.strip_prefix(kind).is_some_and(|rest| rest.is_empty() || rest.starts_with(b"("));
    is_of(b"nan") || is_of(b"inf") || is_of(b"infinity") || word.starts_with(b"1.#")
}

/// What is told of something that is left out.
pub fn left_out(problem: &Problem) -> Problem {
    Problem::new(problem.at, format!("{}; it is left out", problem.message))
}

/// Reads the options and the file of a statement. `find` says where the file of a name is; without one, it is as the
/// statement names it. Values of options that are none are told as `odd`.
pub fn read(
    statement: &Statement,
    mut find: impl FnMut(&str) -> Option<String>,
    odd: &mut Vec<Problem>,
) -> Outcome<Map> {
    let mut words = statement.words.clone();
    let mut options = Options { scale: Vec2::ONE, offset: Vec2::ZERO, is_clamped: false, bump: 1.0 };
    options.read(&mut words, odd);
    let start =
        words.peek().ok_or_else(|| Problem::new(statement.at, format!("{} names no file", statement.shown())))?;
    // A file's name may hold blanks and marks; what is no file may have a comment or options behind it.
    let whole = statement.name_from(start.at);
    words.next();
    let behind = words.clone().find(|word| option(*word).is_some());
    let mut file = find(&whole);
    if let Some(behind) = behind.filter(|_| file.is_none()) {
        let name = statement.name_between(start.at, behind.at);
        file = Some(find(bare(&name)).unwrap_or_else(|| slashes(bare(&name))));
        while words.peek().is_some_and(|word| word.at < behind.at) {
            words.next();
        }
        options.read(&mut words, odd);
    }
    let Options { scale, offset, is_clamped, bump } = options;
    Ok(Map {
        file: file.or_else(|| find(bare(&whole))).unwrap_or_else(|| slashes(bare(&whole))),
        transform: Affine2::from_scale_angle_translation(scale, 0.0, offset),
        is_clamped,
        bump,
    })
}

/// A name with forward slashes; some programs write paths as one of the systems they run on has them.
pub fn slashes(name: &str) -> String {
    name.replace('\\', "/")
}

/// The paths by which a file may be found that is named in a library within `folder`: programs write paths of the machine
/// they ran on, or from the library's folder; a file of that name there or beside the scene will do.
pub fn paths(name: &str, folder: &str) -> Vec<String> {
    let mut paths = Vec::new();
    for name in [slashes(name), narrow_slashes(name)] {
        let alone = name.rsplit('/').next().unwrap_or_default().to_owned();
        let within = |name: &str| if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") };
        paths.extend([within(&name), within(&alone), name, alone]);
    }
    // As it stands, from where the scene is, before all others.
    paths.swap(0, 2);
    paths.dedup();
    paths
}

/// The same, but for backslashes that may be the second byte of a character.
fn narrow_slashes(name: &str) -> String {
    let mut before = ' ';
    let slash = |character: char| {
        let is_wide = ('\u{80}'..='\u{FF}').contains(&std::mem::replace(&mut before, character));
        if character == '\\' && !is_wide { '/' } else { character }
    };
    name.chars().map(slash).collect()
}

/// The textures that maps name, each once.
#[derive(Debug, Default)]
pub struct Textures {
    pub descs: Vec<TextureDesc>,
    names: HashSet<String>,
    /// Where the library stands that is being read, in the file that names it.
    pub at: At,
}

impl Textures {
    /// How a material looks a map up.
    pub fn lookup(&mut self, map: Map) -> Lookup<NameRef> {
        self.texture(map, "", ImageSource::File)
    }

    /// How a material looks a map up whose opacity another file holds.
    pub fn masked(&mut self, map: Map, opacity: String) -> Lookup<NameRef> {
        let by = format!(" masked by {opacity}");
        let opacity = NameRef { name: opacity, at: self.at };
        self.texture(map, &by, |name| ImageSource::Masked { name, opacity })
    }

    /// How a material of one colour looks its opacity up.
    pub fn opacity(&mut self, map: Map) -> Lookup<NameRef> {
        self.texture(map, " as opacity", ImageSource::Opacity)
    }

    fn texture(&mut self, map: Map, kind: &str, source: impl FnOnce(NameRef) -> ImageSource) -> Lookup<NameRef> {
        let Map { file, transform, is_clamped, .. } = map;
        let reference = |name: String| NameRef { name, at: self.at };
        let name = reference(format!("{file}{kind}{}", if is_clamped { ", clamped" } else { "" }));
        if self.names.insert(name.name.clone()) {
            let wrap = if is_clamped { Wrap::Clamp } else { Wrap::Repeat };
            let image = ImageDesc {
                source: source(reference(file)),
                sampler: Sampler { wrap: [wrap; 2], ..Sampler::default() },
                optional: true,
            };
            self.descs.push(TextureDesc { name: name.clone(), kind: TextureKind::Image(image), size: 1.0 });
        }
        Lookup { transform, ..Lookup::new(name) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::statement::statements;
    use super::*;

    /// A map where the files of some names are.
    fn map_beside(text: &str, files: &[&str]) -> (Outcome<Map>, Vec<Problem>) {
        let mut odd = Vec::new();
        let find = |name: &str| paths(name, "").into_iter().find(|path| files.contains(&path.as_str()));
        let map = read(&statements(text.as_bytes()).next().unwrap(), find, &mut odd);
        (map, odd)
    }

    fn map(text: &str) -> Outcome<Map> {
        map_beside(text, &[]).0
    }

    fn file(text: &str, files: &[&str]) -> String {
        map_beside(text, files).0.unwrap().file
    }

    #[test]
    fn names_may_hold_blanks_and_backslashes() {
        assert_eq!(file("map_Kd  wood\\old oak #1.png \r\n", &["wood/old oak #1.png"]), "wood/old oak #1.png");
        assert_eq!(file("map_Kd wood\\oak.png # old", &[]), "wood/oak.png");
        assert_eq!(file("map_Kd \"old oak.png\"", &[]), "old oak.png");
        assert_eq!(file("map_Kd -type sphere -mm 0 1 a.png", &[]), "a.png");
        assert_eq!(file("map_Kd -x.png", &[]), "-x.png");
        for nothing in ["map_Kd", "map_Kd -clamp on", "map_Kd -mm 0 1", "map_Kd -s 1 2 3"] {
            assert!(map(nothing).unwrap_err().message.contains("map_Kd names no file"), "{nothing}");
        }
    }

    #[test]
    fn options_change_coordinates_and_heights() {
        let map = map("bump -bm 0.5 -s 2 -o 0.25 0.5 0 -clamp on a b.png").unwrap();
        assert_eq!((map.file.as_str(), map.is_clamped, map.bump), ("a b.png", true, 0.5));
        assert_eq!(map.transform.transform_point2(Vec2::ONE), Vec2::new(2.25, 1.5));
        let (map, odd) = map_beside("bump -bm much -s 1e39 2 a.png", &[]);
        let map = map.unwrap();
        assert_eq!((map.file.as_str(), map.bump, odd.len()), ("a.png", 1.0, 2));
        assert_eq!(map.transform.transform_point2(Vec2::ONE), Vec2::new(1.0, 2.0));
    }

    #[test]
    fn options_may_stand_behind_names_and_in_capitals() {
        let text = "map_Kd -CLAMP ON a b.png -S 2 3 1 -O 1 # c";
        let map = map(text).unwrap();
        assert_eq!((map.file.as_str(), map.is_clamped), ("a b.png", true));
        assert_eq!(map.transform.transform_point2(Vec2::ONE), Vec2::new(3.0, 3.0));
        // A file of just that name is it.
        assert_eq!(file("map_Kd a -s 2.png", &["a -s 2.png"]), "a -s 2.png");
    }

    #[test]
    fn files_are_sought_along_the_path_and_beside() {
        assert_eq!(paths("C:\\me\\a.png", "sub")[..4], ["C:/me/a.png", "sub/a.png", "sub/C:/me/a.png", "a.png"]);
        // In Shift-JIS and GBK, a backslash may be the second half of a character.
        assert!(paths("maps\\\u{95}\\.png", "").contains(&"maps/\u{95}\\.png".to_owned()));
    }
}
