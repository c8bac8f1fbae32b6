//! Maps: pictures of what a method does instead of what it draws, pixel by pixel. From a film's planes to colours and a
//! legend, and nothing else: no window, no thread.

mod classes;
mod legend;
mod scales;

pub use legend::{Class, Key, Legend, Scale};

use crate::render::{Film, Planes};

/// Where nothing is seen.
const NOTHING: [u8; 3] = [24, 26, 32];

/// What is shown of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Map {
    /// What it draws.
    #[default]
    Picture,
    /// How each pixel was obtained.
    Decisions,
    /// Rays that were traced for each pixel.
    Cost,
    /// How far away what is seen is.
    Depth,
    /// Which way it faces.
    Normals,
    /// Which object it is.
    Objects,
    /// How far the picture is off the exact one.
    Error,
}

impl Map {
    /// All of them, in the order of the key that changes them.
    pub const ALL: [Self; 7] =
        [Self::Picture, Self::Decisions, Self::Cost, Self::Depth, Self::Normals, Self::Objects, Self::Error];

    /// Its name in the panel and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Decisions => "decisions",
            Self::Cost => "cost",
            Self::Depth => "depth",
            Self::Normals => "normals",
            Self::Objects => "objects",
            Self::Error => "error",
        }
    }

    /// One line of help.
    pub fn help(self) -> &'static str {
        match self {
            Self::Picture => "the picture itself",
            Self::Decisions => {
                "how each pixel was obtained, by the ray through its centre; of a grid of rays, by the last"
            }
            Self::Cost => {
                "rays traced for each pixel, of all kinds; not the candidates it was tested against without one"
            }
            Self::Depth => "distance from the eye to what is seen, on a logarithmic scale",
            Self::Normals => "shading normals: red along x, green along y, blue along z",
            Self::Objects => "a colour for each object, dark where there is none",
            Self::Error => "greatest channel difference from the exact picture, in steps of the 8-bit picture",
        }
    }

    /// The one after it.
    pub fn next(self) -> Self {
        let at = Self::ALL.iter().position(|map| *map == self).unwrap_or_default();
        Self::ALL[(at + 1) % Self::ALL.len()]
    }

    /// The planes that a film needs for it.
    pub fn planes(self) -> Planes {
        let none = Planes::default();
        match self {
            Self::Picture | Self::Error => none,
            Self::Decisions => Planes { decision: true, ..none },
            Self::Cost => Planes { cost: true, ..none },
            Self::Depth => Planes { depth: true, ..none },
            Self::Normals => Planes { normal: true, ..none },
            Self::Objects => Planes { object: true, ..none },
        }
    }

    /// Whether it needs the exact picture beside the frame's own.
    pub fn needs_exact(self) -> bool {
        self == Self::Error
    }

    /// Paints films of one view with it, on one scale for all of them; says what the colours mean. Films that lack what it
    /// needs, and the picture itself, stay as they are.
    pub fn paint(self, films: &mut [&mut Film], exact: Option<&Film>) -> Option<Legend> {
        let key = match self {
            Self::Picture => return None,
            Self::Decisions => classes::decisions(films),
            Self::Cost => scales::cost(films),
            Self::Depth => scales::depth(films),
            Self::Normals => classes::normals(films),
            Self::Objects => classes::objects(films),
            Self::Error => scales::error(films, exact?),
        };
        Some(Legend { map: self, key })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_leads_through_all_and_back() {
        let mut map = Map::Picture;
        for expected in Map::ALL.into_iter().skip(1).chain([Map::Picture]) {
            map = map.next();
            assert_eq!(map, expected);
        }
    }

    #[test]
    fn without_its_planes_a_film_stays_as_it_is() {
        for map in Map::ALL {
            let mut film = Film::new(3, 2, Planes::default());
            let before = film.rgba().to_vec();
            map.paint(&mut [&mut film], None);
            assert_eq!(film.rgba(), before, "{}", map.name());
        }
    }
}
