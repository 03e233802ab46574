//! How long the model takes to answer, on this machine.

use std::hint::black_box;
use std::time::Instant;

use capsule_core::{EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Query, Real, Scene, Workspace};
use serde::Serialize;

use crate::{StudyError, name};

/// What is timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Task {
    /// Preparing new parameters.
    Prepare,
    /// New parameters to one outline at one instant.
    Outline,
    /// New parameters to the observables at one instant.
    NewObservables,
    /// New parameters to all nodes at one instant.
    Surface,
    /// New parameters to all nodes at 100 instants.
    Trajectory,
    /// The observables of prepared parameters at another instant.
    Observables,
    /// All nodes of prepared parameters, 0.02 l/V later than before.
    NextFrame,
}

impl Task {
    /// All of them.
    pub const ALL: [Task; 7] = [
        Task::Prepare,
        Task::Outline,
        Task::NewObservables,
        Task::Surface,
        Task::Trajectory,
        Task::Observables,
        Task::NextFrame,
    ];
}

/// Instants of a trajectory.
pub const INSTANTS: usize = 100;

/// The time that a task takes, over repetitions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Timing {
    /// What was timed.
    pub task: Task,
    /// The method's name.
    pub method: &'static str,
    /// Bits of a number: 32 or 64.
    pub bits: usize,
    /// Median, in microseconds.
    pub median_us: f64,
    /// First quartile, in microseconds.
    pub lower_quartile_us: f64,
    /// Third quartile, in microseconds.
    pub upper_quartile_us: f64,
}

/// Times all tasks for both methods, in numbers of type `T` (f32 or f64), each `repetitions` times.
///
/// The queries (Ca, a/l) are taken in turn, so that none is answered from what the workspace still holds.
///
/// # Errors
/// [`StudyError::NothingToMeasure`] for fewer than two queries or no repetition; [`StudyError::Evaluate`] when the model
/// refuses a query.
pub fn measure<T: Real>(model: &Model, queries: &[[T; 2]], repetitions: usize) -> Result<Vec<Timing>, StudyError> {
    if queries.len() < 2 || repetitions == 0 {
        return Err(StudyError::NothingToMeasure {
            queries: queries.len(),
            repetitions,
        });
    }
    let mut timings = Vec::new();
    for method in [Method::Direct, Method::Paper] {
        for task in Task::ALL {
            let mut durations = durations(model, queries, repetitions, method, task)?;
            durations.sort_by(f64::total_cmp);
            let quantile = |q: usize| durations[(durations.len() - 1) * q / 4];
            timings.push(Timing {
                task,
                method: name(method),
                bits: 8 * size_of::<T>(),
                median_us: quantile(2),
                lower_quartile_us: quantile(1),
                upper_quartile_us: quantile(3),
            });
        }
    }
    Ok(timings)
}

/// Microseconds of each repetition of a task.
fn durations<T: Real>(
    model: &Model,
    queries: &[[T; 2]],
    repetitions: usize,
    method: Method,
    task: Task,
) -> Result<Vec<f64>, EvaluateError> {
    let mut workspace = Box::new(Workspace::<T>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    let mut nodes = vec![[T::ZERO; 3]; model.contents().mesh.nodes as usize];
    let mut outline = vec![[T::ZERO; 2]; nodes.len()];
    let all = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let end = T::from_f32(model.end_time());
    let at = |i: usize| end * T::from_index(i) / T::from_index(INSTANTS);
    let times: Vec<T> = (1..=INSTANTS).map(at).collect();
    let mut durations = Vec::with_capacity(repetitions);
    for i in 0..repetitions {
        let query = Query {
            extrapolate: true,
            ..Query::new(queries[i % queries.len()], method)
        };
        // Between stored instants.
        let mut t = times[(7 * i + 1) % (INSTANTS - 1)] + T::from_f32(0.013);
        if matches!(task, Task::Observables | Task::NextFrame) {
            evaluator.prepare(&query)?;
            evaluator.at(t)?.observables()?;
            t = if task == Task::NextFrame {
                t + T::from_f32(0.02)
            } else {
                times[(31 * i + 5) % (INSTANTS - 1)] + T::from_f32(0.013)
            };
        }
        let start = Instant::now();
        if !matches!(task, Task::Observables | Task::NextFrame) {
            evaluator.prepare(&query)?;
        }
        match task {
            Task::Prepare => {}
            Task::Outline => {
                evaluator.at(t)?.outline(MIDPLANE, Frame::Centroid, &mut outline)?;
            }
            Task::NewObservables | Task::Observables => {
                black_box(evaluator.at(t)?.observables()?);
            }
            Task::Surface | Task::NextFrame => {
                evaluator.at(t)?.positions(&all, &mut nodes)?;
            }
            Task::Trajectory => {
                for t in &times {
                    evaluator.at(*t)?.positions(&all, &mut nodes)?;
                    black_box(&nodes);
                }
            }
        }
        black_box((&nodes, &outline));
        durations.push(start.elapsed().as_secs_f64() * 1e6);
    }
    Ok(durations)
}
