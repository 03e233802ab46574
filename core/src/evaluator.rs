//! From a model and a workspace to answers: prepare a query, go to an instant, take what is needed.

use crate::error::{EvaluateError, finite};
use crate::expected_error::{bound_factor, expected_error, extrapolation_error, interval_error};
use crate::interpolate::{Coordinates, Weights, ridge_rows};
use crate::linalg::{slice_or_empty, slice_or_empty_mut};
use crate::mechanics::Membrane;
use crate::model::wire::{Cluster, Errors, Paper, Reference};
use crate::model::{MatrixView, Model, apply};
use crate::motion::{AXIAL_MODES, Controls, Motion, Quantity, leading};
use crate::paper::dynamics::{Source, Step};
use crate::paper::manifold::Times;
use crate::surface::observables::{Lengths, Observables};
use crate::surface::quadrature::volume;
use crate::surface::reconstruct::{Plane, Snapshot, room};
use crate::workspace::{Coefficients, Factor, PAPER_MODES, Prepared, Workspace, scratch_len};
use crate::{Domain, Frame, Method, Nodes, Playback, Query, Real, Scene};
use core::cell::Cell;

/// Root-mean-square displacement, as a share of the radius, below which the last modes are left out of a shape.
const NEGLIGIBLE: f32 = 1e-6;

