//! Time of one velocity evaluation and of its parts, in double and in mixed precision, for a mesh frequency and a
//! number of repetitions (the best counts); then what part of the processor's peak its kernels reach:
//! `RAYON_NUM_THREADS=1 cargo run --release -p capsule-fom --example flow_cost -- 8 100`.

mod roofline;

use std::time::Instant;

use capsule_fom::flow::{Background, Duct, DuctSettings, Flow, FlowError, FreeSpace, Membrane, Precision};
use capsule_fom::{Mesh, Symmetry};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let frequency = std::env::args().nth(1).map_or(Ok(8), |n| n.parse())?;
    let repetitions = std::env::args().nth(2).map_or(Ok(100), |n| n.parse())?;
    // On a thread of the pool, as in a sweep: waking one for every loop would cost more than the loop.
    rayon::scope(|_| evaluations(frequency, repetitions).map_err(|error| error.to_string()))?;
    roofline::print(repetitions);
    Ok(())
}

/// The least time of some repetitions, in seconds.
fn best<E>(repetitions: usize, mut work: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let mut best = f64::INFINITY;
    for _ in 0..repetitions {
        let start = Instant::now();
        work()?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok(best)
}

/// Writes velocities, returns the pressure drop.
type Evaluation<'a> = dyn Fn(&mut [[f64; 3]]) -> Result<f64, FlowError> + 'a;

fn evaluations(frequency: usize, repetitions: usize) -> Result<(), Box<dyn std::error::Error>> {
    let mesh = Mesh::octahedral(frequency)?;
    let symmetry = Symmetry::reduced(&mesh)?;
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
    println!(
        "mesh {frequency}: velocities at {} of {} nodes",
        symmetry.sector.len(),
        nodes.len()
    );
    let mut velocities = Vec::new();
    for precision in [Precision::Double, Precision::Mixed] {
        let start = Instant::now();
        let duct = Duct::new(&DuctSettings {
            precision,
            ..DuctSettings::default()
        })?;
        let set_up = start.elapsed().as_secs_f64();
        let free = FreeSpace::with_precision(Background::Rest, precision);
        let mut out = vec![[0.0; 3]; symmetry.sector.len()];
        let mut ms =
            |evaluate: &Evaluation| best(repetitions, || evaluate(&mut out).map(|_| ())).map(|seconds| 1e3 * seconds);
        let capsule_to_capsule = ms(&|out| free.velocity(&membrane, &symmetry.sector, out))?;
        // No points: the traction on the wall is found all the same.
        let traction = ms(&|_| duct.velocity_at(&membrane, &[], &mut []))?;
        let total = ms(&|out| duct.velocity(&membrane, &symmetry.sector, out))?;
        println!(
            "{precision:?}: {total:.2} ms = {capsule_to_capsule:.2} capsule to capsule + {traction:.2} capsule to wall \
             and \
             traction there + {:.2} wall to capsule (setting up the duct: {set_up:.2} s)",
            total - capsule_to_capsule - traction
        );
        velocities.push(out);
    }
    let difference = velocities[0].iter().flatten().zip(velocities[1].iter().flatten());
    let largest = difference.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("largest difference of the velocities: {largest:.1e} V");
    Ok(())
}
