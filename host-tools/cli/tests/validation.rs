//! The commands that judge the full-order solver, as a user runs them.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn capsule_rom(arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_capsule-rom"))
        .args(arguments.split_whitespace())
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .output()
        .expect("the command starts")
}

fn fails(arguments: &str, word: &str) {
    let output = capsule_rom(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments}: {message}");
    assert!(
        output.stdout.is_empty() && message.contains(word),
        "{arguments}: {message}"
    );
}

#[test]
fn integrators_are_compared_and_plotted() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("integrators.svg");
    let output = capsule_rom(&format!(
        "fom integrators --mesh 2 --ca 0.10 --end-time 0.05 --steps 0.01,0.005 --tolerances 1e-3,1e-5 --json --plot {}",
        plot.display()
    ));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let rows: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(rows.len(), 6);
    assert!(rows[0]["outcome"]["stability_limit"].as_f64() < Some(0.05), "{rows:#?}");
    assert_eq!(rows[4]["integrator"]["rkc2"]["tolerance"], 1e-3);
    let error = |row: &Value| row["error"].as_f64().unwrap();
    assert!(
        error(&rows[5]) <= error(&rows[4]) && error(&rows[3]) < error(&rows[1]),
        "{rows:#?}"
    );
    assert!(std::fs::read_to_string(plot).unwrap().contains("Ralston"));
}

#[test]
fn bad_requests_are_named() {
    fails("fom validate --database no/such/database", "no/such/database");
    fails("fom convergence --workers 0", "--workers");
    fails("fom integrators --steps=-1", "time step");
    fails("fom integrators --mesh 1", "mesh frequency");
}
