//! How a walk through a scene starts, and in which unit its file seems to be.

/// How the first camera of a scene was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Entry {
    /// The file has cameras.
    Camera,
    /// At the file's spawn point of this name.
    Spawn(String),
    /// On the floor of a closed room.
    Interior,
    /// On walkable ground that things rise around.
    Level,
    /// From outside, all of the subject in the picture.
    Framed,
}

/// The length that a file seems to have as its unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unit {
    /// The unit of glTF, and what every file is taken to be in unless its sizes say otherwise.
    #[default]
    Metre,
    /// As Cube's engines and their kin have it: eight are a metre.
    Eighth,
    /// As Unreal and 3ds Max export.
    Centimetre,
    /// As CAD programs export.
    Millimetre,
}

impl Unit {
    /// How many of them a metre has.
    pub fn per_metre(self) -> f32 {
        match self {
            Self::Metre => 1.0,
            Self::Eighth => 8.0,
            Self::Centimetre => 100.0,
            Self::Millimetre => 1000.0,
        }
    }

    /// Its name in the plural.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "metres",
            Self::Eighth => "eighths of a metre",
            Self::Centimetre => "centimetres",
            Self::Millimetre => "millimetres",
        }
    }
}

/// How a walk through a scene starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// How the first camera was found.
    pub entry: Entry,
    /// How high the eye stands above the floor, in the file's units; `None` where it stands on none.
    pub eye_height: Option<f32>,
    /// The unit that the file seems to be in.
    pub unit: Unit,
}

impl Start {
    /// At a camera of the file.
    pub const AT_CAMERA: Self = Self { entry: Entry::Camera, eye_height: None, unit: Unit::Metre };
}

impl std::fmt::Display for Start {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kind = match &self.entry {
            Entry::Camera => return write!(f, "the file's camera"),
            Entry::Framed => return write!(f, "framed from outside"),
            Entry::Spawn(name) => {
                write!(f, "spawn point \"{name}\"")?;
                None
            }
            Entry::Interior => Some("interior"),
            Entry::Level => Some("level"),
        };
        if kind.is_some() {
            write!(f, "on foot")?;
        }
        if let Some(height) = self.eye_height {
            // To two digits: rooms of doll's houses are entered, too.
            let metres = format!("{:.1e}", height / self.unit.per_metre());
            write!(f, ", {} m above the floor", metres.parse::<f32>().unwrap_or(height))?;
        }
        kind.map_or(Ok(()), |kind| write!(f, " ({kind})"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_is_told_in_metres() {
        let told = |entry, eye_height, unit| Start { entry, eye_height, unit }.to_string();
        assert_eq!(told(Entry::Level, Some(1.6), Unit::Metre), "on foot, 1.6 m above the floor (level)");
        assert_eq!(told(Entry::Interior, Some(160.0), Unit::Centimetre), "on foot, 1.6 m above the floor (interior)");
        assert_eq!(told(Entry::Interior, Some(0.0832), Unit::Metre), "on foot, 0.083 m above the floor (interior)");
        let spawn = Entry::Spawn("a".to_owned());
        assert_eq!(told(spawn.clone(), Some(1600.0), Unit::Millimetre), "spawn point \"a\", 1.6 m above the floor");
        assert_eq!(told(spawn, None, Unit::Metre), "spawn point \"a\"");
        assert_eq!(told(Entry::Framed, None, Unit::Metre), "framed from outside");
        assert_eq!(Start::AT_CAMERA.to_string(), "the file's camera");
    }
}
