//! Successive frames of one motion.
//!
//! Between two knots the surface is a linear combination of four surfaces, those of the control vectors with nonzero
//! splines there: a frame costs four multiplications a number, for any number of modes. The surfaces of four successive
//! control vectors are computed together, when the first of them is needed; two such groups hold the four of any
//! instant.

use crate::Real;
use crate::error::EvaluateError;
use crate::linalg::{LANES, TWO_PANELS, in_vectors, slice_or_empty, slice_or_empty_mut};
use crate::model::wire::Cluster;
use crate::model::{MatrixView, Mesh, Model, QuantizedVectors, components};
use crate::motion::spline::ORDER;
use crate::motion::{Motion, Quantity};
use crate::query::Prepared;
use crate::surface::reconstruct::{Snapshot, prefix_mut};

/// Number of cached groups of four control vectors.
const GROUPS: usize = 2;
/// Number of cached surfaces.
const SURFACES: usize = GROUPS * ORDER;

/// Cache of [`Evaluator::frame`](crate::Evaluator::frame) between frames, in the caller's storage: an array, a slice or
/// a vector of [`playback_len`] numbers.
#[derive(Clone, Debug)]
pub struct Playback<T, R> {
    storage: R,
    /// The query of the cached surfaces.
    prepared: Option<Prepared<T>>,
    /// Numbers of the cached groups: group g is stored at g mod 2.
    groups: [Option<usize>; GROUPS],
}

/// Numbers of storage that a [`Playback`] of a model needs.
pub fn playback_len(model: &Model<'_>) -> usize {
    let surface = surface_len(&model.mesh());
    SURFACES * surface + frame_len(surface)
}

impl<T: Real, R: AsMut<[T]>> Playback<T, R> {
    /// An empty cache in a storage of at least [`playback_len`] numbers.
    pub const fn new(storage: R) -> Self {
        Self {
            storage,
            prepared: None,
            groups: [None; GROUPS],
        }
    }

    /// Positions of all nodes at `t`, translated along the axis; returns their number.
    ///
    /// # Errors
    /// [`EvaluateError::BufferTooShort`]; [`EvaluateError::NotFinite`].
    pub(crate) fn positions<const K: usize>(
        &mut self,
        model: &Model<'_>,
        cluster: &Cluster<'_>,
        mut motion: Motion<'_, '_, T, K>,
        prepared: Prepared<T>,
        [t, translation]: [T; 2],
        out: &mut [[T; 3]],
    ) -> Result<usize, EvaluateError> {
        let surface = surface_len(&model.mesh());
        let storage = prefix_mut(self.storage.as_mut(), SURFACES * surface + frame_len(surface))?;
        let out = prefix_mut(out, model.mesh().nodes())?;
        if self.prepared != Some(prepared) {
            (self.prepared, self.groups) = (Some(prepared), [None; GROUPS]);
        }
        let (controls, frame) = storage.split_at_mut(SURFACES * surface);

        let splines = motion.splines(t);
        let first = splines.first;
        let last = first + ORDER - 1;
        for group in first / ORDER..=last / ORDER {
            let surfaces = controls.chunks_exact_mut(ORDER * surface).zip(&mut self.groups);
            let Some((surfaces, cached)) = surfaces.into_iter().nth(group % GROUPS) else {
                continue;
            };
            if *cached != Some(group) {
                let modes = MatrixView::new(&cluster.field.modes);
                let coefficients = coefficients(&mut motion, &modes, group);
                let snapshot = Snapshot {
                    mesh: model.mesh(),
                    modes,
                    coefficients: coefficients.quantized(),
                    scale: model.scale(&prepared.query.parameters),
                    translation: T::ZERO,
                };
                compute(&snapshot, surfaces, surface);
                *cached = Some(group);
            }
        }
        let control = |i: usize| {
            let start = (first + i) % SURFACES * surface;
            slice_or_empty(controls, start..start + surface)
        };
        let factors = Quantity::Displacement.factors(splines);
        if !combine(factors, [0, 1, 2, 3].map(control), translation, frame) {
            return Err(EvaluateError::NotFinite);
        }
        mirror(&model.mesh(), frame, out);
        Ok(out.len())
    }
}

