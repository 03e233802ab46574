//! Outputs of a command: never over an input, checked before anything is computed, all or none.

mod common;

use common::{ELEMENTS, capsule_rom, fails, json, write_arrays, write_series};
use ndarray::{Array2, Array3};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const QUERY: [&str; 5] = ["predict", "--ca", "0.1", "--confinement", "0.9"];

/// Every file below a folder, hidden ones too, with its bytes; folders without content are there with none.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.insert(path.clone(), Vec::new());
            found.extend(files(&path));
        } else {
            found.insert(path.clone(), std::fs::read(&path).unwrap());
        }
    }
    found
}

/// Asserts that a command fails with all of `words`, and leaves the folder as it is.
fn refused(folder: &Path, arguments: &str, words: &[&str]) {
    let before = files(folder);
    fails(folder, arguments.split_whitespace(), 1, words);
    assert!(files(folder) == before, "`{arguments}` left something");
}

#[test]
fn no_output_overwrites_the_data() {
    let root = tempfile::tempdir().unwrap();
    let at = |name: &str| root.path().join(name);
    write_arrays(&at("data.npz"));
    std::fs::create_dir(at("series")).unwrap();
    write_series(&at("series"), ["flow", "size"]);
    std::fs::hard_link(at("data.npz"), at("hard.npz")).unwrap();
    std::fs::hard_link(at("series/parameters.csv"), at("table.csv")).unwrap();
    let mut same = vec!["data.npz", "./data.npz", "series/../data.npz", "hard.npz"];
    if cfg!(unix) {
        #[cfg(unix)]
        std::os::unix::fs::symlink("data.npz", at("soft.npz")).unwrap();
        same.push("soft.npz");
    }
    for out in same {
        for from in ["data.npz", "hard.npz"] {
            refused(
                root.path(),
                &format!("offline build --from {from} --out {out}"),
                &["--out", out, "would overwrite", "--from"],
            );
        }
    }
    for out in ["series/parameters.csv", "series/3/capsule_0000.vtu", "table.csv"] {
        refused(
            root.path(),
            &format!("offline build --from series --out {out}"),
            &["--out", out, "would overwrite", "--from series"],
        );
    }
    let plots = "offline build --from series --out model.crom --plots series/";
    refused(root.path(), plots, &["--plots", "would overwrite"]);
    let errors = "study leave-one-out --from data.npz --csv data.npz";
    refused(root.path(), errors, &["--csv", "would overwrite"]);
    let errors = "study leave-one-out --from series --plots series";
    refused(root.path(), errors, &["--plots", "would overwrite"]);

    // A model among the data is none of them, and may be built again.
    let build = "offline build --from series --out series/model.crom --quiet";
    for _ in 0..2 {
        assert!(capsule_rom(root.path(), build.split(' ')).status.success());
    }
    for option in ["--csv", "--npz"] {
        let query = "predict --model series/model.crom --parameters flow=0.2,size=2 --t 1";
        let arguments = format!("{query} {option} series/../series/model.crom");
        refused(root.path(), &arguments, &[option, "would overwrite", "--model"]);
    }
    // The series would hold a file of the model's name.
    std::fs::rename(at("series/model.crom"), at("capsule.pvd")).unwrap();
    refused(
        root.path(),
        "predict --model capsule.pvd --parameters flow=0.2,size=2 --t 1 --vtu .",
        &["capsule.pvd", "would overwrite", "--model"],
    );
    let merge = "database merge --out series series data";
    refused(root.path(), merge, &["series", "not empty"]);
    std::fs::create_dir(at("empty")).unwrap();
    refused(
        root.path(),
        "database merge --out ./empty empty",
        &["--out", "would overwrite"],
    );
}

