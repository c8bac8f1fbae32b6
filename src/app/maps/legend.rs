//! What the colours of a map mean.

use super::Map;

/// What the colours of a map mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// The map.
    pub map: Map,
    /// Its key.
    pub key: Key,
}

/// What colours stand for.
#[derive(Clone, Debug, PartialEq)]
pub enum Key {
    /// Each for a kind of pixel.
    Classes(Vec<Class>),
    /// For numbers.
    Scale(Scale),
    /// What words tell better.
    Words(String),
}

/// A kind of pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Class {
    /// Its name.
    pub name: &'static str,
    /// Its colour, sRGB.
    pub color: [u8; 3],
    /// Its share of the pixels, film by film, 0 to 1.
    pub shares: Vec<f64>,
}

/// Numbers by viridis colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Numbers along it, with their places from 0, dark violet, to 1, yellow.
    pub marks: Vec<(f64, String)>,
    /// What is counted.
    pub unit: &'static str,
    /// What the numbers come to, film by film.
    pub sums: Vec<String>,
}
