//! The question: the words of a line before the answer.

use crate::words::{Text, Word};
use capsule_core::Method;

/// The scalar of a computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// binary32.
    Single,
    /// binary64.
    Double,
}

/// A question of a prepared query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ask {
    /// The observables, the centroid among them.
    Observables,
    /// The expected error.
    ExpectedError,
    /// The volume.
    Volume,
    /// The outline of the midplane, laboratory frame.
    Midplane,
    /// The outline of the diagonal, centroid's frame.
    Diagonal,
    /// Positions of all nodes, laboratory frame.
    Positions,
    /// Positions of all nodes as a frame of a playback, laboratory frame.
    Frame,
    /// Positions of the nodes 0, 7 and 31, centroid's frame.
    SomePositions,
    /// Velocities of all nodes, laboratory frame.
    Velocities,
    /// Velocities of the nodes of the midplane, centroid's frame.
    MidplaneVelocities,
    /// Area, energy and pressure drop.
    Membrane,
    /// Stretches, tensions and load at node 31.
    Deformation,
}

impl Ask {
    /// All questions and their names in the file.
    pub const ALL: [(Self, &'static str); 12] = [
        (Self::Observables, "observables"),
        (Self::ExpectedError, "expected-error"),
        (Self::Volume, "volume"),
        (Self::Midplane, "midplane"),
        (Self::Diagonal, "diagonal"),
        (Self::Positions, "positions"),
        (Self::Frame, "frame"),
        (Self::SomePositions, "some-positions"),
        (Self::Velocities, "velocities"),
        (Self::MidplaneVelocities, "midplane-velocities"),
        (Self::Membrane, "membrane"),
        (Self::Deformation, "deformation"),
    ];
}

/// A query and a question. Numbers are kept as bits, so that a case is the same in both precisions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Scalar of the computation.
    pub precision: Precision,
    /// Method.
    pub method: Method,
    /// Answer outside the domain too.
    pub extrapolate: bool,
    /// Bits of Ca, a/l, the step and t.
    pub numbers: [u64; 4],
    /// The question.
    pub ask: Ask,
}

impl Case {
    /// A case of numbers in their precision.
    pub fn new<T: Word>(method: Method, extrapolate: bool, numbers: [T; 4], ask: Ask) -> Self {
        Self {
            precision: if T::DIGITS == <f32 as Word>::DIGITS {
                Precision::Single
            } else {
                Precision::Double
            },
            method,
            extrapolate,
            numbers: numbers.map(T::bits),
            ask,
        }
    }

    /// Reads the words before the answer.
    pub fn parse(line: &str) -> Option<Self> {
        let mut words = line.split(' ');
        let precision = match words.next()? {
            "f32" => Precision::Single,
            "f64" => Precision::Double,
            _ => return None,
        };
        let method = match words.next()? {
            "direct" => Method::Direct,
            "paper" => Method::Paper,
            _ => return None,
        };
        let extrapolate = match words.next()? {
            "within" => false,
            "anywhere" => true,
            _ => return None,
        };
        let mut numbers = [0; 4];
        for number in &mut numbers {
            *number = u64::from_str_radix(words.next()?, 16).ok()?;
        }
        let name = words.next()?;
        let (ask, _) = Ask::ALL.into_iter().find(|(_, known)| *known == name)?;
        Some(Self {
            precision,
            method,
            extrapolate,
            numbers,
            ask,
        })
    }

    /// Writes the words before the answer.
    pub fn write<const N: usize>(&self, text: &mut Text<N>) {
        let (precision, digits) = match self.precision {
            Precision::Single => ("f32", <f32 as Word>::DIGITS),
            Precision::Double => ("f64", <f64 as Word>::DIGITS),
        };
        text.word(precision);
        text.word(match self.method {
            Method::Direct => "direct",
            Method::Paper => "paper",
        });
        text.word(if self.extrapolate { "anywhere" } else { "within" });
        for number in self.numbers {
            text.hexadecimal(number, digits);
        }
        if let Some((_, name)) = Ask::ALL.into_iter().find(|(ask, _)| *ask == self.ask) {
            text.word(name);
        }
    }
}
