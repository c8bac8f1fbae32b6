//! Axes: from values to pixels, with ticks.

use super::number::short;
use super::svg::{Anchor, Svg};

/// How values are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    Linear,
    Logarithmic,
}

/// One axis: values `min` to `max` lie at pixels `from` to `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    spread: Spread,
    min: f64,
    max: f64,
    from: f64,
    to: f64,
}

/// The rectangle that values are drawn in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Axis {
    /// A linear axis from 0 to a round number that all `values` stay below.
    pub fn linear(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let greatest = values.fold(0.0, f64::max);
        let step = if greatest > 0.0 { rounded_up(greatest / 5.0) } else { 1.0 };
        let max = step * (greatest * 1.02 / step).ceil().max(1.0);
        Self { spread: Spread::Linear, min: 0.0, max, from, to }
    }

    /// A linear axis for exactly this range.
    pub fn range(min: f64, max: f64, from: f64, to: f64) -> Self {
        Self { spread: Spread::Linear, min, max: max.max(min + 1.0), from, to }
    }

    /// A logarithmic axis around all positive `values`, one round number beyond each end.
    pub fn logarithmic(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let (mut min, mut max) = (f64::INFINITY, 0.0_f64);
        for value in values.filter(|value| *value > 0.0 && value.is_finite()) {
            (min, max) = (min.min(value), max.max(value));
        }
        if max == 0.0 {
            (min, max) = (0.1, 10.0);
        }
        Self { spread: Spread::Logarithmic, min: rounded_down(min / 1.05), max: rounded_up(max * 1.05), from, to }
    }

    /// The same, ending at `max` where it would go beyond.
    pub fn up_to(mut self, max: f64) -> Self {
        self.max = self.max.min(max);
        self
    }

    /// The pixel of a value.
    pub fn at(&self, value: f64) -> f64 {
        let share = match self.spread {
            Spread::Linear => (value - self.min) / (self.max - self.min),
            Spread::Logarithmic => (value / self.min).ln() / (self.max / self.min).ln(),
        };
        self.from + share.clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// Values with a line, and whether they also have a label.
    pub fn ticks(&self) -> Vec<(f64, bool)> {
        match self.spread {
            Spread::Linear => {
                let step = rounded_up((self.max - self.min) / 6.0);
                let first = (self.min / step).ceil() as i64;
                (first..).map(|i| (i as f64 * step, true)).take_while(|(v, _)| *v <= self.max * (1.0 + 1e-9)).collect()
            }
            Spread::Logarithmic => self.logarithmic_ticks(),
        }
    }

    fn logarithmic_ticks(&self) -> Vec<(f64, bool)> {
        let (first, last) = (libm::floor(libm::log10(self.min)) as i32, libm::ceil(libm::log10(self.max)) as i32);
        let decades = libm::log10(self.max / self.min);
        let every = if decades > 8.0 { 2 } else { 1 };
        let mut ticks = Vec::new();
        for exponent in first..=last {
            for digit in 1..10 {
                let value = power_of_ten(exponent) * f64::from(digit);
                let labelled = match digit {
                    1 => exponent % every == 0,
                    2 | 5 => decades < 2.6,
                    3 | 7 => decades < 0.8,
                    _ => false,
                };
                if value >= self.min * (1.0 - 1e-9) && value <= self.max * (1.0 + 1e-9) && (labelled || decades < 6.0) {
                    ticks.push((value, labelled));
                }
            }
        }
        ticks
    }
}

fn power_of_ten(exponent: i32) -> f64 {
    libm::pow(10.0, f64::from(exponent))
}

/// The next of 1, 2, 5 times a power of ten, upwards.
fn rounded_up(value: f64) -> f64 {
    let power = power_of_ten(libm::floor(libm::log10(value)) as i32);
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    steps.into_iter().find(|step| *step >= value * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

/// The next of 1, 2, 5 times a power of ten, downwards.
fn rounded_down(value: f64) -> f64 {
    let power = power_of_ten(libm::floor(libm::log10(value)) as i32);
    let steps = [5.0, 2.0, 1.0].map(|step| step * power);
    steps.into_iter().find(|step| *step <= value * (1.0 + 1e-9)).unwrap_or(power)
}

impl Area {
    pub fn center(&self) -> (f64, f64) {
        ((self.left + self.right) / 2.0, (self.top + self.bottom) / 2.0)
    }

    /// Grid, ticks, labels and title of the axis below.
    pub fn axis_below(&self, svg: &mut Svg, axis: &Axis, title: &str) {
        self.ticks_below(svg, axis);
        svg.text(self.center().0, self.bottom + 38.0, Anchor::Middle, "", title);
    }

    /// The same without a title.
    pub fn ticks_below(&self, svg: &mut Svg, axis: &Axis) {
        for (value, labelled) in axis.ticks() {
            let x = axis.at(value);
            svg.line((x, self.top), (x, self.bottom), if labelled { "grid" } else { "faintgrid" });
            if labelled {
                svg.line((x, self.bottom), (x, self.bottom + 4.0), "axis");
                svg.text(x, self.bottom + 18.0, Anchor::Middle, "tick", &short(value));
            }
        }
    }

    /// Grid, ticks, labels and title of the axis on the left.
    pub fn axis_left(&self, svg: &mut Svg, axis: &Axis, title: &str) {
        for (value, labelled) in axis.ticks() {
            let y = axis.at(value);
            svg.line((self.left, y), (self.right, y), if labelled { "grid" } else { "faintgrid" });
            if labelled {
                svg.line((self.left - 4.0, y), (self.left, y), "axis");
                svg.text(self.left - 8.0, y + 4.0, Anchor::End, "tick", &short(value));
            }
        }
        svg.text_upwards(self.left - 60.0, self.center().1, "", title);
    }

    /// A line around all.
    pub fn frame(&self, svg: &mut Svg) {
        svg.rectangle(self.left, self.top, self.right - self.left, self.bottom - self.top, "frame");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_round_and_hold_all_values() {
        let axis = Axis::logarithmic([3.0, 70.0].into_iter(), 0.0, 100.0);
        assert_eq!((axis.min, axis.max), (2.0, 100.0));
        assert!((axis.at(2.0), axis.at(100.0)) == (0.0, 100.0) && axis.at(0.0) == 0.0);
        let axis = Axis::linear([0.3, 4.2].into_iter(), 100.0, 0.0);
        assert_eq!((axis.max, axis.at(0.0)), (5.0, 100.0));
        assert!(axis.ticks().len() >= 3);
    }

    #[test]
    fn no_values_still_make_an_axis() {
        for axis in [Axis::logarithmic([].into_iter(), 0.0, 1.0), Axis::linear([0.0].into_iter(), 0.0, 1.0)] {
            assert!(!axis.ticks().is_empty() && axis.at(1.0).is_finite());
        }
    }
}
