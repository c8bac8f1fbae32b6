//! Objects: the tree of the file flattened into world-space shapes.

use super::holes::Cut;
use super::mapping::{anchored, mapping};
use super::parts::{Corners, ObjectParts};
use super::placement::{Placement, narrow};
use super::sharing::Sharing;
use super::{Names, SceneBuilder, index};
use crate::geometry::Shape;
use crate::scene::desc::problem::{At, Outcome, Problem, Warnings};
use crate::scene::desc::{MeshDesc, ObjectDesc, ShapeDesc};
use crate::scene::files::CANCELLED;
use crate::scene::limits::exceeded;
use crate::scene::{Object, Texture};
use glam::{DVec3, Vec3, Vec4};
use std::sync::Arc;

/// Primitives of capped cylinders and cones.
const SIDE: u32 = 0;
const BASE: u32 = 1;
const TOP: u32 = 2;

impl SceneBuilder {
    /// Adds objects and what lies within them, depth first.
    pub(super) fn add_objects(
        &mut self,
        objects: &[ObjectDesc],
        parent: &Placement,
        materials: &Names,
        warnings: &mut Warnings,
    ) -> Outcome<()> {
        for object in objects {
            if self.progress().is_cancelled() {
                return Err(Problem::new(object.at, CANCELLED));
            }
            let own = object.transform.as_ref().map(|transform| parent.within(transform, object.at)).transpose()?;
            let placement = own.as_ref().unwrap_or(parent);
            match &object.shape {
                ShapeDesc::Group { children } => {
                    self.enter(object.at)?;
                    self.add_objects(children, placement, materials, warnings)?;
                    self.leave();
                }
                ShapeDesc::Model { file } => {
                    self.enter(object.at)?;
                    self.add_model(file, placement)?;
                    self.leave();
                }
                _ => self.add_leaf(object, placement, materials, warnings)?,
            }
        }
        Ok(())
    }

    fn add_leaf(
        &mut self,
        object: &ObjectDesc,
        placement: &Placement,
        materials: &Names,
        warnings: &mut Warnings,
    ) -> Outcome<()> {
        if self.objects.len() as u64 >= self.limits.objects {
            return Err(Problem::new(object.at, format!("objects: {}", exceeded("objects", self.limits.objects))));
        }
        let material = self.material(object.material.as_ref(), materials)?;
        let id = index(self.objects.len(), object.at, "objects")?;
        let cut = match &object.shape {
            ShapeDesc::Mesh(mesh) => self.holes.cut(material, &self.materials, &self.textures, mesh),
            _ => None,
        };
        if let ShapeDesc::Mesh(mesh) = &object.shape {
            self.placeholders.measure(&self.materials[material as usize], mesh, placement);
        }
        let is_thin = self.materials[material as usize].is_thin();
        let is_mesh = matches!(object.shape, ShapeDesc::Mesh(_));
        let elsewhere = self.sharing.totals();
        let room = (&mut self.parts, &mut self.lost);
        let mut parts = ObjectParts::new(room, elsewhere, &self.limits, id, object.at);
        parts.one_sided = is_mesh && self.materials[material as usize].is_one_sided();
        let is_shared = match &object.shape {
            ShapeDesc::Mesh(mesh) if cut.is_none() => {
                let wanted = || !self.progress.is_cancelled();
                let is_shared = share(&mut self.sharing, mesh, placement, id, &mut parts, &wanted)?;
                if !wanted() {
                    return Err(Problem::new(object.at, CANCELLED));
                }
                is_shared
            }
            _ => false,
        };
        if !is_shared {
            add_shape(object, placement, cut.as_ref(), &mut parts)?;
        }
        let bounds = parts.finish(warnings);
        let (mapping, to_object) = match placement.world_to_object() {
            Some(far) if self.origin != DVec3::ZERO => {
                let (mapping, near) = anchored(&object.shape, far, self.texture_period(material));
                (mapping, Some(near))
            }
            to_object => (mapping(&object.shape), to_object),
        };
        self.objects.push(Object {
            name: object.name.clone(),
            kind: object.kind,
            material,
            body: is_body(object) && !is_thin,
            mapping,
            world_to_object: to_object.map(narrow),
            bounds,
        });
        Ok(())
    }

    /// The length after which the textures of a material repeat; the largest where they do not agree.
    fn texture_period(&self, material: u32) -> f64 {
        let lookups = self.materials[material as usize].lookups();
        let sizes = lookups.map(|lookup| match &self.textures[lookup.texture as usize] {
            Texture::Checker { size, .. } => 2.0 * f64::from(*size),
            Texture::Image(image) => f64::from(image.size),
        });
        sizes.fold(0.0, f64::max)
    }
}