/// Binds a model to a workspace. Cheap to make: what was computed stays in the workspace.
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
    /// [`EvaluateError::Capacity`] if the model does not fit; whether it does for [`Method::Paper`] is asked when that
    /// is.
    pub fn new(model: &'a Model<'a>, workspace: &'a mut Workspace<T, K, M, N, S>) -> Result<Self, EvaluateError> {
        let contents = model.contents();
        for cluster in &contents.clusters {
            let field = &cluster.field;
            fits("modes", field.modes.columns as usize + 1, K)?;
            for span in &field.spans {
                fits("parameter modes", span.parameter_modes.columns as usize, K)?;
            }
            fits("axial modes", field.axial_modes.columns as usize, AXIAL_MODES)?;
        }
        fits("neighbours of the kernel", contents.kernel.neighbours as usize, N)?;
        Ok(Self { model, workspace })
    }

    /// Whether the workspace has room for the paper's method.
    fn fits_the_paper(&self) -> Result<(), EvaluateError> {
        let contents = self.model.contents();
        let Paper {
            neighbours,
            displacement_rank,
            velocity_rank,
            ..
        } = contents.paper;
        // At least one, which lets the compiler see that without room for any there is no way on.
        fits("local displacement modes", (displacement_rank as usize).max(1), M)?;
        fits("local velocity modes", velocity_rank as usize, M)?;
        fits(
            "neighbours of the diffuse approximation",
            neighbours as usize,
            N.saturating_sub(ridge_rows(contents.metadata.parameters.len())),
        )
    }

    /// Prepares a query; nothing is done if it is the one already prepared. Says where the parameters lie. After a
    /// refusal no query is prepared.
    ///
    /// # Errors
    /// Parameters that are not as many as the model's or not finite (Ca and a/l: not positive), or outside the domain
    /// without `extrapolate`; a step that is not in its range; [`Method::Paper`] in a workspace that is too small for
    /// it.
    pub fn prepare(&mut self, query: &Query<T>) -> Result<Domain, EvaluateError> {
        let digest = self.model.digest();
        if let Some(prepared) = &self.workspace.prepared
            && prepared.digest == digest
            && prepared.query == *query
        {
            return Ok(prepared.domain);
        }
        self.workspace.invalidate();
        let mut domain = self.judge(query)?;
        let contents = self.model.contents();
        let cluster = self.model.cluster(&query.parameters);
        let cluster = cluster.ok_or(EvaluateError::NotPrepared)?;
        if query.method == Method::Paper {
            self.fits_the_paper()?;
        }
        let workspace = &mut *self.workspace;
        let (parameters, samples) = (&self.model.scaled(&query.parameters), &cluster.samples);
        let coordinates = Coordinates::new(contents);
        let (weights, scratch) = (&mut workspace.weights, &mut workspace.scratch);
        match query.method {
            Method::Direct => weights.kernel(&contents.kernel, &coordinates, samples, parameters, None, scratch)?,
            Method::Paper => weights.diffuse(&contents.paper, &coordinates, samples, parameters, None, scratch)?,
        }
        if domain == Domain::Inside && contents.steady_limit.rows == 0 {
            domain = reach(cluster, query, &workspace.weights)?;
        }
        workspace.contracted.enter(&cluster.field, &workspace.weights);
        workspace.prepared = Some(Prepared {
            digest,
            query: *query,
            domain,
        });
        Ok(domain)
    }

    /// Checks a query's numbers and its place.
    fn judge(&self, query: &Query<T>) -> Result<Domain, EvaluateError> {
        /// Of a scaled parameter.
        const MAX: f32 = 1e6;
        const MIN: f32 = 1e-6;
        const MAX_STEPS: f32 = 1e5;
        let end_time = self.model.end_time();
        let contents = self.model.contents();
        let ranges = &contents.metadata.parameters;
        let values = query.parameters.as_slice();
        if values.len() != ranges.len() {
            return Err(EvaluateError::ParameterCount {
                expected: ranges.len(),
                found: values.len(),
            });
        }
        let least = match contents.mesh.reference {
            Reference::Sphere => MIN,
            Reference::Shape { .. } => -MAX,
        };
        let scaled = self.model.scaled(&query.parameters);
        for (index, (scaled, range)) in scaled.as_slice().iter().zip(ranges).enumerate() {
            if !lies_in(*scaled, least, MAX) {
                let [origin, scale] = [range.origin as f32, range.scale as f32];
                return Err(EvaluateError::Parameter {
                    index,
                    value: query.parameters.get(index).to_f32(),
                    min: origin + scale * least,
                    max: origin + scale * MAX,
                });
            }
        }
        if let Some(step) = query.step {
            within("the step", step, end_time / MAX_STEPS, end_time)?;
        }
        let domain = self.model.domain(query.parameters)?;
        if query.extrapolate {
            return Ok(domain);
        }
        if let Some(index) = self.model.outside(&query.parameters)
            && let Some(range) = ranges.get(index)
        {
            return Err(EvaluateError::OutsideDomain {
                index,
                value: query.parameters.get(index).to_f32(),
                range: [range.min as f32, range.max as f32],
            });
        }
        if domain == Domain::BeyondSteadyLimit {
            let [capillary_number, confinement] = query.parameters.array();
            return Err(EvaluateError::BeyondSteadyLimit {
                capillary_number: capillary_number.to_f32(),
                confinement: confinement.to_f32(),
                limit: self.model.steady_limit(confinement).map_or(0.0, T::to_f32),
            });
        }
        Ok(domain)
    }

    /// Goes to the instant `t` in [0, T], in l/V, of the prepared query. Costs nothing until something is asked of it.
    ///
    /// # Errors
    /// No query prepared; `t` outside [0, T].
    pub fn at(&mut self, t: T) -> Result<Instant<'_, 'a, T, K, M, N, S>, EvaluateError> {
        let end_time = self.model.end_time();
        // The end as a caller may write it in another precision counts as the end.
        let end = T::from_f32(end_time);
        let t = if t > end && t <= end * (T::ONE + T::from_f32(f32::EPSILON)) {
            end
        } else {
            t
        };
        within("the instant", t, 0.0, end_time)?;
        let prepared = self.workspace.prepared.as_ref();
        let prepared = prepared.filter(|prepared| prepared.digest == self.model.digest());
        let Prepared { query, domain, .. } = *prepared.ok_or(EvaluateError::NotPrepared)?;
        let cluster = self
            .model
            .cluster(&query.parameters)
            .ok_or(EvaluateError::NotPrepared)?;
        Ok(Instant {
            model: self.model,
            cluster,
            workspace: self.workspace,
            query,
            domain,
            t,
        })
    }

    /// Positions of all nodes, in l, at the instant `t` of the prepared query, into the first entries of `out`; returns
    /// how many there are. For frames that follow each other: `playback` keeps what the next one needs, and the first
    /// one takes as long as two groups of four surfaces. The numbers are those of [`Instant::positions`] but for
    /// rounding, as they are added in another order. [`Method::Paper`] has no such short way and goes to the instant.
    ///
    /// # Errors
    /// As [`at`](Self::at) and [`Instant::positions`]; room that is too short.
    pub fn frame<R: AsMut<[T]>>(
        &mut self,
        t: T,
        frame: Frame,
        playback: &mut Playback<T, R>,
        out: &mut [[T; 3]],
    ) -> Result<usize, EvaluateError> {
        let mut instant = self.at(t)?;
        instant.plausible()?;
        match (instant.query.method, instant.workspace.prepared) {
            (Method::Direct, Some(prepared)) => {
                let translation = match frame {
                    Frame::Laboratory => instant.centroid()?,
                    Frame::Centroid => T::ZERO,
                };
                let at = [instant.t, translation];
                playback.positions(instant.model, instant.workspace, prepared, at, out)
            }
            _ => {
                let nodes = Nodes::All;
                instant.positions(&Scene { nodes, frame }, out)
            }
        }
    }
}

