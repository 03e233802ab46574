//! `capsule-rom identify` on the outline of a capsule whose parameters are known, at the nodes of its section, with a
//! decimal comma as spreadsheets write it.

use capsule_core::{Evaluator, Frame, MIDPLANE, Method, Model, Query, Workspace};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

const CA: f64 = 0.06;
const CONFINEMENT: f64 = 0.95;
const HALF_WIDTH_UM: f64 = 25.0;
const FLOW: &str = "--half-width-um 25 --velocity-mm-s 5 --viscosity-pa-s 0.8";

fn run(contour: &Path, options: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_capsule-rom"))
        .arg("identify")
        .arg(contour)
        .args(options.split_whitespace())
        .output()
        .expect("the command starts")
}

/// Writes the section z = 0 in um and returns the capsule's velocity in V.
fn write_contour(path: &Path) -> f64 {
    let model = Model::open(include_bytes!("../../../models/capsule.crom")).unwrap();
    let mut workspace = Workspace::<f64>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    evaluator
        .prepare(&Query::new([CA, CONFINEMENT], Method::Direct))
        .unwrap();
    let mut instant = evaluator.at(f64::from(model.end_time())).unwrap();
    let mut half = vec![[0.0; 2]; model.node_set(MIDPLANE).unwrap().len()];
    instant.outline(MIDPLANE, Frame::Centroid, &mut half).unwrap();
    let mirrored = half[1..half.len() - 1].iter().rev().map(|[x, r]| [*x, -r]);
    let mut text = "x_um;y_um\n".to_owned();
    for [x, y] in half.iter().copied().chain(mirrored) {
        let [x, y] = [x, y].map(|value| format!("{:.4}", HALF_WIDTH_UM * value).replace('.', ","));
        text.push_str(&format!("{x};{y}\n"));
    }
    std::fs::write(path, text).unwrap();
    instant.centroid_velocity().unwrap()
}

#[test]
fn a_known_capsule_lies_in_its_intervals() {
    let directory = tempfile::tempdir().unwrap();
    let contour = directory.path().join("contour.csv");
    let velocity = write_contour(&contour);
    let output = run(&contour, &format!("{FLOW} -o midplane --exposure-ms 0.01 --json"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["verdict"], "identified", "{answer}");
    // G_s = mu V / Ca.
    for (name, truth) in [
        ("ca", CA),
        ("confinement", CONFINEMENT),
        ("radius_um", CONFINEMENT * HALF_WIDTH_UM),
        ("gs_n_per_m", 0.8 * 5e-3 / CA),
    ] {
        let ends = [0, 1].map(|end| answer[format!("{name}_95")][end].as_f64().unwrap());
        assert!(ends[0] < truth && truth < ends[1], "{name}: {truth} in {ends:?}");
        let value = answer[name].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.01, "{name}: {value}, {truth}");
    }
    // The way in the exposure: 0.01 ms at the capsule's velocity, of which 5 mm/s are V.
    let blur = answer["blur_um"].as_f64().unwrap();
    assert!(
        (blur / (0.01 * 5.0 * velocity) - 1.0).abs() < 2e-3,
        "{blur}, {velocity}"
    );
}

#[test]
fn inconsistent_measurements_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let contour = directory.path().join("contour.csv");
    write_contour(&contour);
    let narrow = FLOW.replace("--half-width-um 25", "--half-width-um 12");
    let headless = directory.path().join("headless.csv");
    let text = std::fs::read_to_string(&contour).unwrap();
    std::fs::write(&headless, text.replace("x_um;y_um\n", "")).unwrap();
    let short = directory.path().join("short.csv");
    std::fs::write(&short, text.lines().take(8).collect::<Vec<_>>().join("\n")).unwrap();
    for (file, options, reason) in [
        (&contour, &*narrow, "the channel"),
        (&headless, FLOW, "unit"),
        (&short, FLOW, "12"),
    ] {
        let output = run(file, &format!("{options} -o midplane"));
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.code() == Some(1) && message.contains(reason) && output.stdout.is_empty(),
            "{reason}: {message}"
        );
    }
}
