//! A scene in the making: objects, lights and the view of them, written out as a scene file.

use super::view::View;
use crate::random::Random;
use crate::stress;
use serde_json::{Value, json};

/// What a composition adds to.
pub struct Stage {
    pub view: View,
    /// Scene files' objects.
    pub objects: Vec<Value>,
    /// Scene files' lights.
    pub lights: Vec<Value>,
    /// Most rays on a path.
    pub depth: u32,
}

impl Stage {
    /// Nothing but a view.
    pub fn new(random: &mut Random) -> Self {
        Self { view: View::new(random), objects: Vec::new(), lights: Vec::new(), depth: 1 }
    }

    /// Adds an object before, between or behind the others: of two that are equally far away, the earlier is seen.
    pub fn add(&mut self, random: &mut Random, object: Value) {
        let at = random.below(self.objects.len() + 1);
        self.objects.insert(at, object);
    }

    /// As [`add`](Self::add), with a material drawn from all, most often a cheap one.
    pub fn add_any(&mut self, random: &mut Random, object: Value) {
        let material = if random.chance(0.7) { "matte" } else { random.pick(&stress::MATERIALS) };
        self.add(random, stress::with_material(object, material));
    }

    /// The scene file.
    pub fn to_json(&self) -> Value {
        let (width, height) = self.view.size;
        let mut scene = json!({
            "version": 1, "camera": self.view.to_json(), "materials": stress::materials(),
            "textures": stress::textures(), "objects": self.objects,
            "render": { "width": width, "height": height, "max_depth": self.depth, "background": [0.3, 0.4, 0.6] },
        });
        if !self.lights.is_empty() {
            scene["lights"] = json!(self.lights);
        }
        scene
    }
}
