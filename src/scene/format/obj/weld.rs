//! Corners that are the same vertex.

/// What a corner of a face refers to, from 0 up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// Index of its position.
    pub position: u32,
    /// Index of its texture coordinates.
    pub uv: Option<u32>,
    /// Index of its normal.
    pub normal: Option<u32>,
}

/// Finds the vertex of a mesh that a corner was given before: for each position a chain of the corners there. Chains
/// are short, since a position has few normals and texture coordinates.
#[derive(Debug, Default)]
pub struct Weld {
    /// By position: the mesh that its chain is of, and the chain's first link.
    chains: Vec<(u32, u32)>,
    links: Vec<Link>,
}

#[derive(Debug)]
struct Link {
    corner: Corner,
    vertex: u32,
    next: u32,
}

/// The end of a chain, and the mesh of positions without one.
const NONE: u32 = u32::MAX;
/// Corners compared before one is a vertex of its own, lest a file with one position takes time by the square.
const COMPARED: usize = 64;

impl Weld {
    /// The vertex of a corner in a mesh; `new` adds one where there is none.
    pub fn vertex(&mut self, mesh: u32, corner: Corner, new: impl FnOnce() -> u32) -> u32 {
        let position = corner.position as usize;
        if self.chains.len() <= position {
            self.chains.resize(position + 1, (NONE, NONE));
        }
        let chain = &mut self.chains[position];
        if chain.0 != mesh {
            *chain = (mesh, NONE);
        }
        let mut next = chain.1;
        for _ in 0..COMPARED {
            let Some(link) = self.links.get(next as usize) else { break };
            if link.corner == corner {
                return link.vertex;
            }
            next = link.next;
        }
        let vertex = new();
        self.links.push(Link { corner, vertex, next: chain.1 });
        chain.1 = self.links.len() as u32 - 1;
        vertex
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_corners_of_a_mesh_are_one_vertex() {
        let mut weld = Weld::default();
        let corner = |position, uv| Corner { position, uv, normal: None };
        let fresh = |_: u32| || panic!("it is known");
        assert_eq!(weld.vertex(0, corner(3, None), || 10), 10);
        assert_eq!(weld.vertex(0, corner(3, Some(0)), || 11), 11);
        assert_eq!(weld.vertex(0, corner(3, None), fresh(0)), 10);
        assert_eq!(weld.vertex(0, corner(3, Some(0)), fresh(0)), 11);
        assert_eq!(weld.vertex(1, corner(3, None), || 12), 12, "another mesh has vertices of its own");
    }
}
