//! Scene formats other than JSON and glTF, what all share, and what becomes of damaged files of any.

mod model;
mod mutation;
mod nff;
mod obj;
mod obj_damage;
mod xml;

use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::Scene;
use raywalk::settings::Settings;

/// A small picture of a scene by its first camera: 8-bit red, green and blue.
fn picture(scene: &Scene, width: u32, height: u32) -> Vec<[u8; 3]> {
    let mut film = Film::new(width, height, Planes::default());
    render_frame(scene, &scene.cameras[0].camera, &Settings::exact(), &mut Scratch::default(), &mut film);
    film.rgba().chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}
