//! The two section outlines as a plot.

use anyhow::Result;
use capsule_core::{DIAGONAL, Evaluator, Frame, MIDPLANE};
use capsule_plot::{Axis, Curve, Figure, Lines, Panel};
use std::path::Path;

/// More nodes than any outline has: a mesh is limited to 65,536 nodes.
const LONGEST_OUTLINE: usize = 1024;

/// Plots both sections at these instants, in the laboratory frame.
pub fn plot(file: &Path, evaluator: &mut Evaluator<'_, f32>, times: &[f32], ca: f32, confinement: f32) -> Result<()> {
    let mut section = |set: &str, title: &str, label: &str| -> Result<Panel> {
        let title = format!("{title}, Ca = {ca}, a/l = {confinement}");
        let mut lines = Lines::new(&title, Axis::linear("x / l"), Axis::linear(label)).same_scale();
        for &t in times {
            lines = lines.with(Curve::line(&format!("t = {t}"), outline(evaluator, set, t)?));
        }
        Ok(Panel::Lines(lines))
    };
    let panels = vec![
        section(MIDPLANE, "Section z = 0", "y / l")?,
        section(DIAGONAL, "Section y = z", "sqrt(y^2 + z^2) / l")?,
    ];
    Figure::new(panels).save(file)?;
    Ok(())
}

/// The closed outline: front to rear on one side, back on the other.
fn outline(evaluator: &mut Evaluator<'_, f32>, set: &str, t: f32) -> Result<Vec<(f64, f64)>> {
    let mut points = [[0.0; 2]; LONGEST_OUTLINE];
    let count = evaluator.at(t)?.outline(set, Frame::Laboratory, &mut points)?;
    let side = points[..count].iter().map(|&[x, r]| (f64::from(x), f64::from(r)));
    Ok(side.clone().chain(side.rev().map(|(x, r)| (x, -r))).collect())
}
