//! What a scene costs: counted, and timed beside what this machine can do at most.

use capsule_core::{Method, Model};
use capsule_gauge::{Arithmetic, Counted, count, peak, reading};
use serde::Serialize;

use crate::StudyError;
use crate::speed::{Timing, time};
use crate::task::{Asker, Question, Task, tasks};
use crate::touched::touched;

/// Bytes of the model that are told apart: a few cache lines.
const BLOCK: usize = 256;

/// What this machine can do at most, on one core.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Limits {
    /// Operations in a nanosecond, single precision, each rounded, in the widest registers.
    pub operations_per_ns: f64,
    /// The same with the instructions that every processor of this kind has, for which the core is compiled.
    pub portable_operations_per_ns: f64,
    /// Bytes read in a nanosecond from an array as large as the model.
    pub bytes_per_ns: f64,
}

impl Limits {
    /// Measures them.
    #[must_use]
    pub fn measure(model_bytes: usize) -> Self {
        const REPETITIONS: usize = 100;
        Self {
            operations_per_ns: peak(Arithmetic::RoundedSingle, REPETITIONS) / 1e9,
            portable_operations_per_ns: peak(Arithmetic::PortableSingle, REPETITIONS) / 1e9,
            bytes_per_ns: reading(model_bytes, REPETITIONS) / 1e9,
        }
    }
}

/// What a task costs with direct evaluation in single precision.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Cost {
    /// Stored numbers that it reads, and constants; medians over the questions, as the next.
    pub reads: usize,
    /// Floating-point operations.
    pub operations: usize,
    /// Bytes of the model on which the answer to the first question depends, in whole blocks of 256; none if not asked for.
    pub model_bytes: Option<usize>,
    /// Bytes of the answer.
    pub answer_bytes: usize,
    /// Its time.
    #[serde(flatten)]
    pub timing: Timing,
    /// The least time that this machine would need for the operations and for the bytes, in microseconds.
    pub least_us: f64,
}

/// What every task costs. `with_bytes` finds out the bytes of the model too, which takes a minute.
///
/// # Errors
/// A file that cannot be opened; too few questions; a question that the model refuses.
pub fn scenes(file: &[u8], questions: &[Question], limits: &Limits, with_bytes: bool) -> Result<Vec<Cost>, StudyError> {
    let model = Model::open(file)?;
    let first = questions.first().ok_or(StudyError::NothingToMeasure {
        queries: 0,
        repetitions: 1,
    })?;
    let mut costs = Vec::new();
    for task in tasks(&model) {
        let mut asker = Asker::<Counted>::new(&model, Method::Direct)?;
        let mut counts = Vec::new();
        for question in questions.iter().take(101) {
            asker.before(&model, &task, question)?;
            let (answered, counted) = count(|| asker.answer(&model, &task, question));
            answered?;
            counts.push(counted);
        }
        let answer_bytes = size_of::<f32>() * asker.numbers(task.what).len();
        let median = |of: fn(&capsule_gauge::Counts) -> usize| {
            let mut values: Vec<usize> = counts.iter().map(of).collect();
            values.sort_unstable();
            values[values.len() / 2]
        };
        let operations = median(|counts| counts.operations());
        let model_bytes = with_bytes
            .then(|| touched(file, BLOCK, &task, first))
            .transpose()?
            .map(|blocks| BLOCK * blocks.len());
        let of_operations = operations as f64 / limits.operations_per_ns;
        let of_bytes = (model_bytes.unwrap_or_default() + answer_bytes) as f64 / limits.bytes_per_ns;
        costs.push(Cost {
            reads: median(|counts| counts.reads),
            operations,
            model_bytes,
            answer_bytes,
            timing: time::<f32>(&model, Method::Direct, &task, questions)?,
            least_us: of_operations.max(of_bytes) / 1e3,
        });
    }
    Ok(costs)
}

/// Asks one task, once for each question, for programs that count instructions.
///
/// # Errors
/// A question that the model refuses.
pub fn once(model: &Model<'_>, task: &Task, questions: &[Question]) -> Result<(), StudyError> {
    let mut asker = Asker::<f32>::new(model, Method::Direct)?;
    for question in questions {
        asker.before(model, task, question)?;
        asker.answer(model, task, question)?;
    }
    Ok(())
}
