//! JSON, read lazily: a node is a slice of the text, and its address gives line, column and pointer.
//!
//! The whole text is checked for syntax once. After that each level is split into its values only
//! when it is asked for, and long lists of numbers are read in one go, so that a scene of a million
//! triangles needs no tree in memory.

use super::place::{by_line, byte_offset, line_column};
use super::{Input, settle};
use crate::scene::Camera;
use crate::scene::build::SceneBuilder;
use crate::scene::desc::map::{Map, shortened};
use crate::scene::desc::node::{Field, Kind, Node};
use crate::scene::desc::problem::{At, Outcome, Problem, Warnings};
use crate::scene::desc::{self, Context};
use crate::scene::error::{Place, SceneError};
use crate::scene::limits::{Limits, exceeded};
use glam::DVec3;
use serde::de::{DeserializeOwned, Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use std::borrow::Cow;
use std::collections::HashSet;
use std::fmt;
use std::marker::PhantomData;
use std::path::Path;

/// Reads a JSON scene into `builder`.
pub fn read(input: &Input, builder: &mut SceneBuilder) -> Result<(), SceneError> {
    let document = Document::parse(input.path, input.bytes, builder.limits().nesting)?;
    let mut context = Context { limits: builder.limits(), warnings: Warnings::default() };
    let described = desc::read(document.root(), &mut context);
    settle(described, context.warnings, builder, |positions| document.places(positions))
}

/// Reads a camera from a text that `name` stands for in errors: a camera alone, or something with a `camera` in it, such
/// as a scene; for a scene that was moved so that `origin` is at its origin.
///
/// # Errors
/// The text is no JSON, or what it holds is no camera; with line, column and pointer.
pub fn read_camera(name: &str, text: &str, origin: DVec3) -> Result<Camera, SceneError> {
    let limits = Limits::default();
    let document = Document::parse(Path::new(name), text.as_bytes(), limits.nesting)?;
    let mut context = Context { limits: &limits, warnings: Warnings::default() };
    let mut read = || {
        let node = Map::open(document.root())?.take("camera").unwrap_or(document.root());
        desc::camera::read(node, String::new(), &mut context)?.place(origin)
    };
    read().map_err(|problem| {
        let place = document.places(&[problem.at]).remove(0);
        SceneError::Invalid { place, message: problem.message }
    })
}

/// The outermost value of a text, for formats that read values in their own way; the text's syntax and nesting are
/// checked. Errors have their line and column.
pub(super) fn outermost<'t>(file: &'t Path, bytes: &'t [u8], nesting: u64) -> Result<&'t RawValue, SceneError> {
    Document::parse(file, bytes, nesting).map(|document| document.root)
}

/// A text of valid JSON syntax.
struct Document<'t> {
    file: &'t Path,
    text: &'t str,
    root: &'t RawValue,
}

impl<'t> Document<'t> {
    fn parse(file: &'t Path, bytes: &'t [u8], nesting: u64) -> Result<Self, SceneError> {
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        let invalid = |at: usize, message: String| {
            let line_column = Some(line_column(bytes, at));
            let place = Place { file: file.to_owned(), line_column, pointer: String::new() };
            SceneError::Invalid { place, message }
        };
        let text = std::str::from_utf8(bytes).map_err(|error| {
            invalid(error.valid_up_to(), "the text is not UTF-8; save the file in that encoding".to_owned())
        })?;
        let root = serde_json::from_str(text).map_err(|error| {
            let at = byte_offset(bytes, error.line(), error.column());
            invalid(at, format!("not valid JSON: {}", without_position(&error)))
        })?;
        match first_deeper_than(bytes, nesting) {
            None => Ok(Self { file, text, root }),
            Some(at) => Err(invalid(at, format!("levels of nesting: {}", exceeded("nesting", nesting)))),
        }
    }

