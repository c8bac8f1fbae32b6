//! Lights turned on and off, up and down, warm and cold while one walks.

use crate::scene::light::LightKind;
use crate::scene::{Light, Scene, black_body};
use std::sync::Arc;

/// The temperature that leaves a light's colour as it is, in kelvin.
pub const NEUTRAL: f32 = 6500.0;

/// How one light is turned.
#[derive(Clone, Debug, PartialEq)]
pub struct Dial {
    /// What the light is called.
    pub name: String,
    /// Whether it gives light at all.
    pub on: bool,
    /// Times as bright as in the file.
    pub intensity: f32,
    /// Temperature in kelvin: below [`NEUTRAL`] warmer than in the file, above it colder.
    pub kelvin: f32,
}

impl Dial {
    /// Whether the light is as in the file.
    pub fn is_untouched(&self) -> bool {
        self.on && self.intensity == 1.0 && self.kelvin == NEUTRAL
    }

    /// How it was turned: "lamp: off", "lamp: 0.5 times as bright, 4000 K". `None` as in the file.
    pub fn turned(&self) -> Option<String> {
        let Self { name, on, intensity, kelvin } = self;
        match (on, *intensity != 1.0, *kelvin != NEUTRAL) {
            (false, ..) => Some(format!("{name}: off")),
            (true, true, true) => Some(format!("{name}: {intensity} times as bright, {kelvin} K")),
            (true, true, false) => Some(format!("{name}: {intensity} times as bright")),
            (true, false, true) => Some(format!("{name}: {kelvin} K")),
            (true, false, false) => None,
        }
    }

    fn apply(&self, light: &Light) -> Option<Light> {
        if !self.on {
            return None;
        }
        let mut light = light.clone();
        light.color *= self.intensity;
        if self.kelvin != NEUTRAL {
            light.color *= black_body::color(self.kelvin.into());
        }
        Some(light).filter(|light| light.color.is_finite())
    }
}

/// The dials of a scene's lights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lighting {
    dials: Vec<Dial>,
    /// The lights as the file has them.
    lights: Vec<Light>,
}

impl Lighting {
    /// All lights of `scene` as in its file.
    pub fn of(scene: &Scene) -> Self {
        let mut lighting = Self { dials: Vec::new(), lights: scene.lights.clone() };
        lighting.reset();
        lighting
    }

    /// The scene as it was loaded again: dials stay turned if its lights are the same.
    pub fn keep_for(&mut self, scene: &Scene) {
        if self.lights != scene.lights {
            *self = Self::of(scene);
        }
    }

    /// The dials, one a light.
    pub fn dials(&self) -> &[Dial] {
        &self.dials
    }

    /// Turns one.
    pub fn turn(&mut self, light: usize, to: Dial) {
        if let Some(dial) = self.dials.get_mut(light) {
            *dial = to;
        }
    }

    /// Turns all back to what the file says.
    pub fn reset(&mut self) {
        let dial = |(number, light): (usize, &Light)| Dial {
            name: light.name.clone().unwrap_or_else(|| format!("{} {number}", kind(light))),
            on: true,
            intensity: 1.0,
            kelvin: NEUTRAL,
        };
        self.dials = (1..).zip(&self.lights).map(dial).collect();
    }

    /// Whether all is as in the file.
    pub fn is_untouched(&self) -> bool {
        self.dials.iter().all(Dial::is_untouched)
    }

    /// `scene` in this light: itself where nothing was turned.
    pub fn lit(&self, scene: &Arc<Scene>) -> Arc<Scene> {
        if self.is_untouched() {
            return Arc::clone(scene);
        }
        let lights = self.dials.iter().zip(&scene.lights).filter_map(|(dial, light)| dial.apply(light));
        Arc::new(scene.with_lights(lights.collect()))
    }
}

