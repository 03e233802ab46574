//! Frames of one motion, one after the other.
//!
//! Between knots the surface is a combination of four surfaces, those of the controls that are not zero there: a frame
//! costs four multiplications a number, whatever the number of modes. The surfaces of four successive controls are
//! computed together, when the first of them is needed, and two such groups hold all that an instant needs.

use crate::Real;
use crate::error::EvaluateError;
use crate::linalg::{LANES, TWO_PANELS, in_vectors, slice_or_empty, slice_or_empty_mut};
use crate::model::{MatrixView, Mesh, Model, QuantizedVectors, components};
use crate::motion::spline::ORDER;
use crate::motion::{Motion, Quantity};
use crate::surface::reconstruct::{Snapshot, room};
use crate::workspace::{Prepared, Workspace};

/// Groups of four controls that are kept.
const GROUPS: usize = 2;
/// Surfaces that are kept: those of the controls.
const SURFACES: usize = GROUPS * ORDER;

/// State kept from frame to frame for [`Evaluator::frame`](crate::Evaluator::frame), in storage of the caller's: an
/// array, a slice, a vector.
#[derive(Clone, Debug)]
pub struct Playback<T, R> {
    room: R,
    /// The query whose surfaces these are.
    prepared: Option<Prepared<T>>,
    /// Group number g lies at g mod 2.
    groups: [Option<usize>; GROUPS],
}

/// Numbers that frames of a model need room for.
pub fn playback_len(model: &Model<'_>) -> usize {
    let surface = surface(&model.mesh());
    SURFACES * surface + frame(surface)
}

impl<T: Real, R: AsMut<[T]>> Playback<T, R> {
    /// Nothing is kept yet. `room` holds at least as many numbers as [`playback_len`] says.
    pub const fn new(room: R) -> Self {
        Self {
            room,
            prepared: None,
            groups: [None; GROUPS],
        }
    }

    /// Positions of all nodes at `t`.
    pub(crate) fn positions<const K: usize, const M: usize, const N: usize, const S: usize>(
        &mut self,
        model: &Model<'_>,
        workspace: &mut Workspace<T, K, M, N, S>,
        prepared: Prepared<T>,
        [t, translation]: [T; 2],
        out: &mut [[T; 3]],
    ) -> Result<usize, EvaluateError> {
        let surface = surface(&model.mesh());
        let cluster = model.cluster(&prepared.query.parameters);
        let cluster = cluster.ok_or(EvaluateError::NotPrepared)?;
        let kept = room(self.room.as_mut(), SURFACES * surface + frame(surface))?;
        let out = room(out, model.mesh().nodes())?;
        if self.prepared != Some(prepared) {
            (self.prepared, self.groups) = (Some(prepared), [None; GROUPS]);
        }
        let (controls, frame) = kept.split_at_mut(SURFACES * surface);

        let mut motion = Motion::new(&cluster.field, &workspace.weights, &mut workspace.contracted);
        let splines = motion.splines(t);
        let first = splines.first;
        let last = first + ORDER - 1;
        for group in first / ORDER..=last / ORDER {
            let surfaces = controls.chunks_exact_mut(ORDER * surface).zip(&mut self.groups);
            let Some((surfaces, known)) = surfaces.into_iter().nth(group % GROUPS) else {
                continue;
            };
            if *known != Some(group) {
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
                *known = Some(group);
            }
        }
        let control = |i: usize| {
            let start = (first + i) % SURFACES * surface;
            slice_or_empty(controls, start..start + surface)
        };
        let weights = splines.of(Quantity::Displacement);
        if !combine(weights, [0, 1, 2, 3].map(control), translation, frame) {
            return Err(EvaluateError::NotFinite);
        }
        mirror(&model.mesh(), frame, out);
        Ok(out.len())
    }
}

/// Numbers of a surface: components of the sector's nodes in whole panels, all x before all y before all z.
fn surface(mesh: &Mesh<'_>) -> usize {
    3 * LANES * mesh.panels()
}

/// Numbers of a frame: x, y, z, -y and -z of the sector's nodes.
fn frame(surface: usize) -> usize {
    5 * surface / 3
}

/// Coefficients of the modes, of a group of controls, as far as they are not zero, ready for products.
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

/// Computes a group of surfaces.
fn compute<T: Real>(snapshot: &Snapshot<'_, '_, T, ORDER>, surfaces: &mut [T], surface: usize) {
    let panels = snapshot.mesh.panels();
    let mut places = (0..3).flat_map(|axis| (0..panels).map(move |panel| (axis, panel)));
    while let Some(first) = places.next() {
        match if TWO_PANELS { places.next() } else { None } {
            Some(second) => compute_panels(snapshot, [first, second], surfaces, surface),
            None => compute_panels(snapshot, [first], surfaces, surface),
        }
    }
}

#[inline(always)]
fn compute_panels<T: Real, const P: usize>(
    snapshot: &Snapshot<'_, '_, T, ORDER>,
    places: [(usize, usize); P],
    surfaces: &mut [T],
    surface: usize,
) {
    for ((axis, panel), values) in places.into_iter().zip(snapshot.panels(places)) {
        let first = LANES * (axis * snapshot.mesh.panels() + panel);
        for (values, surface) in values.iter().zip(surfaces.chunks_exact_mut(surface)) {
            slice_or_empty_mut(surface, first..first + LANES).copy_from_slice(values);
        }
    }
}

/// frame <- a combination of surfaces, moved along x, and -y and -z of it. Says whether all is finite.
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
            // Without a way out the loop is done in vectors.
            frame.iter().fold(true, |finite, x| finite & x.is_finite())
        },
    )
}

/// Carries the sector's nodes to all nodes. `sector` holds x, y, z, -y and -z, so that an operation is a choice of two
/// of them.
fn mirror<T: Real>(mesh: &Mesh<'_>, sector: &[T], out: &mut [[T; 3]]) {
    let stride = LANES * mesh.panels();
    let values = |place: usize| slice_or_empty(sector, stride * place..stride * (place + 1));
    for (operation, images) in mesh.images() {
        let [y, z] = components(operation).map(|(axis, opposite)| values(if opposite { axis + 2 } else { axis }));
        for (((image, x), y), z) in images.iter().zip(values(0)).zip(y).zip(z) {
            if let Some(out) = out.get_mut(image) {
                *out = [*x, *y, *z];
            }
        }
    }
}
