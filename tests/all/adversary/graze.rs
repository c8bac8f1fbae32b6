//! Shapes whose outlines run exactly along given rays.
//!
//! The rays may come from the eye, from a mirror's surface, or lead from a surface to a light: whoever bounds many
//! rays by a few of them has to decide about these shapes within rounding errors.

use super::view::Ray;
use crate::random::Random;
use crate::stress::triple;
use glam::DVec3;
use serde_json::{Value, json};

/// Two rays at the border of a beam, and how far along them something may stand.
#[derive(Clone, Copy, Debug)]
pub struct Graze {
    pub rays: [Ray; 2],
    /// Least and greatest t.
    pub span: [f64; 2],
    /// About what one pixel measures at t = 1.
    pub pixel: f64,
}

/// A maker of shapes that touch the rays of a [`Graze`].
pub type Maker = fn(&mut Random, &Touch) -> Value;

/// Where a shape touches the two rays.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// A point on each ray.
    pub ends: [DVec3; 2],
    /// Unit directions of the rays.
    pub directions: [DVec3; 2],
    /// Unit normal of the plane of both rays.
    pub across: DVec3,
    /// How large the shape is.
    pub size: f64,
    /// How large a pixel is there.
    pub pixel: f64,
}

impl Graze {
    /// Draws where to touch.
    pub fn touch(&self, random: &mut Random) -> Touch {
        let [least, greatest] = self.span;
        let t = random.magnitude(least.log10(), greatest.log10());
        let other = if random.chance(0.5) { t } else { random.magnitude(least.log10(), greatest.log10()) };
        let [a, b] = self.rays;
        let ends = [a.at(t), b.at(other)];
        let directions = self.rays.map(|ray| ray.direction.normalize());
        // Parallel rays come from a light far away: their plane holds the way from one to the other.
        let normal = directions[0].cross(directions[1]).try_normalize();
        let normal = normal.or_else(|| directions[0].cross(ends[1] - ends[0]).try_normalize());
        let across = normal.unwrap_or_else(|| directions[0].any_orthonormal_vector()) * random.sign();
        let pixel = self.pixel * t;
        let size = match random.below(3) {
            0 => pixel * random.magnitude(-3.0, 1.0),
            1 => pixel * random.magnitude(1.0, 2.5),
            _ => t * self.rays[0].direction.length() * random.magnitude(-2.0, 1.0),
        };
        Touch { ends, directions, across, size, pixel }
    }
}

impl Touch {
    fn along(&self) -> DVec3 {
        self.ends[1] - self.ends[0]
    }

    /// A point of the line between the ends.
    fn between(&self, random: &mut Random) -> DVec3 {
        self.ends[0].lerp(self.ends[1], random.pick(&[0.0, 0.5, 1.0, 0.25]))
    }

    /// The line between the ends, as long or longer.
    fn edge(&self, random: &mut Random) -> [DVec3; 2] {
        let beyond = self.along() * random.pick(&[0.0, 0.0, 1.0, 10.0]);
        [self.ends[0] - beyond, self.ends[1] + beyond]
    }

    /// Off the plane of the rays, by the shape's size.
    fn aside(&self) -> DVec3 {
        self.across * self.size
    }
}

/// Spheres: tangent, or points at a ray.
pub const SPHERES: &[Maker] = &[tangent_sphere, tangent_sphere, tangent_sphere_to_one_ray, speck];
/// Triangles, alone or in things made of them.
pub const TRIANGLES: &[Maker] =
    &[edge, edge, corner, sliver, sliver, edge_on_triangle, rectangle, needle_fan, closed_fan];
/// Boxes along the axes.
pub const BOXES: &[Maker] = &[axis_box];
/// Disks.
pub const DISKS: &[Maker] = &[tangent_disk, tangent_disk, edge_on_disk];
/// Cones and cylinders.
pub const CONES: &[Maker] = &[tangent_cylinder, tangent_cylinder, tangent_cone, cone_tip, ring, pin];
/// Planes.
pub const PLANES: &[Maker] = &[plane_of_rays, horizon];

/// A maker of any type of shape, each type as likely as the others.
pub fn any(random: &mut Random) -> Maker {
    let kind = random.pick(&[SPHERES, TRIANGLES, TRIANGLES, BOXES, DISKS, CONES, PLANES]);
    random.pick(kind)
}

