//! Answers at one instant of a prepared query.

use crate::error::{EvaluateError, finite};
use crate::expected_error::{bound_factor, expected_error, extrapolation_error, interval_error};
use crate::mechanics::Membrane;
use crate::model::wire::{Errors, Method, Reference};
use crate::model::{MatrixView, apply};
use crate::motion::{Motion, Quantity};
use crate::query::Prepared;
use crate::solver::{Coefficients, Target, scratch_len};
use crate::surface::observables::{Lengths, Observables};
use crate::surface::playback::Playback;
use crate::surface::quadrature::volume;
use crate::surface::reconstruct::{Plane, Snapshot, prefix_mut};
use crate::{Domain, Frame, Nodes, Real, Scene, Workspace};
use core::cell::Cell;

/// One instant of the prepared query. Every method computes what it returns and nothing else, and keeps results that
/// the next one may need.
///
/// Outside the sampled domain (`extrapolate`) every answer is preceded by a check of the whole surface, once an
/// instant: a shape that no capsule can have is refused with [`EvaluateError::WrongVolume`] or
/// [`EvaluateError::BeyondWall`].
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
    target: Target<'a, T>,
    domain: Domain,
    workspace: &'e mut Workspace<T, K, M, N, S>,
}

impl<'e, 'a, T: Real, const K: usize, const M: usize, const N: usize, const S: usize> Instant<'e, 'a, T, K, M, N, S> {
    /// Inlined, so that the target is built in place and not copied on the stack.
    #[inline(always)]
    pub(crate) fn new(target: Target<'a, T>, domain: Domain, workspace: &'e mut Workspace<T, K, M, N, S>) -> Self {
        Self {
            target,
            domain,
            workspace,
        }
    }

    /// The instant, in l/V.
    pub fn t(&self) -> T {
        self.target.t
    }

    /// Does at most `pieces` pieces of the work that all answers at this instant need, and returns true when it is
    /// complete: for callers with other tasks. A piece is a snapshot, a row or a mode of a local basis, or a time step
    /// of [`Method::Paper`]; [`Method::Direct`] has no such work. Answers at other instants may come in between.
    pub fn advance(&mut self, pieces: usize) -> bool {
        self.workspace.solver.advance(&self.target, pieces)
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
        self.check_plausible()?;
        let translation = self.workspace.solver.translation(&self.target, Quantity::Displacement);
        number(axial_position(&self.target, translation))
    }

