//! `map_Kd -s 2 2 1 -clamp on bricks.png`: a texture of a material library, and its options.

use super::statement::Statement;
use crate::scene::desc::problem::{At, Outcome, Problem};
use crate::scene::desc::{ImageDesc, ImageSource, NameRef, TextureDesc, TextureKind};
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

/// Options with as many values as this; those of the three that end the list may leave out the last two.
const OPTIONS: [(&[u8], usize); 14] = [
    (b"-blendu", 1),
    (b"-blendv", 1),
    (b"-bm", 1),
    (b"-boost", 1),
    (b"-cc", 1),
    (b"-clamp", 1),
    (b"-imfchan", 1),
    (b"-mm", 2),
    (b"-texres", 1),
    (b"-texopt", 1),
    (b"-type", 1),
    (b"-o", 3),
    (b"-s", 3),
    (b"-t", 3),
];

/// Reads the options and the file of a statement. Options that change how an image is blended, sharpened or reduced are
/// read and left.
pub fn read(statement: &Statement) -> Outcome<Map> {
    let mut words = statement.words.clone();
    let (mut scale, mut offset) = (Vec2::ONE, Vec2::ZERO);
    let mut map = Map { file: String::new(), transform: Affine2::IDENTITY, is_clamped: false, bump: 1.0 };
    while let Some(word) = words.peek() {
        let Some((_, values)) = OPTIONS.iter().find(|(name, _)| *name == word.bytes) else {
            map.file = statement.name_from(word.at).replace('\\', "/");
            break;
        };
        words.next();
        match word.bytes {
            b"-bm" => map.bump = words.number("-bm")? as f32,
            b"-clamp" => map.is_clamped = words.next().is_some_and(|word| word.bytes == b"on"),
            b"-o" | b"-s" | b"-t" => {
                let mut numbers = [None; 3];
                for number in &mut numbers {
                    let Some(value) = words.peek().and_then(|word| word.parsed()) else { break };
                    words.number("-o or -s")?;
                    *number = Some(value as f32);
                }
                match word.bytes {
                    b"-o" => offset = Vec2::new(numbers[0].unwrap_or(0.0), numbers[1].unwrap_or(0.0)),
                    b"-s" => scale = Vec2::new(numbers[0].unwrap_or(1.0), numbers[1].unwrap_or(1.0)),
                    _ => {}
                }
            }
            _ => drop(words.by_ref().take(*values).last()),
        }
    }
    map.transform = Affine2::from_scale_angle_translation(scale, 0.0, offset);
    match map.file.is_empty() {
        true => Err(Problem::new(statement.at, format!("{} names no file", statement.shown()))),
        false => Ok(map),
    }
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

    fn map(text: &str) -> Outcome<Map> {
        read(&statements(text.as_bytes()).next().unwrap())
    }

    #[test]
    fn names_may_hold_blanks_and_backslashes() {
        assert_eq!(map("map_Kd  wood\\old oak #1.png \r\n").unwrap().file, "wood/old oak #1.png");
        assert_eq!(map("map_Kd -type sphere -mm 0 1 a.png").unwrap().file, "a.png");
        assert_eq!(map("map_Kd -x.png").unwrap().file, "-x.png");
        for nothing in ["map_Kd", "map_Kd -clamp on", "map_Kd -mm 0 1", "map_Kd -s 1 2 3"] {
            assert!(map(nothing).unwrap_err().message.contains("map_Kd names no file"), "{nothing}");
        }
    }

    #[test]
    fn options_change_coordinates_and_heights() {
        let map = map("bump -bm 0.5 -s 2 -o 0.25 0.5 0 -clamp on a b.png").unwrap();
        assert_eq!((map.file.as_str(), map.is_clamped, map.bump), ("a b.png", true, 0.5));
        assert_eq!(map.transform.transform_point2(Vec2::ONE), Vec2::new(2.25, 1.5));
        assert!(self::map("bump -bm much a.png").is_err());
    }
}
