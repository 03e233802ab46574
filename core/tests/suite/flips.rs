//! Every bit of a small model, flipped under a checksum that agrees: refused, or answers that are finite or errors.

use crate::common::Family;
use crate::header::with_header;
use capsule_core::{Evaluator, Frame, Method, Model, Nodes, Query, Scene, Workspace};

const HEADER: usize = 16;

/// Asks for everything that a changed number can reach. Whether the model was opened.
fn ask(payload: &[u8], workspace: &mut Workspace<f32>, vectors: &mut [[f32; 3]]) -> bool {
    let file = with_header(payload);
    let Ok(model) = Model::open(&file) else { return false };
    let Ok(mut evaluator) = Evaluator::new(&model, workspace) else {
        return true;
    };
    for (parameters, method) in [
        ([0.05, 0.83], Method::Direct),
        ([0.05, 1.1], Method::Direct),
        ([0.05, 1.1], Method::Paper),
    ] {
        let query = Query {
            extrapolate: true,
            step: Some(1.0),
            ..Query::new(parameters, method)
        };
        if evaluator.prepare(&query).is_err() {
            continue;
        }
        let Ok(mut instant) = evaluator.at(1.3) else { continue };
        if let Ok(found) = instant.observables() {
            assert!(found.axial_length.is_finite() && found.velocity.is_finite() && found.rear_depth.is_finite());
        }
        assert!(instant.volume().map_or(true, f32::is_finite));
        for number in [instant.expected_error(), instant.error_bound(), instant.centroid()] {
            assert!(number.map_or(true, f32::is_finite));
        }
        let scene = Scene {
            nodes: Nodes::All,
            frame: Frame::Laboratory,
        };
        let finite = |vectors: &[[f32; 3]]| vectors.as_flattened().iter().all(|number| number.is_finite());
        if let Ok(count) = instant.positions(&scene, vectors) {
            assert!(finite(&vectors[..count]));
        }
        if let Ok(count) = instant.velocities(&scene, vectors) {
            assert!(finite(&vectors[..count]));
        }
    }
    true
}

/// Flips every `stride`-th bit, one at a time.
fn flip(stride: usize) {
    let file = Family::small().file();
    let mut payload = file[HEADER..].to_vec();
    let (mut workspace, mut vectors) = (Box::<Workspace<f32>>::default(), vec![[0.0; 3]; 1 << 16]);
    assert!(ask(&payload, &mut workspace, &mut vectors));
    let (mut flips, mut refused) = (0, 0);
    for bit in (0..8 * payload.len()).step_by(stride) {
        payload[bit / 8] ^= 1 << (bit % 8);
        flips += 1;
        refused += usize::from(!ask(&payload, &mut workspace, &mut vectors));
        payload[bit / 8] ^= 1 << (bit % 8);
    }
    println!("{flips} bits flipped, {refused} refused, the others answered");
    assert!(refused > 0 && refused < flips);
}

/// Miri is slow: there a stride that has no factor in common with the eight bits of a byte and the four bytes of a
/// number.
#[test]
fn flipped_bits_are_refused_or_harmless() {
    flip(if cfg!(miri) { 10_007 } else { 1 });
}
