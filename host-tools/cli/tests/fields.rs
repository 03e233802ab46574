//! The mechanics of the membrane on request, as a user asks for it.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn json(arguments: &str) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_capsule-rom"))
        .args(arguments.split_whitespace())
        .current_dir(root())
        .output()
        .expect("the command starts");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments}: {message}");
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

const TOTALS: [&str; 6] = [
    "area",
    "energy",
    "pressure_drop",
    "max_stretch",
    "max_tension",
    "min_tension",
];
const QUANTITIES: &str = "t,node,x,y,z,velocity_x,velocity_y,velocity_z,stretch_1,stretch_2,\
    direction_1_x,direction_1_y,direction_1_z,direction_2_x,direction_2_y,direction_2_z,area_dilation,\
    tension_1,tension_2,load_x,load_y,load_z,energy_density";

/// The table's rows under its heading.
fn table(path: &Path) -> (String, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let heading = lines.next().unwrap().to_owned();
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    (heading, lines.map(row).collect())
}

#[test]
fn a_prediction_with_fields() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let query = "predict --ca 0.05 --confinement 1.00 --t 0.4,2 --json";
    let all = json(&format!(
        "{query} --fields all --csv {} --npz {} --vtu {}",
        at("nodes.csv").display(),
        at("nodes.npz").display(),
        at("paraview").display()
    ));
    let database = capsule_database::Database::open(&root().join("models/database")).unwrap();
    let sample = database.read(&[0.05, 1.0]).unwrap();
    let plain = json(&format!("{query} --csv {}", at("table.csv").display()));
    for (i, t) in [0.4, 2.0].into_iter().enumerate() {
        let (with, without) = (&all["instants"][i], &plain["instants"][i]);
        assert_eq!(with["axial_length"], without["axial_length"]);
        assert!(
            TOTALS.iter().all(|total| without[total].is_null()),
            "not asked: {without}"
        );
        let of = |total: &str| with[total].as_f64().unwrap();
        assert!(of("area") > 4.0 * std::f64::consts::PI && of("energy") > 0.0 && of("max_stretch") > 1.0);
        assert!(of("max_tension") > of("min_tension"));
        // The solver's, by its own load and flow.
        let snapshot = sample.times.iter().position(|time| (time - t).abs() < 1e-6).unwrap();
        let exact = sample.pressure_drop[snapshot];
        assert!((of("pressure_drop") / exact - 1.0).abs() < 0.03, "{with} {exact}");
    }
    let (heading, rows) = table(&at("nodes.csv"));
    assert_eq!(heading, QUANTITIES);
    let nodes = rows.len() / 2;
    assert_eq!(
        (rows[nodes - 1][1], rows[nodes][..2].to_vec()),
        ((nodes - 1) as f64, vec![2.0, 0.0])
    );
    let column = |name: &str| heading.split(',').position(|quantity| quantity == name).unwrap();
    let greatest = rows
        .iter()
        .filter(|row| row[0] == 2.0)
        .map(|row| row[column("tension_1")]);
    let total = all["instants"][1]["max_tension"].as_f64().unwrap();
    assert!((greatest.fold(f64::MIN, f64::max) - total).abs() < 1e-5);
    for row in &rows {
        let [one, two, area] = ["stretch_1", "stretch_2", "area_dilation"].map(|name| row[column(name)]);
        assert!(one >= two && (one * two / area - 1.0).abs() < 1e-4);
    }
    let vtu = std::fs::read_to_string(at("paraview/capsule_0001.vtu")).unwrap();
    assert!(
        ["tension_2", "load", "energy_density", "velocity"]
            .iter()
            .all(|name| vtu.contains(&format!("Name=\"{name}\"")))
    );
    assert_eq!(std::fs::read(at("nodes.npz")).unwrap()[..2], *b"PK");
    let (heading, rows) = table(&at("table.csv"));
    assert!(heading.starts_with("t,axial_length") && !heading.contains("area") && rows.len() == 2);
}

#[test]
fn a_full_order_run_with_fields() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let run = "fom run --ca 0.10 --confinement 0.90 --mesh 3 --end-time 0.4 --quiet --json";
    assert!(json(run)["mechanics"].is_null());
    let run = json(&format!(
        "{run} --fields load,tension --csv {} --npz {} --out {}",
        at("nodes.csv").display(),
        at("nodes.npz").display(),
        at("run").display()
    ));
    let instants = run["t"].as_array().unwrap().len();
    for total in ["area", "volume", "energy", "max_stretch", "max_tension", "min_tension"] {
        assert_eq!(run["mechanics"][total].as_array().unwrap().len(), instants, "{total}");
    }
    // It starts from the stress-free sphere.
    assert!(run["mechanics"]["energy"][0].as_f64().unwrap().abs() < 1e-9);
    assert!(run["mechanics"]["energy"][instants - 1].as_f64().unwrap() > 1e-3);
    let (heading, rows) = table(&at("nodes.csv"));
    assert!(
        heading.ends_with("tension_1,tension_2,load_x,load_y,load_z"),
        "{heading}"
    );
    assert_eq!(rows.len(), instants * 146);
    assert!(at("nodes.npz").is_file() && at("run/capsule.pvd").is_file());
}
