//! A file of every format that the reader knows, and the bits of its answers; others are refused by their number.
//! A file is the family of `common` when its format was new, and stays as it is.

use capsule_core::{
    DIAGONAL, EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Nodes, OpenError, Query, Real, Scene, Workspace,
};
use std::fmt::{LowerHex, Write as _};

const FORMAT: u32 = 10;
const FILE: &[u8] = include_bytes!("golden/format-10.crom");
const ANSWERS: &str = include_str!("golden/format-10.txt");

/// One line for each question: the bits of the numbers.
fn answers(file: &[u8]) -> String {
    let model = Model::open(file).unwrap();
    let mut text = format!("digest {:08x}\n", model.digest());
    for method in [Method::Direct, Method::Paper] {
        for (parameters, t) in [([0.033, 0.87], 0.77), ([0.1, 1.0], 4.0), ([0.12, 0.75], 0.0)] {
            text += &ask::<f32, u32>(&model, method, parameters, t, |x| x.to_bits()).unwrap();
            text += &ask::<f64, u64>(&model, method, parameters, t, |x| x.to_bits()).unwrap();
        }
    }
    text
}

fn ask<T: Real, B: LowerHex>(
    model: &Model<'_>,
    method: Method,
    parameters: [f64; 2],
    t: f64,
    bits: fn(T) -> B,
) -> Result<String, EvaluateError> {
    let mut workspace = Box::new(Workspace::<T>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    evaluator.prepare(&Query::new(parameters.map(T::from_f64), method))?;
    let mut instant = evaluator.at(T::from_f64(t))?;
    let mut text = String::new();
    let mut line = |name: &str, numbers: &[T]| {
        write!(text, "{method:?} {} {parameters:?} {t} {name}", size_of::<T>() * 8).unwrap();
        for &number in numbers {
            write!(text, " {:x}", bits(number)).unwrap();
        }
        text.push('\n');
    };
    let shape = instant.observables()?;
    line(
        "observables",
        &[
            shape.axial_length,
            shape.half_width,
            shape.half_diagonal,
            shape.rear_depth,
            shape.velocity,
            shape.centroid,
        ],
    );
    line("errors", &[instant.expected_error()?, instant.error_bound()?]);
    for outline in [MIDPLANE, DIAGONAL] {
        let mut points = [[T::ZERO; 2]; 32];
        let count = instant.outline(outline, Frame::Centroid, &mut points)?;
        line(outline, points[..count].as_flattened());
    }
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let mut vectors = [[T::ZERO; 3]; 32];
    let count = instant.positions(&scene, &mut vectors)?;
    line("positions", vectors[..count].as_flattened());
    let count = instant.velocities(&scene, &mut vectors)?;
    line("velocities", vectors[..count].as_flattened());
    Ok(text)
}

#[test]
fn a_file_of_the_format_has_the_stored_answers() {
    assert_eq!(FILE[4..8], FORMAT.to_le_bytes());
    let (found, lines) = (answers(FILE), ANSWERS.lines().count());
    assert!(lines == 1 + 2 * 2 * 3 * 6, "{lines} lines are stored");
    for (found, stored) in found.lines().zip(ANSWERS.lines()) {
        assert_eq!(found, stored);
    }
    assert_eq!(found.lines().count(), lines);
}

#[test]
fn every_other_format_is_refused_by_its_number() {
    for version in (0..32).chain([u32::MAX]).filter(|version| *version != FORMAT) {
        let mut file = FILE.to_vec();
        file[4..8].copy_from_slice(&version.to_le_bytes());
        let error = Model::open(&file).unwrap_err();
        assert_eq!(
            error,
            OpenError::Version {
                found: version,
                supported: FORMAT
            }
        );
        let advice = if version > FORMAT {
            "update the reader"
        } else {
            "build the model again"
        };
        let text = error.to_string();
        assert!(
            text.contains(&format!("format version {version};")) && text.contains(advice),
            "{text}"
        );
    }
}
