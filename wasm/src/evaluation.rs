//! Answers of a model to one query, at one instant after another.

use crate::section::curves;
use crate::shared::Shared;
use capsule_core::{
    EvaluateError, Evaluator, Frame, Instant, Method, Parameters, Playback, Query, Workspace, playback_len,
};
use capsule_refusal::Refusal;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// One query of a model and the storage for its answers. The core keeps its results there: a query that is set twice,
/// or an instant that several methods ask for, is computed once. After a refused query every method refuses.
#[wasm_bindgen]
pub struct Evaluation {
    pub(crate) shared: Rc<Shared>,
    workspace: Box<Workspace<f32>>,
    playback: Playback<f32, Vec<f32>>,
    pub(crate) query: Option<Query<f32>>,
    pub(crate) t: f32,
}

/// Scalars of an instant, in the model's units: lengths in l, velocity in V for a capsule in the channel.
#[wasm_bindgen]
#[derive(Clone, Copy)]
pub struct Readings {
    /// Extent along the channel.
    #[wasm_bindgen(readonly)]
    pub axial_length: f32,
    /// max |y| in the plane z = 0.
    #[wasm_bindgen(readonly)]
    pub half_width: f32,
    /// Largest distance from the axis in the plane y = z.
    #[wasm_bindgen(readonly)]
    pub half_diagonal: f32,
    /// Depth of the rear cavity.
    #[wasm_bindgen(readonly)]
    pub rear_depth: f32,
    /// Velocity of the volume centroid.
    #[wasm_bindgen(readonly)]
    pub velocity: f32,
}

/// Closed curves of a plane section.
#[wasm_bindgen(getter_with_clone)]
pub struct Curves {
    /// y, z, y, z, ... of all curves, one after another.
    #[wasm_bindgen(readonly)]
    pub points: Vec<f32>,
    /// Number of points of each curve.
    #[wasm_bindgen(readonly)]
    pub lengths: Vec<u32>,
}

#[wasm_bindgen]
impl Evaluation {
    /// Sets the query: the model's parameters in their order. `method` is "direct" or "paper". Returns where the
    /// parameters lie: "inside", "beyond-steady-limit", "far-from-samples" or "outside".
    ///
    /// # Errors
    /// Parameters that the core refuses: outside the domain without `extrapolate`, not finite, too few or too many.
    pub fn prepare(&mut self, parameters: &[f64], method: &str, extrapolate: bool) -> Result<String, Refusal> {
        // A refusal leaves nothing prepared.
        self.query = None;
        let method = match method {
            "direct" => Method::Direct,
            "paper" => Method::Paper,
            other => return Err(Refusal::unknown("method", other, &["direct", "paper"])),
        };
        let expected = self.shared.core().parameters().len();
        let found = parameters.len();
        let parameters =
            Parameters::from_doubles(parameters).ok_or(EvaluateError::ParameterCount { expected, found })?;
        let query = Query {
            extrapolate,
            ..Query::new(parameters, method)
        };
        let model = self.shared.core();
        let prepared = Evaluator::new(model, &mut self.workspace)?.prepare(&query);
        let domain = prepared.map_err(|error| Refusal::of_query(error, model))?;
        self.query = Some(query);
        Ok(domain.name().to_owned())
    }

    /// Goes to an instant, in l/V; it takes effect when something is asked.
    #[wasm_bindgen(js_name = goTo)]
    pub fn go_to(&mut self, t: f32) {
        self.t = t;
    }

    /// Lengths and velocity; computes the two outlines only.
    ///
    /// # Errors
    /// No query, an instant outside the model's times, or an extrapolated shape that no capsule has. The methods below
    /// have the same errors.
    pub fn readings(&mut self) -> Result<Readings, Refusal> {
        let found = self.ask(|instant| instant.observables())?;
        Ok(Readings {
            axial_length: found.axial_length,
            half_width: found.half_width,
            half_diagonal: found.half_diagonal,
            rear_depth: found.rear_depth,
            velocity: found.velocity,
        })
    }

