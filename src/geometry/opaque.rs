//! Which primitives block light altogether.

use super::{Geometry, Home, Instances, PrimitiveIndex};

/// Which primitives block light altogether, where not all do.
#[derive(Debug, Default)]
pub struct OpaqueList {
    /// For each primitive that is not part of an instance.
    own: Vec<bool>,
    /// For each instance: its triangles are of one material.
    instances: Vec<bool>,
    /// How many primitives come before the first instance: their indices are places in `own`.
    before_instances: usize,
}

impl OpaqueList {
    /// What `geometry` holds, by the objects that block light.
    pub fn new(geometry: &Geometry, blocks: impl Fn(u32) -> bool) -> Self {
        let own: Vec<bool> = geometry.own().map(|(_, id)| blocks(id.object)).collect();
        let placed = &geometry.instances.placed;
        let before_instances = placed.first().map_or(own.len(), |first| first.indices().start as usize);
        Self { own, instances: placed.iter().map(|instance| blocks(instance.object)).collect(), before_instances }
    }

    /// The list to look things up in; the instances are those of the geometry that it was made of.
    pub fn of<'a>(&'a self, instances: &'a Instances) -> Listed<'a> {
        Listed { first: self.own.get(..self.before_instances).unwrap_or_default(), all: self, instances }
    }
}

/// A list of what blocks light altogether, with the means to look up any primitive in it.
#[derive(Clone, Copy, Debug)]
pub struct Listed<'a> {
    /// Those before the first instance: all, in most scenes.
    first: &'a [bool],
    all: &'a OpaqueList,
    instances: &'a Instances,
}

impl Listed<'_> {
    /// Whether a primitive blocks light altogether.
    #[inline(always)]
    pub fn contains(&self, primitive: PrimitiveIndex) -> bool {
        match self.first.get(primitive as usize) {
            Some(&blocks) => blocks,
            None => self.contains_beyond(primitive),
        }
    }

    #[cold]
    #[inline(never)]
    fn contains_beyond(&self, primitive: PrimitiveIndex) -> bool {
        match self.instances.find(primitive) {
            Home::Own(own) => self.all.own[own as usize],
            Home::Shared(triangle) => self.all.instances[triangle.instance as usize],
        }
    }
}

/// Which primitives block light altogether: those listed, or all of them.
#[derive(Clone, Copy, Debug)]
pub enum Opaque<'a> {
    /// Every primitive.
    All,
    /// Those that a list has.
    Listed(Listed<'a>),
}

impl Opaque<'_> {
    /// Whether a primitive blocks light altogether.
    #[inline(always)]
    pub fn contains(&self, primitive: PrimitiveIndex) -> bool {
        match self {
            Self::All => true,
            Self::Listed(listed) => listed.contains(primitive),
        }
    }
}
