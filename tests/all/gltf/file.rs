//! Small glTF files, made in memory.

use crate::temporary::Folder;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use raywalk::scene::{EnvironmentChoice, LoadOptions, Scene, SceneError, load};

/// The buffer of a file and the accessors over it.
#[derive(Default)]
pub struct File {
    pub bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

/// One triangle in the plane z = 0, with a right angle at the origin.
pub const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

impl File {
    /// Adds a view of `bytes`, with more keys if any, and gives its number.
    pub fn view(&mut self, bytes: &[u8], more: &str) -> usize {
        while !self.bytes.len().is_multiple_of(4) {
            self.bytes.push(0);
        }
        let (offset, length) = (self.bytes.len(), bytes.len());
        self.bytes.extend(bytes);
        self.views.push(format!(r#"{{ "buffer": 0, "byteOffset": {offset}, "byteLength": {length} {more} }}"#));
        self.views.len() - 1
    }

    /// Adds an accessor as it is written, and gives its number.
    pub fn accessor(&mut self, text: String) -> usize {
        self.accessors.push(text);
        self.accessors.len() - 1
    }

    /// Adds vectors.
    pub fn vectors<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, "");
        let kind = match N {
            1 => "SCALAR".to_owned(),
            16 => "MAT4".to_owned(),
            _ => format!("VEC{N}"),
        };
        let count = values.len();
        self.accessor(format!(
            r#"{{ "bufferView": {view}, "componentType": 5126, "count": {count}, "type": "{kind}" }}"#
        ))
    }

    /// Adds indices of 16 bits.
    pub fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, "");
        let count = values.len();
        self.accessor(format!(
            r#"{{ "bufferView": {view}, "componentType": 5123, "count": {count}, "type": "SCALAR" }}"#
        ))
    }

    fn json(&self, uri: &str, rest: &str) -> String {
        format!(
            r#"{{ "asset": {{ "version": "2.0" }}, "buffers": [{{ "byteLength": {}{uri} }}],
            "bufferViews": [{}], "accessors": [{}], {rest} }}"#,
            self.bytes.len(),
            self.views.join(", "),
            self.accessors.join(", ")
        )
    }

    /// The file as text, the buffer in a data URI.
    pub fn text(&self, rest: &str) -> String {
        let data = BASE64_STANDARD.encode(&self.bytes);
        self.json(&format!(r#", "uri": "data:application/octet-stream;base64,{data}""#), rest)
    }

    /// The file in binary.
    pub fn binary(&self, rest: &str) -> Vec<u8> {
        let chunk = |kind: &[u8], contents: &[u8], fill: u8| {
            let mut padded = contents.to_vec();
            padded.resize(contents.len().next_multiple_of(4), fill);
            [&(padded.len() as u32).to_le_bytes(), kind, &padded].concat()
        };
        let body = [chunk(b"JSON", self.json("", rest).as_bytes(), b' '), chunk(b"BIN\0", &self.bytes, 0)].concat();
        [&b"glTF"[..], &2_u32.to_le_bytes(), &(body.len() as u32 + 12).to_le_bytes(), &body].concat()
    }

    /// Loads the file with `rest` after the buffer's part.
    pub fn load(&self, rest: &str) -> Scene {
        try_load(self.text(rest)).unwrap_or_else(|error| panic!("{error}"))
    }
}

/// In the light that the file has, and nothing else.
pub fn in_its_own_light() -> LoadOptions {
    LoadOptions { environment: EnvironmentChoice::None, ..LoadOptions::default() }
}

/// Loads a glTF text in a folder of its own, in the light that it has.
pub fn try_load(text: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
    let folder = Folder::new();
    load(&folder.write("s.gltf", text), &in_its_own_light())
}

/// A scene of one triangle with the given keys besides its mesh.
pub fn triangle(rest: &str) -> Scene {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    file.load(&format!(
        r#""meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {positions} }}, "material": 0 }}] }}],
        {rest}"#
    ))
}

/// The messages of a scene's warnings, each after its pointer.
pub fn warnings(scene: &Scene) -> Vec<String> {
    scene.warnings.iter().map(|warning| format!("{}: {}", warning.place.pointer, warning.message)).collect()
}
