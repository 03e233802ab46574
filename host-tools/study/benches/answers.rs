//! Times of the shipped model's answers, by criterion: `cargo bench --package capsule-study`, or with a name behind it
//! (`-- direct/surface`). What each task is, `capsule_study::task` says.

use std::hint::black_box;
use std::time::{Duration, Instant};

use capsule_core::{Method, Model};
use capsule_study::StudyError;
use capsule_study::name;
use capsule_study::task::{Asker, QUERIES, Question, Task, questions, tasks};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion};

const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/capsule.crom");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::fs::read(MODEL)?;
    let model = Model::open(&file)?;
    // Enough that branches are no better foreseen than where a person asks.
    let questions = questions(&model, 997)?;
    let mut criterion = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args();
    criterion.bench_function("open", |bencher| {
        bencher.iter(|| black_box(Model::open(black_box(&file))))
    });
    for method in [Method::Direct, Method::Paper] {
        let mut group = criterion.benchmark_group(name(method));
        match method {
            Method::Direct => tasks(&model).try_for_each(|task| bench(&mut group, &model, method, task, &questions))?,
            Method::Paper => QUERIES
                .into_iter()
                .try_for_each(|task| bench(&mut group, &model, method, task, &questions))?,
        }
        group.finish();
    }
    criterion.final_summary();
    Ok(())
}

/// One task, with one question after the other.
fn bench(
    group: &mut BenchmarkGroup<'_, WallTime>,
    model: &Model<'_>,
    method: Method,
    task: Task,
    questions: &[Question],
) -> Result<(), StudyError> {
    let mut asker = Asker::<f32>::new(model, method)?;
    let mut asked = questions.iter().cycle();
    let mut failed = Ok(());
    group.bench_function(task.name, |bencher| {
        bencher.iter_custom(|count| {
            let mut total = Duration::ZERO;
            for question in asked.by_ref().take(count as usize) {
                let before = asker.before(model, &task, question);
                let start = Instant::now();
                let answered = asker.answer(model, &task, question);
                total += start.elapsed();
                failed = failed.and(before).and(answered);
            }
            total
        });
    });
    Ok(failed?)
}
