//! Which transparent bodies a ray is inside of, in the order in which it entered them.
//!
//! Lists share their tails in an arena: a ray carries one index, and nesting has no limit. The index of refraction
//! outside of a body is that of the last body entered and not left (as in POV-Ray), else 1.

/// A list of bodies: an index into [`Media`].
pub type MediaList = u32;

/// The empty list: outside of everything.
pub const OUTSIDE: MediaList = 0;

#[derive(Clone, Copy, Debug)]
struct Entry {
    object: u32,
    before: MediaList,
}

/// Where an arena ended.
#[derive(Clone, Copy, Debug)]
pub struct MediaMark(usize);

/// The arena of lists of one tile.
#[derive(Debug, Default)]
pub struct Media {
    entries: Vec<Entry>,
}

impl Media {
    /// Forgets all lists and makes one of the bodies around the eye, outermost first.
    pub fn restart(&mut self, around_eye: &[u32]) -> MediaList {
        self.entries.clear();
        around_eye.iter().fold(OUTSIDE, |list, &object| self.enter(list, object))
    }

    /// Bodies that there is memory for.
    #[cfg(test)]
    pub fn room(&self) -> usize {
        self.entries.capacity()
    }

    /// Where the arena ends now.
    pub fn mark(&self) -> MediaMark {
        MediaMark(self.entries.len())
    }

    /// Forgets all lists made since `mark`.
    pub fn truncate(&mut self, mark: MediaMark) {
        self.entries.truncate(mark.0);
    }

    /// The list after entering a body.
    pub fn enter(&mut self, list: MediaList, object: u32) -> MediaList {
        self.entries.push(Entry { object, before: list });
        self.entries.len() as MediaList
    }

    /// The list after leaving a body: without its latest entry, if it has one.
    pub fn leave(&mut self, list: MediaList, object: u32) -> MediaList {
        if !self.bodies(list).any(|o| o == object) {
            return list;
        }
        let kept = self.bodies(list).take_while(|&o| o != object).count();
        let mut rest = list;
        for _ in 0..=kept {
            rest = self.entries[rest as usize - 1].before;
        }
        // Few bodies overlap: walking down once for each that stays is cheaper than a buffer.
        for depth in (0..kept).rev() {
            let stays = self.bodies(list).nth(depth);
            rest = stays.map_or(rest, |object| self.enter(rest, object));
        }
        rest
    }

    /// The list after leaving or entering a body.
    pub fn cross(&mut self, list: MediaList, object: u32, leaves: bool) -> MediaList {
        if leaves { self.leave(list, object) } else { self.enter(list, object) }
    }

    /// The body whose matter the ray is in: the last entered and not left.
    pub fn current(&self, list: MediaList) -> Option<u32> {
        self.bodies(list).next()
    }

    /// The last body entered and not left, other than `object`.
    pub fn around(&self, list: MediaList, object: u32) -> Option<u32> {
        self.bodies(list).find(|&o| o != object)
    }

    /// Bodies of a list, latest first.
    fn bodies(&self, list: MediaList) -> impl Iterator<Item = u32> + '_ {
        let entry = |list: MediaList| (list != OUTSIDE).then(|| self.entries[list as usize - 1]);
        std::iter::successors(entry(list), move |e| entry(e.before)).map(|e| e.object)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_are_left_in_any_order() {
        let mut media = Media::default();
        let list = media.restart(&[7]);
        let list = media.enter(list, 1);
        let list = media.enter(list, 2);
        assert_eq!((media.current(list), media.around(list, 2), media.around(list, 1)), (Some(2), Some(1), Some(2)));
        let without_1 = media.leave(list, 1);
        assert_eq!((media.current(without_1), media.around(without_1, 2)), (Some(2), Some(7)));
        let without_all = [2, 7].into_iter().fold(without_1, |list, object| media.leave(list, object));
        assert_eq!(media.current(without_all), None);
        assert_eq!(media.leave(without_1, 9), without_1);
        assert_eq!(media.current(list), Some(2), "the old list is untouched");
    }
}
