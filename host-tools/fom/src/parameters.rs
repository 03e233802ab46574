//! Parameters of a run: the physical configuration and the solver's settings.

use crate::flow::DuctSettings;
use crate::{FomError, MembraneLaw};

/// The two parameters of the problem.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Configuration {
    /// Capillary number `Ca = mu V / G_s`.
    pub capillary_number: f64,
    /// Confinement `a/l`: radius of the stress-free capsule over half the channel's side.
    pub confinement: f64,
}

/// A time integrator with its accuracy.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// Forward Euler (first of the paper's schemes).
    ForwardEuler {
        /// Fixed step (l/V).
        step: f64,
    },
    /// Ralston's second-order Runge-Kutta scheme (the paper's second).
    Ralston {
        /// Fixed step (l/V).
        step: f64,
    },
    /// Stabilised second-order Runge-Kutta-Chebyshev with error control.
    Rkc2 {
        /// Error of a position allowed a step (l).
        tolerance: f64,
    },
}

/// How the membrane is discretised.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MembraneDiscretisation {
    /// Spherical harmonics on the reference sphere ([`crate::harmonic_membrane`]).
    Harmonics {
        /// Their greatest degree; by default three times the mesh frequency.
        degree: Option<usize>,
        /// Bending stiffness over `G_s a²`; 0 for a membrane without, as the paper's.
        bending: f64,
    },
    /// The paper's six-node elements ([`crate::membrane`]).
    QuadraticElements,
}

/// When a shape counts as steady.
///
/// A run is steady from the first snapshot after which, to its end, the residual (the greatest normal velocity in
/// the frame of the centroid) and the rate of elongation stay below their bounds.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct SteadyCriteria {
    /// Bound on the residual (V).
    pub normal_velocity: f64,
    /// Bound on the rate of the axial length (V).
    pub length_rate: f64,
    /// A steady run continues until a rigid motion with its last velocity to the end time would be wrong by less than
    /// this (a), in place and in shape, by an estimate from the velocities of the last l/V.
    pub motion: f64,
    /// Nor does it end before this time (l/V): a buckle grows from round-off, out of a shape that seems steady.
    pub earliest_end: f64,
}

/// The solver's settings. The default is for production.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Settings {
    /// Mesh frequency `n`: 8 n² elements, 16 n² + 2 nodes.
    pub mesh_frequency: usize,
    /// Law of the membrane. Not recorded where it is the neo-Hookean one: databases of that law have no such entry.
    #[serde(skip_serializing_if = "MembraneLaw::is_neo_hookean")]
    pub law: MembraneLaw,
    /// Discretisation of the membrane on this mesh.
    pub membrane: MembraneDiscretisation,
    /// Time integrator.
    pub integrator: Integrator,
    /// Last instant (l/V).
    pub end_time: f64,
    /// Time between snapshots (l/V); near the start there are more.
    pub snapshot_interval: f64,
    /// Whether velocities are evaluated in an eighth of the channel and mirrored. If not, [`DuctSettings::symmetric`]
    /// is ignored: the walls are not reduced either.
    pub symmetric: bool,
    /// The duct.
    pub duct: DuctSettings,
    /// When to stop.
    pub steady: SteadyCriteria,
}

impl Default for Integrator {
    fn default() -> Self {
        Self::Rkc2 { tolerance: 1e-5 }
    }
}

impl MembraneDiscretisation {
    /// The smallest bending stiffness of a half decade series (over `G_s a²`) with which shapes converge where the
    /// membrane is compressed. Without any the wavelength of its buckles is that of the discretisation.
    pub const BENDING: f64 = 1e-4;
}

impl Default for MembraneDiscretisation {
    fn default() -> Self {
        Self::Harmonics {
            degree: None,
            bending: Self::BENDING,
        }
    }
}

impl Default for SteadyCriteria {
    fn default() -> Self {
        Self {
            normal_velocity: 1e-3,
            length_rate: 1e-3,
            motion: 2e-4,
            earliest_end: 4.0,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            mesh_frequency: 8,
            law: MembraneLaw::default(),
            membrane: MembraneDiscretisation::default(),
            integrator: Integrator::default(),
            end_time: 20.0,
            snapshot_interval: 0.2,
            symmetric: true,
            duct: DuctSettings::default(),
            steady: SteadyCriteria::default(),
        }
    }
}

impl Configuration {
    /// Checks that both parameters are positive numbers.
    ///
    /// # Errors
    /// [`FomError::NotPositive`] with the parameter's name.
    pub fn validate(&self) -> Result<(), FomError> {
        positive("capillary number Ca", self.capillary_number)?;
        positive("confinement a/l", self.confinement)
    }
}

