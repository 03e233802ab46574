//! Normal equations of a least-squares problem, and the elimination of its nuisance parameters.

use crate::algebra::Factor;
use crate::residuals::{MODE, MODES, NUISANCES};

/// Cosines of a place that products of the model's error's need: cos(0) to cos(2 (MODES - 1)).
pub(crate) const COSINES: usize = 2 * MODES - 1;

/// The derivatives of a residual by the nuisance parameters.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) head: [f64; MODE],
    /// Those of the model's error are the first [`MODES`] of these, with the other sign.
    pub(crate) cosines: [f64; COSINES],
}

impl Row {
    /// All derivatives, one after the other.
    pub(crate) fn all(&self) -> [f64; NUISANCES] {
        let mut all = [0.0; NUISANCES];
        let (head, modes) = all.split_at_mut(MODE);
        head.copy_from_slice(&self.head);
        modes
            .iter_mut()
            .zip(self.cosines)
            .for_each(|(entry, cosine)| *entry = -cosine);
        all
    }
}

/// Weighted products of the columns of a least-squares problem: some leading columns, the first of which are the
/// residuals, and the nuisance parameters'.
#[derive(Clone, Debug)]
pub(crate) struct Products<const L: usize> {
    leading: [[f64; L]; L],
    mixed: [[f64; NUISANCES]; L],
    nuisances: [[f64; NUISANCES]; NUISANCES],
    /// Sums of the cosines. Products of two of them are half the sums of two others, so these make the products.
    cosines: [f64; COSINES],
    /// How many of the model's error's cosines take part.
    modes: usize,
}

/// The leading columns without what the nuisance parameters can make of them.
#[derive(Clone, Debug)]
pub(crate) struct Eliminated<const L: usize> {
    /// Their products.
    pub(crate) leading: [[f64; L]; L],
    /// By how much of each nuisance parameter a unit of each column is made up for.
    pub(crate) solved: [[f64; NUISANCES]; L],
    /// The products of the nuisance parameters' columns.
    pub(crate) nuisances: [[f64; NUISANCES]; NUISANCES],
}

impl<const L: usize> Products<L> {
    pub(crate) fn new(modes: usize) -> Self {
        Self {
            leading: [[0.0; L]; L],
            mixed: [[0.0; NUISANCES]; L],
            nuisances: [[0.0; NUISANCES]; NUISANCES],
            cosines: [0.0; COSINES],
            modes,
        }
    }

    pub(crate) fn add_prior(&mut self, nuisance: usize, weight: f64, value: f64) {
        self.leading[0][0] += weight * value * value;
        self.mixed[0][nuisance] += weight * value;
        self.nuisances[nuisance][nuisance] += weight;
    }

    pub(crate) fn add(&mut self, weight: f64, leading: &[f64; L], row: &Row) {
        let modes = self.modes;
        for (i, a) in leading.iter().enumerate() {
            let a = weight * a;
            add(&mut self.leading[i], a, leading);
            let (head, mixed) = self.mixed[i].split_at_mut(MODE);
            add(head, a, &row.head);
            add(&mut mixed[..modes], -a, &row.cosines);
        }
        for (i, a) in row.head.iter().enumerate() {
            let a = weight * a;
            let (head, mixed) = self.nuisances[i].split_at_mut(MODE);
            add(head, a, &row.head);
            add(&mut mixed[..modes], -a, &row.cosines);
        }
        let count = (2 * modes).min(COSINES);
        add(&mut self.cosines[..count], weight, &row.cosines);
    }

    /// Eliminates the nuisance parameters (Schur complement); none if they are not determined.
    pub(crate) fn eliminate(mut self) -> Option<Eliminated<L>> {
        for k in 0..self.modes {
            for i in 0..MODE {
                self.nuisances[MODE + k][i] = self.nuisances[i][MODE + k];
            }
            // cos(k x) cos(m x) = (cos((k + m) x) + cos((k - m) x)) / 2
            for m in 0..self.modes {
                self.nuisances[MODE + k][MODE + m] += 0.5 * (self.cosines[k + m] + self.cosines[k.abs_diff(m)]);
            }
        }
        let factor = Factor::leading(&self.nuisances, MODE + self.modes)?;
        let solved = self.mixed.map(|mixed| factor.solve(&mixed));
        let mut leading = self.leading;
        for (row, mixed) in leading.iter_mut().zip(&self.mixed) {
            for (entry, solved) in row.iter_mut().zip(&solved) {
                *entry -= mixed.iter().zip(solved).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        Some(Eliminated {
            leading,
            solved,
            nuisances: self.nuisances,
        })
    }
}

/// Adds a multiple of some numbers to others.
fn add(sums: &mut [f64], factor: f64, numbers: &[f64]) {
    sums.iter_mut()
        .zip(numbers)
        .for_each(|(sum, number)| *sum += factor * number);
}
