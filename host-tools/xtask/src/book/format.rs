//! The specification of the model file, by a reader that was written from it alone: it must come to the core's answers.

use crate::command::{command, output};
use crate::root;
use anyhow::{Context, Result, anyhow, bail};
use capsule_core::{Evaluator, Frame, Method, Model, Nodes, Query, Scene, Workspace};
use serde_json::Value;

/// The reader.
const READER: &str = "docs/reference/read_crom.py";
/// Instants at which it is asked: in the first span of time and in the last.
const INSTANTS: [f64; 2] = [0.4, 13.0];
/// The greatest distance of a node, in l. The reader decodes a sample, the core interpolates there: the kernel's nugget
/// moves the nodes by at most 5e-5 l. Wrong readings of the format (bytes of a block exchanged, low bytes or narrow
/// columns left out, rows of the modes not padded) move them by 6e-4 l and more.
const TOLERANCE: f64 = 2e-4;

/// Results of a model, with its digest.
const RESULTS: &str = "docs/results/model.json";

/// Runs the reader on the shipped model, and compares. The stored results must be of this model too.
pub fn check() -> Result<()> {
    let file = std::fs::read(root().join("models/capsule.crom")).context("models/capsule.crom")?;
    let model = Model::open(&file)?;
    let stored: Value = serde_json::from_str(&std::fs::read_to_string(root().join(RESULTS)).context(RESULTS)?)?;
    if stored["digest"] != model.digest() {
        bail!(
            "the results in {RESULTS} and beside it are of the model {}, not of {}: docs/maintainers/releases.md has \
             the \
             commands that renew them",
            stored["digest"],
            model.digest()
        );
    }
    for t in INSTANTS {
        let found = output(&mut command(&format!("python3 {READER} models/capsule.crom {t}")))?;
        let found: Value = serde_json::from_str(&found)?;
        let worst = compare(&model, &found, t)?;
        println!("{READER}: nodes at t = {t} within {worst:.1e} l of the core's");
    }
    Ok(())
}

/// The greatest distance of a node from where the core has it.
fn compare(model: &Model<'_>, found: &Value, t: f64) -> Result<f64> {
    let same = |key: &str, expected: f64| match found[key].as_f64() {
        Some(value) if value == expected => Ok(()),
        value => Err(anyhow!("{READER}: {key} is {value:?} instead of {expected}")),
    };
    same("digest", model.digest().into())?;
    same("nodes", model.mesh().nodes() as f64)?;
    same("elements", model.mesh().elements().len() as f64)?;
    same("end_time", model.end_time().into())?;
    let answers = found["answers"].as_array().map_or(&[][..], Vec::as_slice);
    let mut worst: f64 = 0.0;
    let mut count = 0;
    for answer in answers {
        let number = |value: &Value| value.as_f64().ok_or_else(|| anyhow!("{READER}: {value} is no number"));
        let parameters = [number(&answer["parameters"][0])?, number(&answer["parameters"][1])?];
        let expected = positions(model, parameters, t)?;
        let nodes = answer["positions"].as_object().context("positions of nodes")?;
        for (node, position) in nodes {
            let expected = expected.get(node.parse::<usize>()?).context("the index of a node")?;
            for (d, expected) in expected.iter().enumerate() {
                worst = worst.max((number(&position[d])? - expected).abs());
                count += 1;
            }
        }
    }
    if count == 0 || worst.is_nan() || worst > TOLERANCE {
        bail!("{READER}: of {count} coordinates at t = {t} one is {worst:.1e} l off; {TOLERANCE:.0e} l is admitted");
    }
    Ok(worst)
}

/// The core's positions of all nodes.
fn positions(model: &Model<'_>, parameters: [f64; 2], t: f64) -> Result<Vec<[f64; 3]>> {
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    evaluator.prepare(&Query {
        extrapolate: true,
        ..Query::new(parameters, Method::Direct)
    })?;
    let mut positions = vec![[0.0; 3]; model.mesh().nodes()];
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    evaluator.at(t)?.positions(&scene, &mut positions)?;
    Ok(positions)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_reader_that_puts_a_node_elsewhere_is_told() {
        let file = std::fs::read(root().join("models/capsule.crom")).unwrap();
        let model = Model::open(&file).unwrap();
        let parameters = [0.1, 0.9];
        let [x, y, z] = positions(&model, parameters, 1.0).unwrap()[7];
        let found = |x: f64| {
            json!({
                "digest": model.digest(), "nodes": 2706, "elements": 1352, "end_time": 20.0,
                "answers": [{ "parameters": parameters, "positions": { "7": [x, y, z] } }],
            })
        };
        assert!(compare(&model, &found(x + 1e-5), 1.0).unwrap() < 2e-5);
        let told = compare(&model, &found(x + 1e-3), 1.0).unwrap_err().to_string();
        assert!(told.contains("of 3 coordinates at t = 1 one is 1.0"), "{told}");
        let mut other = found(x);
        other["nodes"] = 2705.into();
        let told = compare(&model, &other, 1.0).unwrap_err().to_string();
        assert!(told.contains("nodes is Some(2705.0) instead of 2706"), "{told}");
    }
}
