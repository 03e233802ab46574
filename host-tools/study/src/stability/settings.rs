//! Settings of both methods, on the model as it is: a model file is written again with other settings in it.

use capsule_core::interpolate::Coordinates;
use capsule_core::model::wire::{Contents, Samples};
use capsule_core::model::{MatrixView, encode};
use capsule_core::{Method, Model, Query, Scheme};
use capsule_offline::PlacedSamples;

use super::Row;
use super::truth::{Truth, errors};
use crate::StudyError;

/// The model file with other settings, and its samples where these place them.
pub(crate) fn changed(model: &Model, change: impl FnOnce(&mut Contents)) -> Result<Vec<u8>, StudyError> {
    /// Headroom over the likely size of the file.
    const LONGEST: usize = 64 << 20;
    let mut contents = model.contents().clone();
    change(&mut contents);
    let coordinates = Coordinates::new(&contents);
    let clusters = contents.clusters.iter();
    let placed: Vec<PlacedSamples> = clusters.map(|cluster| place(&cluster.samples, &coordinates)).collect();
    let mut contents = contents;
    for (cluster, placed) in contents.clusters.iter_mut().zip(&placed) {
        cluster.samples = placed.samples();
    }
    let mut bytes = vec![0; LONGEST];
    let length = encode(&contents, &mut bytes)?;
    bytes.truncate(length);
    Ok(bytes)
}

fn place(samples: &Samples, coordinates: &Coordinates) -> PlacedSamples {
    let parameters = MatrixView::new(&samples.parameters);
    let row = |row| (0..parameters.columns()).map(move |column| parameters.get(row, column));
    let rows: Vec<Vec<f32>> = (0..parameters.rows()).map(|index| row(index).collect()).collect();
    PlacedSamples::new(rows.iter().map(Vec::as_slice), coordinates)
}

const SCHEMES: [(Scheme, &str); 3] = [
    (Scheme::Euler, "Euler"),
    (Scheme::Heun, "Heun"),
    (Scheme::RungeKutta4, "RK4"),
];

/// Step and scheme, ranks, window, neighbours, radius, coordinates, precision.
pub(crate) fn rows(model: &Model, truths: &[Truth], quick: bool) -> Result<Vec<Row>, StudyError> {
    let mut rows = Vec::new();
    let steps: &[f64] = if quick {
        &[0.2, 0.02]
    } else {
        &[1.0, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005]
    };
    for (scheme, by) in SCHEMES {
        for step in steps {
            let query = |place: [f64; 2]| Query {
                step: Some(*step),
                scheme,
                ..Query::new(place, Method::Paper)
            };
            rows.push(Row::new(
                "step / (l/V)",
                *step,
                by,
                &errors::<f64>(model, truths, query)?,
            ));
        }
    }
    for (bits, by) in [(32.0, "direct"), (32.0, "paper"), (64.0, "direct"), (64.0, "paper")] {
        let method = if by == "direct" { Method::Direct } else { Method::Paper };
        let errors = if bits == 32.0 {
            errors::<f32>(model, truths, |place| Query::new(place, method))?
        } else {
            errors::<f64>(model, truths, |place| Query::new(place, method))?
        };
        rows.push(Row::new("bits of a number", bits, by, &errors));
    }
    const RANKS: [f64; 8] = [2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 13.0, 16.0];
    type Change = fn(&mut Contents, f64);
    let all: [(&str, Method, &[f64], Change); 8] = [
        ("m_u", Method::Paper, &RANKS, |contents, value| {
            contents.paper.displacement_rank = value as u32;
        }),
        ("m_v", Method::Paper, &RANKS, |contents, value| {
            contents.paper.velocity_rank = value as u32;
        }),
        (
            "R of the manifold / interval",
            Method::Paper,
            &[1.1, 1.5, 2.0, 3.0, 4.0],
            |contents, value| {
                contents.paper.window = value;
            },
        ),
        (
            "M",
            Method::Paper,
            &[6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 26.0, 29.0],
            |contents, value| {
                contents.paper.neighbours = value as u32;
            },
        ),
        (
            "R of the ellipse / distance of sample M",
            Method::Paper,
            &[1.01, 1.1, 1.2, 1.5, 2.0],
            |contents, value| {
                contents.paper.radius = value;
            },
        ),
        (
            "r",
            Method::Paper,
            &[0.5, 1.0, 1.9, 3.0, 5.0, 10.0],
            |contents, value| {
                contents.paper.scales[0] = value;
            },
        ),
        (
            "neighbours of the kernel",
            Method::Direct,
            &[6.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0, 32.0],
            |contents, value| {
                contents.kernel.neighbours = value as u32;
            },
        ),
        (
            "s of the kernel's plane",
            Method::Direct,
            &[0.5, 1.0, 1.5, 2.0, 3.0, 5.0],
            |contents, value| {
                contents.kernel.scales[0] = value;
            },
        ),
    ];
    for (setting, method, values, change) in all {
        let few = [values[0], values[values.len() - 1]];
        for value in if quick { &few } else { values } {
            let bytes = changed(model, |contents| change(contents, *value))?;
            let model = Model::open(&bytes)?;
            let errors = errors::<f64>(&model, truths, |place| Query::new(place, method))?;
            rows.push(Row::new(setting, *value, crate::name(method), &errors));
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_is_its_own_answer_whatever_the_settings() {
        let file = include_bytes!("../../../../models/capsule.crom");
        let model = Model::open(file).unwrap();
        assert_eq!(changed(&model, |_| ()).unwrap(), file);
        let samples = MatrixView::new(&model.contents().clusters[0].samples.parameters);
        let sample = [samples.get(100, 0), samples.get(100, 1)];
        let length = |file: &[u8]| {
            let model = Model::open(file).unwrap();
            let mut workspace = capsule_core::Workspace::<f32>::new();
            let mut evaluator = capsule_core::Evaluator::new(&model, &mut workspace).unwrap();
            evaluator.prepare(&Query::new(sample, Method::Direct)).unwrap();
            evaluator.at(2.0).unwrap().observables().unwrap().axial_length
        };
        let stretched = changed(&model, |contents| contents.kernel.scales[0] = 3.0).unwrap();
        let (expected, found) = (length(file), length(&stretched));
        assert!((found - expected).abs() < 1e-4, "{found}, not {expected}");
    }
}