/// A size that reaches a little too far, or just not.
fn hardly_more(random: &mut Random, size: f64) -> f64 {
    size * random.pick(&[1.0, 1.0 + 1e-7, 1.0 + 1e-6, 1.0 - 1e-7])
}

fn tangent_sphere(random: &mut Random, touch: &Touch) -> Value {
    let center = touch.between(random) + touch.aside();
    json!({ "type": "sphere", "center": triple(center), "radius": hardly_more(random, touch.size) })
}

fn tangent_sphere_to_one_ray(random: &mut Random, touch: &Touch) -> Value {
    let aside = touch.directions[0].cross(random.direction()).normalize_or(touch.across);
    json!({ "type": "sphere", "center": triple(touch.ends[0] + aside * touch.size), "radius": touch.size })
}

/// Far smaller than a pixel, on a ray.
fn speck(random: &mut Random, touch: &Touch) -> Value {
    let radius = touch.pixel * random.magnitude(-6.0, 0.0);
    let aside = touch.across * random.pick(&[0.0, 0.5, 0.999, 1.0, 1.001]) * radius;
    json!({ "type": "sphere", "center": triple(touch.ends[0] + aside), "radius": radius })
}

fn triangle(corners: [DVec3; 3]) -> Value {
    json!({ "type": "triangle", "vertices": corners.map(triple) })
}

fn edge(random: &mut Random, touch: &Touch) -> Value {
    let [a, b] = touch.edge(random);
    let third = a.lerp(b, random.within(-0.5, 1.5))
        + touch.aside()
        + touch.directions[0] * touch.size * random.within(-0.5, 0.5);
    triangle([a, b, third])
}

/// A corner on a ray, anything else anywhere.
fn corner(random: &mut Random, touch: &Touch) -> Value {
    let [b, c] = [(); 2].map(|()| touch.ends[0] + random.direction() * touch.size);
    triangle([touch.ends[0], b, c])
}

/// A blade of grass, thinner than a pixel.
fn sliver(random: &mut Random, touch: &Touch) -> Value {
    let [a, b] = touch.edge(random);
    let thin = touch.pixel * random.magnitude(-5.0, 0.0);
    triangle([a, b, a.lerp(b, random.within(0.0, 1.0)) + touch.across * thin])
}

/// In the plane of the rays.
fn edge_on_triangle(random: &mut Random, touch: &Touch) -> Value {
    let [a, b] = touch.edge(random);
    triangle([a, b, touch.between(random) + touch.directions[1] * touch.size])
}

fn rectangle(random: &mut Random, touch: &Touch) -> Value {
    let [a, b] = touch.edge(random);
    let other = if random.chance(0.5) { touch.aside() } else { random.direction() * touch.size };
    json!({ "type": "rectangle", "corner": triple(a), "edge_u": triple(b - a), "edge_v": triple(other) })
}

/// Needles that meet in a corner.
fn needle_fan(random: &mut Random, touch: &Touch) -> Value {
    let mut vertices = vec![triple(touch.ends[0])];
    let mut triangles = Vec::new();
    for i in 0..random.below(12) as u32 + 2 {
        let tip = touch.ends[0] + random.direction() * touch.size;
        let thin = touch.size * random.magnitude(-6.0, -1.0);
        vertices.extend([tip, tip + random.direction() * thin].map(triple));
        triangles.push([0, 2 * i + 1, 2 * i + 2]);
    }
    json!({ "type": "mesh", "vertices": vertices, "triangles": triangles })
}

/// Triangles around a corner, each sharing its edges with its neighbours.
fn closed_fan(random: &mut Random, touch: &Touch) -> Value {
    let count = random.below(6) + 3;
    let (u, v) = (touch.across, touch.directions[0].cross(touch.across));
    let mut vertices = vec![triple(touch.ends[0])];
    for i in 0..count {
        let angle = (i as f64 / count as f64 * std::f64::consts::TAU).sin_cos();
        vertices.push(triple(touch.ends[0] + (u * angle.1 + v * angle.0) * touch.size));
    }
    let triangles: Vec<[usize; 3]> = (0..count).map(|i| [0, i + 1, (i + 1) % count + 1]).collect();
    json!({ "type": "mesh", "vertices": vertices, "triangles": triangles })
}

