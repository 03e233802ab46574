//! One query's view of the model: the double POD of both fields with the parameters already contracted.

use crate::Real;
use crate::linalg::part;
use crate::model::wire::{self, Cluster};
use crate::model::{MatrixView, Model};

/// What both methods work on: the interpolated coefficients of displacement and velocity at the stored instants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<'a, 's, T> {
    pub(crate) times: Times<'a>,
    pub(crate) displacement: Field<'a, 's, T>,
    pub(crate) velocity: Field<'a, 's, T>,
    cross_product: MatrixView<'a>,
}

impl<'a, 's, T: Real> Motion<'a, 's, T> {
    /// `psi` holds psi_u and psi_v of eqs. (23) and (24).
    pub(crate) fn new<const K: usize>(model: &Model<'a>, cluster: &Cluster<'a>, psi: &'s [[T; K]; 2]) -> Self {
        Self {
            times: Times(model.times()),
            displacement: Field::new(&cluster.displacement, &psi[0]),
            velocity: Field::new(&cluster.velocity, &psi[1]),
            cross_product: MatrixView::new(&cluster.cross_product),
        }
    }

    /// out <- Phi_u^T Phi_v xi: the displacement's rate from the velocity's coefficients.
    pub(crate) fn rate(&self, xi: &[T], out: &mut [T]) {
        self.cross_product.multiply(0, xi, out);
    }

    /// out <- out + Phi_v^T Phi_u rate: the velocity's coefficients of a displacement's rate.
    pub(crate) fn add_velocity(&self, rate: &[T], out: &mut [T]) {
        for (k, rate) in rate.iter().enumerate() {
            self.cross_product.add_row(k, *rate, out);
        }
    }
}

/// A field of a cluster at the query's parameters: coefficients(t_i) = A(t_i) psi.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field<'a, 's, T> {
    pub(crate) modes: MatrixView<'a>,
    translation: MatrixView<'a>,
    coefficients: MatrixView<'a>,
    psi: &'s [T],
}

impl<'a, 's, T: Real> Field<'a, 's, T> {
    /// `psi` holds at least K_c entries.
    pub(crate) fn new(field: &wire::Field<'a>, psi: &'s [T]) -> Self {
        let coefficients = MatrixView::new(&field.coefficients);
        let psi = part(psi, 0..coefficients.columns());
        Self {
            modes: MatrixView::new(&field.modes),
            translation: MatrixView::new(&field.translation),
            coefficients,
            psi,
        }
    }

    /// K, the number of coefficients: the translation and one a mode.
    pub(crate) fn rank(&self) -> usize {
        self.modes.columns() + 1
    }

    /// Coefficient `k` at the stored instant `i`.
    pub(crate) fn coefficient(&self, i: usize, k: usize) -> T {
        match k.checked_sub(1) {
            None => self.translation.dot(i, self.psi),
            Some(mode) => self.coefficients.dot(i * self.modes.columns() + mode, self.psi),
        }
    }

    /// All coefficients at the stored instant `i` (eqs. 21 to 24), as many as `out` holds.
    pub(crate) fn at_instant(&self, i: usize, out: &mut [T]) {
        if let Some((translation, shape)) = out.split_first_mut() {
            *translation = self.translation.dot(i, self.psi);
            self.coefficients.multiply(i * self.modes.columns(), self.psi, shape);
        }
    }
}

/// The stored instants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Times<'a>(pub(crate) MatrixView<'a>);

impl Times<'_> {
    /// Number of instants.
    pub(crate) fn count(&self) -> usize {
        self.0.rows()
    }

    /// Instant `i`.
    pub(crate) fn get<T: Real>(&self, i: usize) -> T {
        T::from_f32(self.0.get(i, 0))
    }

    /// The interval [t_i, t_i+1] that holds t, by halving; the first or last one outside.
    pub(crate) fn interval<T: Real>(&self, t: T) -> usize {
        let (mut low, mut high) = (0, self.count() - 1);
        while high - low > 1 {
            let middle = (low + high) / 2;
            *(if t < self.get(middle) { &mut high } else { &mut low }) = middle;
        }
        low
    }
}
