//! Curves and points over linear or logarithmic axes.

use crate::axis::Axis;
use crate::legend::{Entry, Legend};
use crate::mark::Mark;
use crate::{MARGIN, SMALL, TICK, TITLE, X_LABELS, Y_LABELS, text, title};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::ops::Range;

/// A named series of points. Series of one name have one colour and one entry in the legend.
pub struct Curve {
    name: String,
    points: Vec<(f64, f64)>,
    mark: Mark,
}

impl Curve {
    /// A series.
    pub fn new(name: &str, mark: Mark, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.to_owned(),
            points,
            mark,
        }
    }

    /// Points joined by straight lines.
    pub fn line(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, Mark::Line, points)
    }

    /// Points as dots.
    pub fn points(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, Mark::Dots, points)
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

/// The least height of the axes of a flat shape.
const MIN: u32 = 60;
/// With more dots than this in a panel, they are smaller.
const MANY: usize = 100;

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

    /// The height that this panel wants at a width, in points of the drawing: less than the usual for shapes that are
    /// long.
    pub(crate) fn height(&self, (width, usual): (u32, u32)) -> u32 {
        let Some((xs, ys)) = self.ranges().filter(|_| self.same_scale) else {
            return usual;
        };
        let (xs, ys) = (self.x.with_margin(xs), self.y.with_margin(ys));
        let around = MARGIN + TITLE + self.legend(width).height() + X_LABELS + MARGIN;
        let inside = f64::from(width - 3 * MARGIN - Y_LABELS) * (ys.end - ys.start) / (xs.end - xs.start);
        // Room for the axis' description beside a flat shape.
        (around + (inside as u32).max(MIN)).min(usual)
    }

    /// Names of the curves, each once, in the order of their colours.
    fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for curve in &self.curves {
            if !names.contains(&curve.name.as_str()) {
                names.push(&curve.name);
            }
        }
        names
    }

    fn legend(&self, width: u32) -> Legend {
        let entry = |(index, name): (usize, &str)| {
            let of_name = self.curves.iter().filter(|curve| curve.name == name);
            Entry {
                name: name.to_owned(),
                colour: colour(index),
                marks: of_name.map(|curve| curve.mark).collect(),
            }
        };
        let names = self.names();
        let named = names.into_iter().enumerate().filter(|(_, name)| !name.is_empty());
        Legend::new(named.map(entry).collect(), width)
    }

    pub(crate) fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        unit: u32,
    ) -> Result<(), Box<dyn std::error::Error>>
    where
        B::ErrorType: 'static,
    {
        let Some((xs, ys)) = self.ranges() else { return Ok(()) };
        let (mut xs, mut ys) = (self.x.with_margin(xs), self.y.with_margin(ys));
        let (width, height) = area.dim_in_pixel();
        let (top, rest) = area.split_vertically((MARGIN + TITLE) * unit);
        title(&top, &self.title, unit)?;
        let legend = self.legend(width / unit);
        let (middle, chart) = rest.split_vertically(legend.height() * unit);
        legend.draw(&middle, unit)?;
        if self.same_scale {
            let width = f64::from(width / unit - 3 * MARGIN - Y_LABELS);
            let height = f64::from(height / unit - 2 * MARGIN - TITLE - legend.height() - X_LABELS);
            equalise(&mut xs, &mut ys, width / height);
        }
        let mut chart = ChartBuilder::on(&chart)
            .margin_left(MARGIN * unit)
            // Half of a tick's label may lie beyond the axis.
            .margin_right(2 * MARGIN * unit)
            .margin_bottom(MARGIN * unit)
            .x_label_area_size(X_LABELS * unit)
            .y_label_area_size(Y_LABELS * unit)
            .build_cartesian_2d(self.x.over(xs), self.y.over(ys))?;
        chart
            .configure_mesh()
            .x_desc(self.x.label())
            .y_desc(self.y.label())
            .label_style(text(SMALL, unit))
            .axis_desc_style(text(SMALL, unit))
            .axis_style(BLACK.stroke_width(unit))
            .set_all_tick_mark_size(TICK * unit)
            .light_line_style(TRANSPARENT)
            .bold_line_style(BLACK.mix(0.12).stroke_width(unit))
            .draw()?;
        let names = self.names();
        let dots: usize = self
            .curves
            .iter()
            .filter(|c| c.mark == Mark::Dots)
            .map(|c| c.points.len())
            .sum();
        let radius = if dots > MANY { 2 } else { 3 } * unit;
        for curve in &self.curves {
            let index = names.iter().position(|name| *name == curve.name).unwrap_or(0);
            let colour = colour(index);
            let points = self.visible(curve);
            match curve.mark {
                Mark::Line => chart.draw_series(LineSeries::new(points, colour.stroke_width(2 * unit)))?,
                Mark::Dots => chart.draw_series(points.map(|at| Circle::new(at, radius, colour.filled())))?,
                Mark::Rings => {
                    chart.draw_series(points.map(|at| Circle::new(at, 2 * radius, colour.stroke_width(2 * unit))))?
                }
            };
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

/// Okabe and Ito's palette, distinct for colour-blind readers, and three more colours for panels with many series.
fn colour(index: usize) -> RGBColor {
    const PALETTE: [RGBColor; 10] = [
        RGBColor(0, 114, 178),
        RGBColor(213, 94, 0),
        RGBColor(0, 158, 115),
        RGBColor(204, 121, 167),
        RGBColor(230, 159, 0),
        RGBColor(86, 180, 233),
        RGBColor(0, 0, 0),
        RGBColor(140, 86, 75),
        RGBColor(127, 127, 127),
        RGBColor(200, 30, 60),
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
}
