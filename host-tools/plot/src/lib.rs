//! Figures of the studies as SVG or PNG: panels of curves or of coloured cells, in a grid.
//!
//! ```no_run
//! use capsule_plot::{Axis, Curve, Figure, Lines, Panel};
//! let decay = Curve::line("displacement", vec![(1.0, 1.0), (2.0, 0.1)]);
//! let panel = Lines::new("Decay", Axis::linear("rank"), Axis::logarithmic("1 - RIC")).with(decay);
//! Figure::new(vec![Panel::Lines(panel)]).save("decay.svg".as_ref())?;
//! # Ok::<(), capsule_plot::PlotError>(())
//! ```

mod axis;
mod cells;
mod legend;
mod lines;
mod mark;

pub use axis::Axis;
pub use cells::Cells;
pub use lines::{Curve, Lines};
pub use mark::Mark;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::{Path, PathBuf};
use std::sync::Once;

/// Width and usual height of a panel, in points, and what is around its axes.
const PANEL_SIZE: (u32, u32) = (480, 380);
const MARGIN: u32 = 10;
const TITLE: u32 = 24;
const X_LABELS: u32 = 44;
const Y_LABELS: u32 = 64;
/// Length of tick marks, and sizes of the title's text and of all other text.
const TICK: u32 = 5;
const LARGE: u32 = 16;
const SMALL: u32 = 14;
/// Pixels of a point: in a PNG, and in an SVG, whose backend writes integers only.
const FINE: u32 = 2;
const FINEST: u32 = 10;
const MAX_COLUMNS: usize = 2;
const TEXT: &str = "sans-serif";

/// Errors of drawing and writing a figure.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The file name has no known extension.
    #[error("cannot tell the format of {path}: the name must end in .svg or .png")]
    Format {
        /// The requested file.
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
        /// The requested file.
        path: PathBuf,
        /// The error of the drawing library.
        reason: String,
    },
}

/// The file format of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Vector graphics.
    Svg,
    /// Pixels.
    Png,
}

impl Format {
    /// The format by the extension of `path`: `.svg` or `.png`, in upper or lower case.
    ///
    /// # Errors
    /// [`PlotError::Format`] for another ending.
    pub fn of(path: &Path) -> Result<Self, PlotError> {
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        match ending.as_ref().and_then(|ending| ending.to_str()) {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(PlotError::Format { path: path.to_owned() }),
        }
    }
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

    /// Writes the figure in the [`Format`] of the extension of `path`.
    ///
    /// # Errors
    /// An unknown ending, a panel without finite values, or a file that cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), PlotError> {
        let failed = |reason: String| PlotError::Draw {
            path: path.to_owned(),
            reason,
        };
        match Format::of(path)? {
            Format::Svg => std::fs::write(path, self.svg()?).map_err(|error| failed(error.to_string())),
            Format::Png => {
                let layout = self.layout()?;
                let (width, height) = layout.size();
                let area = BitMapBackend::new(path, (width * FINE, height * FINE)).into_drawing_area();
                self.draw(&area, &layout, FINE)
                    .map_err(|error| failed(error.to_string()))
            }
        }
    }

    /// The figure as the text of an SVG.
    ///
    /// # Errors
    /// A panel without finite values, or one that cannot be drawn.
    pub fn svg(&self) -> Result<String, PlotError> {
        let layout = self.layout()?;
        let (width, height) = layout.size();
        let mut text = String::new();
        let area = SVGBackend::with_string(&mut text, (width * FINEST, height * FINEST)).into_drawing_area();
        self.draw(&area, &layout, FINEST).map_err(|error| PlotError::Draw {
            path: PathBuf::from("a figure"),
            reason: error.to_string(),
        })?;
        drop(area);
        let fine = format!("width=\"{}\" height=\"{}\"", width * FINEST, height * FINEST);
        Ok(text.replacen(&fine, &format!("width=\"{width}\" height=\"{height}\""), 1))
    }

    /// Checks the panels, and finds room for them.
    fn layout(&self) -> Result<Layout, PlotError> {
        register_font();
        for panel in &self.panels {
            panel.check()?;
        }
        let columns = self.panels.len().clamp(1, MAX_COLUMNS);
        let height = |row: &[Panel]| row.iter().map(Panel::height).max().unwrap_or(0);
        Ok(Layout {
            columns,
            rows: self.panels.chunks(columns).map(height).collect(),
        })
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        layout: &Layout,
        unit: u32,
    ) -> Result<(), Box<dyn std::error::Error>>
    where
        B::ErrorType: 'static,
    {
        area.fill(&WHITE)?;
        let mut rest = area.clone();
        for (row, height) in self.panels.chunks(layout.columns).zip(&layout.rows) {
            let (top, below) = rest.split_vertically(height * unit);
            rest = below;
            for (panel, area) in row.iter().zip(top.split_evenly((1, layout.columns))) {
                match panel {
                    Panel::Lines(lines) => lines.draw(&area, unit)?,
                    Panel::Cells(cells) => cells.draw(&area, unit)?,
                }
            }
        }
        area.present()?;
        Ok(())
    }
}

