//! Tasks: the kinds of query that callers make, and the evaluator that answers them.

use std::hint::black_box;

use capsule_core::mechanics::Stencil;
use capsule_core::{
    Domain, EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Observables, Parameters, Playback, Query,
    Real, Scene, Segment, Workspace, playback_len, section,
};
use serde::Serialize;

use crate::StudyError;
use crate::random::Random;

/// The quantities that a task reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum What {
    /// Nothing.
    Nothing,
    /// Lengths, velocity and place.
    Observables,
    /// The outline in the plane z = 0.
    Outline,
    /// The cut of the surface by the plane through its centroid.
    Section,
    /// Positions of all nodes.
    Surface,
    /// Positions of all nodes, one frame after another.
    Frame,
    /// Frames at [`INSTANTS`], evenly over the whole time.
    Trajectory,
    /// Velocities of all nodes.
    Velocities,
    /// Principal tensions at the nodes from which the others follow by symmetry.
    Tensions,
}

/// The instants of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum When {
    /// One at random.
    Once,
    /// 0.02 time units after the previous one.
    Next,
    /// The last, when the capsule has become steady.
    End,
}

/// A kind of question.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Task {
    /// Its name.
    pub name: &'static str,
    /// Whether the parameters are new; else they are prepared before.
    pub new: bool,
    /// Its instants.
    pub when: When,
    /// The quantities that it reads.
    pub what: What,
}

const fn task(name: &'static str, new: bool, when: When, what: What) -> Task {
    Task { name, new, when, what }
}

/// New parameters with the first query.
pub const QUERIES: [Task; 6] = [
    task("prepare", true, When::Once, What::Nothing),
    task("new_observables", true, When::Once, What::Observables),
    task("outline", true, When::Once, What::Outline),
    task("surface", true, When::Once, What::Surface),
    task("trajectory", true, When::Once, What::Trajectory),
    task("steady_state", true, When::End, What::Outline),
];

/// A query at prepared parameters.
pub const SCENES: [Task; 7] = [
    task("observables", false, When::Once, What::Observables),
    task("scene_outline", false, When::Once, What::Outline),
    task("scene_section", false, When::Once, What::Section),
    task("scene_surface", false, When::Once, What::Surface),
    task("scene_velocities", false, When::Once, What::Velocities),
    task("scene_tensions", false, When::Once, What::Tensions),
    task("next_frame", false, When::Next, What::Frame),
];

/// All tasks that a model supports.
pub fn tasks(model: &Model<'_>) -> impl Iterator<Item = Task> {
    let outline = model.node_set(MIDPLANE).is_some();
    let membrane = model.has_mechanics();
    QUERIES.into_iter().chain(SCENES).filter(move |task| match task.what {
        What::Outline => outline,
        What::Tensions => membrane,
        _ => true,
    })
}

/// Instants of a trajectory.
pub const INSTANTS: usize = 100;
/// From one frame to the next.
const FRAME: f64 = 0.02;

/// One question: parameters and instant.
#[derive(Clone, Copy, Debug)]
pub struct Question {
    /// Within the domain.
    pub parameters: Parameters<f64>,
    /// Between 0 and the end less one frame.
    pub t: f64,
}

/// `count` random questions, the same in every run.
///
/// # Errors
/// [`StudyError::NothingToMeasure`] for a domain that chance does not find.
pub fn questions(model: &Model<'_>, count: usize) -> Result<Vec<Question>, StudyError> {
    let mut random = Random(11);
    let end = f64::from(model.end_time()) - FRAME;
    let mut one = || {
        let ranges = model.parameters();
        let values: Vec<f64> = ranges
            .iter()
            .map(|range| random.between(range.min, range.max))
            .collect();
        let parameters = Parameters::new(&values)?;
        let t = random.between(0.0, end);
        (model.domain(parameters) == Ok(Domain::Inside)).then_some(Question { parameters, t })
    };
    let found: Vec<Question> = (0..1000 * count).filter_map(|_| one()).take(count).collect();
    if found.len() == count && count > 0 {
        Ok(found)
    } else {
        Err(StudyError::NothingToMeasure {
            queries: found.len(),
            repetitions: count,
        })
    }
}

/// Runs tasks: a workspace, and buffers for the answers.
#[derive(Clone, Debug)]
pub struct Asker<T: Real> {
    method: Method,
    workspace: Box<Workspace<T>>,
    playback: Playback<T, Vec<T>>,
    stencils: Vec<Stencil<T>>,
    /// The instants of a trajectory.
    times: Vec<T>,
    nodes: Vec<[T; 3]>,
    outline: Vec<[T; 2]>,
    section: Vec<Segment<T>>,
    tensions: Vec<[T; 2]>,
    observables: Option<Observables<T>>,
    /// Length of the answer in its buffer.
    count: usize,
}

