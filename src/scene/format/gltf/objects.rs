//! What nodes draw: every primitive of every node as an object, its triangles read once however often it is drawn.

use super::document::{Document, get};
use super::fault::{Fault, Notes, Read, Report};
use super::instancing;
use super::material::Materials;
use super::mesh::{Drawn, Job};
use super::nodes::{self, Nodes};
use super::skin::Holder;
use super::tangents;
use crate::geometry::Aabb;
use crate::scene::Progress;
use crate::scene::desc::{MeshDesc, NameRef, ObjectDesc, ShapeDesc};
use crate::scene::files::CANCELLED;
use crate::scene::limits::{Limits, exceeded};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// What tells primitives apart that are read only once each: the mesh, the primitive within, and the node where its skin or
/// its own morph weights make a difference.
type Key = (usize, usize, Option<usize>);

/// A node's mesh: where its instances stand, and its primitives as jobs.
struct Drawing {
    node: usize,
    places: Vec<DAffine3>,
    jobs: Vec<usize>,
}

/// Every primitive of every node.
///
/// # Errors
/// A limit is exceeded; or of primitives that are damaged nothing is left, and there are no others.
pub fn objects(
    document: &Document,
    nodes: &Nodes,
    materials: &Materials,
    limits: &Limits,
    progress: &Progress,
    report: &mut Report,
) -> Read<Vec<ObjectDesc>> {
    let mut jobs: Vec<Job> = Vec::new();
    let mut job_of: HashMap<Key, usize> = HashMap::new();
    let mut drawings: Vec<Drawing> = Vec::new();
    let (mut instances_left, mut count) = (limits.nodes, 0_u64);
    for &node in &nodes.order {
        let (Some(own), Some(world)) = (&document.root.nodes[node], &nodes.worlds[node]) else { continue };
        let Some(index) = own.mesh else { continue };
        let mesh = get(&document.root.meshes, index, "mesh", format_args!("/nodes/{node}/mesh"));
        let Some(mesh) = report.attempt(mesh, "meshes left out")? else { continue };
        if mesh.primitives.is_empty() {
            report.warn(format!("/meshes/{}", index.value()), "a mesh without primitives; there is nothing to draw");
            continue;
        }
        let skin = own.skin.map(|skin| {
            get(&document.root.skins, skin, "skin", format_args!("/nodes/{node}/skin")).map(|_| Holder { skin, node })
        });
        let held_by = report.attempt(skin.transpose(), "skins left out")?.flatten();
        let alone = (held_by.is_some() || own.weights.is_some()).then_some(node);
        let weights = own.weights.as_ref().or(mesh.weights.as_ref()).map_or(&[][..], Vec::as_slice);
        // The joints of a skin place it, not its node.
        let places = match held_by {
            Some(_) => vec![DAffine3::IDENTITY],
            None => {
                let mut notes = Notes::default();
                let instances = instancing::instances(document, own, node, instances_left, &mut notes)?;
                report.take(notes);
                instances_left -= instances.len() as u64;
                instances.into_iter().map(|place| *world * place).collect()
            }
        };
        count += places.len() as u64 * mesh.primitives.len() as u64;
        if count > limits.objects {
            return Err(Fault::fatal(
                format!("/nodes/{node}"),
                format!("objects: {}", exceeded("objects", limits.objects)),
            ));
        }
        let mut own_jobs = Vec::with_capacity(mesh.primitives.len());
        for (place, primitive) in mesh.primitives.iter().enumerate() {
            let pointer = format!("/meshes/{}/primitives/{place}", index.value());
            if let Some(&known) = job_of.get(&(index.value(), place, alone)) {
                own_jobs.push(known);
                continue;
            }
            let material = materials.of(primitive.material, &pointer, report);
            let (sets, normal_map) = (materials.sets_of(material), materials.normal_map_of(material));
            if held_by.is_some() {
                report.warn(format!("/nodes/{node}/skin"), "the skin is shown at rest");
            }
            if primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()) {
                report.warn(format!("{pointer}/targets"), "the morph targets are shown at rest");
            }
            job_of.insert((index.value(), place, alone), jobs.len());
            own_jobs.push(jobs.len());
            jobs.push(Job { primitive, pointer, weights, held_by, sets, normal_map });
        }
        drawings.push(Drawing { node, places, jobs: own_jobs });
    }

    progress.begin("reading meshes", jobs.len());
    let read = |job: &Job| {
        if progress.is_cancelled() {
            return Err(Fault::fatal(&*job.pointer, CANCELLED));
        }
        let read = job.read(document, nodes);
        progress.advance();
        read
    };
    let read: Vec<Drawn> = jobs.par_iter().map(read).collect::<Read<_>>()?;
    let mut shapes: Vec<Option<Arc<MeshDesc>>> = Vec::with_capacity(read.len());
    let mut first_fault = None;
    for Drawn { mesh, notes, fault } in read {
        report.take(notes);
        shapes.push(mesh.map(Arc::new));
        first_fault = first_fault.or(fault);
    }
    let objects = place_objects(document, &jobs, &shapes, &drawings, materials, report)?;
    match first_fault {
        // A picture of nothing would say less.
        Some(Fault { pointer, message, .. }) if objects.is_empty() => {
            Err(Fault::fatal(pointer, format!("{message}; nothing is left to draw")))
        }
        _ => Ok(objects),
    }
}

