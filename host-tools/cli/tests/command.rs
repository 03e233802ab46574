//! The command as a user runs it: what it prints, what it writes, and how it fails.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn capsule_rom(arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_capsule-rom"))
        .args(arguments.split_whitespace())
        .current_dir(root())
        .output()
        .expect("the command starts")
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn json(arguments: &str) -> Value {
    let output = capsule_rom(arguments);
    assert!(
        output.status.success(),
        "{arguments}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// Asserts the exit code and that the message on standard error holds all of `words`.
fn fails(arguments: &str, code: i32, words: &[&str]) {
    let output = capsule_rom(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments}: {message}");
    assert!(output.stdout.is_empty(), "{arguments} printed a result");
    for word in words {
        assert!(message.contains(word), "{arguments}: \"{word}\" is not in: {message}");
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .expect("an array")
        .iter()
        .map(|entry| entry.as_f64().expect("a number"))
        .collect()
}

/// The names under "Commands:" of a help text, but for `help` itself.
fn commands(help: &str) -> Vec<String> {
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let listed = listed.take_while(|line| !line.is_empty());
    // A description that is wrapped goes on farther to the right.
    let names = listed.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = names.filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help").map(str::to_owned).collect()
}

#[test]
fn every_command_has_help_with_examples_of_one_line_each() {
    let mut open = vec![String::new()];
    let mut leaves = Vec::new();
    while let Some(command) = open.pop() {
        let output = capsule_rom(&format!("{command} --help"));
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{command}: {text}");
        let below = commands(&text);
        open.extend(below.iter().map(|name| format!("{command} {name}").trim().to_owned()));
        if !below.is_empty() && !command.is_empty() {
            continue;
        }
        let mut examples = text
            .lines()
            .skip_while(|line| !line.starts_with("Example"))
            .skip(1)
            .peekable();
        assert!(examples.peek().is_some(), "{command} has no example: {text}");
        for line in examples.take_while(|line| !line.is_empty()) {
            assert!(
                line.starts_with("  capsule-rom "),
                "{command}: \"{line}\" goes on from the line above"
            );
        }
        leaves.push(command);
    }
    // The walk found commands at every depth.
    for command in ["", "predict", "fom run", "study bending", "database merge"] {
        assert!(leaves.iter().any(|found| found == command), "{command}: {leaves:?}");
    }
}

#[test]
fn wrong_usage_exits_with_2() {
    fails("predict --ca 0.1", 2, &["--confinement"]);
    fails("predict --ca much --confinement 0.9 --t 1", 2, &["much"]);
    fails("sing", 2, &["sing"]);
}

#[test]
fn a_prediction_has_its_fields_and_keeps_the_volume() {
    let prediction = json("predict --ca 0.10 --confinement 0.90 --t 0.4,3,6,9 --json");
    assert_eq!(prediction["method"], "direct");
    assert_eq!(prediction["model_digest"].as_str().map(str::len), Some(8));
    let instants = prediction["instants"].as_array().unwrap();
    assert_eq!(instants.len(), 4);
    let sphere = 4.0 / 3.0 * std::f64::consts::PI * 0.9_f64.powi(3);
    for instant in instants {
        let of = |field: &str| instant[field].as_f64().unwrap();
        // docs/measurements.md: the volume is right to 0.047 % at worst.
        assert!((of("volume") / sphere - 1.0).abs() <= 4.7e-4, "{instant}");
        assert!(
            of("half_width") < 1.0 && of("half_diagonal") < 2.0_f64.sqrt(),
            "{instant}"
        );
        assert!(of("velocity") > 1.0 && of("velocity") < 2.0963, "{instant}");
        assert!(of("rear_depth") >= 0.0 && of("expected_error") > 0.0, "{instant}");
    }
    // Steady from t = 3 on, to the eye.
    let length = |i: usize| instants[i]["axial_length"].as_f64().unwrap();
    assert!((length(1) - length(3)).abs() < 0.01);
}

/// The model holds this sample, so the prediction differs from its snapshot by the compression of the model file alone.
#[test]
fn a_sample_is_reproduced() {
    let database = capsule_database::Database::open(&root().join("models/database")).unwrap();
    let sample = database.read(&[0.05, 1.0]).unwrap();
    let sample = sample.extended(database.mesh(), &[2.0]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sample.npz");
    let prediction = json(&format!(
        "predict --ca 0.05 --confinement 1.00 --t 2 --json --npz {}",
        file.display()
    ));
    let mut arrays = ndarray_npy::NpzReader::new(std::fs::File::open(file).unwrap()).unwrap();
    let positions: ndarray::Array3<f64> = arrays.by_name("positions").unwrap();
    let nodes = &sample.positions[0];
    assert_eq!(positions.dim(), (1, nodes.len(), 3));
    let distance = |(n, node): (usize, &[f64; 3])| -> f64 {
        let squares = (0..3).map(|d| (positions[[0, n, d]] - node[d]).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let distances: Vec<f64> = nodes.iter().enumerate().map(distance).collect();
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    let greatest = distances.iter().copied().fold(0.0, f64::max);
    assert!(mean < 2e-4 && greatest < 1e-3, "mean {mean} l, greatest {greatest} l");

    // The observable interpolates the rim between nodes, as the full-order model's own measure does.
    let instant = &prediction["instants"][0];
    let mesh = capsule_fom::Mesh {
        nodes: database.mesh().nodes.clone(),
        elements: database.mesh().elements.clone(),
    };
    let dimensions = capsule_fom::measures::Outlines::new(&mesh).dimensions(nodes);
    for (field, expected) in [
        ("axial_length", dimensions.axial_length),
        ("half_width", dimensions.half_width),
        ("half_diagonal", dimensions.half_diagonal),
        ("rear_depth", dimensions.rear_depth),
    ] {
        let found = instant[field].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-3, "{field}: {found} against {expected}");
    }
}

/// Two methods that share only the data: their difference is at most the sum of their expected errors.
#[test]
fn both_methods_agree_inside_the_domain() {
    let at = |method: &str| {
        json(&format!(
            "predict --ca 0.055 --confinement 0.97 --t 4 --method {method} --json"
        ))["instants"][0]
            .clone()
    };
    let answers = [at("direct"), at("paper")];
    let of = |field: &str| answers.each_ref().map(|answer| answer[field].as_f64().unwrap());
    let admitted: f64 = of("expected_error").iter().sum();
    assert!(admitted < 5e-3, "{admitted}");
    for field in ["axial_length", "half_width", "half_diagonal", "rear_depth"] {
        let [direct, paper] = of(field);
        assert!(
            (direct - paper).abs() <= admitted,
            "{field}: {direct} and {paper}, {admitted}"
        );
    }
    for (field, tolerance) in [("velocity", 1e-3), ("volume", 1e-3)] {
        let [direct, paper] = of(field);
        assert!(
            (direct / paper - 1.0).abs() < tolerance,
            "{field}: {direct} and {paper}"
        );
    }
    assert_ne!(answers[0], answers[1]);
}

#[test]
fn predictions_are_written_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    json(&format!(
        "predict --ca 0.10 --confinement 0.90 --t 0,2 --json --csv {} --vtu {} --plot {}",
        at("table.csv"),
        at("paraview"),
        at("sections.png")
    ));
    let table = std::fs::read_to_string(at("table.csv")).unwrap();
    assert_eq!(
        table.lines().filter(|line| !line.starts_with('#')).count(),
        3,
        "{table}"
    );
    assert!(Path::new(&at("paraview/capsule.pvd")).is_file() && Path::new(&at("paraview/capsule_0001.vtu")).is_file());
    assert_eq!(std::fs::read(at("sections.png")).unwrap()[1..4], *b"PNG");
}

#[test]
fn questions_without_an_answer_are_refused() {
    fails(
        "predict --ca 0.10 --confinement 2 --t 1",
        1,
        &["confinement = 2", "[0.75, 1.2]"],
    );
    fails("predict --ca -0.10 --confinement 0.9 --t 1", 1, &["-0.1"]);
    fails("predict --ca 0.19 --confinement 1.1 --t 1", 1, &["steady"]);
    fails("predict --ca NaN --confinement 0.9 --t 1", 1, &["capillary"]);
    fails("predict --ca 0.1 --confinement 0.9 --t 21", 1, &["21", "20"]);
    json("predict --ca 0.04 --confinement 1.21 --t 1 --extrapolate --json");
}

#[test]
fn series_that_were_written_become_a_model() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let mut table = "series,ca,al\n".to_owned();
    for ca in [0.04, 0.06, 0.08] {
        for al in [0.8, 0.85, 0.9] {
            let series = at(&format!("{ca}-{al}"));
            json(&format!(
                "predict --ca {ca} --confinement {al} --t 0,1,2,3 --vtu {series} --json"
            ));
            table += &format!("{ca}-{al}/capsule.pvd,{ca},{al}\n");
        }
    }
    std::fs::write(at("parameters.csv"), table).unwrap();
    let (from, model) = (folder.path().display(), at("series.crom"));
    let report = json(&format!("offline build --from {from} --out {model} --quiet --json"));
    assert_eq!(
        (&report["samples"], &report["symmetry"]),
        (&Value::from(9), &Value::from(8))
    );
    let errors = json(&format!("study leave-one-out --from {from} --quiet --json"));
    assert_eq!(errors["parameters"], serde_json::json!(["ca", "al"]));

    let own = json("predict --ca 0.05 --confinement 0.87 --t 2 --json");
    let query = format!("predict --model {model} --parameters al=0.87,ca=0.05 --t 2");
    let other = json(&format!("{query} --json"));
    assert_eq!(other["units"]["length"], "length unit");
    for name in ["axial_length", "half_width", "velocity", "volume"] {
        let [own, other] = [&own, &other].map(|answer| answer["instants"][0][name].as_f64().unwrap());
        assert!((own - other).abs() < 5e-3, "{name}: {own} {other}");
    }
    fails(&format!("{query} --fields tension"), 1, &["sphere"]);
    let query = |parameters: &str| format!("predict --model {model} --parameters {parameters} --t 2");
    fails(&query("al=0.87"), 1, &["`ca` is missing"]);
    fails(&query("al=0.87,ca=0.05,re=1"), 1, &["no parameter `re`", "ca, al"]);
    fails(&query("al=0.87,ca=0.2"), 1, &["ca = 0.2", "[0.04, 0.08]"]);
    fails(&query("al=0.87,ca"), 2, &["NAME=VALUE"]);
    fails(
        &format!("predict --model {model} --ca 0.05 --confinement 0.87 --t 2"),
        1,
        &["capillary_number", "ca, al"],
    );
    fails(
        "offline build --from nowhere.txt --out x.crom",
        1,
        &["nowhere.txt", ".npz"],
    );
}

#[test]
fn damaged_models_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let sound = std::fs::read(root().join("models/capsule.crom")).unwrap();
    let file = folder.path().join("model.crom");
    let refused = |bytes: &[u8], words: &[&str]| {
        std::fs::write(&file, bytes).unwrap();
        let arguments = format!("predict --ca 0.1 --confinement 0.9 --t 1 --model {}", file.display());
        fails(&arguments, 1, words);
    };
    refused(&sound[..sound.len() / 2], &["truncated"]);
    refused(b"no model at all, only text", &["CROM"]);
    let mut flipped = sound.clone();
    flipped[sound.len() / 2] ^= 1;
    refused(&flipped, &["CRC"]);
    let mut newer = sound.clone();
    newer[4] = 99;
    refused(&newer, &["version", "99"]);
    fails(
        "predict --ca 0.1 --confinement 0.9 --t 1 --model no/such.crom",
        1,
        &["no/such.crom"],
    );
}

#[test]
fn a_full_order_run_prints_its_history_and_writes_its_snapshots() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let run = json(&format!(
        "fom run --ca 0.10 --confinement 0.90 --mesh 3 --end-time 0.4 --quiet --json --out {}",
        out.display()
    ));
    assert_eq!((run["nodes"].as_u64(), run["elements"].as_u64()), (Some(146), Some(72)));
    assert_eq!(
        (run["integrator"].as_str(), run["steady"].as_bool()),
        (Some("rkc2"), Some(false))
    );
    let times = numbers(&run["history"]["t"]);
    assert!(
        [0.0, 0.005, 0.2, 0.4].iter().all(|t| times.contains(t)) && times.len() == 12,
        "{times:?}"
    );
    for field in [
        "centroid_velocity",
        "axial_length",
        "half_width",
        "half_diagonal",
        "rear_depth",
        "pressure_drop",
    ] {
        assert_eq!(numbers(&run["history"][field]).len(), times.len(), "{field}");
        assert_eq!(run["history"][field], run[field]);
    }
    for profile in ["profile_midplane", "profile_diagonal"] {
        let points: Vec<Vec<f64>> = run[profile].as_array().unwrap().iter().map(numbers).collect();
        let (front, rear) = (&points[0], &points[points.len() - 1]);
        assert!(
            front[0] > rear[0] && front[1] == 0.0 && rear[1] == 0.0,
            "{profile} runs from pole to pole"
        );
    }
    assert!(run["velocity_evaluations"].as_u64() > Some(10) && run["volume_drift"].as_f64() < Some(1e-4));
    assert!(out.join("capsule.pvd").is_file());
    let snapshots = capsule_database::Database::open(&out.join("snapshots")).unwrap();
    assert_eq!(snapshots.read(&[0.10, 0.90]).unwrap().times, times);
}

#[test]
fn a_membrane_of_another_law_hardens_and_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let of = |law: &str, rest: &str| {
        json(&format!(
            "fom run --ca 0.10 --confinement 0.90 --mesh 3 --end-time 2 --quiet --json --law {law} {rest}"
        ))
    };
    let soft = of("neo-hookean", "");
    let hard = of(
        "skalak:1",
        &format!("--fields tension,energy,load --out {}", out.display()),
    );
    assert_eq!(
        (soft["law"].as_str(), hard["law"].as_str()),
        (Some("neo-Hookean"), Some("Skalak, C = 1"))
    );
    let last = |run: &Value, column: &str| *numbers(&run[column]).last().unwrap();
    assert!(last(&hard, "axial_length") < last(&soft, "axial_length") - 0.02);
    assert!(last(&hard["mechanics"], "max_tension") > 0.0);
    let written = capsule_database::Database::open(&out.join("snapshots")).unwrap();
    assert_eq!(written.description().membrane_law(), "Skalak, C = 1");

    let run = "fom run --ca 0.1 --confinement 0.9 --mesh 3";
    fails(&format!("{run} --law hooke"), 2, &["hooke", "skalak:C"]);
    fails(&format!("{run} --law skalak:-1"), 2, &["above -1/2"]);
    // The nodal load of elements is known for the neo-Hookean law alone; told before the run.
    let elements = format!("{run} --law skalak:1 --membrane p2 --fields load --csv /dev/null");
    fails(&elements, 1, &["Skalak, C = 1", "harmonics"]);
    // Another law does not go into the same database.
    let other = format!("{run} --end-time 2 --quiet --out {}", out.display());
    fails(&other, 1, &["solver.law", "Skalak"]);
}

