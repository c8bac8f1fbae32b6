//! Surfaces over many pixels: what shadows fall on, what mirrors, what hides others.

use super::view::{Ray, View};
use crate::random::Random;
use crate::stress::triple;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

/// A large surface that rays can meet.
#[derive(Clone, Copy, Debug)]
pub enum Receiver {
    Flat {
        point: DVec3,
        /// Unit, towards the eye.
        normal: DVec3,
    },
    Ball {
        center: DVec3,
        radius: f64,
    },
}

impl Receiver {
    /// A flat surface straight ahead, across the view.
    pub fn facing(random: &mut Random, view: &View, distance: f64) -> Self {
        let ahead = Self::ahead(view);
        let tilt = random.pick(&[0.0, 0.0, 0.3, 1.0]);
        let normal = (random.direction() * tilt - ahead.direction.normalize()).normalize_or(-ahead.direction);
        Self::Flat {
            point: ahead.at(distance),
            normal: if normal.dot(ahead.direction) > 0.0 { -normal } else { normal },
        }
    }

    /// A flat one, or a ball that fills a good deal of the picture.
    pub fn any(random: &mut Random, view: &View, distance: f64) -> Self {
        if random.chance(0.6) {
            return Self::facing(random, view, distance);
        }
        let ahead = Self::ahead(view);
        let picture = view.pixel() * f64::from(view.size.1) * distance;
        let radius = picture * random.magnitude(-0.5, 2.0);
        Self::Ball { center: ahead.at(distance) + ahead.direction.normalize() * radius, radius }
    }

    fn ahead(view: &View) -> Ray {
        view.ray(DVec2::new(view.size.0.into(), view.size.1.into()) / 2.0)
    }

    /// Where a ray from outside meets it, and the unit normal there.
    pub fn meet(&self, ray: Ray) -> Option<(DVec3, DVec3)> {
        match *self {
            Self::Flat { point, normal } => {
                let t = normal.dot(point - ray.origin) / normal.dot(ray.direction);
                (t.is_finite() && t > 0.0).then(|| (ray.at(t), normal))
            }
            Self::Ball { center, radius } => {
                let direction = ray.direction.normalize();
                let b = direction.dot(center - ray.origin);
                let nearest = ray.origin + direction * b;
                let half_chord = (radius * radius - nearest.distance_squared(center)).sqrt();
                let point = nearest - direction * half_chord;
                (b > half_chord).then(|| (point, (point - center).normalize()))
            }
        }
    }

    /// The same surface, moved against its normal or grown.
    pub fn moved(self, by: f64) -> Self {
        match self {
            Self::Flat { point, normal } => Self::Flat { point: point - normal * by, normal },
            Self::Ball { center, radius } => Self::Ball { center, radius: (radius + by).max(radius * 0.5) },
        }
    }

    /// As one of the objects that have such a surface, about `size` large where they have an end.
    pub fn to_json(self, random: &mut Random, size: f64) -> Value {
        let Self::Flat { point, normal } = self else {
            let Self::Ball { center, radius } = self else { unreachable!("there are two kinds") };
            return json!({ "type": "sphere", "center": triple(center), "radius": radius });
        };
        let (u, v) = normal.any_orthonormal_pair();
        let (u, v) = (u * size, v * size);
        match random.below(5) {
            0 | 1 => json!({ "type": "plane", "point": triple(point), "normal": triple(normal) }),
            2 => json!({ "type": "disk", "center": triple(point), "normal": triple(normal), "radius": size }),
            3 => {
                let vertices = [point + u * 3.0, point + v * 3.0 - u, point - v * 3.0 - u].map(triple);
                json!({ "type": "triangle", "vertices": vertices })
            }
            _ => json!({ "type": "rectangle", "corner": triple(point - u - v),
                         "edge_u": triple(u * 2.0), "edge_v": triple(v * 2.0) }),
        }
    }
}
