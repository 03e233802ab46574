//! The plot of `capsule-rom identify`.

use capsule_identify::Identification;
use capsule_plot::{Axis, Curve, Figure, Lines, Panel};

/// The contour and the fitted outline, and beside them the residuals along the contour.
pub fn figure(found: &Identification, points: &[[f64; 2]], curve: &[[f64; 2]], half_width_um: f64) -> Figure {
    let mirrored = curve.iter().rev().map(|[x, y]| [*x, -y]);
    let closed: Vec<[f64; 2]> = curve
        .iter()
        .copied()
        .chain(mirrored)
        .map(|p| found.frame.place_um(p))
        .collect();
    let pair = |[x, y]: [f64; 2]| (x, y);
    let residual = |[x, y]: [f64; 2]| {
        let nearest = closed.windows(2).map(|ends| {
            let ([p, q], [r, s]) = (ends[0], ends[1]);
            let (u, v) = (r - p, s - q);
            let share = (((x - p) * u + (y - q) * v) / (u * u + v * v).max(1e-300)).clamp(0.0, 1.0);
            let distance = (x - p - share * u).hypot(y - q - share * v);
            (distance, (x - p) * v - (y - q) * u)
        });
        let (distance, side) = nearest.fold(
            (f64::INFINITY, 0.0),
            |best, next| if next.0 < best.0 { next } else { best },
        );
        distance * if side < 0.0 { -1.0 } else { 1.0 }
    };
    let title = format!(
        "Ca = {:.4}, a = {:.3} um, {}",
        found.capillary_number.value,
        found.confinement.value * half_width_um,
        found.verdict.name()
    );
    let outline = Lines::new(&title, Axis::linear("x / um"), Axis::linear("y / um"))
        .same_scale()
        .with(Curve::points("contour", points.iter().copied().map(pair).collect()))
        .with(Curve::line("model", closed.iter().copied().map(pair).collect()));
    let along = points
        .iter()
        .enumerate()
        .map(|(i, point)| (i as f64, residual(*point)))
        .collect();
    let residuals = Lines::new(
        "Distance from the model",
        Axis::linear("point"),
        Axis::linear("residual / um"),
    )
    .with(Curve::points("", along));
    Figure::new(vec![Panel::Lines(outline), Panel::Lines(residuals)])
}
