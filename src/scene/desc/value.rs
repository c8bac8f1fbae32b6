//! Plain values: numbers, vectors and colours, each checked to be finite in f32.

use super::map::shortened;
use super::node::{Kind, Node};
use super::problem::{Outcome, Problem};
use crate::scene::texture::srgb_to_linear;
use glam::{DVec3, Vec3};
use std::ops::RangeInclusive;

/// A number that is finite when narrowed to f32.
pub fn number<'t>(node: impl Node<'t>) -> Outcome<f64> {
    let value = node.number()?;
    if !(value as f32).is_finite() {
        return Err(Problem::new(node.at(), "the number is too large; the greatest is 3.4e38"));
    }
    Ok(value)
}

/// A number within a range.
pub fn number_in<'t, N: Node<'t>>(range: RangeInclusive<f64>) -> impl Fn(N) -> Outcome<f32> {
    move |node| {
        let value = number(node)?;
        if !range.contains(&value) {
            let (min, max) = (range.start(), range.end());
            let wanted = match max.is_finite() {
                true => format!("expected a number from {min} to {max}"),
                false => format!("expected a number of at least {min}"),
            };
            return Err(Problem::new(node.at(), format!("{value} is out of range; {wanted}")));
        }
        Ok(value as f32)
    }
}

/// A number that is at least 0.
pub fn not_negative<'t>(node: impl Node<'t>) -> Outcome<f32> {
    number_in(0.0..=f64::INFINITY)(node)
}

/// A number greater than 0, in f32 too.
pub fn positive<'t>(node: impl Node<'t>) -> Outcome<f64> {
    let value = number(node)?;
    match value as f32 > 0.0 {
        true => Ok(value),
        false => Err(Problem::new(node.at(), format!("{value} is out of range; expected a number greater than 0"))),
    }
}

/// A whole number within a range.
pub fn integer_in<'t, N: Node<'t>>(range: RangeInclusive<u32>) -> impl Fn(N) -> Outcome<u32> {
    move |node| {
        let value = node.number()?;
        let (min, max) = (*range.start(), *range.end());
        if value.fract() != 0.0 || value < f64::from(min) || value > f64::from(max) {
            let message = format!("{value} is out of range; expected a whole number from {min} to {max}");
            return Err(Problem::new(node.at(), message));
        }
        Ok(value as u32)
    }
}

/// True or false.
pub fn boolean<'t>(node: impl Node<'t>) -> Outcome<bool> {
    node.boolean()
}

/// A string.
pub fn text<'t>(node: impl Node<'t>) -> Outcome<String> {
    Ok(node.text()?.into_owned())
}

/// As many numbers as `N`.
pub fn tuple<'t, const N: usize>(node: impl Node<'t>) -> Outcome<[f64; N]> {
    if node.kind() != Kind::List {
        return Err(node.mismatch(&format!("a list of {N} numbers")));
    }
    let items = node.items()?;
    if items.len() != N {
        return Err(Problem::new(node.at(), format!("expected {N} numbers, found {}", items.len())));
    }
    let mut values = [0.0; N];
    for (value, item) in values.iter_mut().zip(items) {
        *value = number(item)?;
    }
    Ok(values)
}

/// A point or a vector.
pub fn vector<'t>(node: impl Node<'t>) -> Outcome<DVec3> {
    tuple(node).map(DVec3::from_array)
}

/// A unit vector; any length but 0 is given.
pub fn direction<'t>(node: impl Node<'t>) -> Outcome<DVec3> {
    let problem = || Problem::new(node.at(), "a direction of length 0; at least one number must differ from 0");
    vector(node)?.try_normalize().ok_or_else(problem)
}

/// A list of `N` values read by `read`.
pub fn array<'t, T, N: Node<'t>, const LENGTH: usize>(node: N, read: impl Fn(N) -> Outcome<T>) -> Outcome<[T; LENGTH]> {
    let values: Vec<T> = node.items()?.into_iter().map(read).collect::<Outcome<_>>()?;
    let found = values.len();
    values.try_into().map_err(|_| Problem::new(node.at(), format!("expected {LENGTH} values, found {found}")))
}

/// A weight per channel: a number or a triple, none negative.
pub fn weight<'t>(node: impl Node<'t>) -> Outcome<Vec3> {
    channels(node, f64::INFINITY)
}

/// A share of the light per channel: a number or a triple, each from 0 to 1.
pub fn share<'t>(node: impl Node<'t>) -> Outcome<Vec3> {
    channels(node, 1.0)
}

fn channels<'t>(node: impl Node<'t>, max: f64) -> Outcome<Vec3> {
    match node.kind() {
        Kind::Number => number_in(0.0..=max)(node).map(Vec3::splat),
        Kind::List => array(node, number_in(0.0..=max)).map(Vec3::from_array),
        _ => Err(node.mismatch("a number or a list of 3 numbers")),
    }
}

/// A linear colour: a number, a triple or "#rrggbb", which is decoded from sRGB.
pub fn color<'t>(node: impl Node<'t>) -> Outcome<Vec3> {
    match node.kind() {
        Kind::Text => hex_color(node),
        Kind::Number | Kind::List => weight(node),
        _ => Err(node.mismatch("a colour (a number, 3 numbers or \"#rrggbb\")")),
    }
}

fn hex_color<'t>(node: impl Node<'t>) -> Outcome<Vec3> {
    let text = node.text()?;
    let digits = text.strip_prefix('#').filter(|d| d.len() == 6 && d.bytes().all(|b| b.is_ascii_hexdigit()));
    let value = digits.and_then(|d| u32::from_str_radix(d, 16).ok()).ok_or_else(|| {
        let message = format!("\"{}\" is not a colour; expected \"#rrggbb\", such as \"#ff8000\"", shortened(&text));
        Problem::new(node.at(), message)
    })?;
    let [_, r, g, b] = value.to_be_bytes();
    Ok(Vec3::new(srgb_to_linear(r), srgb_to_linear(g), srgb_to_linear(b)))
}

/// Many number tuples, finite in f32.
pub fn rows<'t, const N: usize>(node: impl Node<'t>) -> Outcome<Vec<[f64; N]>> {
    let finite = |rows: &Vec<[f64; N]>| rows.iter().flatten().all(|v| (*v as f32).is_finite());
    match node.number_rows().filter(finite) {
        Some(rows) => Ok(rows),
        None => node.rows()?.into_iter().map(tuple).collect(),
    }
}

/// Many index tuples, each index below `count`, which counts things called `what`.
pub fn indices<'t, const N: usize>(node: impl Node<'t>, count: usize, what: &str) -> Outcome<Vec<[u32; N]>> {
    let known = |rows: &Vec<[u32; N]>| rows.iter().flatten().all(|i| (*i as usize) < count);
    match node.index_rows().filter(known) {
        Some(rows) => Ok(rows),
        None => node.rows()?.into_iter().map(|row| array(row, |i| index(i, count, what))).collect(),
    }
}

fn index<'t>(node: impl Node<'t>, count: usize, what: &str) -> Outcome<u32> {
    let value = node.number()?;
    let known = value >= 0.0 && value < count as f64 && value <= f64::from(u32::MAX) && value.fract() == 0.0;
    let problem = || {
        let range = match count {
            0 => format!("there are no {what}"),
            _ => format!("expected a whole number from 0 to {}", count - 1),
        };
        Problem::new(node.at(), format!("index {value} names none of the {count} {what}; {range}"))
    };
    if known { Ok(value as u32) } else { Err(problem()) }
}
