//! Time per query, on one core of this machine.

use std::time::Instant;

use capsule_core::{Method, Model, Real};
use serde::Serialize;

use crate::task::{Asker, Question, Task};
use crate::{StudyError, name};

/// The time that a task takes, over many questions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Timing {
    /// The task that was timed.
    pub task: &'static str,
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

/// Times a task, in numbers of type `T` (f32 or f64), once for each question.
///
/// Pass many random questions, so that branches are no better predicted than in use, and no answer is already in the
/// workspace. The first tenth warms up and is not timed.
///
/// # Errors
/// [`StudyError::NothingToMeasure`] for fewer than two questions; [`StudyError::Evaluate`] when the model refuses one.
pub fn time<T: Real>(
    model: &Model<'_>,
    method: Method,
    task: &Task,
    questions: &[Question],
) -> Result<Timing, StudyError> {
    let mut asker = Asker::<T>::new(model, method)?;
    let mut durations = Vec::with_capacity(questions.len());
    for question in questions {
        asker.before(model, task, question)?;
        let start = Instant::now();
        asker.answer(model, task, question)?;
        durations.push(start.elapsed().as_secs_f64() * 1e6);
    }
    durations.drain(..questions.len() / 10);
    durations.sort_by(f64::total_cmp);
    let [Some(lower), Some(median), Some(upper)] =
        [1, 2, 3].map(|quarter| durations.get(durations.len().saturating_sub(1) * quarter / 4))
    else {
        return Err(StudyError::NothingToMeasure {
            queries: questions.len(),
            repetitions: 1,
        });
    };
    Ok(Timing {
        task: task.name,
        method: name(method),
        bits: 8 * size_of::<T>(),
        median_us: *median,
        lower_quartile_us: *lower,
        upper_quartile_us: *upper,
    })
}
