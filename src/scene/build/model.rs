//! Models: scene files placed within a scene.
//!
//! A model has names, materials and textures of its own; its lights and objects go where it is placed. Its file is
//! read once, however often it is placed.

use super::placement::Placement;
use super::sharing::Census;
use super::{Names, SceneBuilder};
use crate::scene::Light;
use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::{At, Outcome, Problem, Warnings};
use crate::scene::desc::{NameRef, ObjectDesc};
use crate::scene::files::FileError;
use crate::scene::format::{self, Input};
use crate::scene::light::LightKind;
use crate::scene::limits::exceeded;
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Index of the scene's own file.
const SCENE: usize = 0;

/// What a file puts into the scene, its names resolved.
#[derive(Debug)]
pub struct Contents {
    pub objects: Vec<ObjectDesc>,
    pub lights: Vec<Light<DVec3>>,
    pub materials: Names,
}

/// The scene's file or that of a model.
#[derive(Debug)]
struct File {
    /// Its one path, whatever links and dots it was named with.
    path: PathBuf,
    /// Its path from where the user stands.
    shown: PathBuf,
    /// The files of the models that it names.
    named: HashMap<String, usize>,
    /// What it holds, once it was read.
    contents: Option<Arc<Contents>>,
    /// How often it is placed by the files that led to it first.
    times: u64,
    /// What it places how often.
    census: Census,
    /// Whether it is being added: the file named last, or one that led there.
    is_open: bool,
}

/// The files of a scene, and where in them its construction stands.
#[derive(Debug)]
pub struct Models {
    files: Vec<File>,
    by_path: HashMap<PathBuf, usize>,
    /// The file whose objects are being added.
    open: usize,
    /// Where the model being read is placed.
    placement: Placement,
    /// Whether contents are added once more, without a reader that could tell the place of a problem.
    again: bool,
    /// Groups and models around what is being added.
    depth: u64,
    /// Groups, models and lights of models so far.
    nodes: u64,
}

impl Models {
    /// None yet in the scene file at `path`, which messages call `shown`.
    pub fn of(path: PathBuf, shown: &Path) -> Self {
        let mut models = Self {
            files: Vec::new(),
            by_path: HashMap::new(),
            open: SCENE,
            placement: Placement::WORLD,
            again: false,
            depth: 0,
            nodes: 0,
        };
        models.file(path, || shown.to_owned());
        models.files[SCENE].is_open = true;
        models
    }

    /// Forgets all files but the scene's own.
    pub fn start_over(&mut self) {
        let scene = self.files.swap_remove(SCENE);
        *self = Self::of(scene.path, &scene.shown);
    }

    /// Gives back the memory of what was read.
    pub fn forget(&mut self) {
        self.files = Vec::new();
    }

    /// How often the file that is open is placed.
    pub fn times(&self) -> u64 {
        self.files[self.open].times
    }

    /// Notes what the file that is open places how often.
    pub fn note(&mut self, census: Census) {
        self.files[self.open].census = census;
    }

    /// Whether it is a model that is being read, and not the scene itself.
    pub fn is_reading(&self) -> bool {
        self.open != SCENE
    }

    /// The index of the file at `path`.
    fn file(&mut self, path: PathBuf, shown: impl FnOnce() -> PathBuf) -> usize {
        *self.by_path.entry(path).or_insert_with_key(|path| {
            let (path, shown) = (path.clone(), shown());
            self.files.push(File {
                path,
                shown,
                named: HashMap::new(),
                contents: None,
                times: 1,
                census: Census::default(),
                is_open: false,
            });
            self.files.len() - 1
        })
    }
}

impl SceneBuilder {
    /// Counts a group or model that stands at `at`, and one more level within the scene.
    pub(super) fn enter(&mut self, at: At) -> Outcome<()> {
        self.count_nodes(1, at)?;
        if self.models.depth >= self.limits.nesting {
            let message = format!("groups and models within each other: {}", exceeded("nesting", self.limits.nesting));
            return Err(Problem::new(at, message));
        }
        self.models.depth += 1;
        Ok(())
    }

    /// The group or model last entered ends.
    pub(super) fn leave(&mut self) {
        self.models.depth -= 1;
    }

    fn count_nodes(&mut self, count: usize, at: At) -> Outcome<()> {
        self.models.nodes += count as u64;
        if self.models.nodes > self.limits.nodes {
            let message = format!("groups, models and their lights: {}", exceeded("nodes", self.limits.nodes));
            return Err(Problem::new(at, message));
        }
        Ok(())
    }

