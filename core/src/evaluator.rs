//! Preparation of a query: from a model and a workspace to the weights of the samples.

use crate::derivatives::Derivatives;
use crate::error::EvaluateError;
use crate::instant::Instant;
use crate::interpolate::ridge_rows;
use crate::model::Model;
use crate::model::wire::{Method, Paper};
use crate::motion::AXIAL_MODES;
use crate::query::{Prepared, check_range};
use crate::solver::{Target, scratch_len};
use crate::surface::playback::Playback;
use crate::{Domain, Frame, Query, Real, Workspace};

/// The capacities of the smallest [`Workspace`] that holds a model, for both methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacities {
    /// Modes (K), the translation included.
    pub modes: usize,
    /// Local modes of [`Method::Paper`] (M); 0 will do for [`Method::Direct`].
    pub local_modes: usize,
    /// Samples that take part in a query (N).
    pub neighbours: usize,
}

impl Capacities {
    /// The capacities that a model needs.
    pub fn of(model: &Model<'_>) -> Self {
        let contents = model.contents();
        let fields = || contents.clusters.iter().map(|cluster| &cluster.field);
        let columns = fields().flat_map(|field| field.spans.iter().map(|span| span.parameter_modes.columns as usize));
        let modes = fields().map(|field| field.modes.columns as usize + 1).chain(columns);
        let paper = &contents.paper;
        let ridge = ridge_rows(contents.metadata.parameters.len());
        Self {
            modes: modes.max().unwrap_or_default(),
            local_modes: paper.displacement_rank.max(paper.velocity_rank) as usize,
            neighbours: (contents.kernel.neighbours as usize).max(paper.neighbours as usize + ridge),
        }
    }
}

/// Binds a model to a workspace. Cheap to make: results stay in the workspace.
#[derive(Debug)]
pub struct Evaluator<
    'a,
    T: Real,
    const K: usize = 129,
    const M: usize = 16,
    const N: usize = 32,
    const S: usize = { scratch_len(16, 32) },
> {
    model: &'a Model<'a>,
    workspace: &'a mut Workspace<T, K, M, N, S>,
}

impl<'a, T: Real, const K: usize, const M: usize, const N: usize, const S: usize> Evaluator<'a, T, K, M, N, S> {
    /// Binds a model to a workspace.
    ///
    /// # Errors
    /// [`EvaluateError::Capacity`] if the model does not fit. Whether it fits for [`Method::Paper`] is checked when
    /// such a query is prepared.
    pub fn new(model: &'a Model<'a>, workspace: &'a mut Workspace<T, K, M, N, S>) -> Result<Self, EvaluateError> {
        let contents = model.contents();
        for cluster in &contents.clusters {
            let field = &cluster.field;
            check_capacity("modes", field.modes.columns as usize + 1, K)?;
            for span in &field.spans {
                check_capacity("parameter modes", span.parameter_modes.columns as usize, K)?;
            }
            check_capacity("axial modes", field.axial_modes.columns as usize, AXIAL_MODES)?;
        }
        check_capacity("neighbours of the kernel", contents.kernel.neighbours as usize, N)?;
        Ok(Self { model, workspace })
    }

    /// Refuses a model that does not fit for the paper's method.
    fn check_capacity_of_paper(&self) -> Result<(), EvaluateError> {
        let contents = self.model.contents();
        let Paper {
            neighbours,
            displacement_rank,
            velocity_rank,
            ..
        } = contents.paper;
        // At least one, so that the compiler sees that M = 0 always refuses.
        check_capacity("local displacement modes", (displacement_rank as usize).max(1), M)?;
        check_capacity("local velocity modes", velocity_rank as usize, M)?;
        check_capacity(
            "neighbours of the diffuse approximation",
            neighbours as usize,
            N.saturating_sub(ridge_rows(contents.metadata.parameters.len())),
        )
    }

    /// Prepares a query: computes the weights of the samples. Returns where its parameters lie. Costs nothing if the
    /// query is already prepared. After an error no query is prepared.
    ///
    /// # Errors
    /// A wrong number of parameters, or one that is not finite (Ca and a/l: not positive); parameters outside the
    /// domain without `extrapolate`; a step out of range; [`EvaluateError::Capacity`] for [`Method::Paper`] in a
    /// workspace that is too small for it; [`EvaluateError::BeyondExtrapolation`] and [`EvaluateError::Weights`].
    pub fn prepare(&mut self, query: &Query<T>) -> Result<Domain, EvaluateError> {
        let digest = self.model.digest();
        if let Some(prepared) = &self.workspace.prepared
            && prepared.digest == digest
            && prepared.query == *query
        {
            return Ok(prepared.domain);
        }
        self.workspace.invalidate();
        let mut domain = query.validate(self.model)?;
        let cluster = self.model.cluster(&query.parameters);
        let cluster = cluster.ok_or(EvaluateError::NotPrepared)?;
        if query.method == Method::Paper {
            self.check_capacity_of_paper()?;
        }
        let workspace = &mut *self.workspace;
        workspace.solver.set_query(self.model, cluster, query)?;
        if domain == Domain::Inside && self.model.contents().steady_limit.rows == 0 {
            domain = query.check_distance(cluster, &workspace.solver.weights)?;
        }
        workspace.solver.contract(cluster);
        workspace.prepared = Some(Prepared {
            digest,
            query: *query,
            domain,
        });
        Ok(domain)
    }