/// Places a mesh that is stored once, if it is to be and can be.
fn share(
    sharing: &mut Sharing,
    mesh: &Arc<MeshDesc>,
    placement: &Placement,
    object: u32,
    parts: &mut ObjectParts,
    wanted: &dyn Fn() -> bool,
) -> Outcome<bool> {
    let Some(to_store) = sharing.triangles_to_store(mesh) else { return Ok(false) };
    parts.check(to_store as u64, mesh.triangles.len() as u64)?;
    let transform = *placement.transform();
    let survey = sharing.survey(mesh, &transform);
    if let Some(survey) = survey.filter(|survey| survey.dropped > 0) {
        let corner = mesh.corners(survey.first_dropped)[0];
        parts.lose(transform.point(mesh.vertices[corner]).as_vec3());
    }
    parts.take(survey)?;
    let is_placed =
        survey.is_some_and(|survey| sharing.place(mesh, (object, parts.one_sided), transform, &survey, wanted));
    if !is_placed {
        parts.restart();
    }
    Ok(is_placed)
}

/// Whether light bends in it: what encloses a volume does, single surfaces do not.
fn is_body(object: &ObjectDesc) -> bool {
    match object.shape {
        ShapeDesc::Sphere { .. } | ShapeDesc::Plane { .. } | ShapeDesc::Box { .. } => true,
        ShapeDesc::Cone { capped, .. } => capped,
        // A lone triangle is described like a mesh, but bounds nothing.
        ShapeDesc::Mesh(_) => object.kind == "mesh",
        ShapeDesc::Disk { .. } | ShapeDesc::Rectangle { .. } | ShapeDesc::Group { .. } | ShapeDesc::Model { .. } => {
            false
        }
    }
}

fn add_shape(object: &ObjectDesc, placement: &Placement, cut: Option<&Cut>, parts: &mut ObjectParts) -> Outcome<()> {
    let scale = |radius: f64| scaled_radius(radius, placement, object);
    match &object.shape {
        ShapeDesc::Sphere { center, radius } => {
            let radius = not_zero(scale(*radius)?, object.at)?;
            parts.push(0, Shape::Sphere { center: placement.point(*center).as_vec3(), radius })
        }
        ShapeDesc::Plane { point, normal } => {
            let point = placement.point(*point).as_vec3();
            if !point.is_finite() {
                return Err(Problem::new(object.at, "in the world, the plane lies beyond 3.4e38; move it nearer"));
            }
            parts.push(0, Shape::Plane { point, normal: placement.normal(*normal).as_vec3() })
        }
        ShapeDesc::Disk { center, normal, radius } => {
            let radius = not_zero(scale(*radius)?, object.at)?;
            let (center, normal) = (placement.point(*center).as_vec3(), placement.normal(*normal).as_vec3());
            parts.push(0, Shape::Disk { center, normal, radius })
        }
        ShapeDesc::Cone { base, top, radius, radius_top, capped } => {
            let radii = [scale(*radius)?, scale(*radius_top)?];
            add_cone([placement.point(*base), placement.point(*top)], radii, *capped, object.at, parts)
        }
        ShapeDesc::Box { min, max } => add_box(*min, *max, placement, object.at, parts),
        ShapeDesc::Rectangle { corner, edge_u, edge_v } => {
            let (u, v) = (*corner + *edge_u, *corner + *edge_v);
            add_quad(0, [*corner, u, u + *edge_v, v], placement, parts)
        }
        ShapeDesc::Mesh(mesh) => add_mesh(mesh, placement, cut, parts),
        ShapeDesc::Group { .. } | ShapeDesc::Model { .. } => Ok(()),
    }
}

/// A radius in the world. A stretched circle would be an ellipse, which no kernel knows.
fn scaled_radius(radius: f64, placement: &Placement, object: &ObjectDesc) -> Outcome<f32> {
    match placement.uniform_scale() {
        Some(scale) => Ok((radius * scale) as f32),
        None => {
            let message = format!("a {} cannot be scaled differently along its axes; give one scale", object.kind);
            Err(Problem::new(object.at, message))
        }
    }
}

fn not_zero(radius: f32, at: At) -> Outcome<f32> {
    match radius > 0.0 {
        true => Ok(radius),
        false => Err(Problem::new(at, "scaled into the world, the radius rounds to 0; make it larger")),
    }
}

