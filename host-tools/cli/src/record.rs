//! Full-order runs in the form that the database stores.

use anyhow::{Context, Result};
use capsule_database::{Description, Mesh, Trajectory};
use capsule_fom::{Configuration, Outcome, Settings, Solver, Status};

/// The database's parameters of a configuration: (Ca, a/l).
pub fn parameters(configuration: &Configuration) -> Vec<f64> {
    vec![configuration.capillary_number, configuration.confinement]
}

/// The solver's mesh for the database.
pub fn mesh(solver: &Solver) -> Mesh {
    let mesh = solver.mesh();
    Mesh {
        nodes: mesh.nodes.clone(),
        elements: mesh.elements.clone(),
    }
}

/// The outcome of a run for the database.
pub fn trajectory(outcome: &Outcome) -> Trajectory {
    Trajectory {
        parameters: parameters(&outcome.configuration),
        status: status(&outcome.status),
        times: outcome.times.clone(),
        positions: outcome.positions.clone(),
        velocities: outcome.velocities.clone(),
        centroid: outcome.centroid.clone(),
        pressure_drop: outcome.pressure_drop.clone(),
    }
}

fn status(status: &Status) -> capsule_database::Status {
    match status {
        Status::Steady { time } => capsule_database::Status::Steady { time: *time },
        Status::Unsteady => capsule_database::Status::Unsteady,
        Status::Stopped { time, reason } => capsule_database::Status::Stopped {
            time: *time,
            reason: reason.clone(),
        },
    }
}

/// The description that all runs of a database share.
pub fn description(settings: &Settings) -> Result<Description> {
    let record = serde_json::to_value(settings).context("could not record the solver's settings")?;
    Ok(Description::new(settings.snapshot_times(), record))
}
