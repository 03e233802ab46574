//! Constitutive laws of the membrane: isotropic, hyperelastic sheets of surface shear modulus `G_s`.
//!
//! With the trace `tr = l1^2 + l2^2` and the squared area ratio `J^2 = (l1 l2)^2` of the principal stretches, an energy
//! `W(tr, J^2)` per stress-free area has the second Piola-Kirchhoff tension
//! `S^ab = 2 dW/dtr A^ab + 2 J^2 dW/dJ^2 a^ab`; `A^ab` and `a^ab` are the contravariant metrics of the stress-free and
//! of the current state.

use std::fmt::{Display, Formatter};
use std::str::FromStr;

use crate::FomError;

/// The law of the membrane.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum MembraneLaw {
    /// A thin sheet of an incompressible neo-Hookean material (paper, eq. 9), which softens under strain:
    /// `W = (G_s/2) (tr + J^-2 - 3)`.
    #[default]
    NeoHookean,
    /// The law of Skalak et al. (Biophys. J. 13, 1973), which hardens under strain:
    /// `W = (G_s/4) (I1^2 + 2 I1 - 2 I2 + C I2^2)` with `I1 = tr - 2` and `I2 = J^2 - 1`.
    Skalak {
        /// `C`, resistance to a change of area: the area dilatation modulus is `G_s (1 + 2 C)`.
        area: f64,
    },
}

/// The name of the neo-Hookean law.
const NEO_HOOKEAN: &str = "neo-Hookean";

impl MembraneLaw {
    /// Checks that the membrane resists a change of area, `C > -1/2`.
    ///
    /// # Errors
    /// [`FomError::Law`].
    pub fn validate(self) -> Result<(), FomError> {
        match self {
            Self::Skalak { area } if !(area > -0.5 && area.is_finite()) => Err(FomError::Law { area }),
            Self::NeoHookean | Self::Skalak { .. } => Ok(()),
        }
    }

    /// Whether it is the neo-Hookean law.
    pub fn is_neo_hookean(&self) -> bool {
        *self == Self::NeoHookean
    }

    /// The factors `f` and `g` of `square S^ab = f square A^ab - g adj(a)^ab`, over `G_s`, where the metric `a` has
    /// the `determinant` and `adj(a)^ab = determinant a^ab`. A sphere of radius `sqrt(square)` has `square A^ab` of
    /// the unit sphere.
    #[inline]
    pub fn factors(self, trace: f64, ratio: f64, square: f64, determinant: f64) -> [f64; 2] {
        match self {
            Self::NeoHookean => [1.0, square / (ratio * determinant)],
            Self::Skalak { area } => {
                let resistance = ratio * (1.0 - area * (ratio - 1.0));
                [trace - 1.0, square * resistance / determinant]
            }
        }
    }

    /// The energy per stress-free area, over `G_s`.
    #[inline]
    pub fn energy_density(self, trace: f64, ratio: f64) -> f64 {
        match self {
            Self::NeoHookean => 0.5 * (trace + 1.0 / ratio - 3.0),
            Self::Skalak { area } => {
                let [i1, i2] = [trace - 2.0, ratio - 1.0];
                0.25 * (i1 * i1 + 2.0 * i1 - 2.0 * i2 + area * i2 * i2)
            }
        }
    }

    /// The principal tensions at two principal stretches, over `G_s` (Barthes-Biesel, Diaz & Dhenin, J. Fluid Mech.
    /// 460, 2002).
    pub fn tensions(self, [l1, l2]: [f64; 2]) -> [f64; 2] {
        let along = |stretch: f64, across: f64| match self {
            Self::NeoHookean => {
                let area = l1 * l2;
                (stretch * stretch - 1.0 / (area * area)) / area
            }
            Self::Skalak { area } => {
                let [stretch_2, across_2] = [stretch * stretch, across * across];
                stretch / across * (stretch_2 - 1.0 + area * across_2 * (stretch_2 * across_2 - 1.0))
            }
        };
        [along(l1, l2), along(l2, l1)]
    }
}

impl Display for MembraneLaw {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NeoHookean => f.write_str(NEO_HOOKEAN),
            Self::Skalak { area } => write!(f, "Skalak, C = {area}"),
        }
    }
}

