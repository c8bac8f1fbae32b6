//! Which extensions are known, and what becomes of the others.

use super::fault::{Fault, Notes, Read};
use super::instancing;
use super::root::{Required, Root};
use super::spawn;
use crate::scene::desc::map::shortened;

/// Extensions that are read in full.
const KNOWN: &[&str] = &[
    instancing::EXTENSION,
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    spawn::EXTENSION,
];

/// Extensions that are read in part, and what is left out.
const PARTLY_KNOWN: &[(&str, &str)] = &[
    ("KHR_materials_pbrSpecularGlossiness", "its diffuse colours are shown, its specular ones are left out"),
    ("KHR_materials_variants", "the default materials are shown"),
];

/// Parts of the names of extensions that store or make the shape of meshes.
const OF_SHAPES: &[&str] =
    &["compression", "draco", "geometry", "meshopt", "micromap", "splat", "subdivision", "voxel"];
/// Parts of the names of extensions that meshes name, but that do not change their shape.
const OF_LOOKS: &[&str] = &["animation", "feature", "light", "material", "metadata", "outline", "texture", "variant"];

/// Refuses a file whose meshes cannot be read without an extension that is not known; notes others.
pub fn check(root: &Root, notes: &mut Notes) -> Read<()> {
    let is_known = |name: &str| KNOWN.contains(&name) || PARTLY_KNOWN.iter().any(|(known, _)| *known == name);
    for (i, required) in root.extensions_required.iter().enumerate() {
        if !is_known(&required.name) && changes_shapes(required) {
            let name = shortened(&required.name);
            let message = format!("the meshes need {name}, which is not supported; export the file without it");
            return Err(Fault::fatal(format!("/extensionsRequired/{i}"), message));
        }
    }
    let is_used = |name: &String| root.extensions_used.contains(name);
    let only_required = root.extensions_required.iter().map(|required| &required.name).enumerate();
    let only_required =
        only_required.filter(|(_, name)| !is_used(name)).map(|(i, name)| ("extensionsRequired", i, name));
    let used = root.extensions_used.iter().enumerate().map(|(i, name)| ("extensionsUsed", i, name));
    for (list, i, name) in used.chain(only_required) {
        let pointer = format!("/{list}/{i}");
        match PARTLY_KNOWN.iter().find(|(known, _)| known == name) {
            Some((known, left_out)) => notes.add(pointer, format!("{known} is supported in part: {left_out}")),
            None if !is_known(name) => {
                notes.add(pointer, format!("{} is not supported; what it says is left out", shortened(name)));
            }
            None => {}
        }
    }
    Ok(())
}

/// Whether meshes may have another shape without an extension, as far as its name and its use tell.
fn changes_shapes(required: &Required) -> bool {
    let name = required.name.to_ascii_lowercase();
    let names = |parts: &[&str]| parts.iter().any(|part| name.contains(part));
    names(OF_SHAPES) || (required.is_in_meshes && !names(OF_LOOKS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_changes_shapes_is_needed() {
        for (name, is_in_meshes, changes) in [
            ("KHR_draco_mesh_compression", false, true),
            ("EXT_meshopt_compression", true, true),
            ("KHR_gaussian_splatting", true, true),
            ("FOO_shape", true, true),
            ("FOO_shape", false, false),
            ("KHR_materials_clearcoat", false, false),
            ("KHR_texture_basisu", false, false),
            ("EXT_structural_metadata", true, false),
            ("CESIUM_primitive_outline", true, false),
        ] {
            let required = Required { name: name.to_owned(), is_in_meshes };
            assert_eq!(changes_shapes(&required), changes, "{name}");
        }
    }
}
