//! The conformance vectors: queries of the shipped model with the bits of this machine's answers.

use crate::command::{command, run};
use crate::{root, setup, target_directory, targets};
use anyhow::{Context, Result, anyhow, bail};
use capsule_conformance::{Ask, Asker, Case, LONGEST_LINE, Precision, Text, check};
use capsule_core::{Domain, Method, Model};
use std::path::PathBuf;

const INTRODUCTION: &str = "\
# Queries of a model and the bits of their answers; docs/reference/conformance.md describes the format.
# Written by `cargo xtask conformance --write`.
";

#[derive(clap::Args)]
pub struct Options {
    /// Write the answers of this machine instead of checking them
    #[arg(long)]
    write: bool,
}

/// Writes or checks the vectors.
pub fn conformance(options: &Options) -> Result<()> {
    let model = std::fs::read(root().join("models/capsule.crom")).context("models/capsule.crom")?;
    if options.write {
        let text = vectors(&model)?;
        println!("{} queries", text.lines().filter(|line| line.starts_with('f')).count());
        return std::fs::write(path(), text).with_context(|| format!("could not write {}", path().display()));
    }
    let text = std::fs::read_to_string(path()).with_context(|| path().display().to_string())?;
    let mut different = 0;
    for precision in [Precision::Single, Precision::Double] {
        let differs = |expected: &str, found: &str| {
            different += 1;
            println!("expected {expected}\nfound    {found}");
        };
        let asked = check(&model, &text, precision, &mut Box::default(), differs).map_err(|error| anyhow!(error))?;
        println!("{precision:?}: {asked} queries asked");
    }
    if different > 0 {
        bail!("{different} answers differ from {}", path().display());
    }
    Ok(())
}

/// Builds the module that Node and Chromium run, and returns where it is.
pub fn module() -> Result<PathBuf> {
    setup::bring(&[setup::WASM])?;
    run(&mut command(&format!(
        "cargo rustc --quiet --package capsule-conformance --crate-type cdylib --profile wasm --target {}",
        targets::WASM
    )))?;
    Ok(target_directory()
        .join(targets::WASM)
        .join("wasm/capsule_conformance.wasm"))
}

fn path() -> PathBuf {
    root().join("tests/conformance/vectors.txt")
}

/// The file's text.
fn vectors(model: &[u8]) -> Result<String> {
    let model = Model::open(model)?;
    let mut text = format!("{INTRODUCTION}model {:08x}\n", model.digest());
    let mut asker = Box::new(Asker::new());
    let mut add = |case: Case| {
        let mut line = Text::<LONGEST_LINE>::new();
        case.write(&mut line);
        asker.answer(&model, &case, &mut line);
        text.push_str(line.as_str());
        text.push('\n');
    };
    for case in questions(&model).iter() {
        add(case.single());
    }
    for case in questions(&model).iter() {
        add(case.double());
    }
    Ok(text)
}

/// A question whose numbers are not in a precision yet.
struct Question {
    method: Method,
    extrapolate: bool,
    /// Ca, a/l, the step and t.
    numbers: [f64; 4],
    ask: Ask,
}

impl Question {
    fn single(&self) -> Case {
        Case::new(
            self.method,
            self.extrapolate,
            self.numbers.map(|number| number as f32),
            self.ask,
        )
    }

    fn double(&self) -> Case {
        Case::new(self.method, self.extrapolate, self.numbers, self.ask)
    }
}

const STEP: f64 = 0.02;