    /// Axial velocity U = dX_c/dt of the volume centroid, in V.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn centroid_velocity(&mut self) -> Result<T, EvaluateError> {
        self.check_plausible()?;
        let translation = self.workspace.solver.translation(&self.target, Quantity::Velocity);
        number(translation / self.target.root_of_nodes())
    }

    /// Lengths and velocity. Reconstructs the nodes of the two outlines only, or all nodes where the model has no
    /// outlines.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn observables(&mut self) -> Result<Observables<T>, EvaluateError> {
        let centroid = self.centroid()?;
        let velocity = self.centroid_velocity()?;
        let lengths = Lengths::new(self.target.model, &self.snapshot(Frame::Centroid)?)?;
        Ok(Observables {
            axial_length: lengths.axial_length,
            half_width: lengths.half_width,
            half_diagonal: lengths.half_diagonal,
            rear_depth: lengths.rear_depth,
            velocity,
            centroid,
        })
    }

    /// Volume enclosed by the surface, in l^3. Reconstructs a quarter of the surface where the mesh is symmetric.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn volume(&mut self) -> Result<T, EvaluateError> {
        self.check_plausible()?;
        let [volume, _] = self.volume_and_reach()?;
        Ok(volume)
    }

    /// The volume, and the greatest |y| or |z| of the nodes that it is computed from.
    fn volume_and_reach(&mut self) -> Result<[T; 2], EvaluateError> {
        let solver = &mut self.workspace.solver;
        solver.displacement(&self.target);
        let snapshot = snapshot(&self.target, &solver.displacement, T::ZERO);
        // The scratch is free once there is a displacement.
        let (buffer, _) = solver.scratch.as_chunks_mut();
        let mut sector = buffer.get_mut(..snapshot.mesh.sector_nodes().len());
        if let Some(sector) = &mut sector {
            snapshot.fill_sector(sector)?;
        }
        let reach = Cell::new(T::ZERO);
        let volume = volume(&snapshot.mesh, |node| {
            let vector = match &sector {
                None => snapshot.node(node)?,
                Some(sector) => {
                    let origin = snapshot.mesh.origin(node);
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

    /// Skips the check of an extrapolated shape at this instant: to measure how wrong it is.
    pub fn unchecked(&mut self) {
        self.workspace.plausible = Some(self.target.t);
    }

    /// Refuses an extrapolated shape that no capsule can have. Inside the domain the error bound holds.
    fn check_plausible(&mut self) -> Result<(), EvaluateError> {
        if self.domain == Domain::Inside || self.workspace.plausible == Some(self.target.t) {
            return Ok(());
        }
        // Before the check, while little is on the stack.
        self.workspace.solver.displacement(&self.target);
        self.check_shape()
    }

    #[inline(never)]
    fn check_shape(&mut self) -> Result<(), EvaluateError> {
        /// Maximum relative deviation of the volume.
        const VOLUME: f32 = 0.02;
        let [volume, reach] = self.volume_and_reach()?;
        let model = self.target.model;
        let radius = model.radius(self.target.query.parameters);
        let sphere = T::from_f64(4.0 / 3.0 * core::f64::consts::PI) * radius * radius * radius;
        let [least, greatest] = match model.contents().mesh.reference {
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
        self.workspace.plausible = Some(self.target.t);
        Ok(())
    }

    /// Positions of the scene's nodes, in l, into the first entries of `out`; returns their number.
    ///
    /// # Errors
    /// [`EvaluateError::UnknownNode`] and [`EvaluateError::UnknownNodeSet`] for the scene;
    /// [`EvaluateError::BufferTooShort`]; [`EvaluateError::NotFinite`].
    pub fn positions(&mut self, scene: &Scene<'_>, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        let model = self.target.model;
        self.snapshot(scene.frame)?.fill(model, scene.nodes, out)
    }

    /// Positions of all nodes by [`Evaluator::frame`](crate::Evaluator::frame).
    pub(crate) fn frame<R: AsMut<[T]>>(
        &mut self,
        frame: Frame,
        playback: &mut Playback<T, R>,
        out: &mut [[T; 3]],
    ) -> Result<usize, EvaluateError> {
        self.check_plausible()?;
        let Target {
            model,
            cluster,
            query,
            t,
        } = self.target;
        if query.method == Method::Paper {
            let nodes = Nodes::All;
            return self.positions(&Scene { nodes, frame }, out);
        }
        let translation = match frame {
            Frame::Laboratory => self.centroid()?,
            Frame::Centroid => T::ZERO,
        };
        let prepared = Prepared {
            digest: model.digest(),
            query,
            domain: self.domain,
        };
        let solver = &mut self.workspace.solver;
        let motion = Motion::new(&cluster.field, &solver.weights, &mut solver.contracted);
        playback.positions(model, cluster, motion, prepared, [t, translation], out)
    }

    /// Velocities of the scene's nodes, in V, into the first entries of `out`; returns their number.
    ///
    /// # Errors
    /// Those of [`positions`](Self::positions).
    pub fn velocities(&mut self, scene: &Scene<'_>, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        self.check_plausible()?;
        let velocity = self.workspace.solver.velocity(&self.target).finite()?;
        let translation = match scene.frame {
            Frame::Laboratory => velocity.translation / self.target.root_of_nodes(),
            Frame::Centroid => T::ZERO,
        };
        let field = Snapshot {
            mesh: self.target.model.mesh(),
            modes: MatrixView::new(&self.target.cluster.field.modes),
            coefficients: velocity.shape.quantized(),
            scale: T::ZERO,
            translation,
        };
        field.fill(self.target.model, scene.nodes, out)
    }

    /// A named outline as points [x, r] with r = sqrt(y^2 + z^2), in l, front to rear, into the first entries of `out`;
    /// returns their number.
    ///
    /// # Errors
    /// [`EvaluateError::UnknownNodeSet`]; [`EvaluateError::BufferTooShort`]; [`EvaluateError::NotFinite`].
    pub fn outline(&mut self, name: &str, frame: Frame, out: &mut [[T; 2]]) -> Result<usize, EvaluateError> {
        let nodes = self.target.model.node_set(name).ok_or(EvaluateError::UnknownNodeSet)?;
        let out = prefix_mut(out, nodes.len())?;
        let (snapshot, plane) = (self.snapshot(frame)?, Plane::of(name));
        let mut cache = snapshot.panel_cache();
        for (node, out) in nodes.iter().zip(&mut *out) {
            *out = cache.axial_radial(node, plane)?;
        }
        Ok(out.len())
    }

    /// The membrane, for its mechanics: reconstructs the sector's nodes into the first entries of `sector`, in the
    /// centroid's frame.
    ///
    /// # Errors
    /// [`EvaluateError::UnsupportedReference`] for a model without [`has_mechanics`](crate::Model::has_mechanics);
    /// [`EvaluateError::BufferTooShort`]; [`EvaluateError::NotFinite`].
    #[inline(never)]
    pub fn membrane<'s>(&mut self, sector: &'s mut [[T; 3]]) -> Result<Membrane<'a, 's, T>, EvaluateError> {
        let model = self.target.model;
        if !model.has_mechanics() {
            return Err(EvaluateError::UnsupportedReference);
        }
        let mesh = model.mesh();
        let sector = prefix_mut(sector, mesh.sector_nodes().len())?;
        self.snapshot(Frame::Centroid)?.fill_sector(sector)?;
        let [capillary_number, confinement] = self.target.query.parameters.array();
        Ok(Membrane::new(mesh, sector, confinement, capillary_number))
    }

    /// Expected distance to the full-order solution in the laboratory frame, as a fraction of a: modified Hausdorff
    /// distance for a capsule in the channel, mean distance of the nodes for other people's models
    /// ([`Reference::Shape`]). Outside the sampled domain it is a guess that grows with the distance from the samples.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn expected_error(&mut self) -> Result<T, EvaluateError> {
        self.check_plausible()?;
        if self.domain == Domain::Inside {
            let [expected, _] = self.calibrated_errors();
            return number(expected);
        }
        let [of_time, _] = self.interval_error();
        let weights = &self.workspace.solver.weights;
        let guess = extrapolation_error(self.errors(), &self.error_times(), weights, self.target.t);
        number(self.interpolation_error() + of_time + guess)
    }

    /// Expected error within the sampled domain, and its bound. Leaving out a sample asks farther than a query does:
    /// where the expectation from the leave-one-out errors is above the bound, which is calibrated to that, it is the
    /// bound.
    fn calibrated_errors(&self) -> [T; 2] {
        let interpolation = self.interpolation_error();
        let [of_time, bound_of_time] = self.interval_error();
        let factor = bound_factor::<T>(self.errors(), &self.error_times(), self.target.t);
        let (expected, bound) = (interpolation + of_time, factor * interpolation + bound_of_time);
        [if bound < expected { bound } else { expected }, bound]
    }

    /// Expected error of the interpolation in the parameters and of the truncation.
    fn interpolation_error(&self) -> T {
        let weights = &self.workspace.solver.weights;
        expected_error(self.errors(), &self.error_times(), weights, self.target.t)
    }

    /// Error of the interpolation in time: expected, and its bound.
    fn interval_error(&self) -> [T; 2] {
        let weights = &self.workspace.solver.weights;
        interval_error(self.target.cluster, &self.target.model.times(), weights, self.target.t)
    }

    /// Standard deviation of the interpolation error, see
    /// [`Weights::deviation`](crate::interpolate::Weights::deviation).
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn deviation(&self) -> Result<T, EvaluateError> {
        number(self.workspace.solver.weights.deviation())
    }

    /// Bound of the distance of [`expected_error`](Self::expected_error) that holds for 95 of 100 queries, as a
    /// fraction of a.
    ///
    /// # Errors
    /// [`EvaluateError::NoBound`] outside the sampled domain, where it is not calibrated; [`EvaluateError::NotFinite`].
    pub fn error_bound(&self) -> Result<T, EvaluateError> {
        if self.domain != Domain::Inside {
            return Err(EvaluateError::NoBound);
        }
        let [_, bound] = self.calibrated_errors();
        number(bound)
    }

    /// The leave-one-out errors of the query's method.
    fn errors(&self) -> &'a Errors<'a> {
        self.target.query.errors(self.target.cluster)
    }

    /// The instants of the leave-one-out errors.
    fn error_times(&self) -> MatrixView<'a> {
        MatrixView::new(&self.target.model.contents().error_times)
    }

    /// The surface at this instant.
    fn snapshot(&mut self, frame: Frame) -> Result<Snapshot<'a, '_, T>, EvaluateError> {
        self.check_plausible()?;
        let displacement = self.workspace.solver.displacement(&self.target).finite()?;
        let translation = match frame {
            Frame::Laboratory => axial_position(&self.target, displacement.translation),
            Frame::Centroid => T::ZERO,
        };
        Ok(snapshot(&self.target, displacement, translation))
    }
}

/// Axial position of the centroid, by the translation's coefficient.
fn axial_position<T: Real>(target: &Target<'_, T>, translation: T) -> T {
    translation / target.root_of_nodes() + target.model.origin()
}

/// The surface of a displacement.
fn snapshot<'a, 's, T: Real, const K: usize>(
    target: &Target<'a, T>,
    displacement: &'s Coefficients<T, K>,
    translation: T,
) -> Snapshot<'a, 's, T> {
    Snapshot {
        mesh: target.model.mesh(),
        modes: MatrixView::new(&target.cluster.field.modes),
        coefficients: displacement.shape.quantized(),
        scale: target.model.scale(&target.query.parameters),
        translation,
    }
}

/// A result, if it is finite.
fn number<T: Real>(value: T) -> Result<T, EvaluateError> {
    finite([value]).map(|[value]| value)
}
