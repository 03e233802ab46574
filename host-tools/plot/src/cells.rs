//! Coloured cells over two parameters (a heat map), with a colour bar.

use crate::axis::{Axis, Coordinate};
use crate::{MARGIN, SMALL, TICK, TITLE, X_LABELS, Y_LABELS, text, title};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::ops::Range;

/// Width of the colour bar with its labels, and of the labels.
const BAR: u32 = 84;
const BAR_LABELS: u32 = 52;

/// A panel of cells `(x, y, value)`.
pub struct Cells {
    title: String,
    x_label: String,
    y_label: String,
    unit: String,
    cell: (f64, f64),
    values: Vec<(f64, f64, f64)>,
    logarithmic: bool,
}

impl Cells {
    /// Cells of size `cell` centred at their points; values are shown in `unit`.
    pub fn new(
        title: &str,
        x_label: &str,
        y_label: &str,
        unit: &str,
        cell: (f64, f64),
        values: Vec<(f64, f64, f64)>,
    ) -> Self {
        Self {
            title: title.to_owned(),
            x_label: x_label.to_owned(),
            y_label: y_label.to_owned(),
            unit: unit.to_owned(),
            cell,
            values,
            logarithmic: false,
        }
    }

    /// Equal steps of the colour for equal ratios; values that are not positive are left out.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }

    pub(crate) fn title(&self) -> &str {
        &self.title
    }

    /// The axis of the values.
    fn axis(&self) -> Axis {
        if self.logarithmic {
            Axis::logarithmic(&self.unit)
        } else {
            Axis::linear(&self.unit)
        }
    }

    fn finite(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        self.values
            .iter()
            .copied()
            .filter(|(x, y, value)| x.is_finite() && y.is_finite() && self.axis().shows(*value))
    }

    pub(crate) fn value_range(&self) -> Option<Range<f64>> {
        range(self.finite().map(|cell| cell.2))
    }

    pub(crate) fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        unit: u32,
    ) -> Result<(), Box<dyn std::error::Error>>
    where
        B::ErrorType: 'static,
    {
        let (Some(values), Some(xs), Some(ys)) = (
            self.value_range(),
            range(self.finite().map(|cell| cell.0)),
            range(self.finite().map(|cell| cell.1)),
        ) else {
            return Ok(());
        };
        let (dx, dy) = self.cell;
        let (xs, ys) = (xs.start - dx..xs.end + dx, ys.start - dy..ys.end + dy);
        let (width, _) = area.dim_in_pixel();
        let (top, rest) = area.split_vertically((MARGIN + TITLE) * unit);
        title(&top, &self.title, unit)?;
        let (map, bar) = rest.split_horizontally(width - BAR * unit);
        let mut chart = ChartBuilder::on(&map)
            .margin(MARGIN * unit)
            .x_label_area_size(X_LABELS * unit)
            .y_label_area_size(Y_LABELS * unit)
            .build_cartesian_2d(
                Axis::linear(&self.x_label).over(xs),
                Axis::linear(&self.y_label).over(ys),
            )?;
        chart
            .configure_mesh()
            .disable_mesh()
            .x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .label_style(text(SMALL, unit))
            .axis_desc_style(text(SMALL, unit))
            .axis_style(BLACK.stroke_width(unit))
            .set_all_tick_mark_size(TICK * unit)
            .draw()?;
        // One value alone has a colour, too.
        let end = if values.end > values.start {
            values.end
        } else {
            values.start + 1.0
        };
        let scale = self.axis().over(values.start..end);
        chart.draw_series(self.finite().map(|(x, y, value)| {
            let corners = [(x - 0.5 * dx, y - 0.5 * dy), (x + 0.5 * dx, y + 0.5 * dy)];
            Rectangle::new(corners, colour(scale.share(value)).filled())
        }))?;
        self.draw_bar(&bar, unit, scale)
    }

    fn draw_bar<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        unit: u32,
        scale: Coordinate,
    ) -> Result<(), Box<dyn std::error::Error>>
    where
        B::ErrorType: 'static,
    {
        const STEPS: u32 = 64;
        let mut chart = ChartBuilder::on(area)
            .margin(MARGIN * unit)
            .margin_left(0)
            .y_label_area_size(BAR_LABELS * unit)
            .x_label_area_size(X_LABELS * unit)
            .build_cartesian_2d(0.0..1.0, scale.clone())?;
        chart
            .configure_mesh()
            .disable_mesh()
            .disable_x_axis()
            .y_desc(&self.unit)
            .label_style(text(SMALL, unit))
            .axis_desc_style(text(SMALL, unit))
            .axis_style(BLACK.stroke_width(unit))
            .set_all_tick_mark_size(TICK * unit)
            .draw()?;
        // Each covers the rest of the bar, so that no seam shows between it and the next.
        chart.draw_series((0..STEPS).map(|step| {
            let [low, middle] = [0.0, 0.5].map(|part| (f64::from(step) + part) / f64::from(STEPS));
            Rectangle::new(
                [(0.0, scale.value(low)), (1.0, scale.value(1.0))],
                colour(middle).filled(),
            )
        }))?;
        Ok(())
    }
}

fn range(values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    values.fold(None, |range: Option<Range<f64>>, value| {
        let range = range.unwrap_or(value..value);
        Some(range.start.min(value)..range.end.max(value))
    })
}

/// The colour of a share of the scale, from 0 to 1.
pub(crate) fn colour(share: f64) -> RGBColor {
    ViridisRGB.get_color(share)
}