/// Puts the primitives that were read where their nodes stand.
fn place_objects(
    document: &Document,
    jobs: &[Job],
    shapes: &[Option<Arc<MeshDesc>>],
    drawings: &[Drawing],
    materials: &Materials,
    report: &mut Report,
) -> Read<Vec<ObjectDesc>> {
    let mut objects = Vec::new();
    let at: Vec<_> = jobs.iter().map(|job| report.at(&*job.pointer)).collect();
    let mut reaches = Reaches::default();
    for Drawing { node, places, jobs: own_jobs } in drawings {
        let Some(own) = &document.root.nodes[*node] else { continue };
        let mesh = own.mesh.and_then(|mesh| document.root.meshes.get(mesh.value())?.as_ref());
        let name = own.name.as_ref().or_else(|| mesh?.name.as_ref());
        for place in places {
            let is_flat = !nodes::keeps_volumes(place);
            if is_flat && place.is_finite() {
                report.warn(format!("/nodes/{node}"), "the node's scale is 0 along an axis; it is drawn flat");
            }
            for &job in own_jobs {
                let Some(shape) = &shapes[job] else { continue };
                if !place.is_finite() || !reaches.is_within(shape, place) {
                    let message = "in the world, the mesh of the node reaches beyond 3.4e38; left out";
                    report.warn(format!("/nodes/{node}"), message);
                    continue;
                }
                let material = materials.of(jobs[job].primitive.material, &jobs[job].pointer, report);
                let (shape, transform) = match is_flat {
                    true => (Arc::new(flattened(document, shape, place, &jobs[job])?), None),
                    false => (Arc::clone(shape), (*place != DAffine3::IDENTITY).then_some(*place)),
                };
                objects.push(ObjectDesc {
                    at: at[job],
                    kind: "mesh",
                    name: name.cloned(),
                    material: Some(NameRef { name: materials.descs[material].name.clone(), at: at[job] }),
                    transform,
                    shape: ShapeDesc::Mesh(shape),
                });
            }
        }
    }
    Ok(objects)
}

/// A mesh as a transform that no inverse undoes flattens it, its vertices placed in the world.
fn flattened(document: &Document, mesh: &MeshDesc, place: &DAffine3, job: &Job) -> Read<MeshDesc> {
    let elements = mesh.vertices.len() as u64 + 3 * mesh.triangles.len() as u64;
    document.take_elements(elements, format_args!("{}", job.pointer))?;
    let mut flat = MeshDesc {
        vertices: mesh.vertices.iter().map(|p| place.transform_point3(*p)).collect(),
        // What is flat has the normals of its triangles.
        normals: Vec::new(),
        tangents: Vec::new(),
        ..mesh.clone()
    };
    if let Some(map) = job.normal_map {
        tangents::generate(&mut flat, map.set, map.transform);
    }
    Ok(flat)
}

/// How far meshes reach in their own space, looked at once each.
#[derive(Default)]
struct Reaches(HashMap<*const MeshDesc, f64>);

impl Reaches {
    /// Whether a mesh stays within the numbers of f32 where it is placed.
    fn is_within(&mut self, mesh: &Arc<MeshDesc>, place: &DAffine3) -> bool {
        let furthest = || mesh.vertices.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let reach = *self.0.entry(Arc::as_ptr(mesh)).or_insert_with(furthest);
        let matrix = place.matrix3;
        let columns = matrix.x_axis.abs() + matrix.y_axis.abs() + matrix.z_axis.abs();
        (columns * reach + place.translation.abs()).max_element() < f64::from(f32::MAX)
    }
}

/// The bounds of all objects in the world.
pub fn bounds(objects: &[ObjectDesc]) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    let mut of_meshes = HashMap::new();
    for object in objects {
        let ShapeDesc::Mesh(mesh) = &object.shape else { continue };
        let around = || mesh.vertices.iter().fold(Aabb::EMPTY, |all, p| all.union(Aabb::from_points([p.as_vec3(); 1])));
        // Most meshes of a file are placed more than once.
        let own = *of_meshes.entry(Arc::as_ptr(mesh)).or_insert_with(around);
        if own.is_empty() {
            continue;
        }
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { own.min[axis] } else { own.max[axis] };
            let point = DVec3::new(pick(0).into(), pick(1).into(), pick(2).into());
            let point = object.transform.map_or(point, |to_world| to_world.transform_point3(point));
            bounds = bounds.union(Aabb::from_points([point.as_vec3(); 1]));
        }
    }
    bounds
}
