//! One configuration in memory: position and velocity of every node at each stored instant.

use serde::{Deserialize, Serialize};

use crate::error::{finite, length};
use crate::{DatabaseError, Mesh};

/// How the simulation of a configuration ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The shape became steady.
    Steady {
        /// When, in l/V.
        time: f64,
    },
    /// The shape still changed at the end time.
    Unsteady,
    /// The simulation gave up.
    Stopped {
        /// When, in l/V.
        time: f64,
        /// Why.
        reason: String,
    },
}

impl Status {
    /// The status in one word: "steady", "unsteady" or "stopped".
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Status::Steady { .. } => "steady",
            Status::Unsteady => "unsteady",
            Status::Stopped { .. } => "stopped",
        }
    }

    /// Whether the shape became steady.
    #[must_use]
    pub fn is_steady(&self) -> bool {
        matches!(self, Status::Steady { .. })
    }
}

/// The snapshots of one configuration, at all nodes, in the laboratory frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// The configuration, in the order of the database's parameters: (Ca, a/l).
    pub parameters: Vec<f64>,
    /// How the simulation ended.
    pub status: Status,
    /// The instants, from 0 upwards.
    pub times: Vec<f64>,
    /// Node positions at each instant, `[N_t][N_x]`.
    pub positions: Vec<Vec<[f64; 3]>>,
    /// Node velocities at each instant, `[N_t][N_x]`.
    pub velocities: Vec<Vec<[f64; 3]>>,
    /// Axial position of the volume centroid at each instant.
    pub centroid: Vec<f64>,
    /// Additional pressure drop at each instant, in mu V/l.
    pub pressure_drop: Vec<f64>,
}

/// Instants closer than this (l/V) are the same.
pub(crate) const SAME_TIME: f64 = 1e-9;

impl Trajectory {
    /// Checks that the instants increase, that all arrays have one entry an instant and one value a node, and that
    /// every number is finite.
    ///
    /// # Errors
    /// The first error found, with the name of the array.
    pub fn validate(&self, nodes: usize) -> Result<(), DatabaseError> {
        finite("parameters", &self.parameters)?;
        finite("times", &self.times)?;
        finite("centroid", &self.centroid)?;
        finite("pressure_drop", &self.pressure_drop)?;
        let instants = self.times.len();
        length("instants of positions", instants, self.positions.len())?;
        length("instants of velocities", instants, self.velocities.len())?;
        length("instants of centroid", instants, self.centroid.len())?;
        length("instants of pressure_drop", instants, self.pressure_drop.len())?;
        for (name, fields) in [("positions", &self.positions), ("velocities", &self.velocities)] {
            for (i, field) in fields.iter().enumerate() {
                length(&format!("nodes of {name} at instant {i}"), nodes, field.len())?;
                finite(&format!("{name} at instant {i}"), field.as_flattened())?;
            }
        }
        let mut previous = 0.0;
        for (index, &value) in self.times.iter().enumerate() {
            if (index == 0 && value.abs() > SAME_TIME) || (index > 0 && value <= previous) {
                return Err(DatabaseError::TimesNotIncreasing { index, value, previous });
            }
            previous = value;
        }
        Ok(())
    }

