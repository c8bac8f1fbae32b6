//! glTF: what each part of a file becomes, and how wrong files fail.

pub mod broken;
pub mod file;
mod materials;
mod meshes;
mod nodes;
pub mod sides;
mod views;