/// A corner or an edge of it on the rays, as far as they follow the axes.
fn axis_box(random: &mut Random, touch: &Touch) -> Value {
    let [a, b] = touch.ends;
    let size = touch.size;
    let wide = |sign: f64| DVec3::splat(sign * size);
    let (min, max) = match random.below(3) {
        // The rays' points are corners that lie across from each other, or an edge, made thick.
        0 => (a.min(b), a.max(b) + wide(1e-3)),
        1 => (a.min(b), a.max(b) + wide(1.0)),
        _ => {
            let far = a + DVec3::new(random.sign(), random.sign(), random.sign()) * size;
            (a.min(far), a.max(far))
        }
    };
    json!({ "type": "box", "min": triple(min), "max": triple(max) })
}

fn tangent_disk(random: &mut Random, touch: &Touch) -> Value {
    let center = touch.between(random) + touch.aside();
    let up = touch.directions[0].cross(touch.across);
    let normal = touch.directions[0] + up * random.pick(&[0.0, 0.0, 1.0, 1e3]);
    json!({ "type": "disk", "center": triple(center), "normal": triple(normal), "radius": hardly_more(random, touch.size) })
}

fn edge_on_disk(random: &mut Random, touch: &Touch) -> Value {
    let tilt = random.pick(&[0.0, 1e-7, 1e-5]);
    let normal = touch.across + touch.directions[0] * tilt;
    json!({ "type": "disk", "center": triple(touch.between(random)), "normal": triple(normal), "radius": touch.size })
}

fn tangent_cylinder(random: &mut Random, touch: &Touch) -> Value {
    let radius = if random.chance(0.4) { touch.pixel * random.magnitude(-5.0, 0.0) } else { touch.size };
    let aside = touch.across * radius * random.pick(&[1.0, 1.0, 1.0, 0.0]);
    let [a, b] = touch.edge(random).map(|end| triple(end + aside));
    let radius = hardly_more(random, radius);
    json!({ "type": "cylinder", "base": a, "top": b, "radius": radius, "capped": random.chance(0.5) })
}

/// Its side touches the plane of the rays along a line.
fn tangent_cone(random: &mut Random, touch: &Touch) -> Value {
    let [a, b] = touch.edge(random);
    let (from, to) = (touch.size, touch.size * random.pick(&[0.0, 0.5, 0.99, 1.01, 3.0]));
    let [base, top] = [a + touch.across * from, b + touch.across * to].map(triple);
    json!({ "type": "cone", "base": base, "top": top, "radius": from, "radius_top": to, "capped": random.chance(0.5) })
}

fn cone_tip(random: &mut Random, touch: &Touch) -> Value {
    let base = touch.ends[0] + random.direction() * touch.size;
    let radius = touch.size * random.magnitude(-4.0, 1.0);
    json!({ "type": "cone", "base": triple(base), "top": triple(touch.ends[0]), "radius": radius, "capped": random.chance(0.5) })
}

/// A cylinder or cone that is far wider than high.
fn ring(random: &mut Random, touch: &Touch) -> Value {
    let axis = random.pick(&[touch.across, touch.directions[0], random_unit(touch)]);
    let height = touch.size * random.magnitude(-6.0, -1.0);
    let rim = axis.any_orthonormal_vector() * touch.size;
    let base = touch.between(random) - rim;
    let radius_top = touch.size * random.pick(&[1.0, 1.0, 0.5, 0.999]);
    json!({ "type": "cone", "base": triple(base), "top": triple(base + axis * height), "radius": touch.size,
            "radius_top": radius_top, "capped": random.chance(0.5) })
}

fn random_unit(touch: &Touch) -> DVec3 {
    (touch.across + touch.directions[1] * 0.5).normalize()
}

/// A cylinder that is far longer than wide, seen from its end.
fn pin(random: &mut Random, touch: &Touch) -> Value {
    let radius = touch.pixel * random.magnitude(-4.0, 2.0);
    let base = touch.ends[0] + touch.across * radius * random.pick(&[0.0, 1.0]);
    let top = base + touch.directions[0] * touch.size;
    json!({ "type": "cylinder", "base": triple(base), "top": triple(top), "radius": radius, "capped": random.chance(0.5) })
}

/// The plane that both rays run in.
fn plane_of_rays(random: &mut Random, touch: &Touch) -> Value {
    json!({ "type": "plane", "point": triple(touch.between(random)), "normal": triple(touch.across) })
}

/// A plane that the rays meet at infinity.
fn horizon(random: &mut Random, touch: &Touch) -> Value {
    let off = touch.size * random.magnitude(-6.0, 1.0);
    json!({ "type": "plane", "point": triple(touch.ends[0] + touch.across * off), "normal": triple(touch.across) })
}
