//! Where a file lets players start.

use super::brightness;
use super::probe::{Probe, horizontal};
use super::stand::EYE_HEIGHT;
use crate::geometry::Aabb;
use crate::scene::Camera;
use crate::scene::start::Unit;
use glam::Vec3;

/// How far above a spawn point its floor may be, and how far below, in metres: points are put down by hand.
const ABOVE: f32 = 0.5;
const BELOW: f32 = 10.0;
/// Least height of an upward unit normal of a floor.
const LEVEL: f32 = 0.5;
/// What is nearer than this, in metres, fills the picture: one turns around.
const TOO_NEAR: f32 = 0.7;
/// Sine of how far one looks down where there is nothing ahead.
const DOWN: f32 = -0.5;

/// A spawn point in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Spawn {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub position: Vec3,
    /// Where players look to, if it says so.
    pub forward: Option<Vec3>,
}

/// The camera of somebody who starts at a spawn point, and how high their eye is above the floor, if there is one.
pub fn enter(probe: &mut Probe, spawn: &Spawn, bounds: Aabb, unit: Unit) -> Option<(Camera, Option<f32>)> {
    let metre = unit.per_metre();
    // Far from the origin a step above the point must not be lost.
    let above = spawn.position + Vec3::Y * (ABOVE * metre);
    let floor = probe.look_along(above, Vec3::NEG_Y, 0.0);
    let floor = floor.filter(|met| met.normal.y.abs() >= LEVEL && met.distance <= (ABOVE + BELOW) * metre);
    let ground = floor.map_or(spawn.position, |met| above - Vec3::Y * met.distance);
    let eye = ground + Vec3::Y * (EYE_HEIGHT * metre);
    let view = view(probe, eye, spawn, metre)?;
    let camera = |view: Vec3| {
        let reach = bounds.size().max_element().max(metre).max(eye.abs().max_element() * 1e-3);
        Camera { eye, look_at: eye + view * reach, ..Camera::default() }
    };
    let mut found = camera(view);
    // In the middle of nothing one sees at least what one stands on.
    let sees =
        |probe: &mut Probe, camera: &Camera| probe.see(eye, &brightness::view(camera), 0.0).iter().any(Option::is_some);
    if found.is_valid() && !sees(probe, &found) {
        let down = camera((view + Vec3::Y * DOWN).normalize());
        found = if sees(probe, &down) { down } else { found };
    }
    found.is_valid().then_some((found, floor.map(|_| EYE_HEIGHT * metre)))
}

/// Where one looks to: forward, or where it is free the farthest if there is a wall or the point does not say.
fn view(probe: &mut Probe, eye: Vec3, spawn: &Spawn, metre: f32) -> Option<Vec3> {
    let forward = spawn.forward.and_then(|forward| forward.with_y(0.0).try_normalize());
    let free = |probe: &mut Probe, view: Vec3| probe.look_along(eye, view, 0.0).map(|met| met.distance);
    if let Some(forward) = forward
        && free(probe, forward).is_none_or(|free| free >= TOO_NEAR * metre)
    {
        return Some(forward);
    }
    let views = horizontal();
    let met = probe.look(eye, &views, 0.0);
    // What leads out of the scene is no view, unless all does.
    let free = met.iter().zip(&views).filter_map(|(met, view)| Some((met.as_ref()?.distance, *view)));
    let farthest = free.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, view)| view);
    farthest.or(forward).or(Some(Vec3::NEG_Z))
}

/// Whether something of that name is where players start: `PlayerStart`, `spawn`, `red-spawn`, `spawn_point.001`.
pub fn is_spawn_name(name: &str) -> bool {
    let mut words: Vec<String> = Vec::new();
    let mut is_lower = false;
    let mut is_open = false;
    for letter in name.chars() {
        let starts = !is_open || (letter.is_uppercase() && is_lower);
        is_open = letter.is_alphabetic();
        is_lower = letter.is_lowercase();
        if is_open {
            if starts {
                words.push(String::new());
            }
            let lower = letter.to_lowercase();
            words.last_mut().into_iter().for_each(|word| word.extend(lower.clone()));
        }
    }
    const OTHERS: &[&str] = &[
        "ammo", "ball", "boss", "bot", "car", "enemies", "enemy", "item", "items", "mob", "monster", "npc", "pickup",
        "vehicle", "weapon", "zombie",
    ];
    let is = |word: &String, names: &[&str]| names.contains(&word.as_str());
    let starts = words.windows(2).any(|pair| is(&pair[0], &["player"]) && is(&pair[1], &["start"]));
    let spawns = words.iter().any(|word| is(word, &["spawn", "spawnpoint", "playerspawn", "playerstart"]));
    (starts || spawns) && !words.iter().any(|word| is(word, OTHERS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spawn_points_are_known_by_their_names() {
        for name in [
            "spawn",
            "Spawn",
            "SPAWN",
            "PlayerStart",
            "player_start",
            "PLAYERSTART",
            "red-spawn",
            "spawn_point",
            "SpawnPoint.001",
            "player_spawn",
            "PlayerSpawn2",
            "spawnpoint",
            "Blue Spawn",
            "spawn-3",
        ] {
            assert!(is_spawn_name(name), "{name}");
        }
        for name in [
            "",
            "spawner",
            "respawned",
            "enemy_spawn",
            "ItemSpawn",
            "Start",
            "player",
            "PlayerRestart",
            "spawning",
            "spa wn",
        ] {
            assert!(!is_spawn_name(name), "{name}");
        }
    }
}
