//! glTF 2.0 (Khronos, 2021), as text (`.gltf`) or binary (`.glb`).
//!
//! The `gltf` crate gives the JSON its types; the rest is our own, since nothing a file says may be trusted:
//!
//! | file | what it reads |
//! |---|---|
//! | [`container`] | the chunks of a binary file |
//! | [`root`] | the JSON |
//! | [`document`] | buffers and buffer views; [`uri`] for where buffers are |
//! | [`extensions`] | which extensions the file needs |
//! | [`accessor`] | elements of buffer views |
//! | [`nodes`] | the tree of nodes; [`instancing`] for those that draw a mesh many times |
//! | [`mesh`] | primitives; [`topology`], [`tangents`] and [`skin`] for their triangles, normal maps and joints |
//! | [`material`] | materials; [`texture`] for their textures, images and samplers |
//! | [`light`], [`camera`] | what stands at nodes besides meshes |
//!
//! Each primitive of each node is an object, depth first in file order. All is shown at rest: animations are not played,
//! skins are held by their joints as the nodes place them, and morph targets weigh what the file says.

mod accessor;
mod camera;
mod container;
mod document;
mod extensions;
mod fault;
mod instancing;
mod light;
mod material;
mod mesh;
mod nodes;
mod root;
mod skin;
mod tangents;
mod texture;
mod topology;
mod uri;

use super::Input;
use super::json::parse_as;
use crate::geometry::Aabb;
use crate::scene::RenderDefaults;
use crate::scene::build::SceneBuilder;
use crate::scene::desc::{MaterialDesc, MeshDesc, NameRef, ObjectDesc, SceneDesc, ShapeDesc};
use crate::scene::error::SceneError;
use crate::scene::limits::{Limits, exceeded};
use crate::scene::material::Alpha;
use crate::settings::{Exposure, ToneMap};
use container::Container;
use document::{Document, get};
use fault::{Fault, Read, Report};
use glam::DAffine3;
use mesh::{Drawn, Job};
use nodes::Nodes;
use rayon::prelude::*;
use root::Root;
use std::collections::HashMap;
use std::sync::Arc;
use texture::Textures;

/// Rays on a path where something can be seen through: leaves and panes lie many deep.
const DEPTH_WITH_BLENDING: u32 = 12;

/// Reads a glTF file into `builder`.
pub fn read(input: &Input, builder: &mut SceneBuilder) -> Result<(), SceneError> {
    let in_file = |fault: Fault| fault.in_file(input.path);
    let Container { json, bin } = container::open(input.bytes).map_err(in_file)?;
    let root: Root = parse_as("glTF", input.path, json, builder.limits().nesting)?;
    let mut report = Report::default();
    check_version(&root).and_then(|()| extensions::check(&root, &mut report)).map_err(in_file)?;
    let limits = builder.limits().clone();
    let document = Document::new(root, bin, &limits, |name| builder.read_file(name));
    let scene = describe(&document, &limits, &mut report).map_err(in_file)?;
    drop(document);
    let mut warnings = std::mem::take(&mut report.warnings);
    builder.add(scene, &mut warnings).map_err(|problem| in_file(report.fault(problem)))?;
    report.warnings = warnings;
    builder.warn(report.into_warnings(input.path));
    Ok(())
}

fn check_version(root: &Root) -> Read<()> {
    let fault = |key: &str, version: &str| {
        Err(Fault::new(format!("/asset/{key}"), format!("glTF version {version} is not known; expected 2.0")))
    };
    match (&root.asset.version, &root.asset.min_version) {
        (_, Some(least)) if least != "2.0" => fault("minVersion", least),
        (version, _) if !version.starts_with("2.") => fault("version", version),
        _ => Ok(()),
    }
}

/// The description of the default scene.
fn describe(document: &Document, limits: &Limits, report: &mut Report) -> Read<SceneDesc> {
    let nodes = Nodes::walk(document, limits, report)?;
    let mut textures = Textures::new(document);
    let materials = material::materials(document, &mut textures, report)?;
    let objects = objects(document, &nodes, &materials, limits, report)?;
    let see_through = materials.iter().any(|m| m.alpha == Alpha::Blend || m.is_transparent());
    let render = RenderDefaults::default();
    Ok(SceneDesc {
        render: RenderDefaults {
            max_depth: if see_through { DEPTH_WITH_BLENDING } else { render.max_depth },
            // Lights are in candela and lux.
            exposure: Exposure::Auto,
            tone_map: ToneMap::Neutral,
            ..render
        },
        cameras: camera::cameras(document, &nodes, || bounds(&objects), report)?,
        textures: textures.descs,
        materials,
        lights: light::lights(document, &nodes, report)?,
        objects,
    })
}

