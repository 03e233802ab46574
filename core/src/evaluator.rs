//! From a model and a workspace to answers: prepare a query, go to an instant, take what is needed.

use crate::error::EvaluateError;
use crate::{Domain, Model, Observables, Query, Real, Scene, Workspace};

/// Binds a model to a workspace. Cheap to make: what was computed stays in the workspace.
#[derive(Debug)]
pub struct Evaluator<'a, T, const K: usize = 64, const M: usize = 16, const N: usize = 32> {
    model: &'a Model<'a>,
    workspace: &'a mut Workspace<T, K, M, N>,
}

impl<'a, T: Real, const K: usize, const M: usize, const N: usize> Evaluator<'a, T, K, M, N> {
    /// Binds a model to a workspace.
    ///
    /// # Errors
    /// [`EvaluateError::Capacity`] if the model does not fit.
    pub fn new(model: &'a Model<'a>, workspace: &'a mut Workspace<T, K, M, N>) -> Result<Self, EvaluateError> {
        Ok(Self { model, workspace })
    }

    /// Prepares a query; nothing is done if it is the one already prepared. Says where the parameters lie.
    ///
    /// # Errors
    /// Parameters that are not positive and finite, or outside the domain without `extrapolate`; a step that is too
    /// small or not positive.
    pub fn prepare(&mut self, query: &Query<T>) -> Result<Domain, EvaluateError> {
        let _ = (query, &self.model, &self.workspace);
        unimplemented!()
    }

    /// Goes to the instant `t` in [0, T], in l/V, of the prepared query.
    ///
    /// # Errors
    /// No query prepared; `t` outside [0, T].
    pub fn at(&mut self, t: T) -> Result<Instant<'_, 'a, T, K, M, N>, EvaluateError> {
        Ok(Instant { evaluator: self, t })
    }
}

/// One instant of the prepared query. Every method computes what it returns and nothing else.
#[derive(Debug)]
pub struct Instant<'e, 'a, T, const K: usize, const M: usize, const N: usize> {
    evaluator: &'e mut Evaluator<'a, T, K, M, N>,
    t: T,
}

impl<T: Real, const K: usize, const M: usize, const N: usize> Instant<'_, '_, T, K, M, N> {
    /// The instant, in l/V.
    pub fn t(&self) -> T {
        let _ = &self.evaluator;
        self.t
    }

    /// Axial position X_c of the volume centroid in the laboratory frame, in l.
    pub fn centroid(&self) -> T {
        unimplemented!()
    }

    /// Axial velocity U of the volume centroid, in V.
    pub fn centroid_velocity(&mut self) -> Result<T, EvaluateError> {
        unimplemented!()
    }

    /// Lengths and velocity; reconstructs the nodes of the two outlines only.
    pub fn observables(&mut self) -> Result<Observables<T>, EvaluateError> {
        unimplemented!()
    }

    /// Volume enclosed by the P2 surface, in l^3.
    pub fn volume(&mut self) -> Result<T, EvaluateError> {
        unimplemented!()
    }

    /// Positions of the scene's nodes, in l; `out` holds at least as many entries. Returns how many were written.
    pub fn positions(&mut self, scene: &Scene<'_>, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        let _ = (scene, out);
        unimplemented!()
    }

    /// Velocities of the scene's nodes, in V, like [`positions`](Self::positions).
    pub fn velocities(&mut self, scene: &Scene<'_>, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        let _ = (scene, out);
        unimplemented!()
    }

    /// The named outline as points [x, r] with r = sqrt(y^2 + z^2), front to rear. Returns how many were written.
    pub fn outline(&mut self, scene: &Scene<'_>, out: &mut [[T; 2]]) -> Result<usize, EvaluateError> {
        let _ = (scene, out);
        unimplemented!()
    }

    /// Expected modified Hausdorff distance to the truth in the laboratory frame, as a fraction of a.
    pub fn expected_error(&self) -> T {
        unimplemented!()
    }
}
