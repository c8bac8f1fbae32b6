//! The shapes of one object on their way to the geometry.

use super::bounds::shape_bounds;
use super::footprint::{Survey, has_area};
use super::placement::Placement;
use super::sharing::Totals;
use crate::geometry::{Aabb, Holes, Part, PrimitiveId, Shape, VertexAttributes, VertexExtras};
use crate::scene::desc::problem::{At, Outcome, Problem, Warnings};
use crate::scene::limits::{Limits, exceeded};
use glam::{DVec3, Vec3};

/// What the corners of a triangle carry.
#[derive(Clone, Debug, Default)]
pub struct Corners {
    /// Normals and texture coordinates.
    pub attributes: Option<VertexAttributes>,
    /// What few triangles carry.
    pub extras: Option<Box<VertexExtras>>,
    /// Where they lie on a map of holes.
    pub holes: Option<Box<Holes>>,
}

impl Corners {
    /// With the corners taken in another order.
    fn reordered(self, order: [usize; 3]) -> Self {
        Self {
            attributes: self.attributes.map(|attributes| attributes.reordered(order)),
            extras: self.extras.map(|extras| Box::new(extras.reordered(order))),
            holes: self.holes.map(|holes| Box::new(holes.reordered(order))),
        }
    }
}

/// Indices of primitives fit 32 bits, and one is kept for none.
pub const MOST_INDICES: u64 = u32::MAX as u64 - 1;
/// What is wrong where they do not.
pub const TOO_MANY_INDICES: &str = "with every mesh as often as it is placed, more than 2^32 triangles";

/// Collects the parts of one object, in ascending order of their primitive, and what all of them share.
pub struct ObjectParts<'a> {
    parts: &'a mut Vec<Part>,
    /// Bounds of what was left out.
    lost: &'a mut Aabb,
    /// What instances take.
    elsewhere: Totals,
    limits: &'a Limits,
    object: u32,
    at: At,
    /// Whether its triangles are seen from one side only.
    pub one_sided: bool,
    /// Bounds of what was pushed.
    pub bounds: Aabb,
    /// Triangles without area that were left out, and the first one's primitive.
    dropped: u64,
    first_dropped: u32,
}

impl<'a> ObjectParts<'a> {
    /// No parts yet of the object that stands at `at`.
    pub fn new(
        (parts, lost): (&'a mut Vec<Part>, &'a mut Aabb),
        elsewhere: Totals,
        limits: &'a Limits,
        object: u32,
        at: At,
    ) -> Self {
        Self {
            parts,
            lost,
            elsewhere,
            limits,
            object,
            at,
            one_sided: false,
            bounds: Aabb::EMPTY,
            dropped: 0,
            first_dropped: 0,
        }
    }

    /// Notes where something lies that is left out.
    pub fn lose(&mut self, point: Vec3) {
        *self.lost = self.lost.union(Aabb::from_points([point]));
    }

    /// Makes room for `count` more parts at once.
    pub fn reserve(&mut self, count: usize) -> Outcome<()> {
        self.check(count as u64, count as u64)?;
        let no_memory = |_| Problem::new(self.at, format!("there is no memory for {count} more primitives"));
        self.parts.try_reserve(count).map_err(no_memory)
    }

    /// Whether `stored` more primitives, and `indices` more for them, are allowed.
    pub fn check(&self, stored: u64, indices: u64) -> Outcome<()> {
        let own = self.parts.len() as u64;
        if own + self.elsewhere.triangles + stored > self.limits.primitives {
            let message = format!("primitives: {}", exceeded("primitives", self.limits.primitives));
            return Err(Problem::new(self.at, message));
        }
        match own + self.elsewhere.indices + indices > MOST_INDICES {
            true => Err(Problem::new(self.at, TOO_MANY_INDICES)),
            false => Ok(()),
        }
    }

    /// Takes a mesh into account that is stored elsewhere; `None` is one that reaches beyond all numbers.
    pub fn take(&mut self, survey: Option<Survey>) -> Outcome<()> {
        let Some(Survey { bounds, dropped, first_dropped }) = survey else { return self.enclose(Aabb::INFINITE) };
        (self.bounds, self.dropped, self.first_dropped) = (bounds, dropped.into(), first_dropped);
        Ok(())
    }

    /// Forgets what was taken into account.
    pub fn restart(&mut self) {
        (self.bounds, self.dropped) = (Aabb::EMPTY, 0);
    }

    /// Whether a triangle spans any area; those that do not are counted.
    fn keeps(&mut self, primitive: u32, corners: [Vec3; 3]) -> bool {
        if has_area(corners) {
            return true;
        }
        if self.dropped == 0 {
            self.first_dropped = primitive;
        }
        self.dropped += 1;
        self.lose(corners[0]);
        false
    }

    /// Takes the bounds of something finite into account.
    fn enclose(&mut self, bounds: Aabb) -> Outcome<()> {
        if !bounds.is_finite() {
            let message = "in the world, the object reaches beyond 3.4e38; make it smaller or move it nearer";
            return Err(Problem::new(self.at, message));
        }
        self.bounds = self.bounds.union(bounds);
        Ok(())
    }

    /// Adds a shape.
    pub fn push(&mut self, primitive: u32, shape: Shape) -> Outcome<()> {
        self.push_with(primitive, shape, Corners::default())
    }

    /// Adds a triangle of world-space corners unless rounding has left it no area; `placement` says whether
    /// its winding has to be turned.
    pub fn push_triangle(
        &mut self,
        primitive: u32,
        corners: [DVec3; 3],
        carried: Corners,
        placement: &Placement,
    ) -> Outcome<()> {
        let [a, b, c] = corners.map(|p| p.as_vec3());
        if !self.keeps(primitive, [a, b, c]) {
            return Ok(());
        }
        if placement.is_mirrored() {
            let carried = carried.reordered([0, 2, 1]);
            return self.push_with(primitive, Shape::Triangle { vertices: [a, c, b] }, carried);
        }
        self.push_with(primitive, Shape::Triangle { vertices: [a, b, c] }, carried)
    }

    fn push_with(&mut self, primitive: u32, shape: Shape, carried: Corners) -> Outcome<()> {
        match shape {
            Shape::Plane { .. } => self.bounds = Aabb::INFINITE,
            _ => self.enclose(shape_bounds(&shape))?,
        }
        self.reserve(1)?;
        let id = PrimitiveId { object: self.object, primitive };
        let Corners { attributes, extras, holes } = carried;
        self.parts.push(Part { shape, id, attributes, extras, holes, one_sided: self.one_sided });
        Ok(())
    }

    /// The bounds of all parts, after a warning about those left out.
    pub fn finish(self, warnings: &mut Warnings) -> Aabb {
        if self.dropped > 0 {
            let (n, first) = (self.dropped, self.first_dropped);
            let kind = "objects hold triangles without area, which are left out";
            let message = format!("triangles without area: {n} left out, the first is triangle {first}");
            warnings.push_kind(self.at, kind, format!("{n} triangles from triangle {first} on"), message);
        }
        self.bounds
    }
}