    /// The outermost value.
    fn root(&self) -> Json<'t> {
        Json { text: self.text, raw: self.root }
    }

    /// Line, column and pointer of positions, found in one walk that enters only what holds any of them.
    fn places(&self, positions: &[At]) -> Vec<Place> {
        let mut sorted: Vec<(At, usize)> = positions.iter().copied().zip(0..).collect();
        sorted.sort_unstable();
        let mut pointers = vec![String::new(); positions.len()];
        point(self.root(), "", &sorted, &mut pointers);
        let places = by_line(self.file, self.text.as_bytes(), positions).into_iter();
        places.zip(pointers).map(|(place, pointer)| Place { pointer, ..place }).collect()
    }
}

/// Writes the pointers of the `wanted` positions, sorted and all within `node`.
fn point(node: Json, pointer: &str, wanted: &[(At, usize)], pointers: &mut [String]) {
    for &(_, i) in wanted {
        pointer.clone_into(&mut pointers[i]);
    }
    let mut enter = |start: At, child: Json, segment: &dyn Fn() -> String| {
        let end = At(child.at().0 + child.raw.get().len());
        let within = &wanted[wanted.partition_point(|w| w.0 < start)..wanted.partition_point(|w| w.0 < end)];
        if !within.is_empty() {
            point(child, &format!("{pointer}/{}", segment()), within, pointers);
        }
    };
    match node.kind() {
        Kind::List => {
            let items = node.items().unwrap_or_default();
            items.into_iter().enumerate().for_each(|(i, item)| enter(item.at(), item, &|| i.to_string()));
        }
        Kind::Map => {
            for (key, value) in node.entries().unwrap_or_default() {
                enter(node.key_at(value), node.child(value), &|| shortened(&key).replace('~', "~0").replace('/', "~1"));
            }
        }
        _ => {}
    }
}

/// Where a list or map of valid JSON first lies more than `levels` deep. Asked before any recursion, and
/// before the text is split level by level, which takes time in proportion to its depth.
fn first_deeper_than(text: &[u8], levels: u64) -> Option<usize> {
    let (mut depth, mut in_string, mut escaped) = (0, false, false);
    text.iter().position(|byte| {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => in_string = !in_string,
            b'{' | b'[' if !in_string => depth += 1,
            b'}' | b']' if !in_string => depth -= 1,
            _ => {}
        }
        depth > levels
    })
}

/// A value within the text.
#[derive(Clone, Copy)]
struct Json<'t> {
    text: &'t str,
    raw: &'t RawValue,
}

impl<'t> Json<'t> {
    fn child(&self, raw: &'t RawValue) -> Self {
        Self { raw, ..*self }
    }

    fn offset(&self, raw: &RawValue) -> At {
        At(raw.get().as_ptr().addr() - self.text.as_ptr().addr())
    }

    /// Where the key before a value starts.
    fn key_at(&self, value: &RawValue) -> At {
        let before = &self.text.as_bytes()[..self.offset(value).0];
        let colon = before.trim_ascii_end();
        let key = colon.strip_suffix(b":").unwrap_or(colon).trim_ascii_end();
        let inside = key.strip_suffix(b"\"").unwrap_or(key);
        // The opening quote is the last one that no odd number of backslashes stands before.
        let opens =
            |i: &usize| inside[*i] == b'"' && inside[..*i].iter().rev().take_while(|b| **b == b'\\').count() % 2 == 0;
        At((0..inside.len()).rev().find(opens).unwrap_or(inside.len()))
    }

    /// The values of a map as they stand, names that stand twice included.
    fn entries(&self) -> Outcome<Vec<(Cow<'t, str>, &'t RawValue)>> {
        let Entries(entries) = self.parse("an object")?;
        Ok(entries)
    }

    fn parse<T: Deserialize<'t>>(&self, expected: &str) -> Outcome<T> {
        serde_json::from_str(self.raw.get()).map_err(|error| match error.classify() {
            serde_json::error::Category::Data => self.mismatch(expected),
            // What the first pass over the syntax does not look at: escapes within strings, the size of numbers.
            _ => Problem::new(self.at(), format!("not valid JSON: {}", without_position(&error))),
        })
    }
}

