//! Figures of the studies as SVG or PNG: panels of curves or of coloured cells, in a grid.
//!
//! ```no_run
//! use capsule_plot::{Axis, Curve, Figure, Lines, Panel};
//! let decay = Curve::line("displacement", vec![(1.0, 1.0), (2.0, 0.1)]);
//! let panel = Lines::new("Decay", Axis::linear("rank"), Axis::logarithmic("1 - RIC")).with(decay);
//! Figure::new(vec![Panel::Lines(panel)]).save("decay.svg".as_ref())?;
//! # Ok::<(), capsule_plot::PlotError>(())
//! ```

mod cells;
mod lines;

pub use cells::Cells;
pub use lines::{Axis, Curve, Lines};

use plotters::coord::Shift;
use plotters::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Once;

const PANEL_SIZE: (u32, u32) = (560, 420);
const MAX_COLUMNS: usize = 2;
const TEXT: &str = "sans-serif";

/// Why a figure was not written.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The file name does not say which format is meant.
    #[error("cannot tell the format of {path}: the name must end in .svg or .png")]
    Format {
        /// The file asked for.
        path: PathBuf,
    },
    /// The panel has nothing finite to show.
    #[error("panel \"{panel}\" has no finite value to show")]
    Empty {
        /// Title of the panel.
        panel: String,
    },
    /// Drawing or writing failed.
    #[error("could not draw {path}: {reason}")]
    Draw {
        /// The file asked for.
        path: PathBuf,
        /// What the drawing library said.
        reason: String,
    },
}

/// One part of a figure.
pub enum Panel {
    /// Curves and points over two axes.
    Lines(Lines),
    /// Coloured cells over two axes, with a colour bar.
    Cells(Cells),
}

/// Panels in a grid of at most two columns.
pub struct Figure {
    panels: Vec<Panel>,
}

impl Figure {
    /// A figure of these panels, row by row.
    pub fn new(panels: Vec<Panel>) -> Self {
        Self { panels }
    }

    /// Writes the figure; the ending of `path` (`.svg`, `.png`) chooses the format.
    ///
    /// # Errors
    /// An unknown ending, a panel without finite values, or a file that cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), PlotError> {
        let (size, rows, columns) = self.layout()?;
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("svg") => self.draw(SVGBackend::new(path, size).into_drawing_area(), rows, columns),
            Some("png") => self.draw(BitMapBackend::new(path, size).into_drawing_area(), rows, columns),
            _ => return Err(PlotError::Format { path: path.to_owned() }),
        }
        .map_err(|error| PlotError::Draw {
            path: path.to_owned(),
            reason: error.to_string(),
        })
    }

    /// The figure as the text of an SVG.
    ///
    /// # Errors
    /// A panel without finite values, or one that cannot be drawn.
    pub fn svg(&self) -> Result<String, PlotError> {
        let (size, rows, columns) = self.layout()?;
        let mut text = String::new();
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        self.draw(area, rows, columns).map_err(|error| PlotError::Draw {
            path: PathBuf::from("a figure"),
            reason: error.to_string(),
        })?;
        Ok(text)
    }

    /// Checks the panels; the size in pixels, the rows and columns.
    fn layout(&self) -> Result<((u32, u32), usize, usize), PlotError> {
        register_font();
        for panel in &self.panels {
            panel.check()?;
        }
        let columns = self.panels.len().clamp(1, MAX_COLUMNS);
        let rows = self.panels.len().div_ceil(columns).max(1);
        Ok((
            (PANEL_SIZE.0 * columns as u32, PANEL_SIZE.1 * rows as u32),
            rows,
            columns,
        ))
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: DrawingArea<B, Shift>,
        rows: usize,
        columns: usize,
    ) -> Result<(), Box<dyn std::error::Error>>
    where
        B::ErrorType: 'static,
    {
        area.fill(&WHITE)?;
        for (panel, area) in self.panels.iter().zip(area.split_evenly((rows, columns))) {
            match panel {
                Panel::Lines(lines) => lines.draw(&area)?,
                Panel::Cells(cells) => cells.draw(&area)?,
            }
        }
        area.present()?;
        Ok(())
    }
}

impl Panel {
    fn check(&self) -> Result<(), PlotError> {
        let (title, shows_something) = match self {
            Self::Lines(lines) => (lines.title(), lines.ranges().is_some()),
            Self::Cells(cells) => (cells.title(), cells.value_range().is_some()),
        };
        if shows_something {
            return Ok(());
        }
        Err(PlotError::Empty {
            panel: title.to_owned(),
        })
    }
}

/// The fonts travel with the program, so that figures are the same on machines without any.
fn register_font() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // The only failure is an unreadable font; the drawing would then say that the font is missing.
        let _ = plotters::style::register_font(TEXT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure() -> Figure {
        let curve = Curve::line("exp(-x)", (0..20).map(|i| (i as f64, (-f64::from(i)).exp())).collect());
        let dots = Curve::points("samples", vec![(3.0, 0.1), (f64::NAN, 1.0)]);
        let lines = Lines::new("Decay", Axis::linear("x"), Axis::logarithmic("y"))
            .with(curve)
            .with(dots);
        let cells = Cells::new(
            "Error",
            "Ca",
            "a/l",
            "%",
            (0.01, 0.05),
            vec![(0.1, 0.9, 0.3), (0.11, 0.9, 0.5)],
        );
        Figure::new(vec![Panel::Lines(lines), Panel::Cells(cells)])
    }

    #[test]
    fn svg_holds_the_labels_and_every_cell() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("figure.svg");
        figure().save(&path).unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        for label in ["Decay", "exp(-x)", "samples", "Error", "a/l"] {
            assert!(text.contains(label), "{label} is missing");
        }
    }

    #[test]
    fn png_has_the_size_of_its_panels() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("figure.png");
        figure().save(&path).unwrap();
        let bytes = std::fs::read(path).unwrap();
        let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
        assert_eq!((number(16), number(20)), (2 * PANEL_SIZE.0, PANEL_SIZE.1));
    }

    #[test]
    fn bad_requests_are_named() {
        assert!(matches!(
            figure().save("figure.bmp".as_ref()),
            Err(PlotError::Format { .. })
        ));
        assert!(matches!(
            figure().save("no/such/folder/figure.svg".as_ref()),
            Err(PlotError::Draw { .. })
        ));
        let empty =
            Lines::new("None", Axis::linear("x"), Axis::logarithmic("y")).with(Curve::line("", vec![(1.0, -1.0)]));
        let error = Figure::new(vec![Panel::Lines(empty)]).save("figure.svg".as_ref());
        assert!(matches!(error, Err(PlotError::Empty { panel }) if panel == "None"));
    }
}
