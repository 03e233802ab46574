//! The configurations of one confinement: a row of the design.

use capsule_fom::Configuration;

/// The configurations of one confinement.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub confinement: f64,
    /// Rising.
    pub capillary_numbers: Vec<f64>,
}

impl Row {
    /// That of the row's capillary number `index`.
    pub fn configuration(&self, index: usize) -> Configuration {
        Configuration {
            capillary_number: self.capillary_numbers[index],
            confinement: self.confinement,
        }
    }
}