/// Queries in the interior, at samples, on edges and on the clusters' border, outside, and invalid ones.
fn questions(model: &Model<'_>) -> Vec<Question> {
    let end = f64::from(model.end_time());
    let range = |index: usize| {
        model
            .parameters()
            .get(index)
            .map_or([0.0; 2], |range| [range.min, range.max])
    };
    let (ca, al) = (range(0), range(1));
    let steady_limit = |confinement: f64| model.steady_limit(confinement).unwrap_or(ca[1]);
    let mut questions = Vec::new();
    let mut asks = Ask::ALL.into_iter().map(|(ask, _)| ask).cycle();
    let mut ask = |method, extrapolate, numbers: [f64; 4], count: usize| {
        for ask in asks.by_ref().take(count) {
            questions.push(Question {
                method,
                extrapolate,
                numbers,
                ask,
            });
        }
    };

    // The interior: a sequence that fills the plane evenly (Roberts, 2018), in space and in time.
    let place = |i: usize, share: f64| (0.5 + i as f64 * share).fract();
    for i in 0..160 {
        let confinement = al[0] + place(i, 0.754_877_666_246_693) * (al[1] - al[0]);
        let most = steady_limit(confinement).min(ca[1]);
        let capillary_number = ca[0] + place(i, 0.569_840_290_998_053) * (most - ca[0]);
        let t = end * place(i, 0.419_643_377_607_081);
        ask(Method::Direct, false, [capillary_number, confinement, STEP, t], 1);
    }
    // Every question of one query, by both methods.
    for method in [Method::Direct, Method::Paper] {
        for [capillary_number, confinement, t] in [[0.1, 0.85, 1.234], [0.03, 1.05, 3.3]] {
            ask(method, false, [capillary_number, confinement, STEP, t], Ask::ALL.len());
        }
    }
    // Stored instants and the ends of time.
    let stored: Vec<f64> = [1, 2, 7].map(|i| model.times().get(i, 0).into()).into();
    for t in [0.0, end].into_iter().chain(stored) {
        ask(Method::Direct, false, [0.06, 0.95, STEP, t], 4);
    }
    // Corners, edges, the clusters' borders, samples, the steady limit.
    for confinement in [al[0], al[1], 0.5 * (al[0] + al[1])] {
        let limit = steady_limit(confinement);
        for capillary_number in [ca[0], ca[1], limit, 0.5 * (ca[0] + limit), 1.01 * limit] {
            let outside = model.domain([capillary_number, confinement]) != Ok(Domain::Inside);
            ask(Method::Direct, false, [capillary_number, confinement, STEP, 2.0], 2);
            if outside {
                ask(Method::Direct, true, [capillary_number, confinement, STEP, 2.0], 2);
            }
        }
    }
    for cluster in model.clusters() {
        for confinement in cluster.range() {
            for offset in [-1e-3, 0.0, 1e-3] {
                ask(Method::Direct, true, [0.05, confinement + offset, STEP, 1.5], 2);
            }
        }
        let samples = cluster.parameters();
        for i in (0..samples.rows()).step_by(samples.rows().div_ceil(8).max(1)) {
            let sample = [0, 1].map(|column| f64::from(samples.get(i, column)));
            ask(Method::Direct, true, [sample[0], sample[1], STEP, 4.0], 2);
        }
    }
    // The paper's method, with other steps too, forward in time and back.
    for (i, step) in [STEP, 0.05, 0.2, STEP, 0.1, STEP, 0.04, STEP].into_iter().enumerate() {
        let confinement = al[0] + place(i, 0.754_877_666_246_693) * (al[1] - al[0]);
        let most = steady_limit(confinement).min(ca[1]);
        let capillary_number = ca[0] + place(i, 0.569_840_290_998_053) * (most - ca[0]);
        for t in [0.01, 1.7, 4.4, 0.9] {
            ask(Method::Paper, false, [capillary_number, confinement, step, t], 1);
        }
    }
    // Errors.
    for bad in [f64::NAN, f64::INFINITY, -0.1, 0.0, 1e9] {
        ask(Method::Direct, true, [bad, 0.9, STEP, 1.0], 1);
        ask(Method::Direct, true, [0.05, bad, STEP, 1.0], 1);
        ask(Method::Paper, true, [0.05, 0.9, bad, 1.0], 1);
        ask(
            Method::Direct,
            true,
            [0.05, 0.9, STEP, if bad == 0.0 { -1e-3 } else { bad }],
            1,
        );
    }
    // Far outside.
    for [capillary_number, confinement] in [[1e-4, 0.9], [0.5, 0.9], [0.05, 0.3], [0.05, 3.0], [1e3, 1e3]] {
        ask(Method::Direct, false, [capillary_number, confinement, STEP, 1.0], 1);
        ask(Method::Direct, true, [capillary_number, confinement, STEP, 1.0], 2);
    }
    questions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vectors_are_this_machine_s() {
        conformance(&Options { write: false }).unwrap();
    }

    #[test]
    fn a_difference_is_found() {
        let model = std::fs::read(root().join("models/capsule.crom")).unwrap();
        let text = std::fs::read_to_string(path()).unwrap();
        let other = text.replace("f32 direct", "f32 paper");
        let mut different = 0;
        let asked = check(&model, &other, Precision::Single, &mut Box::default(), |_, _| {
            different += 1
        });
        assert!(asked.unwrap() > 300 && different > 100);
    }
}