#[test]
fn a_film_that_the_walls_do_not_resolve_is_told() {
    let run = |confinement: &str| {
        let output = capsule_rom(&format!(
            "fom run --ca 0.05 --confinement {confinement} --mesh 2 --end-time 0.02 --json"
        ));
        assert!(output.status.success());
        let run: Value = serde_json::from_slice(&output.stdout).unwrap();
        let thickness = run["thinnest_film"]["thickness"].as_f64().unwrap();
        (thickness, String::from_utf8(output.stderr).unwrap())
    };
    let (thickness, warning) = run("0.95");
    assert!(
        warning.starts_with(&format!("warning: a film of {thickness:.3} l")),
        "{warning}"
    );
    assert_eq!(run("0.75").1, "");
}

#[test]
fn single_configurations_are_swept_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let (points, database) = (folder.path().join("points.csv"), folder.path().join("database"));
    let sweep = |text: &str| {
        std::fs::write(&points, text).unwrap();
        let (points, database) = (points.display(), database.display());
        capsule_rom(&format!(
            "fom sweep --database {database} --mesh 2 --end-time 0.05 --points {points}"
        ))
    };
    let output = sweep("ca,confinement\n0.1,0.8\n0.05,0.85\n0.2,0.8\n");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let entries = capsule_database::Database::open(&database).unwrap().entries().unwrap();
    let found: Vec<&[f64]> = entries.iter().map(|entry| entry.parameters.as_slice()).collect();
    assert_eq!(found.len(), 3);
    assert!(found.contains(&[0.1, 0.8].as_slice()) && found.contains(&[0.05, 0.85].as_slice()));
    let output = sweep("ca,confinement\n0.1,many\n");
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("line 2: \"many\" is not a number"));
}

