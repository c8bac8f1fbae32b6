//! From the corners of lists, strips and fans to triangles.

use gltf::json::mesh::Mode;

/// Triangles over `count` vertices, or over those that `indices` name; `None` for points and lines.
///
/// The order of corners is the specification's: all triangles of a strip wind the same way.
pub fn triangles(mode: Mode, indices: Option<&[[u32; 1]]>, count: u32) -> Option<Vec<[u32; 3]>> {
    match indices {
        Some(indices) => connect(mode, indices.len(), |i| indices[i][0]),
        None => connect(mode, count as usize, |i| i as u32),
    }
}

fn connect(mode: Mode, corners: usize, vertex: impl Fn(usize) -> u32) -> Option<Vec<[u32; 3]>> {
    let runs = corners.saturating_sub(2);
    Some(match mode {
        Mode::Triangles => (0..corners / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2].map(&vertex)).collect(),
        Mode::TriangleStrip => (0..runs).map(|i| [i, i + 1 + i % 2, i + 2 - i % 2].map(&vertex)).collect(),
        Mode::TriangleFan => (0..runs).map(|i| [i + 1, i + 2, 0].map(&vertex)).collect(),
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mode_connects_as_the_specification_says() {
        let plain = |mode| triangles(mode, None, 5).unwrap();
        assert_eq!(plain(Mode::Triangles), [[0, 1, 2]]);
        assert_eq!(plain(Mode::TriangleStrip), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(plain(Mode::TriangleFan), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
        assert_eq!(triangles(Mode::Lines, None, 5), None);
        let indices = [[7], [8], [9], [9]];
        assert_eq!(triangles(Mode::TriangleStrip, Some(&indices), 0).unwrap(), [[7, 8, 9], [8, 9, 9]]);
        assert!(triangles(Mode::TriangleFan, None, 1).unwrap().is_empty());
    }
}
