//! The nodes at an instant, with quantities at them.

use crate::DatabaseError;
use crate::error::{finite, length};

/// The nodes at an instant.
#[derive(Debug, Clone)]
pub struct Instant<'a> {
    /// When, in l/V.
    pub time: f64,
    /// Where, one position a node.
    pub positions: &'a [[f64; 3]],
    /// Other quantities; the same at every instant.
    pub data: Vec<PointData<'a>>,
}

impl Instant<'_> {
    /// Checks that there are as many quantities as in the `first` instant, with one finite value a node.
    pub(crate) fn validate(&self, nodes: usize, first: &Instant) -> Result<(), DatabaseError> {
        length("quantities of an instant", first.data.len(), self.data.len())?;
        length("positions of an instant", nodes, self.positions.len())?;
        finite("positions of an instant", self.positions.as_flattened())?;
        for quantity in &self.data {
            let (name, components, values) = quantity.parts();
            length(&format!("values of `{name}`"), nodes * components, values.len())?;
            finite(&format!("`{name}`"), values)?;
        }
        Ok(())
    }
}

/// A quantity at the nodes.
#[derive(Debug, Clone, Copy)]
pub enum PointData<'a> {
    /// One number a node.
    Scalar(&'a str, &'a [f64]),
    /// One vector a node.
    Vector(&'a str, &'a [[f64; 3]]),
}

impl PointData<'_> {
    /// Name, number of components, values.
    pub(crate) fn parts(&self) -> (&str, usize, &[f64]) {
        match self {
            PointData::Scalar(name, values) => (name, 1, values),
            PointData::Vector(name, values) => (name, 3, values.as_flattened()),
        }
    }
}
