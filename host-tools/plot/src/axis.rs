//! Axes: their scales, their ticks, and places along them.

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// An axis: its label and scale.
#[derive(Clone)]
pub struct Axis {
    label: String,
    logarithmic: bool,
}

impl Axis {
    /// Equal steps for equal differences.
    pub fn linear(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            logarithmic: false,
        }
    }

    /// Equal steps for equal ratios; values that are not positive are left out.
    pub fn logarithmic(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            logarithmic: true,
        }
    }

    pub(crate) fn shows(&self, value: f64) -> bool {
        value.is_finite() && (!self.logarithmic || value > 0.0)
    }

    pub(crate) fn with_margin(&self, range: Range<f64>) -> Range<f64> {
        if self.logarithmic {
            return range.start / 1.5..range.end * 1.5;
        }
        let width = range.end - range.start;
        let margin = if width > 0.0 { 0.04 * width } else { 0.5 };
        range.start - margin..range.end + margin
    }

    /// Round values within a range, some eight of them.
    fn ticks(&self, range: &Range<f64>) -> Vec<f64> {
        const MAX: f64 = 8.0;
        if !self.logarithmic {
            let step = step((range.end - range.start) / MAX);
            let first = (range.start / step).ceil() as i64;
            let last = (range.end / step).floor() as i64;
            return (first..=last).map(|i| i as f64 * step).collect();
        }
        let [low, high] = [range.start, range.end].map(f64::log10);
        let every = ((high - low) / MAX).ceil() as i32;
        let within: &[f64] = if high - low > 3.0 {
            &[1.0]
        } else if high - low > 1.0 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]
        };
        let powers = (low.floor() as i32..=high.floor() as i32).filter(|power| power % every == 0);
        let values = powers.flat_map(|power| within.iter().map(move |factor| factor * 10f64.powi(power)));
        values.filter(|value| range.contains(value)).collect()
    }

    pub(crate) fn label(&self) -> &str {
        &self.label
    }

    /// The axis over a range.
    pub(crate) fn over(&self, range: Range<f64>) -> Coordinate {
        Coordinate {
            ticks: self.ticks(&range),
            range,
            logarithmic: self.logarithmic,
        }
    }
}

/// An axis over a range, as the drawing library wants it.
#[derive(Clone)]
pub(crate) struct Coordinate {
    range: Range<f64>,
    ticks: Vec<f64>,
    logarithmic: bool,
}

impl Coordinate {
    /// Where a value lies between the ends of the range, 0 and 1.
    pub(crate) fn share(&self, value: f64) -> f64 {
        let [low, high, at] =
            [self.range.start, self.range.end, value].map(|v| if self.logarithmic { v.ln() } else { v });
        (at - low) / (high - low)
    }

    /// The value there.
    pub(crate) fn value(&self, share: f64) -> f64 {
        let Range { start, end } = self.range;
        if self.logarithmic {
            start * (end / start).powf(share)
        } else {
            start + share * (end - start)
        }
    }
}

impl Ranged for Coordinate {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        first + (self.share(*value) * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Coordinate {
    fn format(value: &f64) -> String {
        label(*value)
    }
}

/// The least of 1, 2 and 5 times a power of ten that is not below a number.
fn step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= least);
    factor.unwrap_or(10.0) * power
}

/// The label of a value on an axis that may have zero on it.
pub(crate) fn label(value: f64) -> String {
    // Ticks of an axis through zero come out as -2e-16; nothing that is plotted over equal steps is that small.
    if value.abs() < 1e-14 {
        "0".to_owned()
    } else {
        power(value)
    }
}

/// Four digits after the point, without trailing zeros; powers of ten outside the comfortable range.
fn power(value: f64) -> String {
    if !(1e-3..1e5).contains(&value.abs()) {
        return format!("{value:e}");
    }
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_short() {
        assert_eq!(
            [label(0.25), label(3.0), label(0.0), label(1e-7), label(-0.5)],
            ["0.25", "3", "0", "1e-7", "-0.5"]
        );
    }

    #[test]
    fn ticks_are_round_and_several() {
        assert_eq!(
            Axis::linear("").ticks(&(-0.1..3.2)),
            [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0]
        );
        for (low, high) in [(4e4, 2e5), (0.03, 1.3), (1.0, 1.9), (1e-15, 1.0), (1e-3, 10.0)] {
            let ticks = Axis::logarithmic("").ticks(&(low..high));
            assert!((2..=10).contains(&ticks.len()), "{low} {high}: {ticks:?}");
        }
    }

    #[test]
    fn shares_and_values_undo_each_other() {
        for axis in [Axis::linear(""), Axis::logarithmic("")] {
            let coordinate = axis.over(0.01..10.0);
            for value in [0.01, 0.1, 3.0, 10.0] {
                assert!((coordinate.value(coordinate.share(value)) - value).abs() < 1e-12);
            }
            assert_eq!(
                (coordinate.map(&0.01, (40, 440)), coordinate.map(&10.0, (40, 440))),
                (40, 440)
            );
        }
    }
}
