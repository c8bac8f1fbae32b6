//! Lights: points, directions and spots.

use glam::Vec3;

/// Where light comes from. `P` is a position: in the world of a scene, or in double precision in a description.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind<P = Vec3> {
    /// From a point in all directions.
    Point {
        /// Position.
        position: P,
    },
    /// From infinitely far away.
    Directional {
        /// Unit vector along which the light travels.
        direction: Vec3,
    },
    /// From a point into a cone, with glTF's smooth falloff between two half-angles.
    Spot {
        /// Position.
        position: P,
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

/// A light of the scene. `P` is its position, as in [`LightKind`].
#[derive(Clone, Debug, PartialEq)]
pub struct Light<P = Vec3> {
    /// Its name, where the file gives one.
    pub name: Option<String>,
    /// Where light comes from.
    pub kind: LightKind<P>,
    /// Linear colour, `temperature` and `intensity` multiplied in.
    pub color: Vec3,
    /// How it weakens with distance (ignored for directional lights).
    pub falloff: Falloff,
}

impl<P: Copy> Light<P> {
    /// The same light with its position and direction put elsewhere.
    pub fn moved<Q>(&self, position: impl Fn(P) -> Q, direction: impl Fn(Vec3) -> Vec3) -> Light<Q> {
        let kind = match self.kind {
            LightKind::Point { position: at } => LightKind::Point { position: position(at) },
            LightKind::Directional { direction: along } => LightKind::Directional { direction: direction(along) },
            LightKind::Spot { position: at, direction: along, cos_inner, cos_outer } => {
                LightKind::Spot { position: position(at), direction: direction(along), cos_inner, cos_outer }
            }
        };
        Light { name: self.name.clone(), kind, color: self.color, falloff: self.falloff }
    }
}
