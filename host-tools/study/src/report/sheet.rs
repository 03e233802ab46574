//! Sections of figures and tables of the report, and the files with their numbers.

use std::path::{Path, PathBuf};

use capsule_database::table;
use capsule_plot::{Axis, Curve, Figure, Lines, Mark, Panel};

use crate::StudyError;

/// A part of the page.
pub(super) struct Section {
    pub(super) title: String,
    pub(super) text: String,
    pub(super) figures: Vec<Drawing>,
    pub(super) tables: Vec<Table>,
}

/// A figure of the page.
pub(super) struct Drawing {
    pub(super) caption: String,
    pub(super) svg: String,
    pub(super) data: String,
}

/// A table of the page.
pub(super) struct Table {
    pub(super) heading: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
    pub(super) data: String,
}

impl Section {
    pub(super) fn new(title: &str, text: &str) -> Self {
        Section {
            title: title.to_owned(),
            text: text.to_owned(),
            figures: Vec::new(),
            tables: Vec::new(),
        }
    }

    /// Adds a panel whose numbers are in a file that is there already.
    pub(super) fn panel(&mut self, panel: Panel, caption: &str, data: &str) -> Result<(), StudyError> {
        self.figures.push(Drawing {
            caption: caption.to_owned(),
            svg: Figure::new(vec![panel]).svg()?,
            data: data.to_owned(),
        });
        Ok(())
    }

    /// Adds curves, and writes their points.
    pub(super) fn curves(
        &mut self,
        sheet: &mut Sheet,
        file: &str,
        caption: &str,
        curves: Curves,
    ) -> Result<(), StudyError> {
        let rows = curves.series.iter().flat_map(|(name, _, points)| {
            points
                .iter()
                .map(|(x, y)| vec![name.clone(), x.to_string(), y.to_string()])
        });
        sheet.csv(file, &["series", "x", "y"], rows)?;
        self.panel(curves.panel(), caption, file)
    }

    /// Adds a table, and writes it.
    pub(super) fn table(
        &mut self,
        sheet: &mut Sheet,
        file: &str,
        heading: &[&str],
        rows: Vec<Vec<String>>,
    ) -> Result<(), StudyError> {
        sheet.csv(file, heading, rows.iter().cloned())?;
        self.tables.push(Table {
            heading: heading.iter().map(ToString::to_string).collect(),
            rows,
            data: file.to_owned(),
        });
        Ok(())
    }
}

/// A series: its name, the mark of its points, and the points.
pub(super) type Series = (String, Mark, Vec<(f64, f64)>);

/// Curves over two axes.
pub(super) struct Curves {
    pub(super) title: String,
    pub(super) axes: [Axis; 2],
    pub(super) same_scale: bool,
    pub(super) series: Vec<Series>,
}

impl Curves {
    pub(super) fn panel(self) -> Panel {
        let [x, y] = self.axes;
        let mut lines = Lines::new(&self.title, x, y);
        if self.same_scale {
            lines = lines.same_scale();
        }
        let series = self.series.into_iter();
        Panel::Lines(series.fold(lines, |lines, (name, mark, points)| {
            lines.with(Curve::new(&name, mark, points))
        }))
    }
}

/// The folder of the page.
pub(super) struct Sheet {
    folder: PathBuf,
}

impl Sheet {
    pub(super) fn new(folder: &Path) -> Self {
        Sheet {
            folder: folder.to_owned(),
        }
    }

    /// Writes rows under a heading.
    pub(super) fn csv(
        &mut self,
        file: &str,
        heading: &[&str],
        rows: impl Iterator<Item = Vec<String>>,
    ) -> Result<(), StudyError> {
        let path = self.folder.join(file);
        let text = table::csv(None, heading, rows)?;
        std::fs::write(&path, text).map_err(|source| StudyError::Write { path, source })
    }
}