/// Numbers of a surface: components of the sector's nodes in whole panels, all x before all y before all z.
fn surface_len(mesh: &Mesh<'_>) -> usize {
    3 * LANES * mesh.panels()
}

/// Numbers of a frame: x, y, z, -y and -z of the sector's nodes.
fn frame_len(surface: usize) -> usize {
    5 * surface / 3
}

/// Coefficients of a group of control vectors up to the last nonzero one, quantised for products with the modes.
#[inline(never)]
fn coefficients<T: Real, const K: usize>(
    motion: &mut Motion<'_, '_, T, K>,
    modes: &MatrixView<'_>,
    group: usize,
) -> QuantizedVectors<T, K, ORDER> {
    let mut coefficients = QuantizedVectors::ZERO;
    let mut control = [T::ZERO; K];
    for i in 0..ORDER {
        motion.control(ORDER * group + i, &mut control);
        let shape = slice_or_empty_mut(&mut control, 1..modes.columns() + 1);
        for (values, shape) in coefficients.values.iter_mut().zip(shape) {
            values[i] = *shape;
        }
    }
    let last = coefficients.values.iter().rposition(|all| *all != [T::ZERO; ORDER]);
    let count = last.map_or(0, |last| last + 1);
    coefficients.quantize(modes, count);
    coefficients
}

/// surfaces <- the surfaces of a group of control vectors.
fn compute<T: Real>(snapshot: &Snapshot<'_, '_, T, ORDER>, surfaces: &mut [T], surface: usize) {
    let panels = snapshot.mesh.panels();
    let mut pairs = (0..3).flat_map(|axis| (0..panels).map(move |panel| (axis, panel)));
    while let Some(first) = pairs.next() {
        match if TWO_PANELS { pairs.next() } else { None } {
            Some(second) => compute_panels(snapshot, [first, second], surfaces, surface),
            None => compute_panels(snapshot, [first], surfaces, surface),
        }
    }
}

#[inline(always)]
fn compute_panels<T: Real, const P: usize>(
    snapshot: &Snapshot<'_, '_, T, ORDER>,
    pairs: [(usize, usize); P],
    surfaces: &mut [T],
    surface: usize,
) {
    for ((axis, panel), values) in pairs.into_iter().zip(snapshot.panels(pairs)) {
        let first = LANES * (axis * snapshot.mesh.panels() + panel);
        for (values, surface) in values.iter().zip(surfaces.chunks_exact_mut(surface)) {
            slice_or_empty_mut(surface, first..first + LANES).copy_from_slice(values);
        }
    }
}

/// frame <- a linear combination of surfaces, translated along x, followed by its -y and -z. Returns whether all
/// numbers are finite.
fn combine<T: Real>([p, q, r, s]: [T; ORDER], [a, b, c, d]: [&[T]; ORDER], translation: T, frame: &mut [T]) -> bool {
    in_vectors(
        #[inline(always)]
        || {
            for ((((out, a), b), c), d) in frame.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                *out = (p * *a + q * *b) + (r * *c + s * *d);
            }
            let (x, others) = frame.split_at_mut(a.len() / 3);
            x.iter_mut().for_each(|x| *x += translation);
            let (yz, opposite) = others.split_at_mut(2 * x.len());
            opposite.iter_mut().zip(&*yz).for_each(|(opposite, x)| *opposite = -*x);
            // No early exit, so that the loop vectorises.
            frame.iter().fold(true, |finite, x| finite & x.is_finite())
        },
    )
}

/// out <- the images of the sector's nodes. `sector` holds x, y, z, -y and -z, so a symmetry operation selects two of
/// the last four.
fn mirror<T: Real>(mesh: &Mesh<'_>, sector: &[T], out: &mut [[T; 3]]) {
    let stride = LANES * mesh.panels();
    let values = |component: usize| slice_or_empty(sector, stride * component..stride * (component + 1));
    for (operation, images) in mesh.images() {
        let [y, z] = components(operation).map(|(axis, opposite)| values(if opposite { axis + 2 } else { axis }));
        for (((image, x), y), z) in images.iter().zip(values(0)).zip(y).zip(z) {
            if let Some(out) = out.get_mut(image) {
                *out = [*x, *y, *z];
            }
        }
    }
}
