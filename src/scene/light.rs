//! Lights: points, directions and spots.

use glam::Vec3;

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From a point in all directions.
    Point {
        /// Position.
        position: Vec3,
    },
    /// From infinitely far away.
    Directional {
        /// Unit vector along which the light travels.
        direction: Vec3,
    },
    /// From a point into a cone, with glTF's smooth falloff between two half-angles.
    Spot {
        /// Position.
        position: Vec3,
        /// Unit vector along the cone's axis.
        direction: Vec3,
        /// Cosine of the half-angle of full brightness.
        cos_inner: f32,
        /// Cosine of the half-angle where darkness starts.
        cos_outer: f32,
    },
}

/// How light weakens with distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// Not at all.
    None,
    /// With the square of the distance.
    InverseSquare,
}

/// A light of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name, where the file gives one.
    pub name: Option<String>,
    /// Where light comes from.
    pub kind: LightKind,
    /// Linear colour, `temperature` and `intensity` multiplied in.
    pub color: Vec3,
    /// How it weakens with distance (ignored for directional lights).
    pub falloff: Falloff,
}
