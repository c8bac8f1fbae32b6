//! What rays meet, in double precision and one after another.

use glam::{DVec2, DVec3};
use raywalk::geometry::{Geometry, PrimitiveKind};

/// A shape as the program holds it, its numbers rounded to f32.
enum Shape {
    Sphere { center: DVec3, radius: f64 },
    Triangle { corners: [DVec3; 3], winding: f64, normals: Option<[DVec3; 3]>, uvs: Option<[DVec2; 3]> },
    Disk { center: DVec3, normal: DVec3, radius: f64 },
    Cone { middle: DVec3, axis: DVec3, half_height: f64, radius: f64, slope: f64 },
    Plane { normal: DVec3, distance: f64 },
}

pub struct Primitive {
    shape: Shape,
    pub object: u32,
    /// Index within the object.
    pub primitive: u32,
}

/// A point of a surface.
pub struct Surface {
    pub position: DVec3,
    /// Unit, outward or as defined.
    pub geometric: DVec3,
    /// Unit, on the side of the geometric one.
    pub shading: DVec3,
    /// The texture coordinates that triangles carry.
    pub uv: Option<DVec2>,
    /// How those grow along the triangle.
    pub uv_gradients: Option<[DVec3; 2]>,
}

/// All primitives, in the order of their identity.
pub fn primitives(geometry: &Geometry) -> Vec<Primitive> {
    geometry
        .own()
        .enumerate()
        .map(|(i, (slot, id))| {
            let (block, place) = (slot.block as usize, usize::from(slot.place));
            let fields: Vec<f64> = match slot.kind {
                PrimitiveKind::Sphere => geometry.spheres[block].get(place).map(f64::from).to_vec(),
                PrimitiveKind::Triangle | PrimitiveKind::Cutout => {
                    geometry.triangles_of(slot.kind)[block].get(place).map(f64::from).to_vec()
                }
                PrimitiveKind::Disk => geometry.disks[block].get(place).map(f64::from).to_vec(),
                PrimitiveKind::Cone => geometry.cones[block].get(place).map(f64::from).to_vec(),
                PrimitiveKind::Plane => geometry.planes[block].get(place).map(f64::from).to_vec(),
            };
            let vector = |at: usize| DVec3::from_slice(&fields[at..at + 3]);
            let attributes = geometry.attributes_of(i as u32);
            let shape = match slot.kind {
                PrimitiveKind::Sphere => Shape::Sphere { center: vector(0), radius: fields[3] },
                PrimitiveKind::Triangle | PrimitiveKind::Cutout => Shape::Triangle {
                    corners: [0, 3, 6].map(vector),
                    winding: fields[9],
                    normals: attributes.and_then(|a| a.normals).map(|n| n.map(|n| n.as_dvec3())),
                    uvs: attributes.and_then(|a| a.uvs).map(|uv| uv.map(|uv| uv.as_dvec2())),
                },
                PrimitiveKind::Disk => {
                    Shape::Disk { center: vector(0), normal: vector(3).normalize(), radius: fields[6] }
                }
                PrimitiveKind::Cone => Shape::Cone {
                    middle: vector(0),
                    axis: vector(3).normalize(),
                    half_height: fields[6],
                    radius: fields[7],
                    slope: fields[8],
                },
                PrimitiveKind::Plane => Shape::Plane { normal: vector(0), distance: fields[3] },
            };
            Primitive { shape, object: id.object, primitive: id.primitive }
        })
        .collect()
}

