//! Writes a small database and reads it: a rigid octahedron that moves along the channel.
//! `cargo run -p capsule-database --example small_database`.

use std::error::Error;

use capsule_database::{Database, Description, Mesh, Status, Trajectory};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;

    // Six nodes on the unit sphere and eight flat triangles, which name their corners twice.
    let mut nodes = Vec::new();
    for axis in 0..3 {
        for side in [1.0, -1.0] {
            let mut node = [0.0; 3];
            node[axis] = side;
            nodes.push(node);
        }
    }
    let corners = [
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    let elements = corners.map(|[a, b, c]| [a, b, c, a, b, c]).to_vec();
    let mesh = Mesh { nodes, elements };

    let (confinement, velocity) = (0.8, 1.4);
    let times: Vec<f64> = (0..=10).map(|i| 0.2 * f64::from(i)).collect();
    let description = Description::new(times.clone(), serde_json::json!({ "solver": "rigid motion" }));
    let database = Database::create(folder.path(), description, mesh)?;

    let centroid: Vec<f64> = times.iter().map(|t| velocity * t).collect();
    let reference = &database.mesh().nodes;
    let moved = |x: &f64| -> Vec<[f64; 3]> {
        let node = |r: &[f64; 3]| [confinement * r[0] + x, confinement * r[1], confinement * r[2]];
        reference.iter().map(node).collect()
    };
    database.write(&Trajectory {
        parameters: vec![0.05, confinement],
        status: Status::Steady { time: 0.0 },
        positions: centroid.iter().map(moved).collect(),
        velocities: vec![vec![[velocity, 0.0, 0.0]; reference.len()]; times.len()],
        pressure_drop: vec![0.0; times.len()],
        centroid,
        times,
    })?;

    let database = Database::open(folder.path())?;
    for entry in database.entries()? {
        let trajectory = database.read(&entry.parameters)?;
        let last = trajectory.positions.last().ok_or("the configuration has no snapshot")?;
        println!(
            "{}: {}, {} snapshots, node 0 ends at x = {:.4} l",
            entry.file,
            entry.status.name(),
            entry.snapshots,
            last[0][0]
        );
    }
    Ok(())
}