fn add_cone(ends: [DVec3; 2], radii: [f32; 2], capped: bool, at: At, parts: &mut ObjectParts) -> Outcome<()> {
    let [base, top] = ends.map(|p| p.as_vec3());
    let [radius_base, radius_top] = radii;
    not_zero(radius_base.max(radius_top), at)?;
    if base == top {
        parts.lose(base);
        return Err(Problem::new(at, "in the world, base and top round to the same point; make it longer"));
    }
    parts.push(SIDE, Shape::Cone { base, top, radius_base, radius_top })?;
    if !capped {
        return Ok(());
    }
    let axis = (ends[1] - ends[0]).normalize_or_zero().as_vec3();
    for (primitive, center, normal, radius) in [(BASE, base, -axis, radius_base), (TOP, top, axis, radius_top)] {
        // The tip of a cone has no cap.
        if radius > 0.0 {
            parts.push(primitive, Shape::Disk { center, normal, radius })?;
        }
    }
    Ok(())
}

/// Faces 0 to 5 are at the least x, greatest x, least y, greatest y, least z, greatest z; all wind outward.
fn add_box(min: DVec3, max: DVec3, placement: &Placement, at: At, parts: &mut ObjectParts) -> Outcome<()> {
    let corner = placement.point(min).as_vec3();
    let ends = DVec3::AXES.map(|axis| placement.point(min + (max - min) * axis).as_vec3());
    if ends.contains(&corner) {
        parts.lose(corner);
        return Err(Problem::new(at, "in the world, two faces round to the same plane; make it larger"));
    }
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (side, level) in [(0, min[axis]), (1, max[axis])] {
            let corner = |at_u: f64, at_v: f64| {
                let mut point = DVec3::ZERO;
                (point[axis], point[u], point[v]) = (level, at_u, at_v);
                point
            };
            let (a, c) = (corner(min[u], min[v]), corner(max[u], max[v]));
            let (b, d) = (corner(max[u], min[v]), corner(min[u], max[v]));
            // u x v points along the axis: outward on the greater side only.
            let corners = if side == 1 { [a, b, c, d] } else { [a, d, c, b] };
            add_quad(2 * axis as u32 + side, corners, placement, parts)?;
        }
    }
    Ok(())
}

/// Four corners in a plane, in order: two triangles of one primitive.
fn add_quad(primitive: u32, corners: [DVec3; 4], placement: &Placement, parts: &mut ObjectParts) -> Outcome<()> {
    let [a, b, c, d] = corners.map(|p| placement.point(p));
    parts.push_triangle(primitive, [a, b, c], Corners::default(), placement)?;
    parts.push_triangle(primitive, [a, c, d], Corners::default(), placement)
}

