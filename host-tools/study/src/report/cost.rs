//! Run time against error, and what scenes cost.

use std::time::Instant;

use capsule_core::{Evaluator, Method, Model, Query, Real, Workspace};
use capsule_plot::Axis;

use super::accuracy::ALL;
use super::sheet::{Curves, Section, Series, Sheet};
use crate::StudyError;
use crate::scenes::{Limits, scenes as costs};
use crate::stability::Subject;
use crate::stability::settings::{SCHEMES, changed};
use crate::stability::truth::{Truth, errors, read};
use crate::task::{INSTANTS as TRAJECTORY, questions};

/// One way to answer.
struct Way {
    name: String,
    microseconds: f64,
    mean: f64,
    max: f64,
    default: bool,
}

/// Time of a query with a trajectory of all nodes against its error, for every method and setting.
pub(super) fn pareto(sheet: &mut Sheet, subject: &Subject, model: &Model) -> Result<Section, StudyError> {
    let truths = read(subject.fresh, if subject.quick { 4 } else { 32 }, |_| true)?;
    let repetitions = if subject.quick { 2 } else { 7 };
    let contents = model.contents();
    let mut ways = Vec::new();
    for neighbours in if subject.quick {
        vec![12, 24]
    } else {
        vec![8, 10, 12, 16, 20, 24, 28, 32]
    } {
        let bytes = changed(model, |contents| contents.kernel.neighbours = neighbours)?;
        let model = Model::open(&bytes)?;
        let default = neighbours == contents.kernel.neighbours;
        let name = |bits| format!("direct, {neighbours} neighbours, f{bits}");
        let query = |place: [f32; 2]| Query::new(place, Method::Direct);
        ways.push(way(&model, &truths, repetitions, name(32), default, query)?);
        let query = |place: [f64; 2]| Query::new(place, Method::Direct);
        ways.push(way(&model, &truths, repetitions, name(64), false, query)?);
    }
    for (scheme, by) in SCHEMES {
        for step in if subject.quick {
            vec![0.2, 0.02]
        } else {
            vec![0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005]
        } {
            let query = |place: [f32; 2]| Query {
                step: Some(step),
                scheme,
                ..Query::new(place, Method::Paper)
            };
            let default = query([0.1, 0.9]) == Query::new([0.1, 0.9], Method::Paper);
            ways.push(way(
                model,
                &truths,
                repetitions,
                format!("paper, {by}, step {step}, f32"),
                default,
                query,
            )?);
        }
    }
    for neighbours in if subject.quick { vec![] } else { vec![6, 8, 10, 16, 20] } {
        let bytes = changed(model, |contents| contents.paper.neighbours = neighbours)?;
        let model = Model::open(&bytes)?;
        let query = |place: [f32; 2]| Query::new(place, Method::Paper);
        ways.push(way(
            &model,
            &truths,
            repetitions,
            format!("paper, M = {neighbours}, f32"),
            false,
            query,
        )?);
    }
    let mut section = Section::new(
        "Run time against error",
        &format!(
            "Time of a new query and {TRAJECTORY} instants with all nodes on one core of this machine, against the mean error at t = 8 over {} \
             configurations that the model does not contain (distance of corresponding nodes in the laboratory frame).",
            truths.len()
        ),
    );
    let mut series: Vec<Series> = Vec::new();
    for (name, start) in [
        ("direct", "direct"),
        ("paper, Euler", "paper, Euler"),
        ("paper, Heun", "paper, Heun"),
        ("paper, RK4", "paper, RK4"),
        ("paper, other M", "paper, M"),
    ] {
        let points = ways
            .iter()
            .filter(|way| way.name.starts_with(start))
            .map(|way| (way.microseconds, way.mean));
        series.push((name.to_owned(), false, points.collect()));
    }
    let defaults = ways
        .iter()
        .filter(|way| way.default)
        .map(|way| (way.microseconds, way.mean));
    series.push(("defaults".to_owned(), false, defaults.collect()));
    series.retain(|(_, _, points)| !points.is_empty());
    let curves = Curves {
        title: "Run time against error".to_owned(),
        axes: [
            Axis::logarithmic("us a trajectory"),
            Axis::logarithmic("mean error at t = 8 / % of a"),
        ],
        same_scale: false,
        series,
    };
    section.curves(
        sheet,
        "pareto_points.csv",
        "Every method and setting; the defaults are marked",
        curves,
    )?;
    let rows = ways.iter().map(|way| {
        let numbers = [
            format!("{:.0}", way.microseconds),
            format!("{:.4}", way.mean),
            format!("{:.4}", way.max),
        ];
        let default = if way.default { "default" } else { "" };
        [vec![way.name.clone()], numbers.to_vec(), vec![default.to_owned()]].concat()
    });
    let heading = ["way", "us a trajectory", "mean error %", "greatest error %", "default"];
    section.table(sheet, "pareto.csv", &heading, rows.collect())?;
    Ok(section)
}

