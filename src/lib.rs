//! raywalk: a first-person walkthrough viewer that ray-traces every frame on CPU threads.
//!
//! The rooms, from the ground up; each imports only what stands above it in this list:
//!
//! | room | what it knows |
//! |---|---|
//! | [`settings`] | every switch and knob, as plain data |
//! | [`math`] | SIMD levels, lanes, vectors of lanes, functions that give the same bits everywhere |
//! | [`geometry`] | what a ray can meet and how to find it; no colour |
//! | [`scene`] | what the place looks like, and how it is read from disk |
//! | [`render`] | one frame from scene, camera and settings; no window, no file |
//! | [`picture`] | pictures on disk |
//! | [`measure`] | how fast and how true: metrics, runs, records, benches, charts |
//! | [`app`] | the window, or the terminal: input in, picture and panel out |
//!
//! Everything that draws goes through one waist, [`render::render_frame`]:
//!
//! ```text
//!  window events ─► walker ─► Camera ─┐
//!  command line ─► Settings ──────────┤
//!  scene file ─► SceneDesc ─► Scene ──┴─► render_frame ─► Film ─► texture, PNG, EXR
//!                                          │ plan: the cheapest pipeline that draws this scene
//!                                          │ tiles: visibility (beams) ─► shade ─► shadows (beams) ─► secondary rays
//!                                          └─► FrameStats ─► overlay, --stats
//! ```
//!
//! A frame in a few lines:
//!
//! ```
//! use raywalk::render::{Film, Planes, Scratch, render_frame};
//! use raywalk::scene::{self, LoadOptions};
//! use raywalk::settings::Settings;
//!
//! let scene = scene::builtin(&LoadOptions::default())?;
//! let camera = scene.cameras[0].camera;
//! let (mut scratch, mut film) = (Scratch::new(), Film::new(64, 36, Planes::default()));
//! let stats = render_frame(&scene, &camera, &Settings::exact(), &mut scratch, &mut film);
//! let pixels = stats.pixels;
//! assert_eq!(pixels.certified + pixels.resolved + pixels.traced, 64 * 36);
//! assert!(film.rgba().iter().any(|&byte| byte > 128));
//! # Ok::<(), raywalk::scene::SceneError>(())
//! ```

pub mod settings;

#[cfg(test)]
mod temporary;

pub mod math;

pub mod geometry;

pub mod scene;

pub mod render;

pub mod picture;

pub mod measure;

pub mod app;
