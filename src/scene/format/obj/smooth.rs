//! Normals of smoothing groups: means over the faces of a group at each position.

use glam::DVec3;

/// Groups compared at a position before one is added anew, lest a file with one position takes time by the square.
const COMPARED: usize = 64;
/// The end of a chain.
const NONE: u32 = u32::MAX;

/// The normals of a file's smoothing groups. For each position a chain of those of the groups there.
#[derive(Debug, Default)]
pub struct SmoothNormals {
    /// By position: the first link.
    chains: Vec<u32>,
    links: Vec<Link>,
}

#[derive(Debug)]
struct Link {
    group: i64,
    sum: DVec3,
    /// Normal of a face, for where the sum is none.
    face: DVec3,
    next: u32,
}

impl SmoothNormals {
    /// The number of a group's normal at a position, for a face to be added.
    pub fn place(&mut self, position: u32, group: i64) -> u32 {
        let position = position as usize;
        if self.chains.len() <= position {
            self.chains.resize(position + 1, NONE);
        }
        let mut next = self.chains[position];
        for _ in 0..COMPARED {
            let Some(link) = self.links.get(next as usize) else { break };
            if link.group == group {
                return next;
            }
            next = link.next;
        }
        let place = self.links.len() as u32;
        self.links.push(Link { group, sum: DVec3::ZERO, face: DVec3::ZERO, next: self.chains[position] });
        self.chains[position] = place;
        place
    }

    /// Adds a face of unit `normal` to the normal at its corner, where the edges to its neighbours leave: it counts by the
    /// angle between them (Thürmer and Wüthrich, "Computing vertex normals from polygonal facets", JGT 1998).
    pub fn add(&mut self, place: u32, normal: DVec3, edges: [DVec3; 2]) {
        let [a, b] = edges.map(DVec3::normalize_or_zero);
        let angle = libm::atan2(a.cross(b).length(), a.dot(b));
        let link = &mut self.links[place as usize];
        link.sum += normal * angle;
        if link.face == DVec3::ZERO {
            link.face = normal;
        }
    }

    /// The normal at a place; of a face there where its faces point in opposite directions. Where all are without area, any
    /// will do.
    pub fn normal(&self, place: u32) -> DVec3 {
        let Link { sum, face, .. } = &self.links[place as usize];
        match sum.length() > 1e-6 {
            true => sum.normalize(),
            false => face.try_normalize().unwrap_or(DVec3::Z),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_count_by_their_angle_and_groups_apart() {
        let mut normals = SmoothNormals::default();
        let place = normals.place(3, 1);
        let other = normals.place(3, 2);
        assert!(normals.place(3, 1) == place && place != other);
        normals.add(place, DVec3::Z, [DVec3::X, DVec3::Y]);
        normals.add(other, DVec3::X, [DVec3::Y, DVec3::Z]);
        assert_eq!([normals.normal(place), normals.normal(other)], [DVec3::Z, DVec3::X]);
        // Two halves of a right angle are one.
        let diagonal = DVec3::new(0.0, 1.0, 1.0);
        normals.add(place, DVec3::X, [DVec3::Y, diagonal]);
        normals.add(place, DVec3::X, [diagonal, DVec3::Z]);
        assert!(normals.normal(place).abs_diff_eq(DVec3::new(1.0, 0.0, 1.0).normalize(), 1e-12));
        let flat = normals.place(0, 1);
        normals.add(flat, DVec3::Y, [DVec3::X, DVec3::Z]);
        normals.add(flat, DVec3::NEG_Y, [DVec3::Z, DVec3::X]);
        assert_eq!(normals.normal(flat), DVec3::Y);
        let none = normals.place(1, 1);
        normals.add(none, DVec3::ZERO, [DVec3::ZERO; 2]);
        assert_eq!(normals.normal(none), DVec3::Z);
    }
}
