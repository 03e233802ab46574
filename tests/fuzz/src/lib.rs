//! The work of the fuzz targets, for the targets and for the replay test, and what they share: a small model, numbers
//! near and far from its ranges, and checks of the answers.

mod calls;
mod model;
mod query;

pub use calls::calls;
pub use model::model;
pub use query::query;

#[path = "../../../core/tests/suite/common/mod.rs"]
mod common;
#[path = "../../../core/tests/suite/header.rs"]
mod header;

use arbitrary::{Arbitrary, Unstructured};
use capsule_core::mechanics::Totals;
use capsule_core::{
    DIAGONAL, Evaluator, Frame, MAX_PARAMETERS, MIDPLANE, Method, Model, Nodes, Query, Scene, Workspace,
};
use std::sync::LazyLock;

use common::Family;
use header::with_header;

/// A small model's file.
static FILE: LazyLock<Vec<u8>> = LazyLock::new(|| Family::small().file());

/// A number: usually near a range, sometimes any pattern of bits.
#[derive(Arbitrary, Clone, Copy, Debug)]
enum Number {
    Bits(u32),
    Share(u16),
}

impl Number {
    /// A share of the range, from a fifth below it to a fifth above it.
    fn of(self, [least, greatest]: [f32; 2]) -> f32 {
        match self {
            Self::Bits(bits) => f32::from_bits(bits),
            Self::Share(share) => least + (f32::from(share) / 65535.0 * 1.4 - 0.2) * (greatest - least),
        }
    }
}

/// A query and its instants.
#[derive(Arbitrary, Debug)]
struct Question {
    parameters: [Number; MAX_PARAMETERS],
    paper: bool,
    extrapolate: bool,
    step: Number,
    instants: [Number; 2],
    node: u16,
}

/// The value that the bytes encode, if there are enough of them.
fn input<'a, I: Arbitrary<'a>>(bytes: &'a [u8]) -> Option<I> {
    I::arbitrary_take_rest(Unstructured::new(bytes)).ok()
}

/// Asks a model every question, and checks that the answers are finite.
///
/// # Panics
/// If an answer is not finite.
fn ask(model: &Model<'_>, workspace: &mut Workspace<f32>, question: &Question) {
    let Ok(mut evaluator) = Evaluator::new(model, workspace) else {
        return;
    };
    let ranges = model.parameters();
    let parameters: Vec<f32> = question
        .parameters
        .iter()
        .zip(ranges)
        .map(|(number, range)| number.of([range.min as f32, range.max as f32]))
        .collect();
    let Some(parameters) = capsule_core::Parameters::new(&parameters) else {
        return;
    };
    let method = if question.paper { Method::Paper } else { Method::Direct };
    let end = model.end_time();
    let step = question.step.of([end / 64.0, end]);
    // Few steps: executions stay short.
    if 0.0 < step && step < end / 64.0 {
        return;
    }
    let query = Query {
        extrapolate: question.extrapolate,
        step: Some(step),
        ..Query::new(parameters, method)
    };
    if evaluator.prepare(&query).is_err() {
        return;
    }
    for t in question.instants {
        let Ok(mut instant) = evaluator.at(t.of([0.0, end])) else {
            continue;
        };
        if let Ok(found) = instant.observables() {
            let all = [
                found.axial_length,
                found.half_width,
                found.half_diagonal,
                found.rear_depth,
                found.velocity,
                found.centroid,
            ];
            assert!(all.iter().all(|number| number.is_finite()), "{found:?}");
        }
        assert!(instant.volume().map_or(true, f32::is_finite));
        for number in [instant.expected_error(), instant.error_bound(), instant.centroid()] {
            assert!(number.map_or(true, f32::is_finite));
        }
        let mut points = vec![[0.0; 2]; 64];
        for name in [MIDPLANE, DIAGONAL] {
            if let Ok(count) = instant.outline(name, Frame::Laboratory, &mut points) {
                assert!(points[..count].as_flattened().iter().all(|number| number.is_finite()));
            }
        }
        let mut vectors = vec![[0.0; 3]; model.mesh().nodes()];
        let nodes = [question.node];
        let scene = Scene {
            nodes: if question.node % 2 == 0 {
                Nodes::All
            } else {
                Nodes::List(&nodes)
            },
            frame: Frame::Centroid,
        };
        if let Ok(count) = instant.positions(&scene, &mut vectors) {
            assert!(vectors[..count].as_flattened().iter().all(|number| number.is_finite()));
        }
        if let Ok(count) = instant.velocities(&scene, &mut vectors) {
            assert!(vectors[..count].as_flattened().iter().all(|number| number.is_finite()));
        }
        if let Ok(membrane) = instant.membrane(&mut vectors) {
            let finite = |totals: Totals<f32>| {
                [totals.area, totals.energy, totals.pressure_drop]
                    .iter()
                    .all(|x| x.is_finite())
            };
            assert!(membrane.totals().map_or(true, finite));
        }
    }
}
