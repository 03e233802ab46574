//! `predict` states the validity of its answers, and states it right.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// Runs the command with the shipped model.
fn capsule(arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_capsule-rom"))
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .args(arguments.split(' '))
        .output()
        .expect("the command starts")
}

fn succeeds(arguments: &str) -> String {
    let output = capsule(arguments);
    assert!(
        output.status.success(),
        "{arguments}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).expect("text")
}

fn json(arguments: &str) -> Value {
    serde_json::from_str(&succeeds(&format!("{arguments} --json"))).expect("one JSON object")
}

#[test]
fn errors_say_what_they_are_against_and_what_bending_changes() {
    let found = json("predict --ca 0.03 --confinement 1.10 --t 2");
    assert_eq!(
        found["errors_against"],
        "the full-order model (neo-Hookean, B = 1e-4 G_s a^2)"
    );
    assert_eq!(
        (&found["domain"], &found["extrapolated"]),
        (&"inside".into(), &false.into())
    );
    // The full-order model at exactly this configuration, with and without bending stiffness
    // (models/database/bending.csv).
    let effect = &found["bending_effect"];
    assert!((effect["ca"].as_f64().unwrap() - 0.03).abs() < 1e-6);
    assert!((effect["confinement"].as_f64().unwrap() - 1.1).abs() < 1e-6);
    assert!(
        (effect["distance"].as_f64().unwrap() - 0.00497).abs() < 1e-4,
        "{effect}"
    );
    let instant = &found["instants"][0];
    assert!(instant["error_bound"].as_f64().unwrap() > 0.0);
    let text = succeeds("predict --ca 0.03 --confinement 1.10 --t 2");
    for words in [
        "errors against the full-order model (neo-Hookean, B = 1e-4",
        "bending stiffness changes",
    ] {
        assert!(text.contains(words), "{text}");
    }
}

/// The full-order solution keeps its volume. Where the model answers, so does it; where it cannot, it refuses, at
/// (0.15, 1.1) with a shape of 130 times the volume and five times the channel's width.
#[test]
fn an_extrapolated_answer_is_a_guess_without_a_bound_and_an_impossible_one_is_refused() {
    let (mut answered, mut refused, mut before, mut first) = (0, 0, 0.0, f64::INFINITY);
    for step in 0..20 {
        let ca = 0.075 + 0.004 * f64::from(step);
        let arguments = format!("predict --ca {ca} --confinement 1.1 --t 8 --extrapolate --json");
        let output = capsule(&arguments);
        if output.status.success() {
            let found: Value = serde_json::from_slice(&output.stdout).unwrap();
            assert_eq!(found["domain"], "beyond-steady-limit");
            assert_eq!(found["extrapolated"], true);
            let instant = &found["instants"][0];
            assert_eq!(instant["error_bound"], Value::Null);
            let number = |name: &str| instant[name].as_f64().unwrap();
            let sphere = 4.0 / 3.0 * std::f64::consts::PI * 1.1_f64.powi(3);
            assert!((number("volume") / sphere - 1.0).abs() < 0.0201, "{instant}");
            assert!(number("half_width") < 1.0, "{instant}");
            // Farther from the samples the guess is no smaller.
            assert!(number("expected_error") >= before, "{ca}: {instant}");
            before = number("expected_error");
            first = before.min(first);
            answered += 1;
        } else {
            let error = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(error.contains("no capsule has the extrapolated shape"), "{error}");
            refused += 1;
        }
    }
    assert!(answered >= 3 && refused >= 3, "{answered} {refused}");
    assert!(before > 10.0 * first, "{first} {before}");
    let output = capsule("predict --ca 0.15 --confinement 1.1 --t 20 --extrapolate");
    assert!(!output.status.success() && output.stdout.is_empty());
    let text = succeeds("predict --ca 0.075 --confinement 1.1 --t 8 --extrapolate");
    assert!(
        text.contains("none") && text.contains("expected_error is a guess"),
        "{text}"
    );
}

/// The example of docs/guides/own-data.md: nine configurations, seven instants. Between them, at an instant at which
/// the motion is too fast for them, the model differs from its source by more than a per cent; its bound says so.
#[test]
fn the_bound_of_the_example_in_the_documents_holds() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let mut table = "series,ca,al\n".to_owned();
    for ca in ["0.04", "0.06", "0.08"] {
        for al in ["0.80", "0.85", "0.90"] {
            let times = "0,0.5,1,1.5,2,2.5,3";
            let series = path(&format!("series/{ca}-{al}"));
            succeeds(&format!(
                "predict --ca {ca} --confinement {al} --t {times} --vtu {series}"
            ));
            table += &format!("{ca}-{al}/capsule.pvd,{ca},{al}\n");
        }
    }
    std::fs::write(path("series/parameters.csv"), table).unwrap();
    let (series, model) = (path("series"), path("series.crom"));
    succeeds(&format!("offline build --from {series} --out {model} -q"));
    let (found, exact) = (path("found.npz"), path("exact.npz"));
    let times = "0.25,0.75,1,2.25,3";
    let answer = json(&format!(
        "predict --model {model} --parameters ca=0.05,al=0.87 --t {times} --npz {found}"
    ));
    assert_eq!(answer["errors_against"], "the data that the model was built from");
    succeeds(&format!(
        "predict --ca 0.05 --confinement 0.87 --t {times} --npz {exact}"
    ));
    let [found, exact] = [found, exact].map(|file| positions(Path::new(&file)));
    let instants = answer["instants"].as_array().unwrap();
    let mut worst: f64 = 0.0;
    for (i, instant) in instants.iter().enumerate() {
        let nodes = found.len() / instants.len() / 3;
        let apart = |n: usize| {
            let at = 3 * (i * nodes + n);
            (at..at + 3).map(|k| (found[k] - exact[k]).powi(2)).sum::<f64>().sqrt()
        };
        let error = (0..nodes).map(apart).sum::<f64>() / nodes as f64 / 0.87;
        assert!(error < instant["error_bound"].as_f64().unwrap(), "{error}: {instant}");
        worst = worst.max(error);
    }
    assert!(worst > 0.01, "the example is too easy: {worst}");
}

fn positions(file: &Path) -> Vec<f64> {
    let mut archive = ndarray_npy::NpzReader::new(std::fs::File::open(file).unwrap()).unwrap();
    let positions: ndarray::Array3<f64> = archive.by_name("positions").unwrap();
    positions.into_iter().collect()
}
