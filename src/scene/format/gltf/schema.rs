//! What the JSON of a file is to hold, as far as it is read: by this, values that do not fit are repaired or left out.

use super::repair::Instead::{Empty, NoEntry, Nothing, Zero};
use super::repair::Kind::{Index, List, Map, Number, Numbers, Object, Text, Truth, Whole};
use super::repair::Need::{AsEmptyList, AsEmptyObject, AsZero, Must, Optional, OrAll, OrNoEntry};
use super::repair::{Key, Kind};

const fn key(name: &'static str, kind: Kind) -> Key {
    Key { name, kind, need: Optional }
}

const fn must(name: &'static str, kind: Kind) -> Key {
    Key { name, kind, need: Must }
}

pub const ASSET: Kind = Object(&[key("version", Text), key("minVersion", Text)]);

pub const NAMES: Kind = List(&Text, Nothing);

pub const SCENE: Kind = Object(&[key("nodes", List(&Index, Nothing))]);

pub const NODE: Kind = Object(&[
    key("name", Text),
    key("camera", Index),
    key("children", List(&Index, Nothing)),
    key("mesh", Index),
    key("skin", Index),
    key("matrix", Numbers(16)),
    key("rotation", Numbers(4)),
    key("scale", Numbers(3)),
    key("translation", Numbers(3)),
    key("weights", List(&Number, Zero)),
    key("extensions", Object(&[key("KHR_lights_punctual", Object(&[must("light", Index)]))])),
]);

const TARGET: Kind = Object(&[key("POSITION", Index), key("NORMAL", Index), key("TANGENT", Index)]);

const PRIMITIVE: Kind = Object(&[
    Key { name: "attributes", kind: Map(&Index), need: AsEmptyObject },
    // Without its indices a primitive would be another one.
    Key { name: "indices", kind: Index, need: OrNoEntry },
    key("material", Index),
    key("mode", Whole),
    key("targets", List(&TARGET, Empty)),
    key("extensions", Object(&[])),
]);

pub const MESH: Kind = Object(&[
    key("name", Text),
    Key { name: "primitives", kind: List(&PRIMITIVE, Empty), need: AsEmptyList },
    key("weights", List(&Number, Zero)),
    key("extensions", Object(&[])),
]);

pub const SKIN: Kind = Object(&[
    key("name", Text),
    key("inverseBindMatrices", Index),
    // Matrices and weights name joints by their place.
    Key { name: "joints", kind: List(&Index, NoEntry), need: AsEmptyList },
    key("skeleton", Index),
    key("extensions", Object(&[])),
]);

pub const CAMERA: Kind = Object(&[
    key("name", Text),
    must("type", Text),
    key(
        "perspective",
        Object(&[
            key("aspectRatio", Number),
            must("yfov", Number),
            key("zfar", Number),
            Key { name: "znear", kind: Number, need: AsZero },
            key("extensions", Object(&[])),
        ]),
    ),
    key(
        "orthographic",
        Object(&[
            Key { name: "xmag", kind: Number, need: AsZero },
            must("ymag", Number),
            Key { name: "zfar", kind: Number, need: AsZero },
            Key { name: "znear", kind: Number, need: AsZero },
            key("extensions", Object(&[])),
        ]),
    ),
    key("extensions", Object(&[])),
]);

pub const LIGHT: Kind = Object(&[
    key("name", Text),
    must("type", Text),
    key("color", Numbers(3)),
    key("intensity", Number),
    key("range", Number),
    key(
        "spot",
        Object(&[key("innerConeAngle", Number), key("outerConeAngle", Number), key("extensions", Object(&[]))]),
    ),
    key("extensions", Object(&[])),
]);

const TRANSFORM: Kind = Object(&[
    key("offset", Numbers(2)),
    key("rotation", Number),
    key("scale", Numbers(2)),
    key("texCoord", Index),
    key("extensions", Object(&[])),
]);

