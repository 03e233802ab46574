//! Settings of a build.

use capsule_core::model::wire::{Kernel, MAX_PARAMETERS, Method, Paper};
use capsule_database::{Collection, Database};
use serde::Serialize;

use crate::OfflineError;

/// The most modes that are kept: with the translation the default capacity of the core's workspace.
pub(crate) const MAX_MODES: usize = 128;

/// Settings of the offline stage; the default is what the shipped model is built with.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// A title for people.
    pub title: String,
    /// The constitutive law of the membrane.
    pub membrane_law: String,
    /// When the model is made, in seconds since 1970 (UTC). Given from outside, so that equal input gives equal bytes.
    pub created_unix_s: u32,
    /// Which configurations take part.
    pub design: Design,
    /// The domain that the model answers for, where it is sampled: least and greatest value of each parameter. Samples
    /// beyond it make its borders interior.
    pub domain: Vec<[f64; 2]>,
    /// How far beyond the largest steady Ca of their row unsteady configurations take part, if they are recorded to the
    /// end time. The first of each row halves the error near the limit up to t = 8; more add nothing,
    /// and all of them disturb t = 20.
    pub beyond: f64,
    /// Where two clusters meet, if there are two. The default is the confinement at which the initial shape changes
    /// from a sphere to an ellipsoid.
    pub split: Option<Split>,
    /// How many modes are kept.
    pub truncation: Truncation,
    /// How modes and coefficients are stored.
    pub storage: Storage,
    /// The instants that are kept, as the motion slows down: none follows another by less than this share of its time.
    /// 0 keeps all.
    pub spacing: f64,
    /// The direct method.
    pub kernel: Kernel,
    /// The paper's method.
    pub paper: Paper,
    /// The method that a reader of the model takes unless told otherwise.
    pub default_method: Method,
    /// The instants at which the leave-one-out errors are measured, as far as there are snapshots.
    pub error_times: Vec<f64>,
}

/// A value of a parameter at which the domain is split, because the solution has a kink or a jump there. The samples at
/// that value belong to both clusters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Split {
    /// The parameter's index.
    pub parameter: usize,
    /// The value.
    pub value: f64,
}

impl Split {
    /// A split between samples of a collection.
    ///
    /// # Errors
    /// [`OfflineError::SeparatesNothing`] for a value outside the parameter's range or at its ends.
    pub fn between(collection: &Collection, parameter: usize, value: f64) -> Result<Self, OfflineError> {
        /// Shares of a parameter's range that are closer than this are the same.
        const CLOSE: f64 = 1e-9;
        let range = collection.ranges()[parameter];
        let margin = CLOSE * (range[1] - range[0]);
        if range[0] + margin < value && value < range[1] - margin {
            return Ok(Self { parameter, value });
        }
        let name = collection.parameter_names[parameter].clone();
        Err(OfflineError::SeparatesNothing { name, value, range })
    }
}

/// Which configurations of a database take part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Design {
    /// All.
    All,
    /// The steady ones on the paper's grid: Ca 0.005 and 0.01 to 0.20 by 0.01; a/l 0.75 to 1.20 by 0.05.
    Paper,
}

/// How many modes are kept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Truncation {
    /// As many as bring the error of the displacement by the basis of space below a tolerance, in l (root mean square
    /// over the nodes, the samples and the instants of each span of time), and by that of the parameters below five
    /// eighths of it, but no more than the core holds.
    Tolerance(f64),
    /// As many as are asked for, like the paper.
    Ranks(Ranks),
}

/// How modes and core are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Storage {
    /// As binary32.
    Single,
    /// As integers of 16 and 8 bits with a scale for each column or row.
    Integer,
}

/// The truncation ranks, of displacement and velocity together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Ranks {
    /// Space modes, K^x, the translation included.
    pub space: usize,
    /// Parameter modes, K^c.
    pub parameter: usize,
}

impl Truncation {
    /// The ranks of the paper (section 4.5) for the velocity, 50 and 50; those for the displacement are 40 and 40.
    pub const PAPER: Truncation = Truncation::Ranks(Ranks {
        space: 50,
        parameter: 50,
    });