#[test]
fn a_sweep_goes_on_where_it_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = |capillary_numbers: &str| {
        let output = capsule_rom(&format!(
            "fom sweep --database {} --mesh 2 --ca {capillary_numbers} --confinement 0.75 --end-time 12 --quiet",
            folder.path().display()
        ));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    assert!(sweep("0.05").starts_with("1 steady of 1 "));
    let file = folder.path().join("ca0.0500_al0.7500.npz");
    let written = file.metadata().unwrap().modified().unwrap();
    assert!(sweep("0.05,0.06").starts_with("2 steady of 2 "));
    assert_eq!(
        file.metadata().unwrap().modified().unwrap(),
        written,
        "what is there is not computed again"
    );
}

#[test]
fn impossible_full_order_runs_are_named() {
    fails("fom run --ca 0 --confinement 0.9", 1, &["capillary number", "positive"]);
    fails("fom run --ca NaN --confinement 0.9", 1, &["NaN"]);
    fails("fom run --ca 0.1 --confinement 0.9 --mesh 1", 1, &["mesh frequency 1"]);
    fails(
        "fom run --ca 0.1 --confinement 0.9 --mesh 2 --integrator euler --step 0.1",
        1,
        &["unstable", "limit"],
    );
    fails(
        "fom run --ca 0.1 --confinement 0.9 --mesh 2 --end-time 0.2 --out /proc/none",
        1,
        &["/proc/none"],
    );
    fails("fom shear --ca -1", 1, &["positive"]);
}

#[test]
fn databases_that_cannot_be_used_are_named() {
    fails("offline build --database no/such/folder", 1, &["no/such/folder"]);
    fails("study leave-one-out --database no/such/folder", 1, &["no/such/folder"]);
    let folder = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir(root().join("models/database")).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    let broken = folder.path().join("ca0.0500_al0.9000.npz");
    let bytes = std::fs::read(&broken).unwrap();
    std::fs::write(&broken, &bytes[..bytes.len() / 2]).unwrap();
    let arguments = format!(
        "offline build --database {} --out /dev/null --quiet",
        folder.path().display()
    );
    fails(&arguments, 1, &["ca0.0500_al0.9000.npz"]);
}