fn way<T: Real>(
    model: &Model,
    truths: &[Truth],
    repetitions: usize,
    name: String,
    default: bool,
    query: impl Fn([T; 2]) -> Query<T>,
) -> Result<Way, StudyError> {
    let errors = errors(model, truths, &query)?;
    let mut workspace = Box::new(Workspace::<T>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    let mut nodes = vec![[T::ZERO; 3]; model.contents().mesh.nodes as usize];
    let end = f64::from(model.end_time());
    let mut durations = Vec::new();
    for i in 0..repetitions {
        let query = Query {
            extrapolate: true,
            ..query(truths[i % truths.len()].parameters.map(T::from_f64))
        };
        let start = Instant::now();
        evaluator.prepare(&query)?;
        for instant in 0..TRAJECTORY {
            let t = end * (instant + 1) as f64 / TRAJECTORY as f64;
            evaluator.at(T::from_f64(t))?.positions(&ALL, &mut nodes)?;
        }
        durations.push(start.elapsed().as_secs_f64() * 1e6);
    }
    durations.sort_by(f64::total_cmp);
    Ok(Way {
        name,
        microseconds: durations[durations.len() / 2],
        mean: 100.0 * errors.mean()[1],
        max: 100.0 * errors.max()[1],
        default,
    })
}

/// What each kind of answer costs.
pub(super) fn scenes(sheet: &mut Sheet, subject: &Subject, model: &Model) -> Result<Section, StudyError> {
    let limits = Limits::measure(subject.model.len());
    let questions = questions(model, if subject.quick { 5 } else { 501 })?;
    let costs = costs(subject.model, &questions, &limits, !subject.quick)?;
    let mut section = Section::new(
        "What a scene costs",
        &format!(
            "Direct evaluation in single precision, medians over {} random questions, on one core of this machine, which does at most \
             {:.0} operations a nanosecond ({:.0} with the instructions that the core is compiled for) and reads {:.0} bytes of the \
             model. Tasks called scene ask of prepared parameters; the bytes are whole blocks of 256 of the model on which the answer depends.",
            questions.len(),
            limits.operations_per_ns,
            limits.portable_operations_per_ns,
            limits.bytes_per_ns
        ),
    );
    let rows = costs.iter().map(|cost| {
        let timing = &cost.timing;
        let counts = [cost.reads, cost.operations].map(|count| count.to_string());
        let bytes = cost.model_bytes.map_or(String::new(), |bytes| bytes.to_string());
        let times = [
            timing.median_us,
            timing.lower_quartile_us,
            timing.upper_quartile_us,
            cost.least_us,
        ];
        let head = [vec![timing.task.replace('_', " ")], counts.to_vec(), vec![bytes]].concat();
        [
            head,
            vec![cost.answer_bytes.to_string()],
            times.map(|us| format!("{us:.2}")).to_vec(),
        ]
        .concat()
    });
    let heading = [
        "task",
        "numbers read",
        "operations",
        "model bytes",
        "answer bytes",
        "median us",
        "lower quartile us",
        "upper quartile us",
        "least possible us",
    ];
    section.table(sheet, "scenes.csv", &heading, rows.collect())?;
    Ok(section)
}