impl Primitive {
    /// Every distance at which a line meets it, in any order.
    pub fn hits(&self, origin: DVec3, direction: DVec3) -> Vec<f64> {
        match self.shape {
            Shape::Sphere { center, radius } => {
                // By the point of the ray nearest to the centre: from a million radii away, squared distances would leave
                // nothing of the radius (Haines, Günther and Akenine-Möller, Ray Tracing Gems, chapter 7, 2019).
                let nearest = (center - origin).dot(direction);
                let across = origin + direction * nearest - center;
                let squared = radius * radius - across.length_squared();
                if squared < 0.0 { Vec::new() } else { vec![nearest - squared.sqrt(), nearest + squared.sqrt()] }
            }
            Shape::Triangle { corners: [a, b, c], .. } => {
                let (ab, ac) = (b - a, c - a);
                let p = direction.cross(ac);
                let (det, from_a) = (ab.dot(p), origin - a);
                let u = from_a.dot(p) / det;
                let q = from_a.cross(ab);
                let v = direction.dot(q) / det;
                if u >= 0.0 && v >= 0.0 && u + v <= 1.0 { vec![ac.dot(q) / det] } else { Vec::new() }
            }
            Shape::Disk { center, normal, radius } => {
                let t = (center - origin).dot(normal) / direction.dot(normal);
                let inside = (origin + direction * t - center).length() <= radius;
                if inside { vec![t] } else { Vec::new() }
            }
            Shape::Cone { middle, axis, half_height, radius, slope } => {
                let (height, climb) = ((origin - middle).dot(axis), direction.dot(axis));
                let (across, step) = (origin - middle - axis * height, direction - axis * climb);
                let (wall, wall_step) = (radius + slope * height, slope * climb);
                let a = step.length_squared() - wall_step * wall_step;
                let roots = quadratic(a, across.dot(step) - wall * wall_step, across.length_squared() - wall * wall);
                roots.into_iter().filter(|t| (height + climb * t).abs() <= half_height).collect()
            }
            Shape::Plane { normal, distance } => {
                vec![(distance - normal.dot(origin)) / normal.dot(direction)]
            }
        }
    }

    /// Whether it is seen from one side only, and a ray meets the other.
    pub fn is_passed(&self, direction: DVec3) -> bool {
        match self.shape {
            Shape::Triangle { corners: [a, b, c], winding, .. } => {
                winding.abs() > 1.0 && (b - a).cross(c - a).dot(direction) * winding > 0.0
            }
            _ => false,
        }
    }

    /// The surface where a ray meets it.
    pub fn surface(&self, origin: DVec3, direction: DVec3, t: f64) -> Surface {
        let position = origin + direction * t;
        let flat = |geometric| Surface { position, geometric, shading: geometric, uv: None, uv_gradients: None };
        match self.shape {
            Shape::Sphere { center, .. } => flat((position - center).normalize()),
            Shape::Disk { normal, .. } => flat(normal),
            Shape::Plane { normal, .. } => flat(normal.normalize()),
            Shape::Cone { middle, axis, slope, .. } => {
                let from = position - middle;
                flat(((from - axis * from.dot(axis)).normalize() - axis * slope).normalize())
            }
            Shape::Triangle { corners: [a, b, c], winding, normals, uvs } => {
                let cross = (b - a).cross(c - a);
                let geometric = cross.normalize() * winding.signum();
                let weight =
                    |from: DVec3, to: DVec3| (to - from).cross(position - from).dot(cross) / cross.length_squared();
                let [u, v, w] = [weight(b, c), weight(c, a), weight(a, b)];
                let smooth = normals.map(|[a, b, c]| (a * u + b * v + c * w).normalize());
                let shading = smooth.map_or(geometric, |n| if n.dot(geometric) < 0.0 { -n } else { n });
                let uv_gradients = uvs.map(|corners| {
                    // The gradient of each weight, across the opposite edge.
                    let [of_a, of_b, of_c] =
                        [(b, c), (c, a), (a, b)].map(|(from, to)| cross.cross(to - from) / cross.length_squared());
                    let grows = |along: fn(DVec2) -> f64| {
                        of_a * along(corners[0]) + of_b * along(corners[1]) + of_c * along(corners[2])
                    };
                    [grows(|uv| uv.x), grows(|uv| uv.y)]
                });
                Surface { position, geometric, shading, uv: uvs.map(|[a, b, c]| a * u + b * v + c * w), uv_gradients }
            }
        }
    }
}

/// Roots of a·t² + 2b·t + c.
fn quadratic(a: f64, b: f64, c: f64) -> Vec<f64> {
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return Vec::new();
    }
    if a == 0.0 {
        return vec![-c / (2.0 * b)];
    }
    let root = discriminant.sqrt();
    vec![(-b - root) / a, (-b + root) / a]
}
