//! Samples and their coordinates as a model file stores them, for interpolation outside a model.

use capsule_core::Parameters;
use capsule_core::interpolate::Coordinates;
use capsule_core::model::wire::{Matrix, Samples};

/// The bytes of samples, by rising last parameter, and of their places.
#[derive(Debug, Clone)]
pub struct PlacedSamples {
    count: u32,
    dimensions: u32,
    parameters: Vec<u8>,
    places: Vec<u8>,
}

impl PlacedSamples {
    /// Places rows of as many parameters each, at most four, in the coordinates.
    pub fn new<'s>(samples: impl IntoIterator<Item = &'s [f32]>, coordinates: &Coordinates<'_>) -> Self {
        let mut placed = Self {
            count: 0,
            dimensions: 0,
            parameters: Vec::new(),
            places: Vec::new(),
        };
        for sample in samples {
            let doubles: Vec<f64> = sample.iter().copied().map(f64::from).collect();
            let Some(parameters) = Parameters::new(&doubles) else {
                continue;
            };
            let place = coordinates.transform(&parameters).map(|value| value as f32);
            placed
                .parameters
                .extend(sample.iter().flat_map(|value| value.to_le_bytes()));
            let place = &place[..sample.len()];
            placed.places.extend(place.iter().flat_map(|value| value.to_le_bytes()));
            placed.count += 1;
            placed.dimensions = sample.len() as u32;
        }
        placed
    }

    /// As the interpolation takes them.
    pub fn samples(&self) -> Samples<'_> {
        Samples {
            parameters: Matrix::f32(self.count, self.dimensions, &self.parameters),
            places: Matrix::f32(self.count, self.dimensions, &self.places),
        }
    }
}
