//! A frame that gives something up for speed: a preset in place of the chosen settings, a smaller picture.

use crate::settings::{PRESETS, Preset, Settings, Supersample};

/// What a frame gives up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lowering {
    /// How many steps down; 0 gives up nothing.
    pub level: usize,
    /// The preset in place of the chosen settings.
    pub preset: Option<&'static str>,
    /// Edge of the traced picture as a share of the window's.
    pub scale: f32,
}

impl Lowering {
    /// Nothing given up.
    pub const NONE: Self = Self { level: 0, preset: None, scale: 1.0 };

    /// One side of the picture, in pixels.
    pub fn scaled(self, side: u32) -> u32 {
        ((side as f32 * self.scale).round() as u32).clamp(1.min(side), side)
    }
}

/// The chosen settings with what a preset says of approximations and samples. What kind of picture it is, and how the
/// machine makes it, stays as chosen.
fn with_preset(chosen: &Settings, preset: &Preset) -> Settings {
    let Settings { visibility, stride, fill, match_threshold, supersample, render_scale, min_weight, .. } =
        (preset.settings)();
    // Of what was chosen, too, the picture is never larger.
    let render_scale = render_scale.min(chosen.render_scale);
    Settings { visibility, stride, fill, match_threshold, supersample, render_scale, min_weight, ..chosen.clone() }
}

/// The settings that `lowering` makes of the chosen ones.
pub fn lowered(chosen: &Settings, lowering: Lowering) -> Settings {
    if lowering.level == 0 {
        return chosen.clone();
    }
    let preset = PRESETS.iter().find(|preset| Some(preset.name) == lowering.preset);
    let settings = preset.map_or_else(|| chosen.clone(), |preset| with_preset(chosen, preset));
    // At rest nothing is given up: what is refined then is another picture.
    Settings { refine_at_rest: false, ..settings }
}

/// The presets that a moving picture may fall back to from the chosen settings, best picture first: those after the one
/// that was chosen; that one too where it is less than what was chosen, which has more samples a pixel.
pub fn presets_below(chosen: &Settings) -> Vec<&'static str> {
    let one_sample = Settings { supersample: Supersample::Off, ..chosen.clone() };
    let first = match PRESETS.iter().rposition(|preset| with_preset(&one_sample, preset) == one_sample) {
        Some(own) if one_sample == *chosen => own + 1,
        Some(own) => own,
        // Settings of the user's own making: they are no more than the best.
        None => 1,
    };
    PRESETS.iter().skip(first).map(|preset| preset.name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::ToneMap;

    #[test]
    fn presets_below_what_was_chosen() {
        let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
        for (i, preset) in PRESETS.iter().enumerate() {
            let chosen = (preset.settings)();
            assert_eq!(presets_below(&chosen), names[i + 1..], "{}", preset.name);
            let finer = Settings { supersample: Supersample::Grid { side: 4 }, depth: Some(3), ..chosen };
            assert_eq!(presets_below(&finer), names[i..], "{} with more samples", preset.name);
        }
        let own = Settings { stride: 2, ..Settings::balanced() };
        assert_eq!(presets_below(&own), names[1..]);
    }

    #[test]
    fn a_lowered_frame_keeps_its_mode() {
        let chosen = Settings {
            tone_map: Some(ToneMap::Neutral),
            shadows: false,
            depth: Some(2),
            threads: 3,
            refine_at_rest: true,
            target_fps: Some(30),
            ..Settings::exact()
        };
        assert_eq!(lowered(&chosen, Lowering::NONE), chosen);
        let scaled = Lowering { level: 1, scale: 0.7, preset: None };
        assert_eq!(lowered(&chosen, scaled), Settings { refine_at_rest: false, ..chosen.clone() });
        let Settings { tone_map, shadows, depth, threads, target_fps, .. } = chosen;
        let expected = Settings { tone_map, shadows, depth, threads, target_fps, ..Settings::fast() };
        assert_eq!(lowered(&chosen, Lowering { preset: Some("fast"), ..scaled }), expected);
    }

    #[test]
    fn pictures_keep_a_pixel() {
        let lowering = Lowering { scale: 0.25, ..Lowering::NONE };
        assert_eq!([1280, 3, 1, 0].map(|side| lowering.scaled(side)), [320, 1, 1, 0]);
    }
}
