//! The cheapest pipeline that draws a scene: what of the tracer a frame runs, and why.

use super::tables::Tables;
use crate::geometry::PrimitiveKind;
use crate::scene::{Scene, Texture};
use crate::settings::{Fill, Settings, SphereCache, Visibility};
use glam::Vec3;

/// What a frame runs. Made once a frame; nothing below asks settings or scene again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Go through the tree rather than test every primitive.
    pub tree: bool,
    /// Compute sphere terms once for all primary rays.
    pub sphere_cache: SphereCache,
    /// Prove for blocks of pixels what they can see.
    pub beams: bool,
    /// Trace shadow rays.
    pub shadows: bool,
    /// Judge shadow rays by beams from their light before any is traced.
    pub shadow_beams: bool,
    /// Shadow rays may pass through something.
    pub coloured_shadows: bool,
    /// Trace mirror rays.
    pub reflections: bool,
    /// Look at what flat mirrors show with beams from the mirrored eye.
    pub flat_mirrors: bool,
    /// Trace refracted rays.
    pub refractions: bool,
    /// Look for surfaces that touch those that rays hit.
    pub contacts: bool,
    /// Keep track of the bodies that rays are inside of.
    pub media: bool,
    /// Some body absorbs light.
    pub absorption: bool,
    /// Look up textures.
    pub textures: bool,
    /// Interpolate normals or texture coordinates of triangles.
    pub vertex_attributes: bool,
    /// Keep track of how texture coordinates grow along surfaces, and of how wide rays are.
    pub gradients: bool,
    /// Some surface is reached by less of the ambient light.
    pub occlusion: bool,
    /// Some surface has relief.
    pub relief: bool,
    /// Some triangles carry tangents.
    pub tangents: bool,
    /// Some triangles carry colours.
    pub vertex_colors: bool,
    /// A sky lights surfaces from everywhere.
    pub sky: bool,
    /// What lies straight behind some surfaces shines through.
    pub blending: bool,
    /// Some surface shows its colour whatever the light.
    pub unlit: bool,
    /// Some surface has a Blinn-Phong highlight.
    pub highlights: bool,
    /// Some surface gives off light.
    pub emission: bool,
    /// Some surface is metallic-roughness.
    pub metallic_roughness: bool,
    /// Keep what each pixel's paths met: only where that is the same are colours interpolated.
    pub trails: bool,
    /// Most rays on a path.
    pub depth: u32,
}

/// As many primitives are tested sooner than a beam is made.
const FEW_PRIMITIVES: usize = 4;

impl Plan {
    /// The plan for a scene under given settings.
    pub fn new(scene: &Scene, settings: &Settings) -> Self {
        Self::with_tables(scene, settings, &Tables::new(scene))
    }

    pub(super) fn with_tables(scene: &Scene, settings: &Settings, tables: &Tables) -> Self {
        let has = |kind| scene.geometry.blocks_of(kind) > 0;
        let absorbs = |object: u32| scene.material_of(object).absorption != Vec3::ZERO;
        let depth = settings.depth.unwrap_or(scene.render.max_depth);
        let refractions = settings.refractions && depth > 1 && tables.opaque.is_some();
        let reflections = settings.reflections && depth > 1 && tables.materials.iter().any(|m| m.secondary);
        let beams = settings.visibility == Visibility::Certified;
        // Whatever found the hits: shaded in the tile's order, they and what follows from them lie close together. Corners
        // of cells that are shaded level by level do not, and gain nothing.
        let secondary_beams = beams || settings.visibility == Visibility::Subsample && settings.fill == Fill::Hit;
        let relief = tables.materials.iter().any(|m| m.relieved);
        // A light at the eye casts no shadow that the eye sees itself, but mirrors and glass show them.
        let shadows = settings.shadows && (!scene.headlight || reflections || refractions);
        Self {
            tree: settings.bvh && scene.geometry.bvh.is_some(),
            beams,
            sphere_cache: if has(PrimitiveKind::Sphere) { settings.sphere_cache } else { SphereCache::Off },
            shadows,
            shadow_beams: secondary_beams && shadows && scene.geometry.len() > FEW_PRIMITIVES,
            coloured_shadows: tables.opaque.is_some(),
            reflections,
            flat_mirrors: secondary_beams && reflections && tables.flat_mirrors,
            refractions,
            contacts: !scene.contacts.is_empty(),
            media: !tables.transparent_bodies.is_empty(),
            absorption: tables.transparent_bodies.iter().any(|&object| absorbs(object)),
            textures: tables.materials.iter().any(|m| m.textured),
            vertex_attributes: !scene.geometry.attributes.is_empty()
                || !scene.geometry.extras.is_empty()
                || scene.geometry.instances.have_corner_data(),
            gradients: relief || scene.textures.iter().any(Texture::is_filtered),
            occlusion: tables.materials.iter().any(|m| m.maps.occlusion.is_some()),
            relief,
            tangents: relief && tables.tangents,
            vertex_colors: tables.vertex_colors,
            sky: tables.sky.is_some(),
            blending: tables.materials.iter().any(|m| m.blended),
            unlit: tables.materials.iter().any(|m| m.unlit),
            highlights: tables.materials.iter().any(|m| m.shiny),
            emission: tables.materials.iter().any(|m| m.emissive),
            metallic_roughness: tables.materials.iter().any(|m| m.metallic_roughness),
            trails: settings.visibility == Visibility::Subsample && settings.fill == Fill::Color,
            depth,
        }
    }

