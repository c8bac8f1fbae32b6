//! Objects: the entries of `"objects"` and of a group's `"children"`. What each type takes stands at its reader.

use super::map::{Map, shortened};
use super::node::Node;
use super::problem::{At, Outcome, Problem};
use super::value::{array, boolean, direction, indices, not_negative, positive, rows, text, vector};
use super::{Context, MeshDesc, NameRef, hint, transform};
use glam::{DAffine3, DVec2, DVec3};
use std::sync::Arc;

/// An object as the file gives it, in its own space.
#[derive(Clone, Debug)]
pub struct ObjectDesc {
    /// Where it stands in the file.
    pub at: At,
    /// The type as the file spells it.
    pub kind: &'static str,
    /// Its name, where the file gives one.
    pub name: Option<String>,
    /// Its material, where the file gives one.
    pub material: Option<NameRef>,
    /// From its own space to its parent's.
    pub transform: Option<DAffine3>,
    /// Its shape.
    pub shape: ShapeDesc,
}

/// The shape of an object. Directions are unit vectors; all numbers are finite in f32.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the fields are the file's own keys")]
pub enum ShapeDesc {
    Sphere {
        center: DVec3,
        radius: f64,
    },
    Plane {
        point: DVec3,
        normal: DVec3,
    },
    /// A cylinder or a cone: one of the radii may be 0.
    Cone {
        base: DVec3,
        top: DVec3,
        radius: f64,
        radius_top: f64,
        capped: bool,
    },
    Box {
        min: DVec3,
        max: DVec3,
    },
    Disk {
        center: DVec3,
        normal: DVec3,
        radius: f64,
    },
    Rectangle {
        corner: DVec3,
        edge_u: DVec3,
        edge_v: DVec3,
    },
    /// One triangle (`triangle`) or many (`mesh`).
    Mesh(Arc<MeshDesc>),
    Group {
        children: Vec<ObjectDesc>,
    },
    /// Everything in another scene file but its cameras and what it asks of the picture.
    Model {
        file: NameRef,
    },
}

/// Reads a type's own keys.
type ShapeReader<'t, N> = fn(&mut Map<'t, N>, &mut Context) -> Outcome<ShapeDesc>;

/// Every type of object: its name in the file and what reads it.
fn types<'t, N: Node<'t>>() -> [(&'static str, ShapeReader<'t, N>); 11] {
    [
        ("sphere", sphere),
        ("plane", plane),
        ("cylinder", cylinder),
        ("cone", cone),
        ("box", axis_box),
        ("disk", disk),
        ("rectangle", rectangle),
        ("triangle", triangle),
        ("mesh", mesh),
        ("group", group),
        ("model", model),
    ]
}

/// Reads an object.
pub fn read<'t, N: Node<'t>>(node: N, context: &mut Context) -> Outcome<ObjectDesc> {
    let mut map = Map::open(node)?;
    let type_node = map.required("type", Ok)?;
    let type_name = type_node.text()?;
    let types = types::<N>();
    let Some((kind, read)) = types.iter().find(|(name, _)| *name == type_name) else {
        let hint = hint(&type_name, types.iter().map(|(name, _)| *name));
        let message = format!("unknown object type \"{}\"; {hint}", shortened(&type_name));
        return Err(Problem::new(type_node.at(), message));
    };
    let object = ObjectDesc {
        at: node.at(),
        kind,
        name: map.optional("name", text)?,
        transform: map.optional("transform", |node| transform::read(node, context))?,
        shape: read(&mut map, context)?,
        material: match *kind {
            // They have no surface of their own; a material there is an unknown key.
            "group" | "model" => None,
            _ => map.optional("material", |node| Ok(NameRef { name: text(node)?, at: node.at() }))?,
        },
    };
    map.finish(&mut context.warnings);
    Ok(object)
}

/// `{ "type": "sphere", "center": [0, 0, 0], "radius": 1 }`
fn sphere<'t, N: Node<'t>>(map: &mut Map<'t, N>, _: &mut Context) -> Outcome<ShapeDesc> {
    Ok(ShapeDesc::Sphere { center: map.required("center", vector)?, radius: map.required("radius", positive)? })
}

/// `{ "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0] }`
fn plane<'t, N: Node<'t>>(map: &mut Map<'t, N>, _: &mut Context) -> Outcome<ShapeDesc> {
    Ok(ShapeDesc::Plane { point: map.required("point", vector)?, normal: map.required("normal", direction)? })
}

/// `{ "type": "cylinder", "base": [2, 0, 0], "top": [2, 2, 0], "radius": 0.3, "capped": true }`
fn cylinder<'t, N: Node<'t>>(map: &mut Map<'t, N>, _: &mut Context) -> Outcome<ShapeDesc> {
    let (base, top) = axis(map)?;
    let radius = map.required("radius", positive)?;
    let capped = map.or("capped", true, boolean)?;
    Ok(ShapeDesc::Cone { base, top, radius, radius_top: radius, capped })
}

/// `{ "type": "cone", "base": [3, 0, 0], "top": [3, 1, 0], "radius": 0.3, "radius_top": 0.1, "capped": true }`
fn cone<'t, N: Node<'t>>(map: &mut Map<'t, N>, _: &mut Context) -> Outcome<ShapeDesc> {
    let (base, top) = axis(map)?;
    let radius_at = |node: N| Ok((node.at(), f64::from(not_negative(node)?)));
    let (at, radius) = map.required("radius", radius_at)?;
    let radius_top = map.optional("radius_top", radius_at)?.map_or(0.0, |(_, radius)| radius);
    if radius == 0.0 && radius_top == 0.0 {
        return Err(Problem::new(at, "radius and radius_top are both 0; one of them must be greater"));
    }
    let capped = map.or("capped", true, boolean)?;
    Ok(ShapeDesc::Cone { base, top, radius, radius_top, capped })
}