    /// The tolerance, if there is one.
    pub(crate) fn tolerance(self) -> Option<f64> {
        match self {
            Truncation::Tolerance(tolerance) => Some(tolerance),
            Truncation::Ranks(_) => None,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            title: "Microcapsule in a square microchannel".to_owned(),
            membrane_law: "neo-Hookean".to_owned(),
            created_unix_s: 0,
            design: Design::All,
            domain: vec![[0.005, 0.20], [0.75, 1.20]],
            beyond: 0.003,
            split: Some(Split {
                parameter: 1,
                value: 0.9,
            }),
            truncation: Truncation::Tolerance(1.2e-4),
            storage: Storage::Integer,
            spacing: 0.05,
            kernel: Kernel {
                neighbours: 12,
                scales: [1.5, 1.0, 1.0, 1.0],
            },
            paper: Paper {
                neighbours: 12,
                scales: [1.9, 1.0, 1.0, 1.0],
                radius: 1.2,
                displacement_rank: 10,
                velocity_rank: 16,
                window: 2.0,
            },
            default_method: Method::Direct,
            error_times: vec![0.02, 0.1, 0.4, 1.0, 2.0, 4.0, 8.0, 20.0],
        }
    }
}

/// Number of instants at which the errors of a model of other people's data are measured.
const ERROR_INSTANTS: usize = 32;

impl Settings {
    /// The settings for a database: the default ones, with its law.
    #[must_use]
    pub fn of_database(database: &Database) -> Self {
        Settings {
            membrane_law: database.description().membrane_law().to_owned(),
            ..Settings::default()
        }
    }

    /// The settings for other people's data: a tolerance of 1e-4 of the capsule's radius, distances in which all
    /// parameters have the same range, and one cluster.
    ///
    /// # Errors
    /// [`OfflineError::Database`] for a surface that encloses no volume.
    pub fn of_collection(collection: &Collection) -> Result<Self, OfflineError> {
        let (_, radius) = collection.reference()?;
        let domain = collection.ranges();
        // Of parameters that are scaled to the same range.
        let scales = [1.0; MAX_PARAMETERS];
        // Twice the monomials of degree two and more, as far as the core's workspace holds them.
        let (kernel, paper) = match domain.len() {
            1 => (10, 6),
            2 => (24, 12),
            3 => (32, 18),
            _ => (32, 22),
        };
        let last = collection.times.len() - 1;
        let mut instants: Vec<usize> = (1..=ERROR_INSTANTS)
            .map(|k| (k * last).div_ceil(ERROR_INSTANTS))
            .collect();
        instants.dedup();
        let standard = Settings::default();
        Ok(Settings {
            title: "Capsules from other people's data".to_owned(),
            membrane_law: "not stated".to_owned(),
            domain,
            split: None,
            truncation: Truncation::Tolerance(2e-4 * radius),
            kernel: Kernel {
                neighbours: kernel,
                scales,
            },
            paper: Paper {
                neighbours: paper,
                scales,
                ..standard.paper
            },
            error_times: instants.into_iter().map(|i| collection.times[i]).collect(),
            ..standard
        })
    }

    /// The settings for the paper's design alone. A quarter of the samples need fewer modes: three quarters of a
    /// megabyte hold a finer truncation. They lie farther apart, and more of them take part in a query.
    #[must_use]
    pub fn of_paper_design() -> Self {
        let standard = Settings::default();
        Settings {
            design: Design::Paper,
            truncation: Truncation::Tolerance(6e-5),
            kernel: Kernel {
                neighbours: 24,
                ..standard.kernel
            },
            ..standard
        }
    }

    /// Checks what the types leave open.
    pub(crate) fn validate(&self) -> Result<(), OfflineError> {
        let bad = |name, value, expected| Err(OfflineError::BadSetting { name, value, expected });
        for [low, high] in &self.domain {
            if !(low.is_finite() && low <= high && high.is_finite()) {
                return bad("domain", *low, "finite bounds, the lower one first");
            }
        }
        if !(self.beyond.is_finite() && self.beyond >= 0.0) {
            return bad("beyond", self.beyond, "a number that is not negative");
        }
        if let Some(Split { parameter, value }) = self.split
            && !(parameter < self.domain.len() && value.is_finite())
        {
            return bad("split", value, "a finite value of one of the parameters");
        }
        match self.truncation {
            Truncation::Tolerance(tolerance) => {
                if !(tolerance.is_finite() && tolerance >= 0.0) {
                    return bad("tolerance", tolerance, "a number that is not negative");
                }
            }
            Truncation::Ranks(Ranks { space, parameter }) => {
                for (name, value) in [("space rank", space), ("parameter rank", parameter)] {
                    if !(1..=MAX_MODES).contains(&value) {
                        return bad(name, value as f64, "a rank from 1 to 128");
                    }
                }
            }
        }
        let rising = self.error_times.windows(2).all(|w| w[0] < w[1]);
        if self.error_times.is_empty() || !rising {
            return bad(
                "error_times",
                self.error_times.len() as f64,
                "at least one instant, increasing",
            );
        }
        Ok(())
    }
}