    /// Adds the model of a file.
    pub(super) fn add_model(&mut self, file: &NameRef, placement: &Placement) -> Outcome<()> {
        let model = self.model_file(file)?;
        if self.models.files[model].is_open {
            return Err(Problem::new(file.at, format!("the model \"{}\" holds itself", shortened(&file.name))));
        }
        self.models.files[model].is_open = true;
        let including = mem::replace(&mut self.models.open, model);
        let added = match self.models.files[model].contents.clone() {
            Some(contents) => self.add_again(&contents, file, placement),
            None => self.read_model(file, placement),
        };
        self.models.open = including;
        self.models.files[model].is_open = false;
        added?;
        let contents = self.models.files[model].contents.clone();
        contents.map_or(Ok(()), |contents| self.add_lights(&contents.lights, placement, file.at))
    }

    /// The file that a model names.
    fn model_file(&mut self, file: &NameRef) -> Outcome<usize> {
        let including = &self.models.files[self.models.open];
        if let Some(&known) = including.named.get(&file.name) {
            return Ok(known);
        }
        let path = self.images.files().locate(&file.name).map_err(|error| unreadable(file, &error))?;
        let shown = including.shown.parent().unwrap_or(Path::new("")).join(&file.name);
        let times = including.times.saturating_mul(including.census.models_of(&file.name)).max(1);
        let model = self.models.file(path, || shown);
        let known = &mut self.models.files[model];
        known.times = known.times.max(times);
        self.models.files[self.models.open].named.insert(file.name.clone(), model);
        Ok(model)
    }

    /// Reads the file that is open; what it holds comes to [`place_model`](Self::place_model).
    fn read_model(&mut self, file: &NameRef, placement: &Placement) -> Outcome<()> {
        let File { path, shown, .. } = &self.models.files[self.models.open];
        let (path, shown) = (path.clone(), shown.clone());
        let bytes = self.images.files().read(&path).map_err(|error| unreadable(file, &error))?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let folder = self.images.files().relative_to(folder);
        let around = mem::replace(&mut self.models.placement, placement.clone());
        let read = format::read_into(self, &Input { path: &shown, bytes: &bytes });
        self.models.placement = around;
        self.images.files().relative_to(folder);
        read.map_err(|error| Problem::new(file.at, format!("in this model: {error}")))
    }

    /// Places what the model being read holds, and keeps it.
    pub(super) fn place_model(&mut self, contents: Contents, warnings: &mut Warnings) -> Outcome<()> {
        let placement = self.models.placement.clone();
        self.survey(&contents)?;
        self.add_objects(&contents.objects, &placement, &contents.materials, warnings)?;
        self.models.files[self.models.open].contents = Some(Arc::new(contents));
        Ok(())
    }

    /// Adds what was read before. What was odd about it has been told.
    fn add_again(&mut self, contents: &Contents, file: &NameRef, placement: &Placement) -> Outcome<()> {
        let (objects, parts, shared) = (self.objects.len(), self.parts.len(), self.sharing.count());
        let (lights, nodes, depth) = (self.lights.len(), self.models.nodes, self.models.depth);
        let outermost = !mem::replace(&mut self.models.again, true);
        let added = self.add_objects(&contents.objects, placement, &contents.materials, &mut Warnings::default());
        self.models.again = !outermost;
        let Err(problem) = added else { return Ok(()) };
        if outermost {
            // Only its reader can tell the place of what does not fit here: all over again.
            self.objects.truncate(objects);
            self.parts.truncate(parts);
            self.sharing.truncate(shared);
            self.lights.truncate(lights);
            (self.models.nodes, self.models.depth) = (nodes, depth);
            self.read_model(file, placement)?;
        }
        Err(Problem::new(file.at, problem.message))
    }

    fn add_lights(&mut self, lights: &[Light<DVec3>], placement: &Placement, at: At) -> Outcome<()> {
        self.count_nodes(lights.len(), at)?;
        self.take_lights(lights.len(), at)?;
        for light in lights {
            let too_far = || Problem::new(at, "in the world, a light of the model lies beyond 3.4e38; move it nearer");
            self.lights.push(placed(light, placement).ok_or_else(too_far)?);
        }
        Ok(())
    }
}

fn unreadable(file: &NameRef, error: &FileError) -> Problem {
    Problem::new(file.at, format!("cannot read the model \"{}\": {error}", shortened(&file.name)))
}

/// A light in the world; `None` when it is too far away.
fn placed(light: &Light<DVec3>, placement: &Placement) -> Option<Light> {
    let along = |d: Vec3| (placement.point(d.as_dvec3()) - placement.point(DVec3::ZERO)).normalize_or_zero().as_vec3();
    let light = light.moved(|position| placement.point(position).as_vec3(), along);
    match light.kind {
        LightKind::Point { position } | LightKind::Spot { position, .. } if !position.is_finite() => None,
        _ => Some(light),
    }
}
