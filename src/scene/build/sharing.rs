//! Which meshes are stored once and placed, and which are flattened into the world.
//!
//! Flattened is faster to trace: beams see every triangle, and no ray is taken into another space. So meshes are
//! shared only where that saves real memory.

use super::footprint::{Footprint, Survey};
use super::parts::MOST_INDICES;
use crate::geometry::{Instance, Instances, Mesh, SharedMesh, Transform};
use crate::scene::desc::problem::At;
use crate::scene::desc::{ObjectDesc, ShapeDesc};
use std::collections::HashMap;
use std::sync::Arc;

/// When meshes that are placed several times are stored once. The picture is the same, bit for bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Instancing {
    /// Where it saves real memory: at least 256 MiB in a file, by meshes that are placed four times or more.
    #[default]
    WhenItPays,
    /// Every mesh, however often it is placed.
    Always,
    /// None.
    Never,
}

/// Meshes that are placed less often are flattened.
const LEAST_PLACEMENTS: u64 = 4;
/// What a flattened triangle takes, about: its place in the tree, its names, what its corners carry.
const TRIANGLE_BYTES: u64 = 200;
/// A file that would save less than this is flattened as a whole.
const LEAST_SAVING: u64 = 256 << 20;
/// So is a mesh that would save less than this.
const LEAST_SAVING_A_MESH: u64 = 1 << 20;

/// How often each mesh of a file is placed that could be shared, and each model.
#[derive(Debug, Default)]
pub struct Census {
    meshes: HashMap<*const Mesh, (Arc<Mesh>, u64)>,
    models: HashMap<String, u64>,
}

impl Census {
    /// Counts what objects and groups of them hold. Objects that may have holes are not shared.
    pub fn of(objects: &[ObjectDesc], may_have_holes: impl Fn(&ObjectDesc) -> bool) -> Self {
        let mut census = Self::default();
        each(objects, |object| match &object.shape {
            ShapeDesc::Model { file } => *census.models.entry(file.name.clone()).or_default() += 1,
            ShapeDesc::Mesh(mesh) if !may_have_holes(object) => {
                census.meshes.entry(Arc::as_ptr(mesh)).or_insert_with(|| (Arc::clone(mesh), 0)).1 += 1;
            }
            _ => {}
        });
        census
    }

    /// How often the file of a model is named.
    pub fn models_of(&self, name: &str) -> u64 {
        self.models.get(name).copied().unwrap_or(0)
    }
}

/// Shows every object that is no group, in no order that matters.
fn each(objects: &[ObjectDesc], mut show: impl FnMut(&ObjectDesc)) {
    let mut groups = vec![objects];
    while let Some(objects) = groups.pop() {
        for object in objects {
            match &object.shape {
                ShapeDesc::Group { children } => groups.push(children),
                _ => show(object),
            }
        }
    }
}

/// The first of `objects` with which the numbers that `count` gives of their meshes come to more than `limit`.
fn first_over(limit: u64, objects: &[ObjectDesc], count: impl Fn(&ObjectDesc, &Arc<Mesh>) -> u64) -> Option<At> {
    let (mut sum, mut over) = (0_u64, None);
    each(objects, |object| {
        let ShapeDesc::Mesh(mesh) = &object.shape else { return };
        sum = sum.saturating_add(count(object, mesh));
        if sum > limit {
            over.get_or_insert(object.at);
        }
    });
    over
}

/// A mesh that is to be shared, and where it is stored once it was placed.
#[derive(Debug)]
struct Candidate {
    mesh: Arc<Mesh>,
    stored: Option<u32>,
    /// Made when it is placed for the first time.
    footprint: Option<Footprint>,
}

/// What instances take.
#[derive(Clone, Copy, Debug, Default)]
pub struct Totals {
    /// Triangles that are stored.
    pub triangles: u64,
    /// Indices: triangles, as often as they are placed.
    pub indices: u64,
}

/// The shared meshes of a scene under construction.
#[derive(Debug, Default)]
pub struct Sharing {
    instancing: Instancing,
    /// By address; each is kept, so that no other takes its place.
    candidates: HashMap<*const Mesh, Candidate>,
    instances: Instances,
    totals: Totals,
}

impl Sharing {
    /// Nothing shared yet.
    pub fn new(instancing: Instancing) -> Self {
        Self { instancing, ..Self::default() }
    }

    /// Forgets everything but when meshes are shared.
    pub fn start_over(&mut self) {
        *self = Self::new(self.instancing);
    }

