//! What a scene may ask of the machine: named limits, checked before memory is taken.

/// Limits of a load. Each can be changed by its name, and every error about one names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes read from all files of a scene together.
    pub file_bytes: u64,
    /// How many bytes a compressed file may have for each of its own, beyond what is always allowed.
    pub expansion: u64,
    /// Bytes of all decoded textures together, and those that any one takes while it is decoded.
    pub texture_bytes: u64,
    /// Width and height of a texture in texels.
    pub texture_edge: u64,
    /// Leaf objects.
    pub objects: u64,
    /// Primitives: triangles, spheres and the like.
    pub primitives: u64,
    /// Nodes of a model's tree, and groups, models and their lights, each as often as it is placed.
    pub nodes: u64,
    /// Lights of the scene and its models, each as often as it is placed.
    pub lights: u64,
    /// Vertices and indices read from a file's meshes together.
    pub vertices: u64,
    /// Levels of objects and lists within each other in a scene file, and of groups and models in the scene.
    pub nesting: u64,
    /// Width and height of the picture that a scene may ask for.
    pub picture_edge: u64,
    /// Pixels of a picture that is rendered, or read to be compared.
    pub picture_pixels: u64,
}

/// One limit: its name on the command line, what it bounds, its default, its place.
struct Row {
    name: &'static str,
    help: &'static str,
    default: u64,
    /// Raising a limit above this would break what relies on it: a stack, or an index's width.
    ceiling: u64,
    field: fn(&mut Limits) -> &mut u64,
}

/// Every limit.
const ROWS: &[Row] = &[
    Row {
        name: "file-bytes",
        help: "bytes read from all files of a scene",
        default: 2 << 30,
        ceiling: u64::MAX,
        field: |l| &mut l.file_bytes,
    },
    Row {
        name: "expansion",
        help: "times that a compressed file of more than 16 MiB, expanded, is as large",
        default: 100,
        ceiling: u64::MAX,
        field: |l| &mut l.expansion,
    },
    Row {
        name: "texture-bytes",
        help: "bytes of all decoded textures, and of any one while it is decoded",
        default: 1 << 30,
        ceiling: u64::MAX,
        field: |l| &mut l.texture_bytes,
    },
    Row {
        name: "texture-edge",
        help: "width and height of a texture",
        default: 16384,
        ceiling: u32::MAX as u64,
        field: |l| &mut l.texture_edge,
    },
    Row {
        name: "objects",
        help: "leaf objects",
        default: 1_000_000,
        ceiling: u32::MAX as u64 - 1,
        field: |l| &mut l.objects,
    },
    Row {
        name: "primitives",
        help: "primitives",
        default: 1 << 31,
        ceiling: u32::MAX as u64 - 1,
        field: |l| &mut l.primitives,
    },
    Row {
        name: "nodes",
        help: "nodes, groups, models and lights of models, as often as placed",
        default: 1_000_000,
        ceiling: u32::MAX as u64 - 1,
        field: |l| &mut l.nodes,
    },
    Row {
        name: "lights",
        help: "lights, as often as placed",
        default: 10_000,
        ceiling: u32::MAX as u64 - 1,
        field: |l| &mut l.lights,
    },
    Row {
        name: "vertices",
        help: "vertices and indices read from a glTF or OBJ file",
        default: 1 << 26,
        ceiling: u32::MAX as u64 - 1,
        field: |l| &mut l.vertices,
    },
    Row { name: "nesting", help: "levels of nesting", default: 128, ceiling: 256, field: |l| &mut l.nesting },
    Row {
        name: "picture-edge",
        help: "width and height of the picture",
        default: 32768,
        ceiling: 65536,
        field: |l| &mut l.picture_edge,
    },
    Row {
        name: "picture-pixels",
        help: "pixels of the picture, or of one that is compared",
        default: 1 << 26,
        ceiling: 1 << 32,
        field: |l| &mut l.picture_pixels,
    },
];

impl Default for Limits {
    fn default() -> Self {
        let mut limits = Self {
            file_bytes: 0,
            expansion: 0,
            texture_bytes: 0,
            texture_edge: 0,
            objects: 0,
            primitives: 0,
            nodes: 0,
            lights: 0,
            vertices: 0,
            nesting: 0,
            picture_edge: 0,
            picture_pixels: 0,
        };
        for row in ROWS {
            *(row.field)(&mut limits) = row.default;
        }
        limits
    }
}

impl Limits {
    /// Sets a limit from the text of `--limit NAME=VALUE`; the error says what is allowed.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        let Some(row) = ROWS.iter().find(|row| row.name == name) else {
            return Err(format!("unknown limit {name}; known: {}", Self::names().collect::<Vec<_>>().join(", ")));
        };
        let allowed = |v: &u64| (1..=row.ceiling).contains(v);
        let Some(value) = value.parse().ok().filter(allowed) else {
            return Err(format!("limit {name}: expected a whole number from 1 to {}, found {value}", row.ceiling));
        };
        *(row.field)(self) = value;
        Ok(())
    }

    /// The limits that are not as by default: their names and values, as [`set`](Self::set) takes them.
    pub fn changed(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let mut limits = self.clone();
        let value = move |row: &Row| (row.name, *(row.field)(&mut limits));
        ROWS.iter().map(value).zip(ROWS).filter(|((_, value), row)| *value != row.default).map(|(limit, _)| limit)
    }

    /// The names of all limits.
    pub fn names() -> impl Iterator<Item = &'static str> {
        ROWS.iter().map(|row| row.name)
    }

    /// One line of help a limit: its name, what it bounds, its default.
    pub fn help() -> impl Iterator<Item = String> {
        ROWS.iter().map(|row| format!("{}: {} (default {})", row.name, row.help, row.default))
    }
}

/// The end of every message about an exceeded limit: which one, and how to raise it.
pub fn exceeded(name: &str, limit: u64) -> String {
    format!("more than the limit {name} of {limit}; raise it with --limit {name}=N")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_limit_can_be_set_and_no_two_rows_share_a_place() {
        for (i, name) in Limits::names().enumerate() {
            let mut limits = Limits::default();
            limits.set(name, "7").unwrap();
            let changed = ROWS.iter().map(|row| *(row.field)(&mut limits) == 7).collect::<Vec<_>>();
            assert_eq!(changed.iter().filter(|c| **c).count(), 1, "{name}");
            assert!(changed[i], "{name}");
            assert_eq!(limits.changed().collect::<Vec<_>>(), [(name, 7)]);
        }
    }

    #[test]
    fn a_wrong_limit_says_what_is_allowed() {
        let mut limits = Limits::default();
        assert!(limits.set("speed", "1").unwrap_err().contains("file-bytes"));
        for value in ["", "0", "-1", "x", "1e9"] {
            assert!(limits.set("nesting", value).unwrap_err().contains("from 1 to 256"), "{value}");
        }
        assert_eq!(limits, Limits::default());
    }
}
