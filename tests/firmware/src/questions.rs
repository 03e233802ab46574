//! Questions whose answers the firmware and the host must agree on, bit for bit.

use capsule_core::mechanics::Stencil;
use capsule_core::{EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Query, Scene, Workspace};

/// Ca, a/l.
const PARAMETERS: [[f32; 2]; 5] = [[0.1, 0.9], [0.03, 1.1], [0.005, 0.85], [0.085, 0.787], [0.042, 0.943]];
const METHODS: [Method; 2] = [Method::Direct, Method::Paper];
const INSTANTS: [f32; 4] = [0.0, 0.4, 1.234, 3.0];

/// Number of questions.
pub const COUNT: usize = PARAMETERS.len() * METHODS.len() * INSTANTS.len();

/// Answers question number `i`: every number of the answer goes to `emit`, in an order of its own.
pub fn answer(
    model: &Model<'_>,
    workspace: &mut Workspace<f32>,
    i: usize,
    emit: &mut impl FnMut(f32),
) -> Result<(), EvaluateError> {
    let [set, instant] = [i / INSTANTS.len(), i % INSTANTS.len()];
    let [capillary_number, confinement] = PARAMETERS[set % PARAMETERS.len()];
    let (method, t) = (METHODS[set / PARAMETERS.len() % METHODS.len()], INSTANTS[instant]);
    let mut evaluator = Evaluator::new(model, workspace)?;
    evaluator.prepare(&Query {
        extrapolate: true,
        step: Some(0.02),
        ..Query::new([capillary_number, confinement], method)
    })?;
    let mut instant = evaluator.at(t)?;
    let found = instant.observables()?;
    for value in [
        found.axial_length,
        found.half_width,
        found.half_diagonal,
        found.rear_depth,
    ] {
        emit(value);
    }
    emit(found.velocity);
    emit(found.centroid);
    emit(instant.volume()?);
    emit(instant.expected_error()?);
    let mut points = [[0.0; 3]; 3];
    let some = Scene {
        nodes: Nodes::List(&[0, 7, 31]),
        frame: Frame::Laboratory,
    };
    instant.positions(&some, &mut points)?;
    points.as_flattened().iter().copied().for_each(&mut *emit);
    instant.velocities(&some, &mut points)?;
    points.as_flattened().iter().copied().for_each(&mut *emit);
    let mut outline = [[0.0; 2]; 128];
    let count = instant.outline(MIDPLANE, Frame::Laboratory, &mut outline)?;
    outline.iter().take(count).flatten().copied().for_each(&mut *emit);
    let mut sector = [[0.0; 3]; 512];
    let membrane = instant.membrane(&mut sector)?;
    let totals = membrane.totals()?;
    for total in [totals.area, totals.energy, totals.pressure_drop] {
        emit(total);
    }
    let deformation = membrane.deformation(&Stencil::at(&model.mesh(), 31)?)?;
    let pairs = [deformation.stretches(), deformation.tensions()];
    pairs.as_flattened().iter().copied().for_each(&mut *emit);
    deformation
        .directions()
        .as_flattened()
        .iter()
        .copied()
        .for_each(&mut *emit);
    emit(deformation.area_dilation());
    emit(deformation.energy_density());
    deformation.load(capillary_number)?.into_iter().for_each(emit);
    Ok(())
}
