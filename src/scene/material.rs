//! What surfaces are made of.

use glam::Vec3;

/// A colour, constant or looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColorSource {
    /// The same everywhere, linear.
    Constant(Vec3),
    /// Index into the scene's textures.
    Texture(u32),
}

/// The reflection model of a surface's direct light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model {
    /// Lambert and Blinn-Phong.
    Phong {
        /// Multiplies the colour under the scene's ambient light.
        ambient: Vec3,
        /// Multiplies the colour under each light.
        diffuse: Vec3,
        /// Colour of the highlight.
        specular: Vec3,
        /// Blinn-Phong exponent.
        shininess: f32,
    },
    /// glTF's metallic-roughness.
    MetallicRoughness {
        /// Multiplies the colour under the scene's ambient light.
        ambient: Vec3,
        /// 0 dielectric to 1 metal.
        metallic: f32,
        /// Perceptual roughness, 0 to 1.
        roughness: f32,
    },
}

/// A material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file; empty for the default material.
    pub name: String,
    /// Surface colour (glTF: base colour).
    pub color: ColorSource,
    /// How direct light is reflected.
    pub model: Model,
    /// Light that the surface gives off by itself.
    pub emission: ColorSource,
    /// Weight of the mirror ray, before Fresnel.
    pub reflectivity: Vec3,
    /// Weight of the refracted ray, before Fresnel; 0 is opaque.
    pub transparency: Vec3,
    /// Index of refraction inside a body of this material.
    pub ior: f32,
    /// Whether reflection and refraction share the light by Fresnel's equations.
    pub fresnel: bool,
    /// Absorption per unit length inside, per channel.
    pub absorption: Vec3,
}

impl Material {
    /// Weight of the scene's ambient light where a material gives none.
    pub const AMBIENT: Vec3 = Vec3::splat(0.05);
    /// Weight of each light's diffuse part where a material gives none.
    pub const DIFFUSE: Vec3 = Vec3::ONE;
    /// Colour of the highlight where a material gives none.
    pub const SPECULAR: Vec3 = Vec3::ONE;
    /// Blinn-Phong exponent where a material gives none.
    pub const SHININESS: f32 = 50.0;

    /// The thesis's material with reflectivity 0: white, ambient 0.05, diffuse 1, specular 1, shininess 50.
    pub fn default_phong() -> Self {
        Self {
            name: String::new(),
            color: ColorSource::Constant(Vec3::ONE),
            model: Model::Phong {
                ambient: Self::AMBIENT,
                diffuse: Self::DIFFUSE,
                specular: Self::SPECULAR,
                shininess: Self::SHININESS,
            },
            emission: ColorSource::Constant(Vec3::ZERO),
            reflectivity: Vec3::ZERO,
            transparency: Vec3::ZERO,
            ior: 1.5,
            fresnel: false,
            absorption: Vec3::ZERO,
        }
    }

    /// Whether any light passes through.
    pub fn is_transparent(&self) -> bool {
        self.transparency != Vec3::ZERO
    }
}