    /// The instant `t` in [0, T], in l/V, of the prepared query. Nothing is computed before an answer is asked for.
    ///
    /// # Errors
    /// [`EvaluateError::NotPrepared`]; [`EvaluateError::Value`] for `t` outside [0, T].
    pub fn at(&mut self, t: T) -> Result<Instant<'_, 'a, T, K, M, N, S>, EvaluateError> {
        let t = self.instant(t)?;
        let prepared = self.workspace.prepared.as_ref();
        let prepared = prepared.filter(|prepared| prepared.digest == self.model.digest());
        let Prepared { query, domain, .. } = *prepared.ok_or(EvaluateError::NotPrepared)?;
        Ok(Instant::new(self.target(query, t)?, domain, self.workspace))
    }

    /// Derivatives, by the parameters, of the answers of [`Method::Direct`] to a query at the instant `t` in [0, T].
    /// The workspace holds them in the place of a prepared query: after them a query must be prepared anew.
    ///
    /// The derivatives are those of the interpolation that answers. Where a sample enters or leaves the nearest ones,
    /// and where the steady limit bends, they jump; at a border of the domain they are those inside. A shape that is
    /// extrapolated is not checked.
    ///
    /// # Errors
    /// Those of [`prepare`](Self::prepare) and [`at`](Self::at); [`EvaluateError::NoDerivatives`] for
    /// [`Method::Paper`].
    pub fn derivatives(&mut self, query: &Query<T>, t: T) -> Result<Derivatives<'_, 'a, T, K, M, N, S>, EvaluateError> {
        self.workspace.invalidate();
        if query.method != Method::Direct {
            return Err(EvaluateError::NoDerivatives);
        }
        let t = self.instant(t)?;
        query.validate(self.model)?;
        let target = self.target(*query, t)?;
        self.workspace
            .solver
            .set_derivatives(self.model, target.cluster, query)?;
        Ok(Derivatives::new(target, self.workspace))
    }

    /// An instant, if it is one.
    #[inline(always)]
    fn instant(&self, t: T) -> Result<T, EvaluateError> {
        let end_time = self.model.end_time();
        // The end, rounded from another precision, is the end.
        let end = T::from_f32(end_time);
        let t = if t > end && t <= end * (T::ONE + T::from_f32(f32::EPSILON)) {
            end
        } else {
            t
        };
        check_range("the instant", t, 0.0, end_time)?;
        Ok(t)
    }

    #[inline(always)]
    fn target(&self, query: Query<T>, t: T) -> Result<Target<'a, T>, EvaluateError> {
        let model = self.model;
        let cluster = model.cluster(&query.parameters).ok_or(EvaluateError::NotPrepared)?;
        Ok(Target {
            model,
            cluster,
            query,
            t,
        })
    }

    /// Positions of all nodes, in l, at the instant `t` of the prepared query, into the first entries of `out`; returns
    /// their number. For successive frames: `playback` caches the surfaces of the control vectors, so the first frame
    /// costs as much as two groups of four surfaces. The positions differ from those of [`Instant::positions`] by
    /// rounding only, because their sums have another order. [`Method::Paper`] cannot use this fast path: its frames
    /// are those of [`Instant::positions`].
    ///
    /// # Errors
    /// Those of [`at`](Self::at) and [`Instant::positions`]; [`EvaluateError::BufferTooShort`] for the storage of
    /// `playback`.
    pub fn frame<R: AsMut<[T]>>(
        &mut self,
        t: T,
        frame: Frame,
        playback: &mut Playback<T, R>,
        out: &mut [[T; 3]],
    ) -> Result<usize, EvaluateError> {
        self.at(t)?.frame(frame, playback, out)
    }
}

fn check_capacity(limit: &'static str, required: usize, capacity: usize) -> Result<(), EvaluateError> {
    if required <= capacity {
        Ok(())
    } else {
        Err(EvaluateError::Capacity {
            limit,
            required,
            capacity,
        })
    }
}
