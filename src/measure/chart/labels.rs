//! Labels that keep clear of marks and of each other.

use super::axis::Area;
use super::svg::{Anchor, Svg, text_width};

const FONT: f64 = 13.0;
const HEIGHT: f64 = 15.0;

/// What space is taken.
pub struct Labels {
    bounds: Area,
    taken: Vec<Area>,
    /// The labels among what is taken.
    written: Vec<Area>,
}

/// A place for a label.
struct Spot {
    area: Area,
    /// Where its text starts from, in the middle of its height.
    at: (f64, f64),
    anchor: Anchor,
    /// So far from its mark that a line has to join them.
    far: bool,
}

impl Labels {
    /// Nothing is taken within `bounds`.
    pub fn within(bounds: Area) -> Self {
        Self { bounds, taken: Vec::new(), written: Vec::new() }
    }

    /// Takes the space of a mark.
    pub fn avoid(&mut self, (x, y): (f64, f64)) {
        self.taken.push(Area { left: x - 7.0, top: y - 7.0, right: x + 7.0, bottom: y + 7.0 });
    }

    /// Takes the space of a level line.
    pub fn avoid_level(&mut self, from: f64, to: f64, y: f64) {
        self.taken.push(Area { left: from, top: y - 1.0, right: to, bottom: y + 1.0 });
    }

    /// Takes the space of a slanting line, in small squares along it.
    pub fn avoid_line(&mut self, (x1, y1): (f64, f64), (x2, y2): (f64, f64)) {
        let steps = ((x2 - x1).hypot(y2 - y1) / 4.0).ceil().max(1.0);
        for step in 0..=steps as u32 {
            let share = f64::from(step) / steps;
            let (x, y) = (x1 + share * (x2 - x1), y1 + share * (y2 - y1));
            self.taken.push(Area { left: x - 2.0, top: y - 2.0, right: x + 2.0, bottom: y + 2.0 });
        }
    }

    /// Writes `text` beside a mark, farther away with a thin line where there is no room; leaves it out where there is none
    /// at all. The line crosses another label only where nothing else is left.
    pub fn place(&mut self, svg: &mut Svg, mark: (f64, f64), text: &str) {
        let width = text_width(text, FONT);
        let spot = self.spot(mark, width, true).or_else(|| self.spot(mark, width, false));
        if let Some(Spot { area, at, anchor, far }) = spot {
            if far {
                svg.line(mark, at, "leader");
            }
            svg.text(at.0, at.1 + 4.5, anchor, "", text);
            self.taken.push(area);
            self.written.push(area);
        }
    }

    /// The first free place around a mark, beginning with the nearest.
    fn spot(&self, (x, y): (f64, f64), width: f64, uncrossed: bool) -> Option<Spot> {
        for distance in [9.0, 20.0, 34.0, 50.0, 68.0, 88.0] {
            let slant = 0.75 * distance;
            let places = [
                (distance, 0.0, Anchor::Start),
                (-distance, 0.0, Anchor::End),
                (0.0, -distance - 5.0, Anchor::Middle),
                (0.0, distance + 6.0, Anchor::Middle),
                (slant, -slant - 3.0, Anchor::Start),
                (-slant, -slant - 3.0, Anchor::End),
                (slant, slant + 3.0, Anchor::Start),
                (-slant, slant + 3.0, Anchor::End),
            ];
            let far = distance > 20.0;
            for (dx, dy, anchor) in places {
                let at = (x + dx, y + dy);
                let left = match anchor {
                    Anchor::Start => at.0,
                    Anchor::Middle => at.0 - width / 2.0,
                    Anchor::End => at.0 - width,
                };
                let top = at.1 - HEIGHT / 2.0;
                let area = Area { left, top, right: left + width, bottom: top + HEIGHT };
                let crosses = |label: &Area| far && uncrossed && meets(label, (x, y), at);
                if self.is_free(area) && !self.written.iter().any(crosses) {
                    return Some(Spot { area, at, anchor, far });
                }
            }
        }
        None
    }

    fn is_free(&self, area: Area) -> bool {
        let inside = area.left >= self.bounds.left
            && area.right <= self.bounds.right
            && area.top >= self.bounds.top
            && area.bottom <= self.bounds.bottom;
        let apart = |other: &Area| {
            area.right < other.left || other.right < area.left || area.bottom < other.top || other.bottom < area.top
        };
        inside && self.taken.iter().all(apart)
    }
}

/// Whether a line passes through an area, as far as points along it tell.
fn meets(area: &Area, (x1, y1): (f64, f64), (x2, y2): (f64, f64)) -> bool {
    (0..=16).map(|step| f64::from(step) / 16.0).any(|share| {
        let (x, y) = (x1 + share * (x2 - x1), y1 + share * (y2 - y1));
        (area.left..=area.right).contains(&x) && (area.top..=area.bottom).contains(&y)
    })
}

/// Heights for labels that would like to stand at `wanted`, at least a line apart, between `top` and `bottom`, in order.
pub fn spread_out(wanted: &[f64], top: f64, bottom: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    let mut heights = vec![0.0; wanted.len()];
    let mut next = top;
    for &i in &order {
        heights[i] = wanted[i].max(next);
        next = heights[i] + HEIGHT;
    }
    // What was pushed out below moves up again.
    let mut last = bottom;
    for &i in order.iter().rev() {
        heights[i] = heights[i].min(last);
        last = heights[i] - HEIGHT;
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_labels_overlap() {
        let bounds = Area { left: 0.0, top: 0.0, right: 400.0, bottom: 300.0 };
        let (mut labels, mut svg) = (Labels::within(bounds), Svg::default());
        let marks: Vec<(f64, f64)> = (0..8).map(|i| (200.0 + f64::from(i), 150.0)).collect();
        marks.iter().for_each(|&mark| labels.avoid(mark));
        marks.iter().for_each(|&mark| labels.place(&mut svg, mark, "a method"));
        let written = &labels.written;
        assert!(written.len() >= 6, "{} labels", written.len());
        for (i, a) in written.iter().enumerate() {
            for b in &labels.taken[..marks.len() + i] {
                let apart = a.right < b.left || b.right < a.left || a.bottom < b.top || b.bottom < a.top;
                assert!(apart, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn heights_are_a_line_apart() {
        let heights = spread_out(&[100.0, 100.0, 101.0, 20.0], 0.0, 110.0);
        let mut sorted = heights.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(sorted.windows(2).all(|pair| pair[1] - pair[0] >= HEIGHT - 1e-9), "{heights:?}");
        assert!(sorted[3] <= 110.0);
    }
}