    /// The reflection models that run.
    fn models(&self) -> &'static str {
        match (self.highlights, self.metallic_roughness) {
            (true, true) => "Lambert, Blinn-Phong and metallic-roughness",
            (true, false) => "Lambert and Blinn-Phong only",
            (false, true) => "Lambert and metallic-roughness: nothing has a Blinn-Phong highlight",
            (false, false) => "Lambert only: nothing has a highlight",
        }
    }

    /// The plan in words: what runs or does not, and why; one line each.
    pub fn reasons(&self, scene: &Scene) -> Vec<String> {
        let primitives = scene.geometry.len();
        let say = |on: bool, yes: String, no: &str| if on { yes } else { no.to_owned() };
        vec![
            say(
                self.tree,
                format!("tree: on, {primitives} primitives are worth one"),
                "tree: off, there are too few primitives for one (or it was switched off)",
            ),
            instances(scene),
            say(
                self.sphere_cache != SphereCache::Off,
                "sphere terms: computed once for all primary rays, they share the eye".to_owned(),
                "sphere terms: off, there are no spheres (or they were switched off)",
            ),
            say(
                self.beams,
                "beams: on, a block of pixels is asked once what it can see, its rays are tested against that alone"
                    .to_owned(),
                "beams: off, they were switched off: every ray goes its own way",
            ),
            say(
                self.shadows,
                format!("shadows: on, {} light(s) cast them", scene.lights.len().max(1)),
                if scene.headlight {
                    "shadows: off, the only light is at the eye"
                } else {
                    "shadows: off, they were switched off"
                },
            ),
            say(
                self.shadow_beams,
                "shadow beams: on, a light is asked for many rays at once whether they arrive".to_owned(),
                "shadow beams: off, there are no shadows, too few primitives, or every ray goes its own way",
            ),
            say(
                self.coloured_shadows,
                "coloured shadows: on, some material lets light through".to_owned(),
                "coloured shadows: off, everything is opaque: any hit ends a shadow ray",
            ),
            say(
                self.reflections,
                format!("reflections: on, some material mirrors; paths of up to {} rays", self.depth),
                "reflections: off, nothing mirrors (or they were switched off)",
            ),
            say(
                self.flat_mirrors,
                "flat mirrors: on, blocks of what they show are certified from the mirrored eye".to_owned(),
                "flat mirrors: off, nothing flat mirrors (or every ray goes its own way)",
            ),
            say(
                self.refractions,
                "refractions: on, some material is transparent".to_owned(),
                "refractions: off, nothing is transparent (or they were switched off)",
            ),
            say(
                self.contacts,
                "contacts: on, some surfaces touch transparent ones".to_owned(),
                "contacts: off, nothing touches a transparent surface",
            ),
            say(
                self.media,
                "media: on, rays keep track of the bodies they are inside of".to_owned(),
                "media: off, no transparent body bends light",
            ),
            say(
                self.absorption,
                "absorption: on, some body takes light along the way".to_owned(),
                "absorption: off, every body is clear",
            ),
            say(
                self.textures,
                format!("textures: on, {} in the scene", scene.textures.len()),
                "textures: off, every colour is constant: no texture coordinates",
            ),
            say(
                self.vertex_attributes,
                "vertex data: on, some triangles carry normals or texture coordinates".to_owned(),
                "vertex data: off, every normal follows from the shape",
            ),
            say(
                self.vertex_colors,
                "vertex colours: on, some triangles carry colours".to_owned(),
                "vertex colours: off, nothing carries any",
            ),
            say(
                self.gradients,
                "ray widths: on, images are filtered or bent by them".to_owned(),
                "ray widths: off, no image is looked up",
            ),
            say(
                self.relief,
                "relief: on, some material has a normal, bump or parallax map".to_owned(),
                "relief: off, every surface is as smooth as its shape",
            ),
            say(
                !scene.geometry.holes.is_empty(),
                format!("holes: on, {} triangles are cut out", scene.geometry.count(PrimitiveKind::Cutout)),
                "holes: off, every surface is whole",
            ),
            say(
                scene.geometry.one_sided,
                format!(
                    "one-sided surfaces: on, {} triangles are seen from their front only; they stop light from both sides",
                    scene.geometry.count_one_sided()
                ),
                "one-sided surfaces: off, every surface is seen from both sides",
            ),
            say(
                self.blending,
                "blending: on, some surfaces let what lies straight behind shine through".to_owned(),
                "blending: off, no surface is see-through by its opacity",
            ),
            say(
                self.sky,
                "sky: on, it lights surfaces from everywhere by formulas, without a ray and without shadows".to_owned(),
                "sky: off, none surrounds the scene",
            ),
            say(
                self.emission,
                "emission: on, some material gives off light".to_owned(),
                "emission: off, nothing gives off light",
            ),
            format!("shading: {}", self.models()),
        ]
    }
}

/// What is stored once although it is placed often.
fn instances(scene: &Scene) -> String {
    let instances = &scene.geometry.instances;
    if instances.is_empty() {
        return "instances: off, no mesh is placed often enough for storing it once to save much memory".to_owned();
    }
    format!(
        "instances: on, {} meshes are placed {} times and stored once: {} MB instead of about {} MB",
        instances.meshes.len(),
        instances.placed.len(),
        instances.bytes() / 1_000_000,
        instances.flattened_bytes() / 1_000_000,
    )
}
