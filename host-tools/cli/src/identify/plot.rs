//! The plot of `capsule-rom identify`.

use capsule_identify::{Identification, MAX_HALF, Shape};
use capsule_measurement::Outline;
use capsule_plot::{Axis, Curve, Figure, Lines, Panel};

/// The contour and the fitted outline, with the dent line and the fitted section if there is one, and beside them the
/// residuals along the contour.
pub fn figure(found: &Identification, outline: &Outline, shape: &Shape, half_width_um: f64) -> Figure {
    let points = &outline.points_um;
    let closed = whole(&shape.curve);
    let placed = |points: &[[f64; 2]]| points.iter().map(|point| pair(found.frame.place_um(*point))).collect();
    let title = format!(
        "Ca = {:.4}, a = {:.3} um, {}",
        found.capillary_number.value,
        found.confinement.value * half_width_um,
        found.verdict.name()
    );
    let mut fit = Lines::new(&title, Axis::linear("x / um"), Axis::linear("y / um"))
        .same_scale()
        .with(Curve::points("contour", points.iter().copied().map(pair).collect()))
        .with(Curve::line("model", placed(&closed)));
    if !outline.dent_line_um.is_empty() {
        fit = fit
            .with(Curve::points(
                "dent line",
                outline.dent_line_um.iter().copied().map(pair).collect(),
            ))
            .with(Curve::line("model, section", placed(&whole(&shape.section))));
    }
    let along = points
        .iter()
        .enumerate()
        .map(|(i, point)| (i as f64, half_width_um * outside(&closed, found.frame.place(*point))))
        .collect();
    let residuals = Lines::new(
        "Distance from the model",
        Axis::linear("point"),
        Axis::linear("residual / um"),
    )
    .with(Curve::points("", along));
    Figure::new(vec![Panel::Lines(fit), Panel::Lines(residuals)])
}

fn pair([x, y]: [f64; 2]) -> (f64, f64) {
    (x, y)
}

/// Half a curve and its mirror image, in steps as fine as a plot shows.
fn whole(half: &capsule_identify::Curve) -> Vec<[f64; 2]> {
    const STEPS: usize = 8 * MAX_HALF;
    let half: Vec<[f64; 2]> = (0..=STEPS).map(|i| half.position(i as f64 / STEPS as f64)).collect();
    let mirrored = half.iter().rev().map(|[x, y]| [*x, -y]);
    half.iter().copied().chain(mirrored).collect()
}

/// Distance of a point from a closed curve that runs from the front over positive y to the rear and back: positive
/// outside.
fn outside(closed: &[[f64; 2]], [x, y]: [f64; 2]) -> f64 {
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_are_positive_outside() {
        let circle: Vec<[f64; 2]> = (0..=400)
            .map(|i| (f64::from(i) * std::f64::consts::TAU / 400.0).sin_cos())
            .map(|(sin, cos)| [cos, sin])
            .collect();
        for angle in [0.3_f64, 2.0, 4.0, 5.5] {
            for radius in [0.9, 1.2] {
                let found = outside(&circle, [radius * angle.cos(), radius * angle.sin()]);
                assert!((found - (radius - 1.0)).abs() < 1e-3, "{found}");
            }
        }
    }
}
