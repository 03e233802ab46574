//! How the duct is represented: length, panels, quadrature.

use super::error::FlowError;
use super::membrane_layer::MembraneQuadrature;
use super::precision::Precision;

/// How the duct is represented. The default is for production.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct DuctSettings {
    /// The walls end at `x = ± half_length` (l); the disturbance falls off like exp(-2 |x|).
    pub half_length: f64,
    /// Panels have the same length for `|x| <= uniform_half_length` (l) and grow from there to the ends.
    pub uniform_half_length: f64,
    /// Panels along `0 <= x <= uniform_half_length`.
    pub uniform_panels: usize,
    /// Panels from there to the end.
    pub growing_panels: usize,
    /// Panels across half a side of the duct.
    pub transverse_panels: usize,
    /// Gauss nodes of a panel in each direction.
    pub order: usize,
    /// Parts of panels whose centre is closer than this many of their radii are divided.
    pub wall_reach: f64,
    /// How the membrane's layer is integrated.
    pub membrane: MembraneQuadrature,
    /// The precision of the far sums.
    pub precision: Precision,
    /// Whether the wall is reduced to an eighth by the symmetry of the square, which the membrane and its load must
    /// then have. If not, there are eight times as many unknowns: a check for coarse settings.
    pub symmetric: bool,
}

impl Default for DuctSettings {
    fn default() -> Self {
        Self {
            half_length: 4.5,
            uniform_half_length: 2.0,
            uniform_panels: 5,
            growing_panels: 3,
            transverse_panels: 3,
            order: 4,
            wall_reach: 2.5,
            membrane: MembraneQuadrature::default(),
            precision: Precision::default(),
            symmetric: true,
        }
    }
}

impl DuctSettings {
    /// A quick duct for tests and trials, good to about 1 %.
    pub fn coarse() -> Self {
        Self {
            half_length: 4.0,
            uniform_half_length: 1.5,
            uniform_panels: 2,
            growing_panels: 2,
            transverse_panels: 1,
            order: 3,
            ..Self::default()
        }
    }

    /// Checks every setting.
    pub(super) fn check(&self) -> Result<(), FlowError> {
        let require = |good: bool, name, value, requirement| {
            if good {
                Ok(())
            } else {
                Err(FlowError::Setting {
                    name,
                    value,
                    requirement,
                })
            }
        };
        let whole = |name, value: usize, range: std::ops::RangeInclusive<usize>, requirement| {
            require(range.contains(&value), name, value as f64, requirement)
        };
        require(
            (2.0..=50.0).contains(&self.half_length),
            "half_length",
            self.half_length,
            "2 to 50",
        )?;
        require(
            self.uniform_half_length > 0.0 && self.uniform_half_length < self.half_length,
            "uniform_half_length",
            self.uniform_half_length,
            "positive and less than half_length",
        )?;
        whole("uniform_panels", self.uniform_panels, 1..=200, "1 to 200")?;
        whole("growing_panels", self.growing_panels, 1..=200, "1 to 200")?;
        whole("transverse_panels", self.transverse_panels, 1..=50, "1 to 50")?;
        whole("order", self.order, 2..=8, "2 to 8")?;
        require(
            (1.5..=20.0).contains(&self.wall_reach),
            "wall_reach",
            self.wall_reach,
            "1.5 to 20",
        )?;
        self.membrane.check()
    }

    /// The mean distance of neighbouring nodes (l) on the uniform panels, in the direction where it is greater.
    pub(super) fn node_spacing(&self) -> f64 {
        let axial = self.uniform_half_length / self.uniform_panels as f64;
        let transverse = 1.0 / self.transverse_panels as f64;
        axial.max(transverse) / self.order as f64
    }

    /// Panel boundaries from x = 0 to the end; the growing panels form a geometric progression that starts at the
    /// length of the uniform ones.
    pub(super) fn axial_boundaries(&self) -> Vec<f64> {
        let length = self.uniform_half_length / self.uniform_panels as f64;
        let rest = self.half_length - self.uniform_half_length;
        let total = |ratio: f64| (1..=self.growing_panels).map(|k| ratio.powi(k as i32)).sum::<f64>() * length;
        let (mut low, mut high) = (0.0, rest / length + 1.0);
        for _ in 0..100 {
            let ratio = 0.5 * (low + high);
            if total(ratio) < rest { low = ratio } else { high = ratio }
        }
        let uniform = (0..=self.uniform_panels).map(|k| k as f64 * length);
        let mut boundaries: Vec<f64> = uniform.collect();
        let mut x = self.uniform_half_length;
        let mut step = length;
        for _ in 0..self.growing_panels {
            step *= low;
            x += step;
            boundaries.push(x);
        }
        boundaries
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_grow_from_the_uniform_ones_to_the_end() {
        let x = DuctSettings::default().axial_boundaries();
        assert_eq!(x.len(), 9);
        assert_eq!(x[5], 2.0);
        assert!((x[8] - 4.5).abs() < 1e-12);
        let lengths: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let ratio = lengths[5] / lengths[4];
        assert!(ratio > 1.0 && (lengths[7] / lengths[6] - ratio).abs() < 1e-9);
    }

    #[test]
    fn each_setting_out_of_range_is_named() {
        assert_eq!(DuctSettings::default().check(), Ok(()));
        let name = |change: fn(&mut DuctSettings)| {
            let mut settings = DuctSettings::coarse();
            change(&mut settings);
            match settings.check() {
                Err(FlowError::Setting { name, .. }) => name,
                other => panic!("{other:?}"),
            }
        };
        assert_eq!(name(|s| s.half_length = f64::NAN), "half_length");
        assert_eq!(name(|s| s.uniform_half_length = 9.0), "uniform_half_length");
        assert_eq!(name(|s| s.uniform_panels = 0), "uniform_panels");
        assert_eq!(name(|s| s.order = 1), "order");
        assert_eq!(name(|s| s.wall_reach = 0.5), "wall_reach");
        assert_eq!(name(|s| s.membrane.near = f64::INFINITY), "membrane.near");
        assert_eq!(name(|s| s.membrane.duffy[1] = 0), "membrane.duffy");
    }
}
