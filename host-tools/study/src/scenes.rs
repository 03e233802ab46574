//! The cost of a scene: operation counts, and times with the peak rates of this machine.

use capsule_core::{Method, Model};
use capsule_opcount::{Arithmetic, Counted, count, peak, reading};
use rayon::prelude::*;
use serde::Serialize;

use crate::StudyError;
use crate::speed::{Timing, time};
use crate::task::{Asker, Question, Task, tasks};
use crate::touched::touched;

/// Resolution of the bytes of the model: a few cache lines.
const BLOCK: usize = 256;

/// Peak rates of this machine, on one core.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Limits {
    /// Operations in a nanosecond, single precision, each rounded, in the widest registers.
    pub operations_per_ns: f64,
    /// The same with the instructions that every processor of this kind has, by which the core does all but products
    /// with panels.
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

/// The cost of a task with direct evaluation in single precision.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Cost {
    /// Stored numbers that it reads, and constants; medians over the questions, as the next.
    pub reads: usize,
    /// Floating-point operations.
    pub operations: usize,
    /// The number of a question that reads as many numbers as the median.
    pub typical: usize,
    /// Bytes of the model on which the answer to this question depends, in whole blocks of 256; none if not asked for.
    pub model_bytes: Option<usize>,
    /// Bytes of the answer.
    pub answer_bytes: usize,
    /// Its time.
    #[serde(flatten)]
    pub timing: Timing,
    /// The least time that this machine would need for the operations and for the bytes, in microseconds.
    pub least_us: f64,
}

/// The cost of every task. `with_bytes` also finds the bytes of the model that each reads, which takes a minute.
///
/// # Errors
/// A file that cannot be opened; too few questions; a question that the model refuses.
pub fn scenes(file: &[u8], questions: &[Question], limits: &Limits, with_bytes: bool) -> Result<Vec<Cost>, StudyError> {
    let model = Model::open(file)?;
    let counted = tasks(&model).map(|task| Counts::new(&model, task, questions));
    let counted: Vec<Counts> = counted.collect::<Result<_, _>>()?;
    let bytes_of = |counts: &Counts| -> Result<usize, StudyError> {
        Ok(BLOCK * touched(file, BLOCK, &counts.task, &counts.question)?.len())
    };
    // Side by side; times are measured afterwards.
    let bytes: Vec<Option<usize>> = counted
        .par_iter()
        .map(|counts| with_bytes.then(|| bytes_of(counts)).transpose())
        .collect::<Result<_, _>>()?;
    let cost = |(counts, model_bytes): (Counts, Option<usize>)| {
        let of_operations = counts.operations as f64 / limits.operations_per_ns;
        let of_bytes = (model_bytes.unwrap_or_default() + counts.answer_bytes) as f64 / limits.bytes_per_ns;
        Ok(Cost {
            reads: counts.reads,
            operations: counts.operations,
            typical: counts.typical,
            model_bytes,
            answer_bytes: counts.answer_bytes,
            timing: time::<f32>(&model, Method::Direct, &counts.task, questions)?,
            least_us: of_operations.max(of_bytes) / 1e3,
        })
    };
    counted.into_iter().zip(bytes).map(cost).collect()
}

/// The counts of a task.
struct Counts {
    task: Task,
    /// Medians over the questions.
    reads: usize,
    operations: usize,
    /// The question that reads as many numbers as the median: its number, and itself.
    typical: usize,
    question: Question,
    answer_bytes: usize,
}

impl Counts {
    fn new(model: &Model<'_>, task: Task, questions: &[Question]) -> Result<Self, StudyError> {
        const MAX: usize = 101;
        let mut asker = Asker::<Counted>::new(model, Method::Direct)?;
        let mut counts = Vec::new();
        for (number, question) in questions.iter().take(MAX).enumerate() {
            asker.before(model, &task, question)?;
            let (answered, counted) = count(|| asker.answer(model, &task, question));
            answered?;
            counts.push((counted.reads, counted.operations(), (number, *question)));
        }
        let middle = counts.len() / 2;
        counts.sort_by_key(|(_, operations, _)| *operations);
        let operations = counts.get(middle).map(|(_, operations, _)| *operations);
        counts.sort_by_key(|(reads, _, _)| *reads);
        let (Some((reads, _, (typical, question))), Some(operations)) = (counts.get(middle), operations) else {
            return Err(StudyError::NothingToMeasure {
                queries: 0,
                repetitions: 1,
            });
        };
        Ok(Self {
            task,
            reads: *reads,
            operations,
            typical: *typical,
            question: *question,
            answer_bytes: size_of::<f32>() * asker.numbers(task.what).len(),
        })
    }
}

/// Runs one task once, for programs that count instructions.
///
/// # Errors
/// A question that the model refuses.
pub fn once(model: &Model<'_>, task: &Task, question: &Question) -> Result<(), StudyError> {
    let mut asker = Asker::<f32>::new(model, Method::Direct)?;
    asker.before(model, task, question)?;
    Ok(asker.answer(model, task, question)?)
}
