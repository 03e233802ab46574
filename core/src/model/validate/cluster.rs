//! Checks of a cluster: samples, errors, motion.

use super::checks::{ANY, MAX, POSITIVE, Range, TIME, Validator};
use crate::linalg::LANES;
use crate::model::error::OpenError;
use crate::model::wire::{Cluster, Errors, MAX_SAMPLES, Matrix, Samples, Span};

/// Order of the cubic splines.
const ORDER: usize = 4;

impl Validator {
    pub(super) fn samples(&mut self, samples: &Samples<'_>, parameters: usize, least: f32) {
        let (stored, places) = (&samples.parameters, &samples.places);
        let rows = stored.rows as usize;
        self.count("samples", rows.clamp(1, MAX_SAMPLES), rows);
        let samples = self.matrix("samples", stored, [rows, parameters], [least, MAX]);
        self.singles("samples", stored);
        self.matrix("places of the samples", places, [rows, parameters], ANY);
        self.singles("places of the samples", places);
        for second in 1..samples.rows() {
            let first = second - 1;
            // The last parameter in which they differ.
            let differing = (0..parameters)
                .rev()
                .find(|d| samples.get(first, *d) != samples.get(second, *d));
            let Some(d) = differing else {
                return self.refuse(OpenError::DuplicateSample { first, second });
            };
            let value = samples.get(second, d);
            if value < samples.get(first, d) {
                let expected = "more than in the sample before, whose later parameters are the same";
                self.number("samples", second * parameters + d, value, expected);
            }
        }
    }

    pub(super) fn errors(&mut self, errors: &Errors<'_>, samples: usize, error_times: usize) {
        let Errors {
            left_out,
            deviation,
            bound_factors,
            changes,
            floor,
        } = errors;
        self.matrix("leave-one-out errors", left_out, [samples, error_times], POSITIVE);
        self.matrix("deviations", deviation, [samples, 1], [f32::MIN_POSITIVE, MAX]);
        self.matrix("bound's factors", bound_factors, [error_times, 1], POSITIVE);
        self.matrix("changes between samples", changes, [error_times, 1], POSITIVE);
        self.fixed(
            *floor,
            &Range {
                what: "error floor",
                min: 0.0,
                max: 1e6,
            },
        );
    }

    pub(super) fn field(&mut self, cluster: &Cluster<'_>, nodes: usize, end_time: f32) {
        let (field, samples) = (&cluster.field, cluster.samples.parameters.rows as usize);
        let columns = |matrix: &Matrix<'_>| matrix.columns as usize;
        let (modes, axial) = (columns(&field.modes), columns(&field.axial_controls));
        self.matrix("modes", &field.modes, [panelled(nodes).saturating_mul(3), modes], ANY);
        let controls = self.knots(&field.knots, end_time);
        let mut slices = 0;
        for span in &field.spans {
            let columns = columns(&span.parameter_modes);
            self.matrix("parameter modes", &span.parameter_modes, [samples, columns], ANY);
            self.matrix("core", &span.core, [span.core.rows as usize, columns], self.length);
            slices += self.slices(span, modes);
        }
        self.count("slices", controls, slices);
        self.matrix("axial controls", &field.axial_controls, [controls, axial], self.length);
        self.matrix("axial modes", &field.axial_modes, [samples, axial], ANY);
    }

    /// Returns the number of controls.
    fn knots(&mut self, stored: &Matrix<'_>, end_time: f32) -> usize {
        let rows = stored.rows as usize;
        self.count("knots", rows.max(2 * ORDER), rows);
        let knots = self.matrix("knots", stored, [rows, 1], TIME);
        let controls = knots.rows().saturating_sub(ORDER);
        for index in 0..knots.rows() {
            let value = knots.get(index, 0);
            let fault = if index < ORDER && value != 0.0 {
                "0, as the first four"
            } else if index >= controls && value != end_time {
                "the end time, as the last four"
            } else if index > 0 && value < knots.get(index - 1, 0) {
                "no less than the one before"
            } else if index >= ORDER && value <= knots.get(index - ORDER, 0) {
                "more than the fourth before it"
            } else {
                continue;
            };
            self.number("knots", index, value, fault);
        }
        controls
    }

    /// The slices have no more panels than the modes need, and share out all rows. Returns how many there are.
    fn slices(&mut self, span: &Span<'_>, modes: usize) -> usize {
        let count = span.slices.data.len() / 2;
        let slices = self.indices("slices", &span.slices, count, modes.div_ceil(LANES) + 1);
        let panels: usize = slices.iter().sum();
        self.count("rows of the core", LANES * panels, span.core.rows as usize);
        count
    }
}

/// Number of rows that the panels of so many rows hold.
fn panelled(rows: usize) -> usize {
    rows.div_ceil(LANES).saturating_mul(LANES)
}