fn add_mesh(mesh: &MeshDesc, placement: &Placement, cut: Option<&Cut>, parts: &mut ObjectParts) -> Outcome<()> {
    parts.reserve(mesh.triangles.len())?;
    let points: Vec<DVec3> = mesh.vertices.iter().map(|p| placement.point(*p)).collect();
    let normals: Vec<Vec3> = mesh.normals.iter().map(|n| placement.normal(*n).as_vec3()).collect();
    let tangents: Vec<Vec4> = mesh.tangents.iter().map(|t| placement.tangent(*t)).collect();
    for (primitive, triangle) in (0..).zip(&mesh.triangles) {
        let corners = triangle.map(|i| i as usize);
        let attributes = mesh.attributes(corners, |i| normals[i]);
        let extras = mesh.extras(corners, |i| tangents[i]).map(Box::new);
        let holes = cut.map(|cut| Box::new(cut.corners(mesh, corners)));
        let carried = Corners { attributes, extras, holes };
        parts.push_triangle(primitive, corners.map(|i| points[i]), carried, placement)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Part;
    use crate::scene::desc::SceneDesc;
    use crate::scene::files::Files;
    use crate::scene::{FORMATS, LoadOptions};
    use glam::{DAffine3, DVec2};
    use std::path::Path;

    /// The parts of one object under a transform.
    fn parts_of(shape: ShapeDesc, transform: Option<DAffine3>) -> Vec<Part> {
        let options = LoadOptions::default();
        let limits = &options.limits;
        let mut builder = SceneBuilder::new(Path::new("test"), &FORMATS[0], Files::embedded(&[], limits), &options);
        let object = ObjectDesc { at: At(0), kind: "shape", name: None, material: None, transform, shape };
        let scene = SceneDesc { objects: vec![object], ..SceneDesc::default() };
        builder.add(scene, &mut Warnings::default()).unwrap();
        builder.parts
    }

    fn triangle(part: &Part) -> [Vec3; 3] {
        match part.shape {
            Shape::Triangle { vertices } => vertices,
            other => panic!("expected a triangle, found {other:?}"),
        }
    }

    fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
        (b - a).cross(c - a).normalize()
    }

    fn mirrored() -> Option<DAffine3> {
        Some(DAffine3::from_scale(DVec3::new(-1.0, 2.0, 3.0)))
    }

    #[test]
    fn box_faces_wind_outward_and_are_numbered_by_axis() {
        for transform in [None, mirrored()] {
            let parts = parts_of(ShapeDesc::Box { min: DVec3::splat(-1.0), max: DVec3::ONE }, transform);
            let numbers: Vec<u32> = parts.iter().map(|p| p.id.primitive).collect();
            assert_eq!(numbers, [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]);
            let mut outward = [Vec3::NEG_X, Vec3::X, Vec3::NEG_Y, Vec3::Y, Vec3::NEG_Z, Vec3::Z];
            if transform.is_some() {
                outward.swap(0, 1);
            }
            for part in &parts {
                assert_eq!(normal(triangle(part)), outward[part.id.primitive as usize], "{part:?}");
            }
        }
    }

    #[test]
    fn a_rectangle_is_one_primitive_that_faces_along_u_cross_v() {
        let (corner, edge_u, edge_v) = (DVec3::ONE, DVec3::X * 2.0, DVec3::Z * 3.0);
        let parts = parts_of(ShapeDesc::Rectangle { corner, edge_u, edge_v }, None);
        assert_eq!(parts.len(), 2);
        let area: f32 = parts
            .iter()
            .map(|part| {
                let [a, b, c] = triangle(part);
                assert_eq!(part.id.primitive, 0);
                assert_eq!(normal([a, b, c]), Vec3::NEG_Y);
                (b - a).cross(c - a).length() / 2.0
            })
            .sum();
        assert_eq!(area, 6.0);
    }

    #[test]
    fn caps_face_outward_and_a_tip_has_none() {
        let cone = |radius, radius_top, capped| {
            let shape = ShapeDesc::Cone { base: DVec3::ZERO, top: DVec3::Y, radius, radius_top, capped };
            parts_of(shape, Some(DAffine3::from_scale(DVec3::new(-2.0, 2.0, 2.0))))
        };
        let disks = |parts: &[Part]| -> Vec<(u32, Vec3, Vec3, f32)> {
            let disk = |part: &Part| match part.shape {
                Shape::Disk { center, normal, radius } => Some((part.id.primitive, center, normal, radius)),
                _ => None,
            };
            parts.iter().filter_map(disk).collect()
        };
        let (base, top) = ((1, Vec3::ZERO, Vec3::NEG_Y, 2.0), (2, Vec3::Y * 2.0, Vec3::Y, 1.0));
        let capped = cone(1.0, 0.5, true);
        assert_eq!(
            capped[0].shape,
            Shape::Cone { base: Vec3::ZERO, top: Vec3::Y * 2.0, radius_base: 2.0, radius_top: 1.0 }
        );
        assert_eq!(disks(&capped), [base, top]);
        assert_eq!(disks(&cone(1.0, 0.0, true)), [base]);
        assert_eq!(disks(&cone(0.0, 0.5, true)), [top]);
        assert_eq!(disks(&cone(1.0, 0.5, false)), []);
    }

    #[test]
    fn a_mirrored_mesh_keeps_its_outside_and_its_corners_their_data() {
        let mesh = MeshDesc {
            vertices: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 0, 1], [0, 1, 2]],
            normals: vec![DVec3::Z, DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 1.0)],
            uvs: vec![DVec2::ZERO, DVec2::X, DVec2::Y],
            ..MeshDesc::default()
        };
        let mesh = ShapeDesc::Mesh(Arc::new(mesh));
        let plain = parts_of(mesh.clone(), None);
        let turned = parts_of(mesh, mirrored());
        for parts in [&plain, &turned] {
            // The first triangle has no area; the second keeps its number.
            let [part] = &parts[..] else { panic!("one triangle is left") };
            assert_eq!(part.id.primitive, 1);
            assert_eq!(normal(triangle(part)), Vec3::Z);
        }
        let (plain, turned) = (plain[0].attributes.unwrap(), turned[0].attributes.unwrap());
        let ([a, b, c], [x, y, z]) = (plain.uvs.unwrap(), turned.uvs.unwrap());
        assert_eq!([x, z, y], [a, b, c]);
        let leaning = turned.normals.unwrap()[2];
        assert!(leaning.abs_diff_eq(Vec3::new(-1.0, 0.0, 1.0 / 3.0).normalize(), 1e-6), "{leaning}");
    }

    #[test]
    fn a_planes_solid_side_follows_a_mirror() {
        let plane = ShapeDesc::Plane { point: DVec3::X, normal: DVec3::X };
        let [part] = &parts_of(plane, mirrored())[..] else { panic!("one plane") };
        assert_eq!(part.shape, Shape::Plane { point: Vec3::NEG_X, normal: Vec3::NEG_X });
    }
}
