//! Curves and points over linear or logarithmic axes.

use crate::TEXT;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;
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

    fn shows(&self, value: f64) -> bool {
        value.is_finite() && (!self.logarithmic || value > 0.0)
    }

    fn with_margin(&self, range: Range<f64>) -> Range<f64> {
        if self.logarithmic {
            return range.start / 1.5..range.end * 1.5;
        }
        let width = range.end - range.start;
        let margin = if width > 0.0 { 0.04 * width } else { 0.5 };
        range.start - margin..range.end + margin
    }
}

/// A named series of points, joined or not.
pub struct Curve {
    name: String,
    points: Vec<(f64, f64)>,
    joined: bool,
    like: Option<String>,
}

impl Curve {
    /// Points joined by straight lines.
    pub fn line(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.to_owned(),
            points,
            joined: true,
            like: None,
        }
    }

    /// Points as dots.
    pub fn points(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.to_owned(),
            points,
            joined: false,
            like: None,
        }
    }

    /// The same curve in the colour of the first one with this name.
    pub fn like(mut self, name: &str) -> Self {
        self.like = Some(name.to_owned());
        self
    }
}

/// A panel of curves.
pub struct Lines {
    title: String,
    x: Axis,
    y: Axis,
    curves: Vec<Curve>,
    same_scale: bool,
}

impl Lines {
    /// An empty panel.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self {
            title: title.to_owned(),
            x,
            y,
            curves: Vec::new(),
            same_scale: false,
        }
    }

    /// Adds a curve.
    pub fn with(mut self, curve: Curve) -> Self {
        self.curves.push(curve);
        self
    }

    /// One unit of x as long as one unit of y, for shapes.
    pub fn same_scale(mut self) -> Self {
        self.same_scale = true;
        self
    }

    pub(crate) fn title(&self) -> &str {
        &self.title
    }

    fn visible<'a>(&'a self, curve: &'a Curve) -> impl Iterator<Item = (f64, f64)> + 'a {
        curve
            .points
            .iter()
            .copied()
            .filter(|&(x, y)| self.x.shows(x) && self.y.shows(y))
    }

    /// The ranges of all that is visible, without margins.
    pub(crate) fn ranges(&self) -> Option<(Range<f64>, Range<f64>)> {
        self.curves
            .iter()
            .flat_map(|curve| self.visible(curve))
            .fold(None, |ranges, (x, y)| {
                let (xs, ys) = ranges.unwrap_or((x..x, y..y));
                Some((xs.start.min(x)..xs.end.max(x), ys.start.min(y)..ys.end.max(y)))
            })
    }

    pub(crate) fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Box<dyn std::error::Error>>
    where
        B::ErrorType: 'static,
    {
        let Some((xs, ys)) = self.ranges() else { return Ok(()) };
        let (mut xs, mut ys) = (self.x.with_margin(xs), self.y.with_margin(ys));
        if self.same_scale {
            let (width, height) = area.dim_in_pixel();
            equalise(&mut xs, &mut ys, (f64::from(width) - 90.0) / (f64::from(height) - 90.0));
        }
        match (self.x.logarithmic, self.y.logarithmic) {
            (false, false) => self.draw_over(area, xs, ys),
            (false, true) => self.draw_over(area, xs, ys.log_scale()),
            (true, false) => self.draw_over(area, xs.log_scale(), ys),
            (true, true) => self.draw_over(area, xs.log_scale(), ys.log_scale()),
        }
    }

    fn draw_over<B, X, Y>(&self, area: &DrawingArea<B, Shift>, xs: X, ys: Y) -> Result<(), Box<dyn std::error::Error>>
    where
        B: DrawingBackend,
        B::ErrorType: 'static,
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let format = |value: &f64| label(*value);
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, (TEXT, 17))
            .margin(10)
            .x_label_area_size(42)
            .y_label_area_size(64)
            .build_cartesian_2d(xs, ys)?;
        chart
            .configure_mesh()
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .x_label_formatter(&format)
            .y_label_formatter(&format)
            .label_style((TEXT, 13))
            .light_line_style(WHITE)
            .bold_line_style(BLACK.mix(0.12))
            .draw()?;
        for (index, curve) in self.curves.iter().enumerate() {
            let like = curve.like.as_ref();
            let model = like.and_then(|name| self.curves.iter().position(|curve| curve.name == *name));
            let colour = colour(model.unwrap_or(index));
            let drawn = if curve.joined {
                chart.draw_series(LineSeries::new(self.visible(curve), colour.stroke_width(2)))?
            } else {
                chart.draw_series(self.visible(curve).map(|at| Circle::new(at, 3, colour.filled())))?
            };
            if !curve.name.is_empty() {
                drawn
                    .label(&curve.name)
                    .legend(move |(x, y)| Rectangle::new([(x, y - 1), (x + 16, y + 1)], colour.filled()));
            }
        }
        if self.curves.iter().any(|curve| !curve.name.is_empty()) {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.8))
                .border_style(BLACK.mix(0.2))
                .label_font((TEXT, 13))
                .draw()?;
        }
        Ok(())
    }
}

/// Widens the narrower range so that both axes have one scale on an area of this aspect (width / height).
fn equalise(xs: &mut Range<f64>, ys: &mut Range<f64>, aspect: f64) {
    let widen = |range: &mut Range<f64>, width: f64| {
        let middle = 0.5 * (range.start + range.end);
        *range = middle - 0.5 * width..middle + 0.5 * width;
    };
    let (width, height) = (xs.end - xs.start, ys.end - ys.start);
    if width < height * aspect {
        widen(xs, height * aspect);
    } else {
        widen(ys, width / aspect);
    }
}

/// Four significant digits, without trailing zeros; powers of ten outside the comfortable range.
pub(crate) fn label(value: f64) -> String {
    let size = value.abs();
    // Ticks of an axis through zero come out as -2e-16; nothing that is plotted here is that small.
    if size < 1e-14 {
        return "0".to_owned();
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{value:.0e}");
    }
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Okabe and Ito's palette, distinct for colour-blind readers.
fn colour(index: usize) -> RGBColor {
    const PALETTE: [RGBColor; 7] = [
        RGBColor(0, 114, 178),
        RGBColor(213, 94, 0),
        RGBColor(0, 158, 115),
        RGBColor(204, 121, 167),
        RGBColor(230, 159, 0),
        RGBColor(86, 180, 233),
        RGBColor(0, 0, 0),
    ];
    PALETTE[index % PALETTE.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_scales_keep_the_data_inside() {
        let (mut xs, mut ys) = (0.0..4.0, -1.0..1.0);
        equalise(&mut xs, &mut ys, 1.0);
        assert_eq!((xs, ys), (0.0..4.0, -2.0..2.0));
    }

    #[test]
    fn labels_are_short() {
        assert_eq!(
            [label(0.25), label(3.0), label(0.0), label(1e-7)],
            ["0.25", "3", "0", "1e-7"]
        );
    }
}
