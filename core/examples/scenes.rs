//! Reconstructs different parts of the capsule at one instant. Each call computes only the nodes that it returns.
//!
//!     cargo run -p capsule-rom-core --example scenes

use capsule_core::mechanics::Stencil;
use capsule_core::{Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Query, Scene, Workspace, section};
use std::error::Error;

const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/capsule.crom");

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::fs::read(MODEL)?;
    let model = Model::open(&file)?;
    let mesh = model.mesh();
    let mut workspace = Workspace::<f32>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace)?;
    evaluator.prepare(&Query::new([0.10, 0.90], Method::Direct))?;
    let mut instant = evaluator.at(3.0)?;

    // One node, in the laboratory frame.
    let mut node = [[0.0; 3]];
    let one = Scene {
        nodes: Nodes::List(&[0]),
        frame: Frame::Laboratory,
    };
    instant.positions(&one, &mut node)?;
    println!("node 0 at {:.3?} l", node[0]);
    instant.velocities(&one, &mut node)?;
    println!("       with {:.3?} V", node[0]);

    // The outline in the plane z = 0, as points [x, r] from the front to the rear pole.
    let mut outline = [[0.0; 2]; 128];
    let count = instant.outline(MIDPLANE, Frame::Centroid, &mut outline)?;
    println!(
        "outline of {count} points from {:.3?} to {:.3?}",
        outline[0],
        outline[count - 1]
    );

    // All nodes, and the section x = 0 of the surface.
    let mut positions = vec![[0.0; 3]; mesh.nodes()];
    let all = Scene {
        nodes: Nodes::All,
        frame: Frame::Centroid,
    };
    instant.positions(&all, &mut positions)?;
    let mut segments = vec![[[0.0; 2]; 2]; 4 * mesh.elements().len()];
    let count = section(&mesh, &positions, 0.0, &mut segments)?;
    println!("section x = 0 of {count} segments; volume {:.4} l^3", instant.volume()?);

    // The mechanics of the membrane at a node.
    let mut sector = vec![[0.0; 3]; mesh.sector_nodes().len()];
    let membrane = instant.membrane(&mut sector)?;
    let deformation = membrane.deformation(&Stencil::at(&mesh, 0)?)?;
    println!(
        "stretches {:.3?} and tensions {:.3?} G_s at node 0",
        deformation.stretches(),
        deformation.tensions()
    );
    Ok(())
}