/// Where panels are, in points.
struct Layout {
    columns: usize,
    /// The height of each row.
    rows: Vec<u32>,
}

impl Layout {
    fn size(&self) -> (u32, u32) {
        (PANEL_SIZE.0 * self.columns as u32, self.rows.iter().sum())
    }
}

impl Panel {
    fn height(&self) -> u32 {
        match self {
            Self::Lines(lines) => lines.height(PANEL_SIZE),
            Self::Cells(_) => PANEL_SIZE.1,
        }
    }

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

fn text(size: u32, unit: u32) -> TextStyle<'static> {
    (TEXT, size * unit).into_text_style(&(0, 0))
}

/// Writes a panel's title into the middle of an area.
fn title<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    words: &str,
    unit: u32,
) -> Result<(), Box<dyn std::error::Error>>
where
    B::ErrorType: 'static,
{
    let (width, height) = area.dim_in_pixel();
    let style = text(LARGE, unit).pos(Pos::new(HPos::Center, VPos::Center));
    area.draw_text(words, &style, ((width / 2) as i32, (height / 2) as i32))?;
    Ok(())
}

/// The font is embedded, so that figures are the same on every machine.
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
        // The least value has the first colour of the scale, the greatest the last. The cells touch, as their centres
        // are one width apart.
        let [least, greatest] = [0.0, 1.0].map(|share| rectangles(&text, cells::colour(share)));
        let ([least], [greatest]) = (&least[..], &greatest[..]) else {
            panic!("one rectangle a cell: {least:?}, {greatest:?}");
        };
        let [x, y, width, height] = *least;
        let expected = [x + width, y, width, height];
        assert!(width > 0.0 && height > 0.0);
        assert!(
            expected.iter().zip(greatest).all(|(a, b)| (a - b).abs() <= 1.0),
            "{least:?}, {greatest:?}"
        );
    }

    /// Place and size `[x, y, width, height]` of the rectangles that are filled with a colour.
    fn rectangles(svg: &str, colour: RGBColor) -> Vec<[f64; 4]> {
        let RGBColor(red, green, blue) = colour;
        let fill = format!("fill=\"#{red:02X}{green:02X}{blue:02X}\"");
        let number = |line: &str, name: &str| -> f64 {
            let (_, rest) = line.split_once(&format!(" {name}=\"")).unwrap();
            rest.split('"').next().unwrap().parse().unwrap()
        };
        let filled = svg.split("<rect").skip(1).map(|rest| rest.split('>').next().unwrap());
        let filled = filled.filter(|attributes| attributes.contains(&fill));
        filled
            .map(|attributes| ["x", "y", "width", "height"].map(|name| number(attributes, name)))
            .collect()
    }

    #[test]
    fn png_has_the_size_of_its_panels() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("figure.PNG");
        figure().save(&path).unwrap();
        let bytes = std::fs::read(path).unwrap();
        let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
        assert_eq!((number(16), number(20)), (2 * FINE * PANEL_SIZE.0, FINE * PANEL_SIZE.1));
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
