//! What surrounds the scene, changed while one walks.

use crate::scene::environment::SkyImage;
use crate::scene::{Environment, EnvironmentChoice, Scene, Sky};
use std::path::PathBuf;
use std::sync::Arc;

/// The environment of the scene that is shown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// As the scene was loaded.
    own: Option<Environment>,
    /// As it is shown.
    current: Option<Environment>,
    /// What `current` is called, if that is not the scene's own sky.
    choice: EnvironmentChoice,
}

impl Surroundings {
    /// Those that `scene` was loaded with.
    pub fn of(scene: &Scene) -> Self {
        let own = scene.environment.clone();
        Self { current: own.clone(), own, choice: EnvironmentChoice::Scene }
    }

    /// The scene as it was loaded again: what was changed stays so if its own environment is the same.
    pub fn keep_for(&mut self, scene: &Scene) {
        if self.own != scene.environment {
            let is_chosen = self.choice != EnvironmentChoice::Scene;
            let kept = std::mem::replace(self, Self::of(scene));
            // A sky that the user brought does not depend on the scene's.
            if is_chosen {
                *self = Self { own: scene.environment.clone(), ..kept };
            }
        }
    }

    /// The environment that is shown.
    pub fn current(&self) -> Option<&Environment> {
        self.current.as_ref()
    }

    /// Whether the scene brings an environment.
    pub fn has_own(&self) -> bool {
        self.own.is_some()
    }

    /// Whether all is as the scene was loaded.
    pub fn is_untouched(&self) -> bool {
        self.current == self.own
    }

    /// Shows the picture in `file`: as the one before is turned, if that is the same file.
    pub fn bring(&mut self, file: PathBuf, image: SkyImage) {
        let choice = EnvironmentChoice::File(file);
        let sky = Sky::Image(Arc::new(image));
        let before = self.current.take().filter(|_| self.choice == choice);
        self.current = Some(match before {
            Some(before) => Environment { sky, ..before },
            None => Environment::new(sky),
        });
        self.choice = choice;
    }

    /// Does what the user asks for.
    pub fn apply(&mut self, change: Change) {
        match change {
            Change::Reset => (self.current, self.choice) = (self.own.clone(), EnvironmentChoice::Scene),
            Change::None => (self.current, self.choice) = (None, EnvironmentChoice::None),
            Change::Studio => {
                (self.current, self.choice) = (Some(Environment::new(Sky::Studio)), EnvironmentChoice::Studio);
            }
            Change::Turn { rotation, intensity, backdrop } => {
                if let Some(current) = &mut self.current {
                    *current = Environment { rotation, intensity, backdrop, sky: current.sky.clone() };
                }
            }
        }
    }

    /// `scene` in these surroundings: itself where they are its own.
    pub fn around(&self, scene: Arc<Scene>) -> Arc<Scene> {
        if scene.environment == self.current {
            return scene;
        }
        Arc::new(scene.with_environment(self.current.clone()))
    }

    /// What a command line calls the sky that is shown, in a window that loads scenes by `loaded`.
    pub fn choice(&self, loaded: &EnvironmentChoice) -> EnvironmentChoice {
        if self.choice == EnvironmentChoice::Scene { loaded.clone() } else { self.choice.clone() }
    }

    /// How it differs from what that is by itself, in words.
    pub fn turned(&self) -> Option<String> {
        let current = self.current.as_ref()?;
        let as_named = match self.choice {
            EnvironmentChoice::Scene => self.own.clone(),
            _ => Some(Environment::new(current.sky.clone())),
        };
        (as_named.as_ref() != Some(current)).then(|| current.to_string())
    }
}