impl<'t> Node<'t> for Json<'t> {
    fn at(self) -> At {
        self.offset(self.raw)
    }

    fn kind(self) -> Kind {
        match self.raw.get().as_bytes().first() {
            Some(b'{') => Kind::Map,
            Some(b'[') => Kind::List,
            Some(b'"') => Kind::Text,
            Some(b't' | b'f') => Kind::Boolean,
            Some(b'n') => Kind::Null,
            _ => Kind::Number,
        }
    }

    fn fields(self) -> Outcome<Vec<Field<'t, Self>>> {
        let entries = self.entries()?;
        let mut seen = HashSet::with_capacity(entries.len());
        if let Some((key, value)) = entries.iter().find(|(key, _)| !seen.insert(key)) {
            let message = format!("the key \"{}\" stands twice in this object; remove one", shortened(key));
            return Err(Problem::new(self.key_at(value), message));
        }
        let field = |(key, value)| Field { key, at: self.key_at(value), value: self.child(value) };
        Ok(entries.into_iter().map(field).collect())
    }

    fn items(self) -> Outcome<Vec<Self>> {
        let items: Vec<&'t RawValue> = self.parse("a list")?;
        Ok(items.into_iter().map(|raw| self.child(raw)).collect())
    }

    fn number(self) -> Outcome<f64> {
        self.parse("a number")
    }

    fn text(self) -> Outcome<Cow<'t, str>> {
        self.parse("a string").map(|Text(text)| text)
    }

    fn boolean(self) -> Outcome<bool> {
        self.parse("true or false")
    }

    fn number_rows<const N: usize>(self) -> Option<Vec<[f64; N]>> {
        rows(self.raw)
    }

    fn index_rows<const N: usize>(self) -> Option<Vec<[u32; N]>> {
        rows(self.raw)
    }
}

/// Rows of numbers, as long as every one of them is a `T`.
fn rows<T: DeserializeOwned + Copy + Default, const N: usize>(raw: &RawValue) -> Option<Vec<[T; N]>> {
    let rows: Vec<Row<T, N>> = serde_json::from_str(raw.get()).ok()?;
    Some(rows.into_iter().map(|Row(row)| row).collect())
}

/// `N` numbers; serde knows arrays only by the length.
struct Row<T, const N: usize>([T; N]);

impl<'de, T: Deserialize<'de> + Copy + Default, const N: usize> Deserialize<'de> for Row<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct RowVisitor<T, const N: usize>(PhantomData<T>);
        impl<'de, T: Deserialize<'de> + Copy + Default, const N: usize> Visitor<'de> for RowVisitor<T, N> {
            type Value = Row<T, N>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                write!(f, "{N} numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
                let mut row = [T::default(); N];
                for (i, value) in row.iter_mut().enumerate() {
                    *value = sequence.next_element()?.ok_or_else(|| A::Error::invalid_length(i, &self))?;
                }
                Ok(Row(row))
            }
        }
        deserializer.deserialize_seq(RowVisitor(PhantomData))
    }
}

/// A string, borrowed from the text unless it holds escapes.
#[derive(Deserialize)]
struct Text<'t>(#[serde(borrow)] Cow<'t, str>);

/// The entries of a map in order, names that stand twice included.
struct Entries<'t>(Vec<(Cow<'t, str>, &'t RawValue)>);

impl<'de> Deserialize<'de> for Entries<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EntriesVisitor;
        impl<'de> Visitor<'de> for EntriesVisitor {
            type Value = Entries<'de>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some((Text(key), value)) = map.next_entry()? {
                    entries.push((key, value));
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(EntriesVisitor)
    }
}

/// The parser's message without its own idea of the position.
fn without_position(error: &serde_json::Error) -> String {
    let message = error.to_string();
    message.rfind(" at line ").map_or(message.as_str(), |end| &message[..end]).to_owned()
}