const INFO: Kind = Object(&[
    must("index", Index),
    key("texCoord", Index),
    key("scale", Number),
    key("strength", Number),
    key("extensions", Object(&[key("KHR_texture_transform", TRANSFORM)])),
]);

pub const MATERIAL: Kind = Object(&[
    key("name", Text),
    key("alphaMode", Text),
    key("alphaCutoff", Number),
    key("doubleSided", Truth),
    key("emissiveFactor", Numbers(3)),
    key("emissiveTexture", INFO),
    key("normalTexture", INFO),
    key("occlusionTexture", INFO),
    key(
        "pbrMetallicRoughness",
        Object(&[
            key("baseColorFactor", Numbers(4)),
            key("baseColorTexture", INFO),
            key("metallicFactor", Number),
            key("roughnessFactor", Number),
            key("metallicRoughnessTexture", INFO),
            key("extensions", Object(&[])),
        ]),
    ),
    key(
        "extensions",
        Object(&[
            key("KHR_materials_emissive_strength", Object(&[key("emissiveStrength", Number)])),
            key("KHR_materials_ior", Object(&[key("ior", Number)])),
            key(
                "KHR_materials_pbrSpecularGlossiness",
                Object(&[
                    key("diffuseFactor", Numbers(4)),
                    key("diffuseTexture", INFO),
                    key("specularFactor", Numbers(3)),
                    key("glossinessFactor", Number),
                    key("specularGlossinessTexture", INFO),
                ]),
            ),
            key(
                "KHR_materials_transmission",
                Object(&[key("transmissionFactor", Number), key("transmissionTexture", INFO)]),
            ),
            key("KHR_materials_unlit", Object(&[])),
            key(
                "KHR_materials_volume",
                Object(&[
                    key("thicknessFactor", Number),
                    key("thicknessTexture", INFO),
                    key("attenuationDistance", Number),
                    key("attenuationColor", Numbers(3)),
                ]),
            ),
        ]),
    ),
]);

pub const TEXTURE: Kind = Object(&[
    key("name", Text),
    key("sampler", Index),
    key("source", Index),
    key("extensions", Object(&[key("EXT_texture_webp", Object(&[key("source", Index)]))])),
]);

pub const IMAGE: Kind = Object(&[
    key("name", Text),
    key("bufferView", Index),
    key("mimeType", Text),
    key("uri", Text),
    key("extensions", Object(&[])),
]);

pub const SAMPLER: Kind = Object(&[
    key("name", Text),
    key("magFilter", Whole),
    key("minFilter", Whole),
    key("wrapS", Whole),
    key("wrapT", Whole),
    key("extensions", Object(&[])),
]);

/// Elsewhere in the bytes, or of another type, an accessor would hold something else.
pub const ACCESSOR: Kind = Object(&[
    key("name", Text),
    Key { name: "bufferView", kind: Index, need: OrNoEntry },
    Key { name: "byteOffset", kind: Whole, need: OrAll },
    must("componentType", Whole),
    must("count", Whole),
    must("type", Text),
    key("normalized", Truth),
    key(
        "sparse",
        Object(&[
            must("count", Whole),
            must(
                "indices",
                Object(&[
                    must("bufferView", Index),
                    Key { name: "byteOffset", kind: Whole, need: OrAll },
                    must("componentType", Whole),
                    key("extensions", Object(&[])),
                ]),
            ),
            must(
                "values",
                Object(&[
                    must("bufferView", Index),
                    Key { name: "byteOffset", kind: Whole, need: OrAll },
                    key("extensions", Object(&[])),
                ]),
            ),
            key("extensions", Object(&[])),
        ]),
    ),
    key("extensions", Object(&[])),
]);

pub const VIEW: Kind = Object(&[
    key("name", Text),
    must("buffer", Index),
    must("byteLength", Whole),
    Key { name: "byteOffset", kind: Whole, need: OrAll },
    key("byteStride", Whole),
    key("target", Whole),
    key("extensions", Object(&[])),
]);

pub const BUFFER: Kind = Object(&[key("byteLength", Whole), key("uri", Text)]);