impl<T: Real> Asker<T> {
    /// With an empty workspace.
    ///
    /// # Errors
    /// A model that does not fit the workspace.
    pub fn new(model: &Model<'_>, method: Method) -> Result<Self, EvaluateError> {
        let mesh = model.mesh();
        let sector = if model.has_mechanics() {
            mesh.sector_nodes().len()
        } else {
            0
        };
        let end = f64::from(model.end_time());
        let times = (1..=INSTANTS).map(|i| T::from_f64(end * i as f64 / INSTANTS as f64));
        let stencils = mesh.sector_nodes().iter().take(sector);
        Ok(Self {
            method,
            workspace: Box::new(Workspace::new()),
            playback: Playback::new(vec![T::ZERO; playback_len(model)]),
            stencils: stencils
                .map(|node| Stencil::at(&mesh, node))
                .collect::<Result<_, _>>()?,
            times: times.collect(),
            nodes: vec![[T::ZERO; 3]; mesh.nodes()],
            outline: vec![[T::ZERO; 2]; model.node_set(MIDPLANE).map_or(0, |set| set.len())],
            section: vec![[[T::ZERO; 2]; 2]; 4 * mesh.elements().count()],
            tensions: vec![[T::ZERO; 2]; sector],
            observables: None,
            count: 0,
        })
    }

    fn query(&self, question: &Question) -> Query<T> {
        let mut values = [T::ZERO; capsule_core::MAX_PARAMETERS];
        let given = question.parameters.as_slice();
        for (value, given) in values.iter_mut().zip(given) {
            *value = T::from_f64(*given);
        }
        let parameters = Parameters::new(values.get(..given.len()).unwrap_or_default());
        Query {
            extrapolate: true,
            ..Query::new(parameters.unwrap_or_else(|| values.into()), self.method)
        }
    }

    /// Prepares for a task; this is not part of its cost.
    ///
    /// # Errors
    /// A question that the model refuses.
    pub fn before(&mut self, model: &Model<'_>, task: &Task, question: &Question) -> Result<(), EvaluateError> {
        if task.what == What::Trajectory {
            self.nodes.resize(self.times.len() * model.mesh().nodes(), [T::ZERO; 3]);
        }
        if task.new {
            self.workspace.invalidate();
            return Ok(());
        }
        let query = self.query(question);
        let mut evaluator = Evaluator::new(model, &mut self.workspace)?;
        evaluator.prepare(&query)?;
        if task.when == When::Next {
            let t = T::from_f64(question.t);
            evaluator.frame(t, Frame::Laboratory, &mut self.playback, &mut self.nodes)?;
        }
        Ok(())
    }

    /// The task. Not inlined, so that `cargo xtask scenes` can count its instructions by its name.
    ///
    /// # Errors
    /// A question that the model refuses.
    #[inline(never)]
    pub fn answer(&mut self, model: &Model<'_>, task: &Task, question: &Question) -> Result<(), EvaluateError> {
        let query = self.query(question);
        let all = Scene {
            nodes: Nodes::All,
            frame: Frame::Laboratory,
        };
        let mut evaluator = Evaluator::new(model, &mut self.workspace)?;
        if task.new {
            evaluator.prepare(&query)?;
        }
        let t = match task.when {
            When::Once => question.t,
            When::Next => question.t + FRAME,
            When::End => model.end_time().into(),
        };
        let t = T::from_f64(t);
        if task.what == What::Frame {
            self.count = evaluator.frame(t, all.frame, &mut self.playback, &mut self.nodes)?;
        } else if task.what == What::Trajectory {
            let frames = self.nodes.chunks_exact_mut(model.mesh().nodes());
            for (t, out) in self.times.iter().zip(frames) {
                evaluator.frame(*t, all.frame, &mut self.playback, out)?;
            }
            self.count = self.nodes.len();
        } else {
            let mut instant = evaluator.at(t)?;
            match task.what {
                What::Nothing | What::Frame | What::Trajectory => {}
                What::Observables => self.observables = Some(instant.observables()?),
                What::Outline => self.count = instant.outline(MIDPLANE, Frame::Centroid, &mut self.outline)?,
                What::Surface => self.count = instant.positions(&all, &mut self.nodes)?,
                What::Velocities => self.count = instant.velocities(&all, &mut self.nodes)?,
                What::Section => {
                    instant.positions(&all, &mut self.nodes)?;
                    let x = instant.centroid()?;
                    self.count = section(&model.mesh(), &self.nodes, x, &mut self.section)?;
                }
                What::Tensions => {
                    let membrane = instant.membrane(&mut self.nodes)?;
                    for (stencil, tensions) in self.stencils.iter().zip(&mut self.tensions) {
                        *tensions = membrane.deformation(stencil)?.tensions();
                    }
                    self.count = self.tensions.len();
                }
            }
        }
        black_box((
            &self.nodes,
            &self.outline,
            &self.section,
            &self.tensions,
            &self.observables,
        ));
        Ok(())
    }

    /// The numbers of the last answer.
    pub(crate) fn numbers(&self, what: What) -> Vec<f64> {
        let numbers: Box<dyn Iterator<Item = T> + '_> = match what {
            What::Nothing => Box::new(std::iter::empty()),
            What::Observables => Box::new(self.observables.iter().flat_map(|found| {
                [
                    found.axial_length,
                    found.half_width,
                    found.half_diagonal,
                    found.rear_depth,
                    found.velocity,
                    found.centroid,
                ]
            })),
            What::Outline => Box::new(self.outline.iter().take(self.count).flatten().copied()),
            What::Section => Box::new(self.section.iter().take(self.count).flatten().flatten().copied()),
            What::Surface | What::Frame | What::Trajectory | What::Velocities => {
                Box::new(self.nodes.iter().take(self.count).flatten().copied())
            }
            What::Tensions => Box::new(self.tensions.iter().take(self.count).flatten().copied()),
        };
        numbers.map(T::to_f64).collect()
    }
}