/// What tells primitives apart that are read only once each: the mesh, the primitive within, and the node where its skin or
/// its own morph weights make a difference.
type Key = (usize, usize, Option<usize>);

/// Every primitive of every node.
fn objects(
    document: &Document,
    nodes: &Nodes,
    materials: &[MaterialDesc],
    limits: &Limits,
    report: &mut Report,
) -> Read<Vec<ObjectDesc>> {
    let mut jobs: Vec<Job> = Vec::new();
    let mut job_of: HashMap<Key, usize> = HashMap::new();
    // Node, where its instances stand, and its primitives as jobs.
    let mut drawn: Vec<(usize, Vec<DAffine3>, Vec<usize>)> = Vec::new();
    let mut instances_left = limits.nodes;
    for &node in &nodes.order {
        let (own, Some(world)) = (&document.root.nodes[node], &nodes.worlds[node]) else { continue };
        let Some(index) = own.mesh else { continue };
        let mesh = get(&document.root.meshes, index, "mesh", format_args!("/nodes/{node}/mesh"))?;
        let skinned = own.skin.is_some();
        let alone = (skinned || own.weights.is_some()).then_some(node);
        let weights = own.weights.as_ref().or(mesh.weights.as_ref()).map_or(&[][..], Vec::as_slice);
        let mut own_jobs = Vec::with_capacity(mesh.primitives.len());
        for (place, primitive) in mesh.primitives.iter().enumerate() {
            let pointer = format!("/meshes/{}/primitives/{place}", index.value());
            if let Some(&known) = job_of.get(&(index.value(), place, alone)) {
                own_jobs.push(known);
                continue;
            }
            let (second_coordinates, normal_map) = material::coordinates(material_of(primitive, materials, &pointer)?);
            let joints = own.skin.map(|skin| skin::joint_matrices(document, nodes, skin, node)).transpose()?;
            if skinned {
                report.warn(format!("/nodes/{node}/skin"), "the skin is shown at rest");
            }
            if primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()) {
                report.warn(format!("{pointer}/targets"), "the morph targets are shown at rest");
            }
            job_of.insert((index.value(), place, alone), jobs.len());
            own_jobs.push(jobs.len());
            jobs.push(Job { primitive, pointer, weights, joints, second_coordinates, normal_map });
        }
        // The joints of a skin place it, not its node.
        let places = match skinned {
            true => vec![DAffine3::IDENTITY],
            false => {
                let instances = instancing::instances(document, own, node, instances_left)?;
                instances_left -= instances.len() as u64;
                instances.into_iter().map(|place| *world * place).collect()
            }
        };
        drawn.push((node, places, own_jobs));
    }

    let meshes: Vec<_> = jobs.par_iter().map(|job| job.read(document)).collect::<Read<_>>()?;
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
    place_objects(document, &jobs, &shapes, &drawn, materials, limits, report)
}

/// Puts the primitives that were read where their nodes stand.
fn place_objects(
    document: &Document,
    jobs: &[Job],
    shapes: &[Option<Arc<MeshDesc>>],
    drawn: &[(usize, Vec<DAffine3>, Vec<usize>)],
    materials: &[MaterialDesc],
    limits: &Limits,
    report: &mut Report,
) -> Read<Vec<ObjectDesc>> {
    let mut objects = Vec::new();
    let mut primitives = 0;
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
                primitives += shape.triangles.len() as u64;
                let over = |name: &str, limit: u64| {
                    Err(Fault::new(format!("/nodes/{node}"), format!("{name}: {}", exceeded(name, limit))))
                };
                if primitives > limits.primitives {
                    return over("primitives", limits.primitives);
                }
                if objects.len() as u64 >= limits.objects {
                    return over("objects", limits.objects);
                }
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
fn material_of<'a>(
    primitive: &gltf::json::mesh::Primitive,
    materials: &'a [MaterialDesc],
    pointer: &str,
) -> Read<&'a MaterialDesc> {
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
fn bounds(objects: &[ObjectDesc]) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    for object in objects {
        let ShapeDesc::Mesh(mesh) = &object.shape else { continue };
        let own = mesh.vertices.iter().fold(Aabb::EMPTY, |all, p| all.union(Aabb::from_points([p.as_vec3(); 1])));
        if own.is_empty() {
            continue;
        }
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { own.min[axis] } else { own.max[axis] };
            let point = glam::DVec3::new(pick(0).into(), pick(1).into(), pick(2).into());
            let point = object.transform.map_or(point, |to_world| to_world.transform_point3(point));
            bounds = bounds.union(Aabb::from_points([point.as_vec3(); 1]));
        }
    }
    bounds
}
