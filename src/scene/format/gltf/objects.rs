//! What nodes draw: every primitive of every node as an object, its triangles read once however often it is drawn.

use super::document::{Document, get};
use super::fault::{Fault, Read, Report};
use super::mesh::{Drawn, Job};
use super::nodes::{self, Nodes};
use super::skin::Holder;
use super::{instancing, material};
use crate::geometry::Aabb;
use crate::scene::Progress;
use crate::scene::desc::{MaterialDesc, MeshDesc, NameRef, ObjectDesc, ShapeDesc};
use crate::scene::files::CANCELLED;
use crate::scene::limits::{Limits, exceeded};
use glam::{DAffine3, DVec3};
use gltf::json::mesh::Primitive;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// What tells primitives apart that are read only once each: the mesh, the primitive within, and the node where its skin or
/// its own morph weights make a difference.
type Key = (usize, usize, Option<usize>);

/// Every primitive of every node.
pub fn objects(
    document: &Document,
    nodes: &Nodes,
    materials: &[MaterialDesc],
    limits: &Limits,
    progress: &Progress,
    report: &mut Report,
) -> Read<Vec<ObjectDesc>> {
    let mut jobs: Vec<Job> = Vec::new();
    let mut job_of: HashMap<Key, usize> = HashMap::new();
    // Node, where its instances stand, and its primitives as jobs.
    let mut drawn: Vec<(usize, Vec<DAffine3>, Vec<usize>)> = Vec::new();
    let (mut instances_left, mut count) = (limits.nodes, 0_u64);
    for &node in &nodes.order {
        let (own, Some(world)) = (&document.root.nodes[node], &nodes.worlds[node]) else { continue };
        let Some(index) = own.mesh else { continue };
        let mesh = get(&document.root.meshes, index, "mesh", format_args!("/nodes/{node}/mesh"))?;
        let skinned = own.skin.is_some();
        let alone = (skinned || own.weights.is_some()).then_some(node);
        let weights = own.weights.as_ref().or(mesh.weights.as_ref()).map_or(&[][..], Vec::as_slice);
        // The joints of a skin place it, not its node.
        let places = match skinned {
            true => vec![DAffine3::IDENTITY],
            false => {
                let instances = instancing::instances(document, own, node, instances_left)?;
                instances_left -= instances.len() as u64;
                instances.into_iter().map(|place| *world * place).collect()
            }
        };
        count += places.len() as u64 * mesh.primitives.len() as u64;
        if count > limits.objects {
            return Err(Fault::new(
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
            let (second_coordinates, normal_map) = material::coordinates(material_of(primitive, materials, &pointer)?);
            let held_by = own.skin.map(|skin| Holder { skin, node });
            if skinned {
                report.warn(format!("/nodes/{node}/skin"), "the skin is shown at rest");
            }
            if primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()) {
                report.warn(format!("{pointer}/targets"), "the morph targets are shown at rest");
            }
            job_of.insert((index.value(), place, alone), jobs.len());
            own_jobs.push(jobs.len());
            jobs.push(Job { primitive, pointer, weights, held_by, second_coordinates, normal_map });
        }
        drawn.push((node, places, own_jobs));
    }

    progress.begin("reading meshes", jobs.len());
    let read = |job: &Job| {
        if progress.is_cancelled() {
            return Err(Fault::new(&*job.pointer, CANCELLED));
        }
        let read = job.read(document, nodes);
        progress.advance();
        read
    };
    let meshes: Vec<_> = jobs.par_iter().map(read).collect::<Read<_>>()?;
    let mut shapes: Vec<Option<Arc<MeshDesc>>> = Vec::with_capacity(meshes.len());
    for (job, read) in jobs.iter().zip(meshes) {
        shapes.push(match read {
            Ok(Drawn { mesh, notes }) => {
                notes.into_iter().for_each(|note| report.warn(&*job.pointer, note));
                Some(Arc::new(mesh))
            }
            Err(why) => {
                report.warn(&*job.pointer, why);
                None
            }
        });
    }
    place_objects(document, &jobs, &shapes, &drawn, materials, report)
}

/// Puts the primitives that were read where their nodes stand.
fn place_objects(
    document: &Document,
    jobs: &[Job],
    shapes: &[Option<Arc<MeshDesc>>],
    drawn: &[(usize, Vec<DAffine3>, Vec<usize>)],
    materials: &[MaterialDesc],
    report: &mut Report,
) -> Read<Vec<ObjectDesc>> {
    let mut objects = Vec::new();
    let at: Vec<_> = jobs.iter().map(|job| report.at(&*job.pointer)).collect();
    for (node, places, own_jobs) in drawn {
        let own = &document.root.nodes[*node];
        let mesh = own.mesh.and_then(|mesh| document.root.meshes.get(mesh.value()));
        let name = own.name.as_ref().or_else(|| mesh?.name.as_ref());
        for place in places {
            if !nodes::keeps_surfaces(place) {
                report.warn(
                    format!("/nodes/{node}"),
                    "the node's scale is 0 along an axis; what it flattens is left out",
                );
                continue;
            }
            for &job in own_jobs {
                let Some(shape) = &shapes[job] else { continue };
                let material = material_of(jobs[job].primitive, materials, &jobs[job].pointer)?;
                objects.push(ObjectDesc {
                    at: at[job],
                    kind: "mesh",
                    name: name.cloned(),
                    material: Some(NameRef { name: material.name.clone(), at: at[job] }),
                    transform: (*place != DAffine3::IDENTITY).then_some(*place),
                    shape: ShapeDesc::Mesh(Arc::clone(shape)),
                });
            }
        }
    }
    Ok(objects)
}

/// The material of a primitive: the one it names, else the default one, which is the last.
fn material_of<'a>(primitive: &Primitive, materials: &'a [MaterialDesc], pointer: &str) -> Read<&'a MaterialDesc> {
    let (default, named) = (materials.len() - 1, &materials[..materials.len() - 1]);
    match primitive.material {
        None => Ok(&materials[default]),
        Some(index) => named.get(index.value()).ok_or_else(|| {
            let message = format!("material {} does not exist; the file has {default}", index.value());
            Fault::new(format!("{pointer}/material"), message)
        }),
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
