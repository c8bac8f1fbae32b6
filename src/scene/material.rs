//! What surfaces are made of.

use glam::{Affine2, Vec3};

/// A texture as one property of a material looks it up. `T` names the texture: its index in a scene, its name in a
/// description.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup<T = u32> {
    /// The texture.
    pub texture: T,
    /// Which of the surface's texture coordinates: 0, or 1 for the second that meshes may carry.
    pub set: u8,
    /// What the coordinates go through first. v = 0 is the bottom row of an image.
    pub transform: Affine2,
}

impl<T> Lookup<T> {
    /// A texture by the first coordinates as they are.
    pub fn new(texture: T) -> Self {
        Self { texture, set: 0, transform: Affine2::IDENTITY }
    }

    fn try_map<U, E>(
        self,
        map: &mut impl FnMut(T, Encoding) -> Result<U, E>,
        encoding: Encoding,
    ) -> Result<Lookup<U>, E> {
        Ok(Lookup { texture: map(self.texture, encoding)?, set: self.set, transform: self.transform })
    }
}

/// What the numbers of a texture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// Colours: images hold them in sRGB.
    Color,
    /// Anything else, linear.
    Data,
}

/// A colour: a factor, times what a texture holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorSource<T = u32> {
    /// Linear.
    pub factor: Vec3,
    /// Where the colour varies.
    pub texture: Option<Lookup<T>>,
}

impl<T> ColorSource<T> {
    /// The same everywhere, linear.
    pub fn constant(color: Vec3) -> Self {
        Self { factor: color, texture: None }
    }

    /// What a texture holds.
    pub fn textured(texture: Lookup<T>) -> Self {
        Self { factor: Vec3::ONE, texture: Some(texture) }
    }

    /// Whether any light is left of it.
    pub fn is_black(&self) -> bool {
        self.factor == Vec3::ZERO
    }
}

/// A texture whose values are scaled by a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaled<T = u32> {
    /// Where the values come from.
    pub lookup: Lookup<T>,
    /// What they are scaled by; its meaning is that of the property.
    pub scale: f32,
}

/// How relief is shown on a smooth surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relief<T = u32> {
    /// Tangent-space normals (red to the right, green up, blue outward); the scale multiplies red and green.
    pub normal: Option<Scaled<T>>,
    /// Heights from 0 (black) to the scale (white), in the scene's unit of length, that bend the normal (Blinn, SIGGRAPH
    /// 1978).
    pub bump: Option<Scaled<T>>,
    /// Depths from 0 (white) to the scale (black), in the scene's unit of length, that move what is looked up
    /// (parallax occlusion mapping; Tatarchuk, I3D 2006).
    pub parallax: Option<Scaled<T>>,
}

impl<T> Relief<T> {
    /// A smooth surface.
    pub const NONE: Self = Self { normal: None, bump: None, parallax: None };
}

/// What the opacity of a surface means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Alpha {
    /// Nothing: it is whole.
    Opaque,
    /// There are holes where it is below this.
    Mask(f32),
    /// So much of what is seen is the surface's own; the rest lies straight behind it.
    Blend,
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

/// A material. `T` names textures, as in [`Lookup`].
#[derive(Clone, Debug, PartialEq)]
pub struct Material<T = u32> {
    /// Its name in the file; empty for the default material.
    pub name: String,
    /// Surface colour (glTF: base colour).
    pub color: ColorSource<T>,
    /// How direct light is reflected.
    pub model: Model,
    /// Multiplies metallic (blue) and roughness (green).
    pub metallic_roughness: Option<Lookup<T>>,
    /// How much ambient light arrives (red); the scale is its strength, from 0 to 1.
    pub occlusion: Option<Scaled<T>>,
    /// Light that the surface gives off by itself.
    pub emission: ColorSource<T>,
    /// The surface's colour is what is seen, whatever the light.
    pub unlit: bool,
    /// Weight of the mirror ray, before Fresnel.
    pub reflectivity: Vec3,
    /// Weight of the refracted ray, before Fresnel; 0 is opaque.
    pub transparency: Vec3,
    /// Multiplies the transparency (red).
    pub transmission: Option<Lookup<T>>,
    /// Index of refraction inside a body of this material; of metallic-roughness ones, also what dielectrics reflect.
    pub ior: f32,
    /// Whether reflection and refraction share the light by Fresnel's equations.
    pub fresnel: bool,
    /// Absorption per unit length inside, per channel.
    pub absorption: Vec3,
    /// Whether even closed shapes bound no body: light passes through without bending.
    pub thin: bool,
    /// Whether meshes of it are seen from outside only, unless light bends in it or passes through.
    pub one_sided: bool,
    /// Whether it stands in for one that its file does not name.
    pub is_stand_in: bool,
    /// What the opacity means.
    pub alpha: Alpha,
    /// Multiplies the colour texture's alpha, from 0 to 1.
    pub opacity: f32,
    /// Relief of the surface.
    pub relief: Relief<T>,
}