/// What the user may ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// All as the scene was loaded.
    Reset,
    /// No environment.
    None,
    /// The built-in studio.
    Studio,
    /// The same sky, turned, brighter or hidden.
    Turn {
        /// Degrees to the left.
        rotation: f32,
        /// Multiplies its radiance.
        intensity: f32,
        /// Whether it is seen behind the scene.
        backdrop: bool,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{LoadOptions, load_text};

    fn scene(environment: &str) -> Arc<Scene> {
        let text = format!(r#"{{ "version": 1, "render": {{ "background": 0.5{environment} }} }}"#);
        Arc::new(load_text("sky.json", &text, &LoadOptions::default()).expect("right"))
    }

    fn image(value: f32) -> SkyImage {
        SkyImage::new("sky.hdr", (1, 1), Box::new([[value; 3]])).expect("a texel")
    }

    const STUDIO: &str = r#", "environment": "studio""#;
    const TURNED: Change = Change::Turn { rotation: 30.0, intensity: 2.0, backdrop: false };

    #[test]
    fn a_changed_environment_is_a_scene_of_the_same_geometry() {
        let bare = scene("");
        let mut surroundings = Surroundings::of(&bare);
        assert!(Arc::ptr_eq(&surroundings.around(Arc::clone(&bare)), &bare), "nothing was changed");
        assert!(surroundings.is_untouched() && surroundings.current().is_none() && bare.headlight);
        surroundings.apply(TURNED);
        assert!(surroundings.is_untouched(), "there is nothing to turn");
        surroundings.bring("a/sky.hdr".into(), image(1.0));
        let seen = surroundings.around(Arc::clone(&bare));
        assert!(Arc::ptr_eq(&seen.geometry, &bare.geometry) && seen.generation != bare.generation);
        assert_eq!((seen.headlight, seen.render.background), (bare.headlight, bare.render.background));
        assert_eq!(seen.environment, Some(Environment::new(Sky::Image(Arc::new(image(1.0))))));
        surroundings.apply(Change::Reset);
        assert_eq!(surroundings, Surroundings::of(&bare));
    }

    #[test]
    fn a_sky_that_was_edited_keeps_how_it_was_turned() {
        let mut surroundings = Surroundings::of(&scene(STUDIO));
        surroundings.bring("a/sky.hdr".into(), image(1.0));
        surroundings.apply(TURNED);
        surroundings.bring("a/sky.hdr".into(), image(2.0));
        let current = surroundings.current().expect("brought");
        assert_eq!((current.rotation, current.intensity, current.backdrop), (30.0, 2.0, false));
        assert_eq!(current.sky, Sky::Image(Arc::new(image(2.0))));
        surroundings.bring("b/sky.hdr".into(), image(2.0));
        assert_eq!(surroundings.current().map(|current| current.rotation), Some(0.0), "another file");
    }

    #[test]
    fn a_reload_keeps_what_does_not_depend_on_the_file() {
        let (bare, studio) = (scene(""), scene(STUDIO));
        let mut turned = Surroundings::of(&studio);
        turned.apply(TURNED);
        turned.keep_for(&scene(STUDIO));
        assert_eq!(turned.current().map(|current| current.intensity), Some(2.0));
        turned.keep_for(&bare);
        assert!(turned.is_untouched() && turned.current().is_none());
        turned.bring("sky.hdr".into(), image(1.0));
        turned.keep_for(&studio);
        assert!(turned.has_own() && matches!(turned.current(), Some(Environment { sky: Sky::Image(_), .. })));
        turned.apply(Change::None);
        turned.keep_for(&bare);
        assert!(turned.current().is_none() && turned.is_untouched());
    }

    #[test]
    fn what_is_shown_is_named_for_a_command_line() {
        let file = EnvironmentChoice::File("sky.hdr".into());
        let mut surroundings = Surroundings::of(&scene(STUDIO));
        assert_eq!((surroundings.choice(&file), surroundings.turned()), (file.clone(), None));
        surroundings.apply(TURNED);
        let words = "studio, rotation 30, intensity 2, not seen behind the scene";
        assert_eq!(surroundings.turned().as_deref(), Some(words));
        surroundings.apply(Change::None);
        assert_eq!((surroundings.choice(&file), surroundings.turned()), (EnvironmentChoice::None, None));
        surroundings.apply(Change::Studio);
        assert_eq!((surroundings.choice(&file), surroundings.turned()), (EnvironmentChoice::Studio, None));
        surroundings.bring("sky.hdr".into(), image(1.0));
        let turn = Change::Turn { rotation: 0.0, intensity: 0.5, backdrop: true };
        surroundings.apply(turn);
        let words = Some("image sky.hdr 1x1, intensity 0.5".to_owned());
        assert_eq!((surroundings.choice(&EnvironmentChoice::Scene), surroundings.turned()), (file, words));
    }
}
