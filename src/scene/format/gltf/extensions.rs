//! Which extensions are known, and what becomes of the others.

use super::fault::{Fault, Read, Report};
use super::instancing;
use super::root::Root;
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
];

/// Extensions that are read in part, and what is left out.
const PARTLY_KNOWN: &[(&str, &str)] =
    &[("KHR_materials_pbrSpecularGlossiness", "its diffuse colours are shown, its specular ones are left out")];

/// Refuses a file that cannot be shown without an extension that is not known; warns of others.
pub fn check(root: &Root, report: &mut Report) -> Read<()> {
    let is_known = |name: &str| KNOWN.contains(&name) || PARTLY_KNOWN.iter().any(|(known, _)| *known == name);
    for (i, name) in root.extensions_required.iter().enumerate() {
        if !is_known(name) {
            let message = format!("the file needs {}, which is not supported; export it without", shortened(name));
            return Err(Fault::new(format!("/extensionsRequired/{i}"), message));
        }
    }
    for (i, name) in root.extensions_used.iter().enumerate() {
        let pointer = format!("/extensionsUsed/{i}");
        match PARTLY_KNOWN.iter().find(|(known, _)| known == name) {
            Some((known, left_out)) => report.warn(pointer, format!("{known} is supported in part: {left_out}")),
            None if !is_known(name) => {
                report.warn(pointer, format!("{} is not supported; what it says is left out", shortened(name)));
            }
            None => {}
        }
    }
    Ok(())
}