    /// Enclosed volume, in l^3; computes all nodes.
    pub fn volume(&mut self) -> Result<f32, Refusal> {
        self.ask(|instant| instant.volume())
    }

    /// Expected distance, laboratory frame, as a fraction of a: in the channel the modified Hausdorff distance to the
    /// full-order model, else the mean distance of the nodes to the data. Outside the sampled domain it is a guess.
    #[wasm_bindgen(js_name = expectedError)]
    pub fn expected_error(&mut self) -> Result<f32, Refusal> {
        self.ask(|instant| instant.expected_error())
    }

    /// The bound below which 95 % of the errors lie, in the unit of the expected error; undefined outside the sampled
    /// domain, where no bound is calibrated.
    #[wasm_bindgen(js_name = errorBound)]
    pub fn error_bound(&mut self) -> Result<Option<f32>, Refusal> {
        self.ask(|instant| {
            instant.centroid()?;
            match instant.error_bound() {
                Err(EvaluateError::NoBound) => Ok(None),
                bound => bound.map(Some),
            }
        })
    }

    /// Axial position of the volume centroid in the laboratory frame, in l.
    pub fn centroid(&mut self) -> Result<f32, Refusal> {
        self.ask(|instant| instant.centroid())
    }

    /// An outline by name, from the front pole to the rear pole: x, r, x, r, ..., in l, laboratory frame.
    pub fn outline(&mut self, name: &str) -> Result<Vec<f32>, Refusal> {
        let mut points = vec![[0.0; 2]; self.shared.nodes];
        let count = self.ask(|instant| instant.outline(name, Frame::Laboratory, &mut points))?;
        points.truncate(count);
        Ok(points.into_flattened())
    }

    /// Positions of the vertices to draw, x, y, z, ..., in l, relative to the centroid.
    pub fn surface(&mut self) -> Result<Vec<f32>, Refusal> {
        let nodes = self.all_nodes()?;
        Ok(self.shared.surface.positions(&nodes).into_flattened())
    }

    /// The section by the plane at `offset` along the channel from the centroid, in l.
    pub fn transversal(&mut self, offset: f32) -> Result<Curves, Refusal> {
        let nodes = self.all_nodes()?;
        let curves = curves(self.shared.core(), &nodes, offset)?;
        Ok(Curves {
            lengths: curves.iter().map(|curve| curve.len() as u32).collect(),
            points: curves.concat().into_flattened(),
        })
    }
}

impl Evaluation {
    pub(crate) fn new(shared: Rc<Shared>) -> Self {
        let room = playback_len(shared.core());
        Self {
            shared,
            playback: Playback::new(vec![0.0; room]),
            workspace: Box::default(),
            query: None,
            t: 0.0,
        }
    }

    /// Puts a question to the core about the current query and instant.
    pub(crate) fn ask<A>(
        &mut self,
        question: impl FnOnce(&mut Instant<'_, '_, f32>) -> Result<A, EvaluateError>,
    ) -> Result<A, Refusal> {
        let mut evaluator = Evaluator::new(self.shared.core(), &mut self.workspace)?;
        evaluator.prepare(self.query.as_ref().ok_or(EvaluateError::NotPrepared)?)?;
        Ok(question(&mut evaluator.at(self.t)?)?)
    }

    /// All nodes in the laboratory frame.
    pub(crate) fn laboratory_nodes(&mut self) -> Result<Vec<[f32; 3]>, Refusal> {
        let centroid = self.centroid()?;
        let mut nodes = self.all_nodes()?;
        nodes.iter_mut().for_each(|node| node[0] += centroid);
        Ok(nodes)
    }

    fn all_nodes(&mut self) -> Result<Vec<[f32; 3]>, Refusal> {
        let mut nodes = vec![[0.0; 3]; self.shared.nodes];
        let mut evaluator = Evaluator::new(self.shared.core(), &mut self.workspace)?;
        evaluator.prepare(self.query.as_ref().ok_or(EvaluateError::NotPrepared)?)?;
        evaluator.frame(self.t, Frame::Centroid, &mut self.playback, &mut nodes)?;
        Ok(nodes)
    }
}