fn axis<'t, N: Node<'t>>(map: &mut Map<'t, N>) -> Outcome<(DVec3, DVec3)> {
    let base = map.required("base", vector)?;
    let (at, top) = map.required("top", |node| Ok((node.at(), vector(node)?)))?;
    match base == top {
        true => Err(Problem::new(at, "top equals base; they must be different points")),
        false => Ok((base, top)),
    }
}

/// `{ "type": "box", "min": [0, 0, 0], "max": [1, 1, 1] }`
fn axis_box<'t, N: Node<'t>>(map: &mut Map<'t, N>, _: &mut Context) -> Outcome<ShapeDesc> {
    let min = map.required("min", vector)?;
    let (at, max) = map.required("max", |node| Ok((node.at(), vector(node)?)))?;
    match max.cmpgt(min).all() {
        true => Ok(ShapeDesc::Box { min, max }),
        false => Err(Problem::new(at, "max must be greater than min along every axis (a flat box is a rectangle)")),
    }
}

/// `{ "type": "disk", "center": [0, 0, 0], "normal": [0, 1, 0], "radius": 1 }`
fn disk<'t, N: Node<'t>>(map: &mut Map<'t, N>, _: &mut Context) -> Outcome<ShapeDesc> {
    Ok(ShapeDesc::Disk {
        center: map.required("center", vector)?,
        normal: map.required("normal", direction)?,
        radius: map.required("radius", positive)?,
    })
}

/// `{ "type": "rectangle", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1] }`
fn rectangle<'t, N: Node<'t>>(map: &mut Map<'t, N>, _: &mut Context) -> Outcome<ShapeDesc> {
    let corner = map.required("corner", vector)?;
    let edge_u = map.required("edge_u", vector)?;
    let (at, edge_v) = map.required("edge_v", |node| Ok((node.at(), vector(node)?)))?;
    match edge_u.cross(edge_v).try_normalize() {
        Some(_) => Ok(ShapeDesc::Rectangle { corner, edge_u, edge_v }),
        None => Err(Problem::new(at, "edge_u and edge_v must span a surface: neither of length 0, not parallel")),
    }
}

/// `{ "type": "triangle", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]] }`, with `normals` and `uvs` as a mesh has them.
fn triangle<'t, N: Node<'t>>(map: &mut Map<'t, N>, _: &mut Context) -> Outcome<ShapeDesc> {
    let vertices: [DVec3; 3] = map.required("vertices", |node| array(node, vector))?;
    let (normals, uvs) = vertex_attributes(map, 3)?;
    let mesh =
        MeshDesc { vertices: vertices.to_vec(), triangles: vec![[0, 1, 2]], normals, uvs, ..MeshDesc::default() };
    Ok(ShapeDesc::Mesh(Arc::new(mesh)))
}

/// `{ "type": "mesh", "vertices": [[0, 0, 0], ..], "triangles": [[0, 1, 2], ..], "normals": [], "uvs": [] }`
fn mesh<'t, N: Node<'t>>(map: &mut Map<'t, N>, _: &mut Context) -> Outcome<ShapeDesc> {
    let vertices: Vec<DVec3> = map.required("vertices", rows)?.into_iter().map(DVec3::from_array).collect();
    let triangles = map.required("triangles", |node| indices(node, vertices.len(), "vertices"))?;
    let (normals, uvs) = vertex_attributes(map, vertices.len())?;
    Ok(ShapeDesc::Mesh(Arc::new(MeshDesc { vertices, triangles, normals, uvs, ..MeshDesc::default() })))
}

fn vertex_attributes<'t, N: Node<'t>>(map: &mut Map<'t, N>, count: usize) -> Outcome<(Vec<DVec3>, Vec<DVec2>)> {
    let normals = map.or("normals", Vec::new(), |node| {
        let normals: Vec<DVec3> = one_a_vertex(node, count)?.into_iter().map(DVec3::from_array).collect();
        match normals.iter().position(|n| n.try_normalize().is_none()) {
            None => Ok(normals),
            Some(zero) => direction(node.rows()?[zero]).map(|_| normals),
        }
    })?;
    let uvs = map.or("uvs", Vec::new(), |node| one_a_vertex(node, count))?;
    Ok((normals, uvs.into_iter().map(DVec2::from_array).collect()))
}

fn one_a_vertex<'t, const N: usize>(node: impl Node<'t>, count: usize) -> Outcome<Vec<[f64; N]>> {
    let values = rows::<N>(node)?;
    match values.is_empty() || values.len() == count {
        true => Ok(values),
        false => Err(Problem::new(node.at(), format!("expected one entry a vertex ({count}), found {}", values.len()))),
    }
}

/// `{ "type": "group", "transform": { "translate": [0, 1, 0] }, "children": [] }`
fn group<'t, N: Node<'t>>(map: &mut Map<'t, N>, context: &mut Context) -> Outcome<ShapeDesc> {
    let children = map.or("children", Vec::new(), |node| {
        node.items()?.into_iter().map(|child| read(child, context)).collect::<Outcome<_>>()
    })?;
    Ok(ShapeDesc::Group { children })
}

/// `{ "type": "model", "file": "room.glb" }`
fn model<'t, N: Node<'t>>(map: &mut Map<'t, N>, _: &mut Context) -> Outcome<ShapeDesc> {
    Ok(ShapeDesc::Model { file: map.required("file", |node| Ok(NameRef { name: text(node)?, at: node.at() }))? })
}