impl<T> Material<T> {
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
            color: ColorSource::constant(Vec3::ONE),
            model: Model::Phong {
                ambient: Self::AMBIENT,
                diffuse: Self::DIFFUSE,
                specular: Self::SPECULAR,
                shininess: Self::SHININESS,
            },
            metallic_roughness: None,
            occlusion: None,
            emission: ColorSource::constant(Vec3::ZERO),
            unlit: false,
            reflectivity: Vec3::ZERO,
            transparency: Vec3::ZERO,
            transmission: None,
            ior: 1.5,
            fresnel: false,
            absorption: Vec3::ZERO,
            thin: false,
            one_sided: false,
            is_stand_in: false,
            alpha: Alpha::Opaque,
            opacity: 1.0,
            relief: Relief::NONE,
        }
    }

    /// Whether any light passes through, bent or straight.
    pub fn is_transparent(&self) -> bool {
        self.transparency != Vec3::ZERO || self.is_blended()
    }

    /// Whether what lies straight behind it shines through.
    pub fn is_blended(&self) -> bool {
        self.alpha == Alpha::Blend
    }

    /// Whether even closed shapes of it bound no body.
    pub fn is_thin(&self) -> bool {
        self.thin || self.is_blended()
    }

    /// All textures that are looked up.
    pub fn lookups(&self) -> impl Iterator<Item = &Lookup<T>> {
        let Relief { normal, bump, parallax } = &self.relief;
        let scaled =
            [&self.occlusion, normal, bump, parallax].map(|scaled| scaled.as_ref().map(|scaled| &scaled.lookup));
        let (color, emission) = (self.color.texture.as_ref(), self.emission.texture.as_ref());
        let plain = [color, emission, self.metallic_roughness.as_ref(), self.transmission.as_ref()];
        plain.into_iter().chain(scaled).flatten()
    }

    /// Leaves out the maps whose textures are `missing`, and with them what they would have held: a map of what glows says
    /// where. The colour stays, since something is shown for it.
    pub fn leave_out(&mut self, missing: impl Fn(&T) -> bool) {
        let lost = |lookup: &Lookup<T>| missing(&lookup.texture);
        let without = |map: &mut Option<Scaled<T>>| drop(map.take_if(|map| lost(&map.lookup)));
        let Relief { normal, bump, parallax } = &mut self.relief;
        [normal, bump, parallax, &mut self.occlusion].into_iter().for_each(without);
        self.transmission.take_if(|lookup| lost(lookup));
        if self.metallic_roughness.take_if(|lookup| lost(lookup)).is_some()
            && let Model::MetallicRoughness { metallic, .. } = &mut self.model
        {
            // Factors are 1 beside a map, and what is all metal shows nothing of its own.
            *metallic = 0.0;
        }
        if self.emission.texture.take_if(|lookup| lost(lookup)).is_some() {
            self.emission.factor = Vec3::ZERO;
        }
    }

    /// Whether faces of it that are seen from behind are not there for camera, mirror and refraction rays. What transmits
    /// light has an inside that is seen.
    pub fn is_one_sided(&self) -> bool {
        self.one_sided && self.transparency == Vec3::ZERO
    }

    /// Takes the metal from a metallic-roughness material: rough metal looks the same all over where the only light is at
    /// the eye.
    pub fn take_metal(&mut self) {
        if let Model::MetallicRoughness { metallic, .. } = &mut self.model {
            *metallic = 0.0;
        }
    }

    /// The same material with its textures named in another way.
    ///
    /// # Errors
    /// The first that `map` gives, which is told what the texture's numbers are.
    pub fn try_map<U, E>(self, mut map: impl FnMut(T, Encoding) -> Result<U, E>) -> Result<Material<U>, E> {
        let mut data = |lookup: Lookup<T>| lookup.try_map(&mut map, Encoding::Data);
        let metallic_roughness = self.metallic_roughness.map(&mut data).transpose()?;
        let transmission = self.transmission.map(&mut data).transpose()?;
        let mut scaled = |map: Option<Scaled<T>>| {
            map.map(|Scaled { lookup, scale }| Ok(Scaled { lookup: data(lookup)?, scale })).transpose()
        };
        let occlusion = scaled(self.occlusion)?;
        let Relief { normal, bump, parallax } = self.relief;
        let relief = Relief { normal: scaled(normal)?, bump: scaled(bump)?, parallax: scaled(parallax)? };
        let mut color = |ColorSource { factor, texture }: ColorSource<T>| {
            let texture = texture.map(|lookup| lookup.try_map(&mut map, Encoding::Color)).transpose()?;
            Ok(ColorSource { factor, texture })
        };
        Ok(Material {
            color: color(self.color)?,
            emission: color(self.emission)?,
            metallic_roughness,
            occlusion,
            transmission,
            relief,
            name: self.name,
            model: self.model,
            unlit: self.unlit,
            reflectivity: self.reflectivity,
            transparency: self.transparency,
            ior: self.ior,
            fresnel: self.fresnel,
            absorption: self.absorption,
            thin: self.thin,
            one_sided: self.one_sided,
            is_stand_in: self.is_stand_in,
            alpha: self.alpha,
            opacity: self.opacity,
        })
    }
}