#[test]
fn a_model_is_named_after_its_data() {
    let root = tempfile::tempdir().unwrap();
    let at = |name: &str| root.path().join(name);
    write_arrays(&at("data.npz"));
    for name in ["Ca0.05", "Ca0.1"] {
        write_series(&at(name), ["flow", "size"]);
    }
    for (from, model) in [
        ("data.npz", "data.npz.crom"),
        ("Ca0.05", "Ca0.05.crom"),
        ("Ca0.1/", "Ca0.1.crom"),
    ] {
        let report = json(root.path(), ["offline", "build", "--from", from, "--quiet", "--json"]);
        assert_eq!(report["bytes"].as_u64(), Some(at(model).metadata().unwrap().len()));
    }
    std::fs::remove_file(at("Ca0.1.crom")).unwrap();
    json(&at("Ca0.1"), ["offline", "build", "--from", ".", "--quiet", "--json"]);
    assert!(at("Ca0.1.crom").is_file());
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_anything_is_computed() {
    let root = tempfile::tempdir().unwrap();
    let at = |name: &str| root.path().join(name);
    std::fs::create_dir(at("folder")).unwrap();
    std::fs::write(at("file"), "a file").unwrap();
    // The model is not there, which would be said next.
    let cases: &[(&str, &[&str])] = &[
        ("--csv folder", &["--csv folder", "name a file"]),
        ("--npz new/", &["--npz new/", "name a file"]),
        ("--csv none/table.csv", &["--csv", "no folder none"]),
        ("--csv file/table.csv", &["--csv", "no folder file"]),
        ("--vtu file", &["--vtu file", "is a file"]),
        ("--vtu file/deep", &["--vtu file/deep", "file is a file"]),
        ("--plot figure.bmp", &["--plot figure.bmp", ".svg or .png"]),
        ("--plot figure", &["--plot figure", ".svg or .png"]),
        (
            "--csv table --npz ./table",
            &["--csv table", "--npz ./table", "are the same"],
        ),
        ("--csv folder/a --vtu folder/a", &["are the same"]),
        ("--t -1", &["--t -1", "from 0 on"]),
        ("--t 1,NaN", &["--t NaN", "finite"]),
        ("--t inf", &["--t inf", "finite"]),
    ];
    for (outputs, words) in cases {
        let t = if outputs.starts_with("--t ") { "" } else { "--t 1" };
        let outputs = outputs.replacen("--t ", "--t=", 1);
        let arguments = format!("{} {t} {outputs} --model none.crom", QUERY.join(" "));
        refused(root.path(), &arguments, words);
    }
    let arguments = "offline build --from none.npz --out file/model.crom";
    refused(root.path(), arguments, &["--out", "no folder file"]);
    let arguments = "fom integrators --plot figure.pdf";
    refused(root.path(), arguments, &["--plot figure.pdf", ".svg or .png"]);
    for arguments in [
        "fom run --ca 0.1 --confinement 0.9 --out file",
        "study report --out file",
        "study stability --plots file",
        "study leave-one-out --plots file",
    ] {
        refused(root.path(), arguments, &["file is a file"]);
    }
    for arguments in [
        "study test-set --csv folder",
        "study suggest --csv folder",
        "fom convergence --out folder",
    ] {
        refused(root.path(), arguments, &["name a file"]);
    }
    // No user writes there, root neither.
    if cfg!(target_os = "linux") {
        let arguments = format!("{} --t 1 --csv /proc/table.csv --vtu new", QUERY.join(" "));
        refused(root.path(), &arguments, &["/proc/table.csv", "cannot write"]);
    }
    fails(root.path(), QUERY.iter().chain(&["--t", ""]), 2, &["--t"]);
}

#[test]
fn a_failed_run_leaves_nothing() {
    let root = tempfile::tempdir().unwrap();
    std::fs::write(root.path().join("table.csv"), "old").unwrap();
    let outputs = "--csv table.csv --npz nodes.npz --vtu paraview --plot figure.svg";
    // The second instant is beyond the model's.
    let arguments = format!("{} --t 1,21 {outputs}", QUERY.join(" "));
    refused(root.path(), &arguments, &["21", "20"]);
    // All files are written before it shows that two of them are the same.
    std::fs::create_dir(root.path().join("folder")).unwrap();
    let arguments = format!(
        "{} --t 1 --npz nodes.npz --vtu folder --csv folder/capsule.pvd",
        QUERY.join(" ")
    );
    refused(root.path(), &arguments, &["capsule.pvd", "two"]);
}

#[test]
fn runs_of_one_kind_share_a_folder() {
    let root = tempfile::tempdir().unwrap();
    let run = |ca: &str, mesh: u32| {
        format!(
            "fom run --ca {ca} --confinement 0.8 --mesh {mesh} --end-time 0.05 --json --out run --fields load --csv \
             run/n.csv"
        )
    };
    for ca in ["0.1", "0.2"] {
        json(root.path(), run(ca, 2).split(' '));
    }
    let database = capsule_database::Database::open(&root.path().join("run/snapshots")).unwrap();
    let entries = database.entries().unwrap();
    let found: Vec<&[f64]> = entries.iter().map(|entry| &entry.parameters[..]).collect();
    assert_eq!(found, [[0.1, 0.8], [0.2, 0.8]]);
    assert!(root.path().join("run/n.csv").is_file() && root.path().join("run/capsule.pvd").is_file());
    refused(root.path(), &run("0.3", 3), &["run/snapshots", "another kind", "mesh"]);
}

#[test]
fn a_series_of_unordered_instants_is_rising() {
    let root = tempfile::tempdir().unwrap();
    let arguments = "--t 2,1,1.0,-0,0.5 --json --csv TABLE.CSV --vtu new/folder --plot PLOT.SVG --npz N.NPZ";
    let prediction = json(root.path(), QUERY.into_iter().chain(arguments.split(' ')));
    let rows = prediction["instants"].as_array().unwrap();
    let times: Vec<f64> = rows.iter().map(|row| row["t"].as_f64().unwrap()).collect();
    assert_eq!(times, [0.0, 0.5, 1.0, 2.0]);
    let alone = json(root.path(), QUERY.into_iter().chain(["--t", "2", "--json"]));
    assert_eq!(rows[3], alone["instants"][0]);
    let series = std::fs::read_to_string(root.path().join("new/folder/capsule.pvd")).unwrap();
    let stamps: Vec<&str> = series
        .split("timestep=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap())
        .collect();
    assert_eq!(stamps, ["0", "0.5", "1", "2"]);
    let mut table = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(root.path().join("TABLE.CSV"))
        .unwrap();
    let times: Vec<String> = table.records().map(|row| row.unwrap()[0].to_owned()).collect();
    assert_eq!(times, ["0", "0.5", "1", "2"]);
    assert!(
        std::fs::read_to_string(root.path().join("PLOT.SVG"))
            .unwrap()
            .starts_with("<svg")
    );
    let mut arrays = ndarray_npy::NpzReader::new(std::fs::File::open(root.path().join("N.NPZ")).unwrap()).unwrap();
    assert_eq!(
        arrays
            .by_name::<ndarray::OwnedRepr<f64>, ndarray::Ix1>("times")
            .unwrap()
            .len(),
        4
    );
    let mut left: Vec<_> = std::fs::read_dir(root.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    left.sort();
    assert_eq!(left, ["N.NPZ", "PLOT.SVG", "TABLE.CSV", "new"]);
}

#[test]
fn a_flat_mesh_comes_back_as_it_was_given() {
    let root = tempfile::tempdir().unwrap();
    write_arrays(&root.path().join("data.npz"));
    json(
        root.path(),
        "offline build --from data.npz --out data.crom --quiet --json".split(' '),
    );
    let query = "predict --model data.crom --parameters parameter_1=0.2,parameter_2=2 --t 0,1 --json --npz nodes.npz";
    json(root.path(), query.split(' '));
    let file = std::fs::File::open(root.path().join("nodes.npz")).unwrap();
    let mut arrays = ndarray_npy::NpzReader::new(file).unwrap();
    let elements: Array2<u32> = arrays.by_name("elements").unwrap();
    assert_eq!(elements.map(|node| i64::from(*node)), ndarray::arr2(&ELEMENTS));
    // At a sample the nodes are where they were.
    let positions: Array3<f64> = arrays.by_name("positions").unwrap();
    let front = 1.2 + 1.0 + 0.2 * 0.2 * 1.2;
    assert!((positions[[1, 0, 0]] - front).abs() < 1e-3, "{}", positions[[1, 0, 0]]);
}

#[cfg(unix)]
#[test]
fn devices_and_links_receive_what_is_written() {
    let root = tempfile::tempdir().unwrap();
    let query = QUERY.into_iter().chain(["--t", "1", "--json"]);
    let output = capsule_rom(root.path(), query.clone().chain(["--csv", "/dev/stdout"]));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.starts_with("# capsule-rom predict") && text.contains("\n{\n"),
        "{text}"
    );
    std::os::unix::fs::symlink("table.csv", root.path().join("link.csv")).unwrap();
    std::fs::write(root.path().join("table.csv"), "old").unwrap();
    json(root.path(), query.clone().chain(["--csv", "link.csv"]));
    assert!(root.path().join("link.csv").is_symlink());
    assert!(
        std::fs::read_to_string(root.path().join("table.csv"))
            .unwrap()
            .starts_with("# capsule-rom")
    );
    // Printed and written text would be mixed.
    let printed = std::fs::File::create(root.path().join("printed")).unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_capsule-rom"));
    command
        .args(query.chain(["--csv", "printed"]))
        .current_dir(root.path())
        .stdout(printed);
    let output = command
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap()
        .wait_with_output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() == Some(1) && message.contains("standard output"),
        "{message}"
    );
}
