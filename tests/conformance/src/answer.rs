//! Asking a case, and what comes out: its scalars in full, of many numbers their count and the CRC-32 of their bytes.

use crate::line::{Ask, Case, Precision};
use crate::words::{Text, Word};
use capsule_core::error::EvaluateError;
use capsule_core::mechanics::Stencil;
use capsule_core::{DIAGONAL, Evaluator, Frame, MIDPLANE, Model, Nodes, Playback, Query, Real, Scene, Workspace};
use crc::{CRC_32_ISO_HDLC, Crc};

/// The most nodes of a mesh.
const NODES: usize = 4096;
/// Numbers of a playback of a mesh of as many nodes with the square's symmetry.
const ROOM: usize = 29 * NODES / 8;
static CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Whether a case has an answer or an error.
pub type Outcome = Result<(), EvaluateError>;

/// Storage for asking in both precisions.
pub struct Asker {
    single: Storage<f32>,
    double: Storage<f64>,
}

struct Storage<T: Real> {
    workspace: Workspace<T>,
    playback: Playback<T, [T; ROOM]>,
    vectors: [[T; 3]; NODES],
    points: [[T; 2]; 512],
}

impl<T: Word> Storage<T> {
    const fn new() -> Self {
        Self {
            workspace: Workspace::new(),
            playback: Playback::new([T::ZERO; ROOM]),
            vectors: [[T::ZERO; 3]; NODES],
            points: [[T::ZERO; 2]; 512],
        }
    }
}

impl Asker {
    /// Nothing is computed yet.
    pub const fn new() -> Self {
        Self {
            single: Storage::new(),
            double: Storage::new(),
        }
    }

    /// Writes the answer's words after those of the case; an error is a word too.
    pub fn answer<const N: usize>(&mut self, model: &Model<'_>, case: &Case, text: &mut Text<N>) {
        let outcome = match case.precision {
            Precision::Single => self.single.answer(model, case, text),
            Precision::Double => self.double.answer(model, case, text),
        };
        if let Err(error) = outcome {
            text.word(match error {
                EvaluateError::Value { .. } => "error-value",
                EvaluateError::Parameter { .. } => "error-parameter",
                EvaluateError::FarFromSamples { .. } => "error-far-from-samples",
                EvaluateError::BeyondExtrapolation { .. } => "error-beyond-extrapolation",
                EvaluateError::OutsideDomain { .. } => "error-outside-domain",
                EvaluateError::BeyondSteadyLimit { .. } => "error-beyond-steady-limit",
                EvaluateError::Weights { .. } => "error-weights",
                EvaluateError::NotFinite => "error-not-finite",
                EvaluateError::Capacity { .. } => "error-capacity",
                _ => "error-other",
            });
        }
    }
}

impl Default for Asker {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Word> Storage<T> {
    fn answer<const N: usize>(&mut self, model: &Model<'_>, case: &Case, text: &mut Text<N>) -> Outcome {
        let [capillary_number, confinement, step, t] = case.numbers.map(T::from_bits);
        let mut evaluator = Evaluator::new(model, &mut self.workspace)?;
        evaluator.prepare(&Query {
            extrapolate: case.extrapolate,
            step: Some(step),
            ..Query::new([capillary_number, confinement], case.method)
        })?;
        if case.ask == Ask::Frame {
            let count = evaluator.frame(t, Frame::Laboratory, &mut self.playback, &mut self.vectors)?;
            many(self.vectors.iter().take(count).flatten(), text);
            return Ok(());
        }
        let mut instant = evaluator.at(t)?;
        match case.ask {
            Ask::Frame => {}
            Ask::Observables => {
                let found = instant.observables()?;
                text.number(found.axial_length);
                text.number(found.half_width);
                text.number(found.half_diagonal);
                text.number(found.rear_depth);
                text.number(found.velocity);
                text.number(found.centroid);
            }
            Ask::ExpectedError => text.number(instant.expected_error()?),
            Ask::Volume => text.number(instant.volume()?),
            Ask::Midplane | Ask::Diagonal => {
                let (name, frame) = if case.ask == Ask::Midplane {
                    (MIDPLANE, Frame::Laboratory)
                } else {
                    (DIAGONAL, Frame::Centroid)
                };
                let count = instant.outline(name, frame, &mut self.points)?;
                many(self.points.iter().take(count).flatten(), text);
            }
            Ask::Positions | Ask::SomePositions => {
                let scene = if case.ask == Ask::Positions {
                    Scene {
                        nodes: Nodes::All,
                        frame: Frame::Laboratory,
                    }
                } else {
                    Scene {
                        nodes: Nodes::List(&[0, 7, 31]),
                        frame: Frame::Centroid,
                    }
                };
                let count = instant.positions(&scene, &mut self.vectors)?;
                many(self.vectors.iter().take(count).flatten(), text);
            }
            Ask::Velocities | Ask::MidplaneVelocities => {
                let scene = if case.ask == Ask::Velocities {
                    Scene {
                        nodes: Nodes::All,
                        frame: Frame::Laboratory,
                    }
                } else {
                    Scene {
                        nodes: Nodes::Set(MIDPLANE),
                        frame: Frame::Centroid,
                    }
                };
                let count = instant.velocities(&scene, &mut self.vectors)?;
                many(self.vectors.iter().take(count).flatten(), text);
            }
            Ask::Membrane => {
                let totals = instant.membrane(&mut self.vectors)?.totals()?;
                for total in [totals.area, totals.energy, totals.pressure_drop] {
                    text.number(total);
                }
            }
            Ask::Deformation => {
                let membrane = instant.membrane(&mut self.vectors)?;
                let found = membrane.deformation(&Stencil::at(&model.mesh(), 31)?)?;
                for number in found.stretches().into_iter().chain(found.tensions()) {
                    text.number(number);
                }
                for number in found.load(capillary_number)? {
                    text.number(number);
                }
            }
        }
        Ok(())
    }
}

/// Writes how many numbers there are and the CRC-32 of their little-endian bytes.
fn many<'n, T: Word, const N: usize>(numbers: impl Iterator<Item = &'n T>, text: &mut Text<N>) {
    let mut digest = CHECKSUM.digest();
    let mut count = 0;
    for number in numbers {
        let bytes = number.bits().to_le_bytes();
        digest.update(bytes.get(..T::DIGITS / 2).unwrap_or_default());
        count += 1;
    }
    text.hexadecimal(count, 8);
    text.hexadecimal(digest.finalize().into(), 8);
}
