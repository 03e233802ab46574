//! The two section outlines as a plot.

use anyhow::{Context, Result};
use capsule_core::{DIAGONAL, Evaluator, Frame, MIDPLANE, Real};
use capsule_plot::{Axis, Curve, Figure, Lines, Panel};
use std::path::Path;

/// More nodes than any outline has: a mesh is limited to 65,535 nodes.
const LONGEST_OUTLINE: usize = 1024;

/// Plots both sections at these instants, in the laboratory frame; `query` is the text of the title.
pub fn plot<T: Real>(
    file: &Path,
    evaluator: &mut Evaluator<'_, T>,
    times: &[T],
    query: &str,
    length: &str,
) -> Result<()> {
    let mut section = |set: &str, title: &str, label: &str| -> Result<Panel> {
        let title = format!("{title}, {query}");
        let [x, r] = ["x", label].map(|name| Axis::linear(&format!("{name} / {length}")));
        let mut lines = Lines::new(&title, x, r).same_scale();
        for &t in times {
            lines = lines.with(Curve::line(&format!("t = {t}"), outline(evaluator, set, t)?));
        }
        Ok(Panel::Lines(lines))
    };
    let panels = vec![
        section(MIDPLANE, "Section z = 0", "y")?,
        section(DIAGONAL, "Section y = z", "sqrt(y^2 + z^2)")?,
    ];
    Figure::new(panels).save(file)?;
    Ok(())
}

/// The closed outline: front to rear on one side, back on the other.
fn outline<T: Real>(evaluator: &mut Evaluator<'_, T>, set: &str, t: T) -> Result<Vec<(f64, f64)>> {
    let mut points = [[T::ZERO; 2]; LONGEST_OUTLINE];
    let found = evaluator.at(t)?.outline(set, Frame::Laboratory, &mut points);
    let count = found.with_context(|| format!("outline `{set}` cannot be plotted"))?;
    let side = points[..count].iter().map(|&[x, r]| (x.to_f64(), r.to_f64()));
    Ok(side.clone().chain(side.rev().map(|(x, r)| (x, -r))).collect())
}
