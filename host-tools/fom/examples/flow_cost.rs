//! Time of the parts of one velocity evaluation:
//! `RAYON_NUM_THREADS=1 cargo run --release -p capsule-fom --example flow_cost -- 8`.

use std::time::Instant;

use capsule_fom::flow::{Duct, DuctSettings, Flow, Membrane};
use capsule_fom::{Mesh, Symmetry};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let frequency = std::env::args().nth(1).map_or(Ok(8), |n| n.parse())?;
    let mesh = Mesh::octahedral(frequency)?;
    let symmetry = Symmetry::reduced(&mesh)?;
    let start = Instant::now();
    let duct = Duct::new(&DuctSettings::default())?;
    println!("setting up the duct: {:.2} s", start.elapsed().as_secs_f64());
    // A parachute with a film of 0.1 l and a smooth load; only its cost matters here.
    let nodes: Vec<[f64; 3]> = mesh
        .nodes
        .iter()
        .map(|&[x, y, z]| {
            let round = 0.88 * (1.0 - 0.1 * x);
            [x + 0.45 * (y * y + z * z) - 0.3, round * y, round * z]
        })
        .collect();
    let load: Vec<[f64; 3]> = mesh
        .nodes
        .iter()
        .map(|&[x, y, z]| [3.0 + 4.0 * x, 5.0 * x * y, 5.0 * x * z])
        .collect();
    let force: Vec<[f64; 3]> = load.iter().map(|q| q.map(|c| 0.01 * c)).collect();
    let membrane = Membrane {
        elements: &mesh.elements,
        nodes: &nodes,
        load: &load,
        force: &force,
    };
    let mut out = vec![[0.0; 3]; symmetry.sector.len()];
    let mut best = f64::MAX;
    for _ in 0..300 {
        let start = Instant::now();
        duct.velocity(&membrane, &symmetry.sector, &mut out)?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!(
        "mesh {frequency}, {} targets of {}: {:.2} ms",
        out.len(),
        nodes.len(),
        1e3 * best
    );
    Ok(())
}