impl serde::Serialize for MembraneLaw {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Reads `neo-hookean` or `skalak:C`.
impl FromStr for MembraneLaw {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lower = text.to_ascii_lowercase();
        let law = match lower.strip_prefix("skalak:").map(str::parse) {
            Some(Ok(area)) => Self::Skalak { area },
            None if lower == NEO_HOOKEAN.to_ascii_lowercase() => Self::NeoHookean,
            _ => return Err("expected neo-hookean or skalak:C, such as skalak:1".to_owned()),
        };
        law.validate().map_err(|error| error.to_string())?;
        Ok(law)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) const LAWS: [MembraneLaw; 4] = [
        MembraneLaw::NeoHookean,
        MembraneLaw::Skalak { area: 1.0 },
        MembraneLaw::Skalak { area: 0.1 },
        MembraneLaw::Skalak { area: 10.0 },
    ];

    /// The pressure in a sphere of radius 1 that is inflated by `stretch`, over `G_s`.
    pub(crate) fn exact_pressure(law: MembraneLaw, stretch: f64) -> f64 {
        let square = stretch * stretch;
        let tension = match law {
            MembraneLaw::NeoHookean => 1.0 - square.powi(-3),
            MembraneLaw::Skalak { area } => square - 1.0 + area * square * (square * square - 1.0),
        };
        2.0 * tension / stretch
    }

    fn energy(law: MembraneLaw, [l1, l2]: [f64; 2]) -> f64 {
        law.energy_density(l1 * l1 + l2 * l2, (l1 * l2).powi(2))
    }

    /// `T_1 = (1/l2) dW/dl1`, and so does the tension `S^ab` of the solver.
    #[test]
    fn tensions_are_derivatives_of_the_energy() {
        let step = 1e-5;
        for law in LAWS {
            for [l1, l2] in [[1.0, 1.0], [1.3, 0.9], [0.8, 0.7], [1.6, 1.2]] {
                let [first, second] = law.tensions([l1, l2]);
                let slope = (energy(law, [l1 + step, l2]) - energy(law, [l1 - step, l2])) / (2.0 * step);
                assert!((slope / l2 - first).abs() < 1e-7, "{law}: {slope} {first}");
                let slope = (energy(law, [l1, l2 + step]) - energy(law, [l1, l2 - step])) / (2.0 * step);
                assert!((slope / l1 - second).abs() < 1e-7, "{law}: {slope} {second}");

                let ratio = (l1 * l2).powi(2);
                let [f, g] = law.factors(l1 * l1 + l2 * l2, ratio, 1.0, ratio);
                let cauchy = l1 / l2 * (f - g * l2 * l2);
                assert!((cauchy - first).abs() < 1e-12, "{law}: {cauchy} {first}");
            }
        }
    }

    /// Shear modulus `G_s` and area dilatation modulus `K_s`: 3 of the neo-Hookean law, 1 + 2 C of Skalak's.
    #[test]
    fn small_strain_has_the_moduli_of_the_law() {
        let strain = 1e-6;
        for (law, dilatation) in LAWS.into_iter().zip([3.0, 3.0, 1.2, 21.0]) {
            let [first, second] = law.tensions([1.0 + strain, 1.0 - strain]);
            assert!(((first - second) / (4.0 * strain) - 1.0).abs() < 1e-4, "{law}");
            let [first, _] = law.tensions([1.0 + strain; 2]);
            assert!((first / (2.0 * strain) - dilatation).abs() < 1e-3, "{law}: {first}");
        }
    }

    #[test]
    fn names_are_read_and_shown() {
        assert_eq!("neo-hookean".parse(), Ok(MembraneLaw::NeoHookean));
        assert_eq!("skalak:0.5".parse(), Ok(MembraneLaw::Skalak { area: 0.5 }));
        assert_eq!(MembraneLaw::Skalak { area: 1.0 }.to_string(), "Skalak, C = 1");
        for bad in ["", "skalak", "skalak:", "skalak:x", "hooke"] {
            assert!(bad.parse::<MembraneLaw>().unwrap_err().contains("skalak:C"), "{bad}");
        }
        for bad in ["skalak:-0.5", "skalak:nan", "skalak:inf"] {
            assert!(bad.parse::<MembraneLaw>().unwrap_err().contains("above -1/2"), "{bad}");
        }
    }
}
