//! Time of one velocity evaluation and of its parts, for a mesh frequency and a number of repetitions (the best counts):
//! `RAYON_NUM_THREADS=1 cargo run --release -p capsule-fom --example flow_cost -- 8 100`.

use std::time::Instant;

use capsule_fom::flow::{Background, Duct, DuctSettings, Flow, FlowError, FreeSpace, Membrane};
use capsule_fom::{Mesh, Symmetry};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // On a thread of the pool, as in a sweep: waking one for every loop would cost more than the loop.
    std::thread::scope(|_| rayon::scope(|_| run().map_err(|error| error.to_string())))?;
    Ok(())
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let frequency = std::env::args().nth(1).map_or(Ok(8), |n| n.parse())?;
    let repetitions = std::env::args().nth(2).map_or(Ok(100), |n| n.parse())?;
    let mesh = Mesh::octahedral(frequency)?;
    let symmetry = Symmetry::reduced(&mesh)?;
    let start = Instant::now();
    let duct = Duct::new(&DuctSettings::default())?;
    println!("setting up the duct: {:.2} s", start.elapsed().as_secs_f64());

    // A parachute with a film of 0.1 l and a smooth load: only its cost matters here.
    let map = |f: fn([f64; 3]) -> [f64; 3]| mesh.nodes.iter().map(|&p| f(p)).collect::<Vec<_>>();
    let nodes = map(|[x, y, z]| {
        let round = 0.88 * (1.0 - 0.1 * x);
        [x + 0.45 * (y * y + z * z) - 0.3, round * y, round * z]
    });
    let load = map(|[x, y, z]| [3.0 + 4.0 * x, 5.0 * x * y, 5.0 * x * z]);
    let force: Vec<[f64; 3]> = load.iter().map(|q| q.map(|c| 0.01 * c)).collect();
    let membrane = Membrane {
        elements: &mesh.elements,
        nodes: &nodes,
        load: &load,
        force: &force,
    };
    let mut out = vec![[0.0; 3]; symmetry.sector.len()];
    let best = |evaluate: &mut dyn FnMut() -> Result<f64, FlowError>| -> Result<f64, FlowError> {
        let mut best = f64::INFINITY;
        for _ in 0..repetitions {
            let start = Instant::now();
            evaluate()?;
            best = best.min(start.elapsed().as_secs_f64());
        }
        Ok(1e3 * best)
    };
    let free = FreeSpace::new(Background::Rest);
    let total = best(&mut || duct.velocity(&membrane, &symmetry.sector, &mut out))?;
    let capsule_to_capsule = best(&mut || free.velocity(&membrane, &symmetry.sector, &mut out))?;
    // No points: the traction on the wall is found all the same.
    let traction = best(&mut || duct.velocity_at(&membrane, &[], &mut []))?;
    println!(
        "mesh {frequency}, {} of {} nodes: {total:.2} ms = {capsule_to_capsule:.2} capsule to capsule + {traction:.2} \
         capsule to wall and traction there + {:.2} wall to capsule",
        symmetry.sector.len(),
        nodes.len(),
        total - capsule_to_capsule - traction
    );
    Ok(())
}
