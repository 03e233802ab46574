//! Derivatives of answers by a parameter of the query.
//!
//! Direct evaluation is linear in the weights of the samples, apart from the sphere of radius a/l that the displacement
//! belongs to. So the derivative of an answer is the same answer with the derivatives of the weights, and the
//! derivative of a/l in the place of a/l.

use crate::error::{EvaluateError, finite};
use crate::model::MatrixView;
use crate::model::wire::Reference;
use crate::motion::Quantity;
use crate::solver::{Target, scratch_len};
use crate::surface::reconstruct::{Plane, Snapshot, prefix_mut};
use crate::{Frame, Real, Scene, Workspace};

/// Derivatives of the answers at an instant, by each parameter, from
/// [`Evaluator::derivatives`](crate::Evaluator::derivatives). The parameter is a number from 0; lengths are in l,
/// velocities in V, for each unit of the parameter. Answers by one parameter one after the other share their work.
///
/// ```
/// use capsule_core::{Evaluator, Frame, MIDPLANE, Method, Model, Query, Workspace};
///
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// # let file = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../models/capsule.crom"))?;
/// let model = Model::open(&file)?;
/// let mut workspace = Workspace::<f32>::new();
/// let mut evaluator = Evaluator::new(&model, &mut workspace)?;
/// let mut derivatives = evaluator.derivatives(&Query::new([0.10, 0.90], Method::Direct), 3.0)?;
/// let mut by_ca = [[0.0; 2]; 96];
/// derivatives.outline(0, MIDPLANE, Frame::Centroid, &mut by_ca)?;
/// // A softer membrane is drawn out to the front.
/// assert!(by_ca[0][0] > 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Derivatives<
    'e,
    'a,
    T: Real,
    const K: usize = 129,
    const M: usize = 16,
    const N: usize = 32,
    const S: usize = { scratch_len(16, 32) },
> {
    target: Target<'a, T>,
    workspace: &'e mut Workspace<T, K, M, N, S>,
    /// The parameter whose derivatives stand in the place of the weights.
    selected: Option<usize>,
}

impl<'e, 'a, T: Real, const K: usize, const M: usize, const N: usize, const S: usize>
    Derivatives<'e, 'a, T, K, M, N, S>
{
    pub(crate) fn new(target: Target<'a, T>, workspace: &'e mut Workspace<T, K, M, N, S>) -> Self {
        Self {
            target,
            workspace,
            selected: None,
        }
    }

    /// Puts the derivatives by a parameter in the place of the weights.
    fn select(&mut self, parameter: usize) -> Result<(), EvaluateError> {
        let count = self.target.query.parameters.as_slice().len();
        if parameter >= count {
            return Err(EvaluateError::UnknownParameter {
                index: parameter,
                count,
            });
        }
        if self.selected != Some(parameter) {
            let solver = &mut self.workspace.solver;
            solver.invalidate();
            solver.select_derivative(parameter);
            solver.contract(self.target.cluster);
            self.selected = Some(parameter);
        }
        Ok(())
    }

    /// Derivative of the axial position of the centroid in the laboratory frame.
    ///
    /// # Errors
    /// [`EvaluateError::UnknownParameter`]; [`EvaluateError::NotFinite`].
    pub fn centroid(&mut self, parameter: usize) -> Result<T, EvaluateError> {
        self.translation(parameter, Quantity::Displacement)
    }

    /// Derivative of the axial velocity of the centroid.
    ///
    /// # Errors
    /// [`EvaluateError::UnknownParameter`]; [`EvaluateError::NotFinite`].
    pub fn centroid_velocity(&mut self, parameter: usize) -> Result<T, EvaluateError> {
        self.translation(parameter, Quantity::Velocity)
    }

    fn translation(&mut self, parameter: usize, quantity: Quantity) -> Result<T, EvaluateError> {
        self.select(parameter)?;
        let translation = self.workspace.solver.translation(&self.target, quantity);
        finite([translation / self.target.root_of_nodes()]).map(|[value]| value)
    }

    /// Derivatives of the positions of a scene's nodes, into the first entries of `out`; returns their number.
    ///
    /// # Errors
    /// [`EvaluateError::UnknownParameter`]; those of [`Instant::positions`](crate::Instant::positions).
    pub fn positions(
        &mut self,
        parameter: usize,
        scene: &Scene<'_>,
        out: &mut [[T; 3]],
    ) -> Result<usize, EvaluateError> {
        let model = self.target.model;
        self.snapshot(parameter, scene.frame)?.fill(model, scene.nodes, out)
    }

    /// Derivatives of the points [x, r] of an outline, [`MIDPLANE`](crate::MIDPLANE) or [`DIAGONAL`](crate::DIAGONAL),
    /// into the first entries of `out`; returns their number. A point is one of the membrane, and moves also along the
    /// outline; what moves the outline is the part along its normal.
    ///
    /// # Errors
    /// [`EvaluateError::UnknownParameter`]; [`EvaluateError::UnknownNodeSet`] for other sets too, whose nodes lie in no
    /// plane; [`EvaluateError::BufferTooShort`]; [`EvaluateError::NotFinite`].
    pub fn outline(
        &mut self,
        parameter: usize,
        name: &str,
        frame: Frame,
        out: &mut [[T; 2]],
    ) -> Result<usize, EvaluateError> {
        let plane = Plane::of(name);
        let nodes = self.target.model.node_set(name).filter(|_| plane != Plane::Other);
        let nodes = nodes.ok_or(EvaluateError::UnknownNodeSet)?;
        let out = prefix_mut(out, nodes.len())?;
        let snapshot = self.snapshot(parameter, frame)?;
        let mut cache = snapshot.panel_cache();
        for (node, out) in nodes.iter().zip(&mut *out) {
            *out = cache.axial_radial_derivative(node, plane)?;
        }
        Ok(out.len())
    }

    /// The surface's derivative at the instant.
    fn snapshot(&mut self, parameter: usize, frame: Frame) -> Result<Snapshot<'a, '_, T>, EvaluateError> {
        self.select(parameter)?;
        let Target { model, cluster, .. } = self.target;
        let root_of_nodes = self.target.root_of_nodes();
        let displacement = self.workspace.solver.displacement(&self.target).finite()?;
        let of_radius = parameter == 1 && matches!(model.contents().mesh.reference, Reference::Sphere);
        Ok(Snapshot {
            mesh: model.mesh(),
            modes: MatrixView::new(&cluster.field.modes),
            coefficients: displacement.shape.quantized(),
            scale: if of_radius { T::ONE } else { T::ZERO },
            translation: match frame {
                Frame::Laboratory => displacement.translation / root_of_nodes,
                Frame::Centroid => T::ZERO,
            },
        })
    }
}
