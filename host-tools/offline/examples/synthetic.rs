//! From snapshots to a model file to an answer, on a synthetic motion.
//!
//! Run it by `cargo run -p capsule-offline --example synthetic`.
//!
//! A sphere is stretched along the channel, by an amount and at a rate that depend on two parameters p and q.

#[path = "../tests/support/mesh.rs"]
mod mesh;

use capsule_core::{Evaluator, Frame, Method, Model, Nodes, Parameters, Query, Scene, Workspace};
use capsule_database::Collection;
use capsule_offline::{Settings, build};
use std::error::Error;

/// Position of the node that is at (x, y, z) on the unit sphere at rest. The stretch preserves the volume.
fn position([x, y, z]: [f64; 3], [p, q]: [f64; 2], t: f64) -> [f64; 3] {
    let stretch = 1.0 + (0.2 + 0.1 * p * p) * (1.0 - (-(1.0 + q) * t).exp());
    let across = 1.0 / stretch.sqrt();
    [stretch * x + (1.0 + 0.3 * q) * t, across * y, across * z]
}

fn main() -> Result<(), Box<dyn Error>> {
    // The snapshots: 25 configurations at 21 instants.
    let mesh = mesh::octahedral(2);
    let times: Vec<f64> = (0..=20).map(|i| 0.1 * f64::from(i)).collect();
    let parameters: Vec<Vec<f64>> = (0..25)
        .map(|k| vec![0.25 * f64::from(k % 5), 0.25 * f64::from(k / 5)])
        .collect();
    let at = |row: &[f64], t: f64| {
        mesh.nodes
            .iter()
            .map(|node| position(*node, [row[0], row[1]], t))
            .collect()
    };
    let run = |row: &Vec<f64>| times.iter().map(|t| at(row, *t)).collect();
    let collection = Collection::new(Collection {
        parameter_names: vec!["p".to_owned(), "q".to_owned()],
        length_unit: None,
        time_unit: None,
        positions: parameters.iter().map(run).collect(),
        velocities: Vec::new(),
        elements: mesh.elements.clone(),
        parameters,
        times,
    })?;

    // The model file.
    let settings = Settings::of_collection(&collection)?;
    let (file, report) = build(&collection, &settings, &|_, _, _| {})?;
    println!(
        "{} samples, {} instants: {} bytes",
        report.samples,
        report.instants,
        file.len()
    );

    // An answer between the samples, at an instant between the snapshots.
    let model = Model::open(&file)?;
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(&model, &mut workspace)?;
    let (query, t) = ([0.4, 0.6], 1.25);
    evaluator.prepare(&Query::new(Parameters::from(query), Method::Direct))?;
    let mut instant = evaluator.at(t)?;
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let mut nodes = vec![[0.0; 3]; mesh.nodes.len()];
    instant.positions(&scene, &mut nodes)?;
    let distance = |(found, reference): (&[f64; 3], &[f64; 3])| {
        let exact = position(*reference, query, t);
        (0..3).map(|d| (found[d] - exact[d]).powi(2)).sum::<f64>().sqrt()
    };
    let error = nodes.iter().zip(&mesh.nodes).map(distance).sum::<f64>() / nodes.len() as f64;
    println!(
        "at p = {}, q = {}, t = {t}: mean error of the nodes {:.4} % of the radius, bound {:.4} %",
        query[0],
        query[1],
        100.0 * error,
        100.0 * instant.error_bound()?
    );
    Ok(())
}
