//! Parameters whose names hold anything, as other people's data have them.

mod common;

use common::{capsule_rom, fails, json, write_series};
use serde_json::Value;
use std::path::Path;

/// Builds `model.crom` from data whose parameters have these names.
fn build(folder: &Path, names: [&str; 2]) {
    write_series(folder, names);
    let build = "offline build --from . --out model.crom --quiet";
    let output = capsule_rom(folder, build.split(' '));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn query<'a>(parameters: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["predict", "--model", "model.crom", "--t", "1"];
    arguments.extend(parameters.iter().flat_map(|text| ["--parameters", *text]));
    arguments
}

fn answer(folder: &Path, parameters: &[&str]) -> Value {
    json(folder, query(parameters).into_iter().chain(["--json"]))
}

#[test]
fn every_name_can_be_asked_for() {
    for names in [
        ["Q, flow", "size"],
        ["Re=UL/nu", "a=b"],
        ["the \"flow\"", "size (µm)"],
        ["流量, mean", "flow rate"],
    ] {
        let folder = tempfile::tempdir().unwrap();
        build(folder.path(), names);
        let [first, second] = names.map(|name| format!("\"{}\"", name.replace('"', "\"\"")));
        let [a, b] = names;
        let expected = answer(folder.path(), &[&format!("{a}=0.17,{b}=1.5")]);
        for (name, value) in [(a, 0.17), (b, 1.5)] {
            let found = expected["parameters"][name].as_f64().unwrap();
            assert!((found - value).abs() < 1e-6, "{name}: {found}");
        }
        for parameters in [
            &[&format!("{b} = 1.5 , {a} = 1.7e-1")][..],
            &[&format!("{first}=0.17,{second}=1.5")],
            &[&format!("{a}=0.17"), &format!("{b}=1.5")],
            &[&format!("{second}=1.5"), &format!("{a}=0.17")],
        ] {
            let parameters: Vec<&str> = parameters.iter().map(|text| text.as_str()).collect();
            assert_eq!(answer(folder.path(), &parameters), expected, "{parameters:?}");
        }
    }
}

#[test]
fn what_is_wrong_is_said_with_the_names() {
    let folder = tempfile::tempdir().unwrap();
    build(folder.path(), ["Q, flow", "size"]);
    let refused = |parameters: &[&str], code, words: &[&str]| fails(folder.path(), query(parameters), code, words);
    let known = "\"Q, flow\", size";
    refused(&["Q=0.2,size=2"], 1, &["no parameter `Q`", known]);
    refused(&["Q, flow=0.2"], 1, &["`size` is missing", known]);
    refused(&["Q, flow=0.2,size=2,size=2"], 1, &["`size` is given twice"]);
    refused(&["Q, flow=0.2,size=2", "size=2"], 1, &["`size` is given twice"]);
    refused(
        &["Q, flow=0.2", "size=big"],
        2,
        &["--parameters", "`size`", "\"big\"", "finite number"],
    );
    refused(&["Q, flow=NaN,size=2"], 2, &["`Q, flow`", "\"NaN\"", "finite number"]);
    refused(&["Q, flow=0.2,size"], 2, &["\"size\"", "NAME=VALUE", known]);
    fails(
        folder.path(),
        "predict --model model.crom --ca 0.1 --confinement 0.9 --t 1".split(' '),
        1,
        &["no parameter `capillary_number`", known],
    );
}

#[test]
fn names_that_can_be_read_in_two_ways_need_quotes() {
    let folder = tempfile::tempdir().unwrap();
    build(folder.path(), ["a", "a=0.2,a"]);
    fails(
        folder.path(),
        query(&["a=0.2,a=2"]),
        1,
        &["several ways", "a, \"a=0.2,a\""],
    );
    let found = answer(folder.path(), &["a=0.2", "\"a=0.2,a\"=2"]);
    assert_eq!(found["parameters"]["a=0.2,a"], 2.0);
}

#[test]
fn a_split_names_its_parameter_and_separates_samples() {
    let folder = tempfile::tempdir().unwrap();
    write_series(folder.path(), ["Q, flow", "size"]);
    let build = |split: &'static str| ["offline", "build", "--from", ".", "--out", "x.crom", "--split", split];
    let refused = |split, code, words: &[&str]| fails(folder.path(), build(split), code, words);
    for value in ["0.1", "0.3", "-1", "7", "0.30000000000000004"] {
        let split: &'static str = format!("Q, flow={value}").leak();
        refused(
            split,
            1,
            &["--split", "`Q, flow`", "0.1 to 0.3", "separates no samples"],
        );
    }
    refused("size=3.0000000000000004", 1, &["`size`", "1 to 3"]);
    refused("width=2", 1, &["no parameter `width`", "\"Q, flow\", size"]);
    refused("size=2,Q, flow=0.2", 1, &["one NAME=VALUE"]);
    refused("size=inf", 2, &["`size`", "finite number"]);
    refused("size", 2, &["NAME=VALUE"]);
    assert!(!folder.path().join("x.crom").exists());
}
