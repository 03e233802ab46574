//! Coloured cells over two parameters (a heat map), with a colour bar.

use crate::TEXT;
use crate::lines::label;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::ops::Range;

const BAR_WIDTH: u32 = 92;

/// A panel of cells `(x, y, value)`.
pub struct Cells {
    title: String,
    x_label: String,
    y_label: String,
    unit: String,
    cell: (f64, f64),
    values: Vec<(f64, f64, f64)>,
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
        }
    }

    pub(crate) fn title(&self) -> &str {
        &self.title
    }

    fn finite(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        self.values
            .iter()
            .copied()
            .filter(|(x, y, value)| x.is_finite() && y.is_finite() && value.is_finite())
    }

    pub(crate) fn value_range(&self) -> Option<Range<f64>> {
        range(self.finite().map(|cell| cell.2))
    }

    pub(crate) fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>) -> Result<(), Box<dyn std::error::Error>>
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
        let (width, _) = area.dim_in_pixel();
        let (map, bar) = area.split_horizontally(width - BAR_WIDTH);
        let mut chart = ChartBuilder::on(&map)
            .caption(&self.title, (TEXT, 17))
            .margin(10)
            .x_label_area_size(42)
            .y_label_area_size(56)
            .build_cartesian_2d(xs.start - dx..xs.end + dx, ys.start - dy..ys.end + dy)?;
        chart
            .configure_mesh()
            .disable_mesh()
            .x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .x_label_formatter(&|value| label(*value))
            .y_label_formatter(&|value| label(*value))
            .label_style((TEXT, 13))
            .draw()?;
        chart.draw_series(self.finite().map(|(x, y, value)| {
            let corners = [(x - 0.5 * dx, y - 0.5 * dy), (x + 0.5 * dx, y + 0.5 * dy)];
            Rectangle::new(corners, colour(value, &values).filled())
        }))?;
        self.draw_bar(&bar, values)
    }

    fn draw_bar<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        values: Range<f64>,
    ) -> Result<(), Box<dyn std::error::Error>>
    where
        B::ErrorType: 'static,
    {
        const STEPS: u32 = 64;
        let shown = if values.end > values.start {
            values.clone()
        } else {
            values.start - 0.5..values.end + 0.5
        };
        let mut chart = ChartBuilder::on(area)
            .caption(&self.unit, (TEXT, 15))
            .margin(10)
            .y_label_area_size(52)
            .x_label_area_size(42)
            // Some room between the labels and the colours.
            .build_cartesian_2d(-0.3..1.0, shown.clone())?;
        chart
            .configure_mesh()
            .disable_mesh()
            .disable_x_axis()
            // The labels stand close to the bar; tick marks would run through them.
            .set_all_tick_mark_size(0)
            .y_label_formatter(&|value| label(*value))
            .label_style((TEXT, 13))
            .draw()?;
        let height = (shown.end - shown.start) / f64::from(STEPS);
        chart.draw_series((0..STEPS).map(|step| {
            let low = shown.start + f64::from(step) * height;
            Rectangle::new(
                [(0.0, low), (1.0, low + height)],
                colour(low + 0.5 * height, &shown).filled(),
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

fn colour(value: f64, values: &Range<f64>) -> RGBColor {
    let fraction = if values.end > values.start {
        (value - values.start) / (values.end - values.start)
    } else {
        0.5
    };
    ViridisRGB.get_color(fraction)
}