    /// Decides which meshes of a file are shared; the file is placed `times` times.
    pub fn decide(&mut self, census: &Census, times: u64) {
        let saving = |mesh: &Mesh, count: u64| {
            let count = count.saturating_mul(times);
            let copies = if count < LEAST_PLACEMENTS { 0 } else { count - 1 };
            copies.saturating_mul(mesh.triangles.len() as u64).saturating_mul(TRIANGLE_BYTES)
        };
        let in_all = census.meshes.values().fold(0_u64, |sum, (mesh, count)| sum.saturating_add(saving(mesh, *count)));
        for (&address, (mesh, count)) in &census.meshes {
            let shares = match self.instancing {
                Instancing::Never => false,
                Instancing::Always => true,
                Instancing::WhenItPays => in_all >= LEAST_SAVING && saving(mesh, *count) >= LEAST_SAVING_A_MESH,
            };
            if shares {
                self.candidates.entry(address).or_insert_with(|| Candidate {
                    mesh: Arc::clone(mesh),
                    stored: None,
                    footprint: None,
                });
            }
        }
    }

    /// The first of a file's objects with which its flattened meshes have more triangles than `limit`.
    pub fn first_beyond(
        &self,
        objects: &[ObjectDesc],
        limit: u64,
        may_have_holes: impl Fn(&ObjectDesc) -> bool,
    ) -> Option<At> {
        first_over(limit, objects, |object, mesh| {
            let is_flattened = may_have_holes(object) || !self.candidates.contains_key(&Arc::as_ptr(mesh));
            if is_flattened { mesh.triangles.len() as u64 } else { 0 }
        })
    }

    /// The first of a file's objects with which its shared meshes have more triangles, as often as they are placed, than
    /// there are indices; the file is placed `times` times.
    pub fn first_without_index(
        &self,
        objects: &[ObjectDesc],
        times: u64,
        may_have_holes: impl Fn(&ObjectDesc) -> bool,
    ) -> Option<At> {
        first_over(MOST_INDICES, objects, |object, mesh| {
            let is_shared = self.candidates.contains_key(&Arc::as_ptr(mesh)) && !may_have_holes(object);
            if is_shared { times.saturating_mul(mesh.triangles.len() as u64) } else { 0 }
        })
    }

    /// How many triangles have to be stored before a mesh can be placed; `None` if it is not to be shared.
    pub fn triangles_to_store(&self, mesh: &Arc<Mesh>) -> Option<usize> {
        let candidate = self.candidates.get(&Arc::as_ptr(mesh))?;
        Some(if candidate.stored.is_some() { 0 } else { mesh.triangles.len() })
    }

    /// What all instances take so far.
    pub fn totals(&self) -> Totals {
        self.totals
    }

    /// What a mesh that is to be shared comes to under a transform; `None` if it reaches beyond all numbers.
    pub fn survey(&mut self, mesh: &Arc<Mesh>, transform: &Transform) -> Option<Survey> {
        let footprint = &mut self.candidates.get_mut(&Arc::as_ptr(mesh))?.footprint;
        footprint.get_or_insert_with(|| Footprint::new(mesh)).survey(mesh, transform)
    }

    /// Places a mesh as an object, which may be seen from one side only, given what it comes to there.
    /// False if it has to be flattened after all: it is empty, or rays cannot be taken into its space.
    /// So it is with `wanted` saying no, too.
    pub fn place(
        &mut self,
        mesh: &Arc<Mesh>,
        (object, one_sided): (u32, bool),
        transform: Transform,
        survey: &Survey,
        wanted: &dyn Fn() -> bool,
    ) -> bool {
        let Some(candidate) = self.candidates.get_mut(&Arc::as_ptr(mesh)) else { return false };
        let known = match candidate.stored {
            Some(known) => known,
            None => {
                let Some(shared) = SharedMesh::new(Arc::clone(&candidate.mesh), wanted) else { return false };
                self.totals.triangles += mesh.triangles.len() as u64;
                self.instances.meshes.push(shared);
                *candidate.stored.insert(self.instances.meshes.len() as u32 - 1)
            }
        };
        let shared = &self.instances.meshes[known as usize];
        let with_area = mesh.triangles.len() as u32 - survey.dropped;
        let instance = Instance::new((known, shared), object, transform, survey.bounds, with_area);
        let Some(mut instance) = instance else { return false };
        instance.one_sided = one_sided;
        self.totals.indices += mesh.triangles.len() as u64;
        self.instances.placed.push(instance);
        true
    }

    /// How many instances there are.
    pub fn count(&self) -> usize {
        self.instances.placed.len()
    }

    /// Forgets all instances but the first `count`.
    pub fn truncate(&mut self, count: usize) {
        for removed in self.instances.placed.drain(count..) {
            self.totals.indices -= self.instances.meshes[removed.mesh as usize].mesh.triangles.len() as u64;
        }
    }

    /// What was placed.
    pub fn finish(self) -> Instances {
        self.instances
    }
}