/// One instant of the prepared query. Every method computes what it returns and nothing else, and keeps what the next
/// may need.
///
/// Outside the sampled domain (`extrapolate`) every answer waits for a check of the whole surface, once an instant: a
/// shape that no capsule can have is refused with [`EvaluateError::WrongVolume`] or [`EvaluateError::BeyondWall`].
#[derive(Debug)]
pub struct Instant<
    'e,
    'a,
    T: Real,
    const K: usize = 129,
    const M: usize = 16,
    const N: usize = 32,
    const S: usize = { scratch_len(16, 32) },
> {
    model: &'a Model<'a>,
    cluster: &'a Cluster<'a>,
    workspace: &'e mut Workspace<T, K, M, N, S>,
    query: Query<T>,
    domain: Domain,
    t: T,
}

impl<'a, T: Real, const K: usize, const M: usize, const N: usize, const S: usize> Instant<'_, 'a, T, K, M, N, S> {
    /// The instant, in l/V.
    pub fn t(&self) -> T {
        self.t
    }

    /// Does at most `pieces` pieces of the work that everything at this instant waits for, and returns whether it is
    /// done: for callers who must not be kept. A piece is a snapshot, a row or a mode of a local basis, or a step in
    /// time of [`Method::Paper`]; [`Method::Direct`] has no such work. Another instant may be asked for in between.
    pub fn advance(&mut self, pieces: usize) -> bool {
        let (t, step) = (self.t, self.step());
        match self.query.method {
            Method::Direct => true,
            Method::Paper => {
                let Workspace {
                    weights,
                    contracted,
                    controls,
                    dynamics,
                    scratch,
                    ..
                } = &mut *self.workspace;
                let motion = Motion::new(&self.cluster.field, weights, contracted);
                let Some((mut source, factor)) = learned::<T, K, M>(self.model, motion, controls, scratch) else {
                    return true;
                };
                (0..pieces).any(|_| dynamics.advance(&mut source, step, t, factor))
            }
        }
    }

    /// Where the query's parameters lie.
    pub fn domain(&self) -> Domain {
        self.domain
    }

    /// Axial position X_c of the volume centroid in the laboratory frame, in l.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn centroid(&mut self) -> Result<T, EvaluateError> {
        self.plausible()?;
        let translation = self.translation(Quantity::Displacement);
        number(self.axial_position(translation))
    }

    /// Axial velocity U = dX_c/dt of the volume centroid, in V.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn centroid_velocity(&mut self) -> Result<T, EvaluateError> {
        self.plausible()?;
        number(self.translation(Quantity::Velocity) / self.root_of_nodes())
    }

    /// The axial position of the centroid that a translation's coefficient means.
    fn axial_position(&self, translation: T) -> T {
        translation / self.root_of_nodes() + self.model.origin()
    }

    /// The translation's coefficient alone.
    fn translation(&mut self, quantity: Quantity) -> T {
        match (self.query.method, quantity) {
            (Method::Direct, _) => {
                let Workspace {
                    weights, contracted, ..
                } = &mut *self.workspace;
                Motion::new(&self.cluster.field, weights, contracted).translation(self.t, quantity)
            }
            (Method::Paper, Quantity::Displacement) => {
                self.displacement();
                self.workspace.displacement.translation
            }
            (Method::Paper, Quantity::Velocity) => {
                self.velocity();
                self.workspace.velocity.translation
            }
        }
    }

    /// Lengths and velocity; reconstructs the nodes of the two outlines only. Where the model has no outlines, it takes
    /// all nodes.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn observables(&mut self) -> Result<Observables<T>, EvaluateError> {
        let centroid = self.centroid()?;
        let velocity = self.centroid_velocity()?;
        let lengths = Lengths::new(self.model, &self.shape(Frame::Centroid)?)?;
        Ok(Observables {
            axial_length: lengths.axial_length,
            half_width: lengths.half_width,
            half_diagonal: lengths.half_diagonal,
            rear_depth: lengths.rear_depth,
            velocity,
            centroid,
        })
    }

    /// Volume enclosed by the surface, in l^3; reconstructs a quarter of the surface where that is enough.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn volume(&mut self) -> Result<T, EvaluateError> {
        self.plausible()?;
        let [volume, _] = self.volume_and_reach()?;
        Ok(volume)
    }

    /// The volume, and the greatest |y| or |z| of the nodes that it is computed from.
    fn volume_and_reach(&mut self) -> Result<[T; 2], EvaluateError> {
        self.displacement();
        let Workspace {
            displacement, scratch, ..
        } = &mut *self.workspace;
        let shape = shape(self.model, self.cluster, &self.query, displacement, T::ZERO);
        // What is learned in the scratch is learned when there is a displacement.
        let (room, _) = scratch.as_chunks_mut();
        let mut sector = room.get_mut(..shape.mesh.sector_nodes().len());
        if let Some(sector) = &mut sector {
            shape.fill_sector(sector)?;
        }
        let reach = Cell::new(T::ZERO);
        let volume = volume(&shape.mesh, |node| {
            let vector = match &sector {
                None => shape.node(node)?,
                Some(sector) => {
                    let origin = shape.mesh.origin(node);
                    let vector = origin.and_then(|(index, operation)| Some(apply(operation, *sector.get(index)?)));
                    vector.ok_or(EvaluateError::NotFinite)?
                }
            };
            let [_, y, z] = vector;
            reach.set(reach.get().max(y.abs()).max(z.abs()));
            Ok(vector)
        })?;
        Ok([volume, reach.get()])
    }

    /// Takes the shape at this instant as it is, without the check that an extrapolated one waits for: to measure how
    /// wrong it is.
    pub fn unchecked(&mut self) {
        self.workspace.plausible = Some(self.t);
    }

    /// Refuses an extrapolated shape that no capsule can have. Inside the domain the bound of the error says how good
    /// it is.
    fn plausible(&mut self) -> Result<(), EvaluateError> {
        if self.domain == Domain::Inside || self.workspace.plausible == Some(self.t) {
            return Ok(());
        }
        // First, with little on the stack.
        self.displacement();
        self.judge_shape()
    }

    #[inline(never)]
    fn judge_shape(&mut self) -> Result<(), EvaluateError> {
        /// Relative deviation of a volume that is allowed.
        const VOLUME: f32 = 0.02;
        let [volume, reach] = self.volume_and_reach()?;
        let radius = self.model.radius(self.query.parameters);
        let sphere = T::from_f64(4.0 / 3.0 * core::f64::consts::PI) * radius * radius * radius;
        let [least, greatest] = match self.model.contents().mesh.reference {
            Reference::Sphere if reach > T::ONE => {
                return Err(EvaluateError::BeyondWall { reach: reach.to_f32() });
            }
            Reference::Sphere => [1.0, 1.0],
            Reference::Shape { volumes, .. } => volumes.map(|volume| volume as f32),
        };
        let (volume, min, max) = (
            (volume / sphere).to_f32(),
            least * (1.0 - VOLUME),
            greatest * (1.0 + VOLUME),
        );
        if !(min <= volume && volume <= max) {
            return Err(EvaluateError::WrongVolume { volume, min, max });
        }
        self.workspace.plausible = Some(self.t);
        Ok(())
    }

    /// Positions of the scene's nodes, in l, into the first entries of `out`. Returns how many there are.
    ///
    /// # Errors
    /// A scene that does not fit the model or `out`; [`EvaluateError::NotFinite`].
    pub fn positions(&mut self, scene: &Scene<'_>, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        let model = self.model;
        self.shape(scene.frame)?.fill(model, scene.nodes, out)
    }

    /// Velocities of the scene's nodes, in V, like [`positions`](Self::positions).
    ///
    /// # Errors
    /// As [`positions`](Self::positions).
    pub fn velocities(&mut self, scene: &Scene<'_>, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        self.plausible()?;
        self.velocity();
        let velocity = &self.workspace.velocity;
        velocity.checked()?;
        let translation = match scene.frame {
            Frame::Laboratory => velocity.translation / self.root_of_nodes(),
            Frame::Centroid => T::ZERO,
        };
        let field = Snapshot {
            mesh: self.model.mesh(),
            modes: MatrixView::new(&self.cluster.field.modes),
            coefficients: velocity.shape.quantized(),
            scale: T::ZERO,
            translation,
        };
        field.fill(self.model, scene.nodes, out)
    }

    /// A named outline as points [x, r] with r = sqrt(y^2 + z^2), front to rear, into the first entries of `out`.
    /// Returns how many there are.
    ///
    /// # Errors
    /// No such node set; `out` too short; [`EvaluateError::NotFinite`].
    pub fn outline(&mut self, name: &str, frame: Frame, out: &mut [[T; 2]]) -> Result<usize, EvaluateError> {
        let nodes = self.model.node_set(name).ok_or(EvaluateError::UnknownNodeSet)?;
        let out = room(out, nodes.len())?;
        let (shape, plane) = (self.shape(frame)?, Plane::of(name));
        let mut walk = shape.walk();
        for (node, out) in nodes.iter().zip(&mut *out) {
            *out = walk.axial_radial(node, plane)?;
        }
        Ok(out.len())
    }

    /// The membrane, for its mechanics: reconstructs the sector's nodes into the first entries of `sector`, in the
    /// centroid's frame.
    ///
    /// # Errors
    /// [`EvaluateError::UnsupportedReference`] for a model whose stress-free state is not known;
    /// [`EvaluateError::BufferTooShort`]; [`EvaluateError::NotFinite`].
    #[inline(never)]
    pub fn membrane<'s>(&mut self, sector: &'s mut [[T; 3]]) -> Result<Membrane<'a, 's, T>, EvaluateError> {
        if !matches!(self.model.contents().mesh.reference, Reference::Sphere) {
            return Err(EvaluateError::UnsupportedReference);
        }
        let mesh = self.model.mesh();
        let sector = room(sector, mesh.sector_nodes().len())?;
        self.shape(Frame::Centroid)?.fill_sector(sector)?;
        let [capillary_number, confinement] = self.query.parameters.array();
        Ok(Membrane::new(mesh, sector, confinement, capillary_number))
    }

    /// Expected distance to the full-order solution in the laboratory frame, as a fraction of a: modified Hausdorff
    /// distance for a capsule in the channel, mean distance of the nodes for other people's models
    /// ([`Reference::Shape`]). Outside the sampled domain it is a guess that grows with the distance from the samples.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn expected_error(&mut self) -> Result<T, EvaluateError> {
        self.plausible()?;
        let [time, _] = self.interval_error();
        let guess = if self.domain == Domain::Inside {
            T::ZERO
        } else {
            extrapolation_error(self.errors(), &self.error_times(), &self.workspace.weights, self.t)
        };
        number(self.interpolation_error() + time + guess)
    }

    /// Expected error of the interpolation in the parameters and of the truncation.
    fn interpolation_error(&self) -> T {
        expected_error(self.errors(), &self.error_times(), &self.workspace.weights, self.t)
    }

    /// Error of the interpolation in time: expected, and its bound.
    fn interval_error(&self) -> [T; 2] {
        interval_error(self.cluster, &self.model.times(), &self.workspace.weights, self.t)
    }

    /// Deviation of the weights by which the answer is interpolated, see
    /// [`Weights::deviation`](crate::interpolate::Weights::deviation).
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn deviation(&self) -> Result<T, EvaluateError> {
        number(self.workspace.weights.deviation())
    }

    /// The bound below which that distance stays in 95 of 100 cases: laboratory frame, fraction of a.
    ///
    /// # Errors
    /// [`EvaluateError::NoBound`] outside the sampled domain, where it is not calibrated; [`EvaluateError::NotFinite`].
    pub fn error_bound(&self) -> Result<T, EvaluateError> {
        if self.domain != Domain::Inside {
            return Err(EvaluateError::NoBound);
        }
        let [_, time] = self.interval_error();
        number(bound_factor::<T>(self.errors(), &self.error_times(), self.t) * self.interpolation_error() + time)
    }

    /// The leave-one-out errors of the query's method.
    fn errors(&self) -> &'a Errors<'a> {
        match self.query.method {
            Method::Direct => &self.cluster.direct_errors,
            Method::Paper => &self.cluster.paper_errors,
        }
    }

    /// The instants of the leave-one-out errors.
    fn error_times(&self) -> MatrixView<'a> {
        MatrixView::new(&self.model.contents().error_times)
    }

    /// sqrt(N_x), the scale of the translation's coefficient.
    fn root_of_nodes(&self) -> T {
        T::from_index(self.model.mesh().nodes()).sqrt()
    }

    /// How [`Method::Paper`] steps.
    fn step(&self) -> Step<T> {
        let share = || T::from_f32(self.model.end_time()) / T::from_f32(1000.0);
        Step {
            length: self.query.step.unwrap_or_else(share),
            scheme: self.query.scheme,
        }
    }

    /// Brings the displacement's coefficients to this instant.
    fn displacement(&mut self) {
        if self.workspace.displacement.t != Some(self.t) {
            self.coefficients(Quantity::Displacement);
        }
    }

    /// Brings the velocity's coefficients to this instant.
    fn velocity(&mut self) {
        if self.workspace.velocity.t != Some(self.t) {
            self.coefficients(Quantity::Velocity);
        }
    }

    /// Computes the coefficients of a field.
    fn coefficients(&mut self, quantity: Quantity) {
        let (t, step) = (self.t, self.step());
        let modes = MatrixView::new(&self.cluster.field.modes);
        let negligible = match quantity {
            Quantity::Displacement => {
                let negligible = T::from_f32(NEGLIGIBLE) * self.model.radius(self.query.parameters);
                negligible * self.root_of_nodes()
            }
            Quantity::Velocity => T::ZERO,
        };
        let Workspace {
            weights,
            contracted,
            controls,
            dynamics,
            scratch,
            displacement,
            velocity,
            ..
        } = &mut *self.workspace;
        let computed = match quantity {
            Quantity::Displacement => displacement,
            Quantity::Velocity => velocity,
        };
        // They are computed in place, the translation's first: a stack has no room for them.
        computed.t = None;
        let out = slice_or_empty_mut(computed.shape.values.as_flattened_mut(), 0..modes.columns() + 1);
        let motion = Motion::new(&self.cluster.field, weights, contracted);
        match self.query.method {
            Method::Direct => {
                let mut motion = motion;
                motion.coefficients(controls, t, quantity, out);
            }
            Method::Paper => {
                let Some((mut source, factor)) = learned::<T, K, M>(self.model, motion, controls, scratch) else {
                    return;
                };
                match quantity {
                    Quantity::Displacement => dynamics.displacement(&mut source, step, t, factor, out),
                    Quantity::Velocity => dynamics.velocity(&mut source, step, t, factor, out),
                }
            }
        }
        computed.translation = out.first().copied().unwrap_or(T::ZERO);
        let places = Cell::from_mut(&mut *out).as_slice_of_cells();
        for (place, next) in places.iter().zip(places.iter().skip(1)) {
            place.set(next.get());
        }
        let count = leading(slice_or_empty(out, 0..modes.columns()), negligible);
        computed.t = Some(t);
        computed.judge(modes.columns());
        computed.shape.quantize(&modes, count);
    }

    /// The surface at this instant.
    fn shape(&mut self, frame: Frame) -> Result<Snapshot<'a, '_, T>, EvaluateError> {
        self.plausible()?;
        self.displacement();
        let displacement = &self.workspace.displacement;
        displacement.checked()?;
        let translation = match frame {
            Frame::Laboratory => self.axial_position(displacement.translation),
            Frame::Centroid => T::ZERO,
        };
        Ok(shape(self.model, self.cluster, &self.query, displacement, translation))
    }
}