    /// The trajectory at `times`: the stored snapshots, and beyond the last one a rigid translation at the end velocity
    /// of the centroid, which is the motion of a steady capsule.
    ///
    /// # Errors
    /// [`DatabaseError::NoSnapshot`] for an instant that was not stored, or that lies beyond the end of a trajectory
    /// that is not steady; [`DatabaseError::WrongLength`] when the snapshots do not fit the mesh.
    pub fn extended(&self, mesh: &Mesh, times: &[f64]) -> Result<Trajectory, DatabaseError> {
        self.validate(mesh.nodes.len())?;
        let end = self.times.last().copied().unwrap_or(0.0);
        let missing = |time| DatabaseError::NoSnapshot {
            time,
            end,
            status: self.status.name(),
        };
        let mut extended = Trajectory {
            parameters: self.parameters.clone(),
            status: self.status.clone(),
            times: times.to_vec(),
            positions: Vec::with_capacity(times.len()),
            velocities: Vec::with_capacity(times.len()),
            centroid: Vec::with_capacity(times.len()),
            pressure_drop: Vec::with_capacity(times.len()),
        };
        let Some(last) = self.times.len().checked_sub(1) else {
            return times.first().map_or(Ok(extended), |t| Err(missing(*t)));
        };
        let velocity = mesh.centroid_velocity(&self.positions[last], &self.velocities[last])?;
        for &time in times {
            if time <= end + SAME_TIME {
                let i = self.times.partition_point(|t| *t < time - SAME_TIME);
                if i > last || (self.times[i] - time).abs() > SAME_TIME {
                    return Err(missing(time));
                }
                extended.positions.push(self.positions[i].clone());
                extended.velocities.push(self.velocities[i].clone());
                extended.centroid.push(self.centroid[i]);
                extended.pressure_drop.push(self.pressure_drop[i]);
            } else if self.status.is_steady() {
                let shift = velocity * (time - end);
                extended.positions.push(
                    self.positions[last]
                        .iter()
                        .map(|[x, y, z]| [x + shift, *y, *z])
                        .collect(),
                );
                extended.velocities.push(vec![[velocity, 0.0, 0.0]; mesh.nodes.len()]);
                extended.centroid.push(self.centroid[last] + shift);
                extended.pressure_drop.push(self.pressure_drop[last]);
            } else {
                return Err(missing(time));
            }
        }
        Ok(extended)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::mesh::tests::octahedral;

    /// A capsule that relaxes towards an ellipsoid while it travels, in closed form, at `times`.
    pub(crate) fn relaxing(mesh: &Mesh, times: &[f64]) -> Trajectory {
        let at = |t: f64| {
            let (e, de) = ((-1.5 * t).exp(), -1.5 * (-1.5 * t).exp());
            // Positions X = (s x + U(t), y / s', z / s'), with the square's symmetry through y^2 z^2.
            let centroid = 1.3 * t + 0.1 * (1.0 - e);
            let velocity = 1.3 - 0.1 * de;
            let place = |[x, y, z]: &[f64; 3]| {
                let w = 1.0 + 0.2 * (1.0 - e) * (1.0 + y * y * z * z);
                [centroid + 0.9 * x * w, 0.9 * y / w, 0.9 * z / w]
            };
            let speed = |[x, y, z]: &[f64; 3]| {
                let w = 1.0 + 0.2 * (1.0 - e) * (1.0 + y * y * z * z);
                let dw = -0.2 * de * (1.0 + y * y * z * z);
                [
                    velocity + 0.9 * x * dw,
                    -0.9 * y * dw / (w * w),
                    -0.9 * z * dw / (w * w),
                ]
            };
            let positions: Vec<_> = mesh.nodes.iter().map(place).collect();
            let velocities: Vec<_> = mesh.nodes.iter().map(speed).collect();
            (positions, velocities, centroid)
        };
        let mut trajectory = Trajectory {
            parameters: vec![0.1, 0.9],
            status: Status::Steady {
                time: times.last().copied().unwrap_or(0.0),
            },
            times: times.to_vec(),
            positions: vec![],
            velocities: vec![],
            centroid: vec![],
            pressure_drop: times.iter().map(|t| 7.8 - (-t).exp()).collect(),
        };
        for t in times {
            let (positions, velocities, centroid) = at(*t);
            trajectory.positions.push(positions);
            trajectory.velocities.push(velocities);
            trajectory.centroid.push(centroid);
        }
        trajectory
    }

    #[test]
    fn a_steady_trajectory_goes_on_at_its_end_velocity() {
        let mesh = octahedral(2);
        let times: Vec<f64> = (0..=60).map(|i| 0.2 * f64::from(i)).collect();
        let trajectory = relaxing(&mesh, &times);
        let longer: Vec<f64> = (0..=100).map(|i| 0.2 * f64::from(i)).collect();
        let extended = trajectory.extended(&mesh, &longer).unwrap();
        assert_eq!(extended.positions[..=60], trajectory.positions[..]);
        let exact = relaxing(&mesh, &longer);
        let pairs = extended
            .positions
            .as_slice()
            .iter()
            .flatten()
            .zip(exact.positions.iter().flatten());
        let worst = pairs
            .flat_map(|(a, b)| [0, 1, 2].map(|d| (a[d] - b[d]).abs()))
            .fold(0.0, f64::max);
        assert!(worst < 1e-6, "{worst}");
        assert!((extended.centroid[100] - exact.centroid[100]).abs() < 1e-6);
    }

    #[test]
    fn what_was_not_stored_is_refused() {
        let mesh = octahedral(2);
        let mut trajectory = relaxing(&mesh, &[0.0, 0.2, 0.4]);
        assert!(matches!(
            trajectory.extended(&mesh, &[0.3]),
            Err(DatabaseError::NoSnapshot { time: 0.3, .. })
        ));
        trajectory.status = Status::Unsteady;
        let error = trajectory.extended(&mesh, &[0.6]).unwrap_err().to_string();
        assert!(
            error.contains("0.6") && error.contains("0.4") && error.contains("unsteady"),
            "{error}"
        );
    }

    #[test]
    fn misshapen_trajectories_are_named() {
        let mesh = octahedral(2);
        let good = relaxing(&mesh, &[0.0, 0.2, 0.4]);
        good.validate(mesh.nodes.len()).unwrap();
        let message = |t: &Trajectory| t.validate(mesh.nodes.len()).unwrap_err().to_string();
        let mut bad = good.clone();
        bad.velocities[1].pop();
        assert!(message(&bad).contains("velocities at instant 1"), "{}", message(&bad));
        let mut bad = good.clone();
        bad.positions[2][3][1] = f64::INFINITY;
        assert!(message(&bad).contains("positions at instant 2"), "{}", message(&bad));
        let mut bad = good.clone();
        bad.times[2] = 0.1;
        assert!(message(&bad).contains("times must increase"), "{}", message(&bad));
        let mut bad = good;
        bad.centroid.push(0.0);
        assert!(message(&bad).contains("centroid"), "{}", message(&bad));
    }
}
