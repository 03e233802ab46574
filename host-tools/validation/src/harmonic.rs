//! Zonal spherical harmonics about an axis that no mesh knows.

use nalgebra::Vector3;

/// `Y = P_n(d . r)` on the unit sphere.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Harmonic {
    degree: u32,
    axis: Vector3<f64>,
}

impl Harmonic {
    /// About an axis in no plane of symmetry.
    pub fn oblique(degree: u32) -> Self {
        Self {
            degree,
            axis: Vector3::new(0.36, 0.48, 0.8),
        }
    }

    /// The value and the surface gradient at a point of the unit sphere.
    pub fn at(&self, r: Vector3<f64>) -> (f64, Vector3<f64>) {
        let t = self.axis.dot(&r);
        // Bonnet's recursion, differentiated along.
        let (mut p, mut dp) = ([1.0, t], [0.0, 1.0]);
        for n in 1..self.degree {
            let n = f64::from(n);
            let next = ((2.0 * n + 1.0) * t * p[1] - n * p[0]) / (n + 1.0);
            let slope = ((2.0 * n + 1.0) * (p[1] + t * dp[1]) - n * dp[0]) / (n + 1.0);
            (p, dp) = ([p[1], next], [dp[1], slope]);
        }
        (p[1], dp[1] * (self.axis - t * r))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use capsule_fom::vectors::norm;

    #[test]
    fn values_and_gradients_of_degree_three() {
        let harmonic = Harmonic::oblique(3);
        let r = Vector3::new(0.6, 0.0, 0.8);
        let t = 0.36 * 0.6 + 0.8 * 0.8;
        let (value, gradient) = harmonic.at(r);
        assert!((value - 0.5 * (5.0 * t * t * t - 3.0 * t)).abs() < 1e-15);
        let slope = 0.5 * (15.0 * t * t - 3.0);
        let size = slope * (1.0 - t * t).sqrt();
        assert!((norm(gradient) - size).abs() < 1e-14 && gradient.dot(&r).abs() < 1e-15);
    }
}