/// Source and factor of the paper's method; none in a workspace without room for it, where no query is prepared for it.
fn learned<'a, 's, 'f, T: Real, const K: usize, const M: usize>(
    model: &'s Model<'a>,
    motion: Motion<'a, 's, T, K>,
    controls: &'s mut Controls<T, K>,
    scratch: &'f mut [T],
) -> Option<(Source<'s, 'a, 's, T, K>, &'f mut Factor<T>)> {
    if M == 0 {
        return None;
    }
    let factor = scratch.as_chunks_mut().0.first_chunk_mut()?;
    let source = Source {
        motion: motion.leading(PAPER_MODES),
        controls,
        times: Times(model.times()),
        settings: &model.contents().paper,
    };
    Some((source, factor))
}

/// The surface of a displacement.
fn shape<'a, 's, T: Real, const K: usize>(
    model: &Model<'a>,
    cluster: &Cluster<'a>,
    query: &Query<T>,
    displacement: &'s Coefficients<T, K>,
    translation: T,
) -> Snapshot<'a, 's, T> {
    Snapshot {
        mesh: model.mesh(),
        modes: MatrixView::new(&cluster.field.modes),
        coefficients: displacement.shape.quantized(),
        scale: model.scale(&query.parameters),
        translation,
    }
}

/// Whether the samples reach a query within their ranges. Each sample, left out, was farther from the others than the
/// query may be; beyond the greatest of these distances no leave-one-out error says what to expect.
fn reach<T: Real, const N: usize>(
    cluster: &Cluster<'_>,
    query: &Query<T>,
    weights: &Weights<T, N>,
) -> Result<Domain, EvaluateError> {
    let errors = match query.method {
        Method::Direct => &cluster.direct_errors,
        Method::Paper => &cluster.paper_errors,
    };
    let deviations = MatrixView::new(&errors.deviation);
    let greatest = (0..deviations.rows())
        .map(|j| deviations.get(j, 0))
        .fold(0.0, Real::max);
    let deviation = weights.deviation();
    if deviation <= T::from_f32(greatest) {
        Ok(Domain::Inside)
    } else if query.extrapolate {
        Ok(Domain::FarFromSamples)
    } else {
        Err(EvaluateError::FarFromSamples {
            ratio: (deviation / T::from_f32(greatest)).to_f32(),
        })
    }
}

fn fits(limit: &'static str, required: usize, capacity: usize) -> Result<(), EvaluateError> {
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

fn within<T: Real>(what: &'static str, value: T, min: f32, max: f32) -> Result<(), EvaluateError> {
    if lies_in(value, min, max) {
        Ok(())
    } else {
        let value = value.to_f32();
        Err(EvaluateError::Value { what, value, min, max })
    }
}

/// One number on its way out.
fn number<T: Real>(value: T) -> Result<T, EvaluateError> {
    finite([value]).map(|[value]| value)
}

/// A number that is none lies nowhere.
fn lies_in<T: Real>(value: T, min: f32, max: f32) -> bool {
    T::from_f32(min) <= value && value <= T::from_f32(max)
}
