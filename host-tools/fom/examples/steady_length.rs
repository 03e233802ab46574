//! The steady length of a capsule at Ca = 0.10, a/l = 0.90 on a coarse mesh, in some seconds:
//! `cargo run --release -p capsule-fom --example steady_length`.

use std::error::Error;
use std::ops::ControlFlow;

use capsule_fom::{Configuration, Settings, Solver, Status};

fn main() -> Result<(), Box<dyn Error>> {
    let solver = Solver::new(Settings {
        mesh_frequency: 5,
        ..Settings::default()
    })?;
    let configuration = Configuration {
        capillary_number: 0.10,
        confinement: 0.90,
    };
    let outcome = solver.run(&configuration, &mut |progress| {
        eprint!("\rt = {:5.2} l/V, step {}", progress.t, progress.steps);
        ControlFlow::Continue(())
    })?;
    eprintln!();
    let length = outcome.history.axial_length.last().ok_or("the run has no snapshot")?;
    match outcome.status {
        Status::Steady { time } => println!("steady from t = {time:.1} l/V, length {length:.3} l"),
        Status::Unsteady => println!("not steady at the end time, length {length:.3} l"),
        Status::Stopped { time, reason } => println!("stopped at t = {time:.2} l/V: {reason}"),
    }
    Ok(())
}
