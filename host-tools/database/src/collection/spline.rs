//! Velocities from positions: the derivative of the cubic spline through the snapshots.

/// The derivative at the instants of the cubic spline through values there, with the not-a-knot condition at both ends
/// (de Boor, A Practical Guide to Splines, chapter IV): exact for cubics; for a smooth motion the error is at most
/// h^3 / 24 times its fourth derivative, h the longest interval. Through three instants a parabola, through two a line.
pub(crate) struct Derivative {
    intervals: Vec<f64>,
    /// Below, on and above the diagonal of the system for the slopes.
    rows: Vec<[f64; 3]>,
}

impl Derivative {
    /// The derivative on rising instants, at least two.
    pub(crate) fn new(times: &[f64]) -> Self {
        let h: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let last = h.len() - 1;
        let inner = (1..h.len()).map(|i| [h[i], 2.0 * (h[i - 1] + h[i]), h[i - 1]]);
        let first = if last > 0 {
            [0.0, h[1], h[0] + h[1]]
        } else {
            [0.0, 1.0, 0.0]
        };
        let end = if last > 0 {
            [h[last] + h[last - 1], h[last - 1], 0.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        let rows = std::iter::once(first)
            .chain(inner)
            .chain(std::iter::once(end))
            .collect();
        Self { intervals: h, rows }
    }

    /// The velocities `[N_t][N_x]` of positions `[N_t][N_x]`.
    pub(crate) fn of(&self, positions: &[Vec<[f64; 3]>]) -> Vec<Vec<[f64; 3]>> {
        let mut velocities = vec![vec![[0.0; 3]; positions[0].len()]; positions.len()];
        let mut values = vec![0.0; positions.len()];
        for node in 0..positions[0].len() {
            for d in 0..3 {
                for (value, field) in values.iter_mut().zip(positions) {
                    *value = field[node][d];
                }
                for (velocity, slope) in velocities.iter_mut().zip(self.slopes(&values)) {
                    velocity[node][d] = slope;
                }
            }
        }
        velocities
    }

    fn slopes(&self, values: &[f64]) -> Vec<f64> {
        let h = &self.intervals;
        let chord: Vec<f64> = (0..h.len()).map(|i| (values[i + 1] - values[i]) / h[i]).collect();
        let n = values.len();
        if n == 2 {
            return vec![chord[0]; 2];
        }
        if n == 3 {
            let curvature = (chord[1] - chord[0]) / (h[0] + h[1]);
            return vec![
                chord[0] - h[0] * curvature,
                chord[0] + h[0] * curvature,
                chord[1] + h[1] * curvature,
            ];
        }
        let end = |near: usize, next: usize| {
            let (a, b) = (h[near], h[next]);
            ((a + 2.0 * (a + b)) * b * chord[near] + a * a * chord[next]) / (a + b)
        };
        let mut slopes = vec![0.0; n];
        slopes[0] = end(0, 1);
        slopes[n - 1] = end(n - 2, n - 3);
        for i in 1..n - 1 {
            slopes[i] = 3.0 * (h[i] * chord[i - 1] + h[i - 1] * chord[i]);
        }
        // Elimination downwards without pivots: the second pivot is h_0 + h_1, all others are dominant.
        let mut pivots = vec![self.rows[0][1]; n];
        for i in 1..n {
            let factor = self.rows[i][0] / pivots[i - 1];
            pivots[i] = self.rows[i][1] - factor * self.rows[i - 1][2];
            slopes[i] -= factor * slopes[i - 1];
        }
        slopes[n - 1] /= pivots[n - 1];
        for i in (0..n - 1).rev() {
            slopes[i] = (slopes[i] - self.rows[i][2] * slopes[i + 1]) / pivots[i];
        }
        slopes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Greatest error of the derivative at the instants.
    fn error(times: &[f64], f: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> f64 {
        let positions: Vec<_> = times.iter().map(|t| vec![[f(*t), 0.0, -f(*t)]]).collect();
        let found = Derivative::new(times).of(&positions);
        let of = |(v, t): (&Vec<[f64; 3]>, &f64)| (v[0][0] - slope(*t)).abs().max((v[0][2] + slope(*t)).abs());
        found.iter().zip(times).map(of).fold(0.0, f64::max)
    }

    #[test]
    fn polynomials_up_to_the_degree_are_exact() {
        let times = [0.0, 0.1, 0.3, 0.35, 0.8, 1.0];
        for n in 2..=6 {
            let degree = (n as i32 - 1).min(3);
            let found = error(
                &times[..n],
                |t| 1.0 + t.powi(degree),
                |t| f64::from(degree) * t.powi(degree - 1),
            );
            assert!(found < 1e-12, "{n} {found:e}");
        }
    }

    #[test]
    fn a_smooth_motion_is_within_the_bound() {
        for n in [10, 20, 40] {
            let h = 2.0 / f64::from(n);
            let times: Vec<f64> = (0..=n).map(|i| h * f64::from(i)).collect();
            // The not-a-knot ends are less accurate than the bound's clamped spline: a factor of ten.
            let found = error(&times, |t| (2.0 * t).sin(), |t| 2.0 * (2.0 * t).cos());
            assert!(found < 10.0 * h.powi(3) / 24.0 * 16.0, "{n} {found:e}");
        }
    }
}