fn kind(light: &Light) -> &'static str {
    match light.kind {
        LightKind::Point { .. } => "point",
        LightKind::Directional { .. } => "directional",
        LightKind::Spot { .. } => "spot",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Film, Planes, Scratch, render_frame};
    use crate::scene::{LoadOptions, load_text};
    use crate::settings::Settings;

    fn scene(lights: &str) -> Arc<Scene> {
        let text = format!(
            r#"{{ "version": 1, "camera": {{ "position": [0, 1, 6], "look_at": [0, 0, 0] }},
                "lights": [{lights}],
                "objects": [ {{ "type": "sphere", "center": [0, 0, 0], "radius": 1 }},
                             {{ "type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0] }} ] }}"#
        );
        Arc::new(load_text("lit.json", &text, &LoadOptions::default()).expect("right"))
    }

    /// The bits of every value of a picture.
    fn picture(scene: &Scene, scratch: &mut Scratch) -> Vec<[u32; 3]> {
        let mut film = Film::new(64, 36, Planes::default());
        render_frame(scene, &scene.cameras[0].camera, &Settings::exact(), scratch, &mut film);
        let pixels = (0..36).flat_map(|y| (0..64).map(move |x| (x, y)));
        pixels.map(|(x, y)| film.color(x, y).map(f32::to_bits)).collect()
    }

    const KEY: &str = r#"{ "type": "point", "position": [-4, 6, 5], "color": [1, 0.9, 0.8], "name": "key" }"#;
    const FILL: &str = r#"{ "type": "directional", "direction": [-1, -1, -1], "color": [0.25, 0.25, 0.5] }"#;

    #[test]
    fn turned_lights_are_bit_for_bit_those_of_a_file_that_has_them_so() {
        let both = scene(&format!("{KEY}, {FILL}"));
        let mut lighting = Lighting::of(&both);
        assert_eq!(
            lighting.dials().iter().map(|dial| dial.name.as_str()).collect::<Vec<_>>(),
            ["key", "directional 2"]
        );
        assert!(Arc::ptr_eq(&lighting.lit(&both), &both), "nothing was turned");
        // One scratch for all: nothing it keeps of one light may show in another.
        let mut scratch = Scratch::new();
        let before = picture(&both, &mut scratch);
        let turned = |key: &str, dial: Dial, lighting: &mut Lighting, scratch: &mut Scratch| {
            lighting.turn(0, dial);
            let lit = lighting.lit(&both);
            assert!(Arc::ptr_eq(&lit.geometry, &both.geometry) && lit.generation != both.generation);
            let lights = if key.is_empty() { FILL.to_owned() } else { format!("{key}, {FILL}") };
            let as_file = picture(&scene(&lights), scratch);
            assert_eq!(picture(&lit, scratch), as_file, "{key}");
        };
        let dial = lighting.dials()[0].clone();
        let brighter = KEY.replace("\"name\"", "\"intensity\": 2.5, \"name\"");
        turned(&brighter, Dial { intensity: 2.5, ..dial.clone() }, &mut lighting, &mut scratch);
        let warmer = KEY.replace("\"name\"", "\"temperature\": 2700, \"name\"");
        turned(&warmer, Dial { kelvin: 2700.0, ..dial.clone() }, &mut lighting, &mut scratch);
        turned("", Dial { on: false, ..dial.clone() }, &mut lighting, &mut scratch);
        assert_eq!(dial.turned(), None);
        let both_ways = Dial { intensity: 2.5, kelvin: 2700.0, ..dial };
        assert_eq!(both_ways.turned().as_deref(), Some("key: 2.5 times as bright, 2700 K"));
        lighting.reset();
        assert_eq!(picture(&lighting.lit(&both), &mut scratch), before);
    }

    #[test]
    fn with_all_lights_off_what_is_left_is_ambient() {
        let one = scene(KEY);
        let mut lighting = Lighting::of(&one);
        lighting.turn(0, Dial { on: false, ..lighting.dials()[0].clone() });
        let dark = picture(&lighting.lit(&one), &mut Scratch::new());
        let lit = picture(&one, &mut Scratch::new());
        let brightest = |picture: &[[u32; 3]]| picture.iter().map(|c| f32::from_bits(c[0])).fold(0.0, f32::max);
        assert!(brightest(&dark) > 0.0 && brightest(&dark) < 0.1 * brightest(&lit));
    }

    #[test]
    fn a_reload_keeps_the_dials_of_lights_that_stayed() {
        let before = scene(KEY);
        let mut lighting = Lighting::of(&before);
        lighting.turn(0, Dial { intensity: 3.0, ..lighting.dials()[0].clone() });
        lighting.keep_for(&scene(KEY));
        assert_eq!(lighting.dials()[0].intensity, 3.0);
        lighting.keep_for(&scene(FILL));
        assert!(lighting.is_untouched());
    }
}