impl Integrator {
    /// Checks that step or tolerance are positive numbers.
    ///
    /// # Errors
    /// [`FomError::NotPositive`].
    pub fn validate(&self) -> Result<(), FomError> {
        match *self {
            Self::ForwardEuler { step } | Self::Ralston { step } => positive("time step", step),
            Self::Rkc2 { tolerance } => positive("tolerance of the time integrator", tolerance),
        }
    }
}

impl Settings {
    /// Checks all but the mesh and the duct, which check themselves.
    ///
    /// # Errors
    /// [`FomError::NotPositive`] with the setting's name; [`FomError::TooManySnapshots`].
    pub fn validate(&self) -> Result<(), FomError> {
        self.integrator.validate()?;
        if let MembraneDiscretisation::Harmonics { bending, .. } = self.membrane {
            // 0 is none.
            positive("bending stiffness", if bending == 0.0 { 1.0 } else { bending })?;
        }
        positive("end time", self.end_time)?;
        positive("snapshot interval", self.snapshot_interval)?;
        snapshots(self.end_time, self.snapshot_interval)?;
        positive("steady bound on the normal velocity", self.steady.normal_velocity)?;
        positive("steady bound on the length rate", self.steady.length_rate)?;
        positive("earliest end of a steady run", self.steady.earliest_end)?;
        positive("steady bound on the motion to come", self.steady.motion)
    }

    /// The instants of the snapshots (l/V).
    pub fn snapshot_times(&self) -> Vec<f64> {
        snapshot_times(self.snapshot_interval, self.end_time)
    }
}

/// Instants of additional snapshots (l/V): at low Ca the start is over long before the first regular one.
const EARLY: [f64; 9] = [0.005, 0.01, 0.02, 0.035, 0.05, 0.075, 0.1, 0.15, 0.3];

/// The instants of the snapshots: multiples of `interval` from 0, the early ones, and `end_time`.
fn snapshot_times(interval: f64, end_time: f64) -> Vec<f64> {
    let regular = (0..).map(|i| f64::from(i) * interval);
    let mut times: Vec<f64> = regular.take_while(|&t| t < end_time).collect();
    times.extend(EARLY.iter().filter(|&&t| t < end_time));
    times.push(end_time);
    times.sort_by(f64::total_cmp);
    // An instant that rounding doubles is kept once.
    times.dedup_by(|next, last| *next - *last < 1e-6 * interval);
    times
}

/// A positive, finite number or an error with its name.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), FomError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(FomError::NotPositive { name, value })
    }
}

/// The greatest number of snapshots of a run: they are kept in memory.
pub(crate) const MAX_SNAPSHOTS: f64 = 10_000.0;

/// Checks that the snapshots up to `end_time` are not too many to keep.
pub(crate) fn snapshots(end_time: f64, interval: f64) -> Result<(), FomError> {
    if end_time / interval <= MAX_SNAPSHOTS {
        Ok(())
    } else {
        Err(FomError::TooManySnapshots { end_time, interval })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snapshots_are_dense_at_the_start_and_regular_later() {
        let times = Settings::default().snapshot_times();
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((times[0], times.last()), (0.0, Some(&20.0)));
        assert_eq!(times.len(), 101 + EARLY.len());
        assert_eq!(
            snapshot_times(0.3, 0.8),
            [0.0, 0.005, 0.01, 0.02, 0.035, 0.05, 0.075, 0.1, 0.15, 0.3, 0.6, 0.8]
        );
    }

    #[test]
    fn bad_parameters_are_named() {
        for bad in [0.0, -0.1, f64::NAN, f64::INFINITY] {
            let error = Configuration {
                capillary_number: bad,
                confinement: 0.9,
            }
            .validate()
            .unwrap_err();
            assert!(error.to_string().contains("capillary number"), "{error}");
            let error = Configuration {
                capillary_number: 0.1,
                confinement: bad,
            }
            .validate()
            .unwrap_err();
            assert!(error.to_string().contains("confinement"), "{error}");
            let settings = Settings {
                integrator: Integrator::Ralston { step: bad },
                ..Settings::default()
            };
            assert!(settings.validate().unwrap_err().to_string().contains("time step"));
            assert!(
                Settings {
                    snapshot_interval: bad,
                    ..Settings::default()
                }
                .validate()
                .is_err()
            );
        }
        let dense = Settings {
            snapshot_interval: 1e-9,
            ..Settings::default()
        };
        assert!(matches!(dense.validate(), Err(FomError::TooManySnapshots { .. })));
        assert!(Settings::default().validate().is_ok());
    }
}
