//! glTF: what each part of a file becomes, how wrong files fail, and files that others made.

pub mod broken;
mod corpus;
mod file;
mod materials;
mod meshes;
mod nodes;
mod views;
