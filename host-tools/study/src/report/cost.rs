//! Run time against error, and the cost of scenes.

use std::time::Instant;

use capsule_core::model::wire::Contents;
use capsule_core::{Evaluator, Frame, Method, Model, Playback, Query, Real, Scheme, Workspace, playback_len};
use capsule_offline::{Progress, Settings, Truncation, build};
use capsule_plot::{Axis, Mark};

use super::sheet::{Curves, Section, Series, Sheet};
use crate::StudyError;
use crate::scenes::{Limits, scenes as costs};
use crate::stability::Subject;
use crate::stability::settings::changed;
use crate::stability::truth::{Truth, errors, read};
use crate::task::{INSTANTS, questions};

/// One way to answer.
struct Way {
    /// Ways of one kind have one colour.
    kind: &'static str,
    name: String,
    default: bool,
    bytes: usize,
    microseconds: f64,
    mean: f64,
    max: f64,
}

/// The figures by which methods are compared.
struct Comparison {
    truths: Vec<Truth>,
    /// How often each query is repeated.
    repetitions: usize,
    ways: Vec<Way>,
}

/// Tolerances of the models that are compared with the shipped one, in l.
const TOLERANCES: [f64; 3] = [6e-4, 3e-4, 8e-5];

/// Time of a query with a trajectory of all nodes against its error, for every method and setting.
pub(super) fn pareto(
    sheet: &mut Sheet,
    subject: &Subject,
    model: &Model,
    progress: Progress,
) -> Result<[Section; 2], StudyError> {
    let quick = subject.quick;
    let mut comparison = Comparison {
        truths: read(subject.tests, if quick { 4 } else { 32 }, |_| true)?,
        repetitions: if quick { 2 } else { 5 },
        ways: Vec::new(),
    };
    let size = subject.model.len();
    let few = |values: &'static [u32]| if quick { &values[..2] } else { values };
    let direct = |place: [f32; 2]| Query::new(place, Method::Direct);
    let paper = |place: [f32; 2]| Query::new(place, Method::Paper);

    comparison.add("direct", "direct, f32", true, size, model, direct)?;
    let query = |place: [f64; 2]| Query::new(place, Method::Direct);
    comparison.add("direct, f64", "direct, f64", false, size, model, query)?;
    for neighbours in few(&[8, 10, 12, 16, 20, 28, 32]) {
        let bytes = changed(model, |contents| contents.kernel.neighbours = *neighbours)?;
        let name = format!("direct, {neighbours} neighbours, f32");
        comparison.add(
            "direct, other neighbours",
            &name,
            false,
            size,
            &Model::open(&bytes)?,
            direct,
        )?;
    }
    for (i, tolerance) in TOLERANCES.iter().enumerate().filter(|_| !quick) {
        progress("models of other tolerances", i, TOLERANCES.len());
        let settings = Settings {
            truncation: Truncation::Tolerance(*tolerance),
            ..Settings::default()
        };
        let (bytes, _) = build(subject.database, &settings, &|_, _, _| ())?;
        let name = format!("direct, tolerance {tolerance} l, f32");
        comparison.add(TOLERANCE, &name, false, bytes.len(), &Model::open(&bytes)?, direct)?;
    }

    comparison.add("paper, Euler", "paper, Euler, f32", true, size, model, paper)?;
    let query = |place: [f64; 2]| Query::new(place, Method::Paper);
    comparison.add("paper, Euler", "paper, Euler, f64", false, size, model, query)?;
    for (scheme, kind, name) in [
        (Scheme::Euler, "paper, Euler", "Euler"),
        (Scheme::Heun, "paper, Heun", "Heun"),
        (Scheme::RungeKutta4, "paper, RK4", "RK4"),
    ] {
        let steps: &[f32] = if quick {
            &[0.2]
        } else {
            &[0.5, 0.2, 0.1, 0.05, 0.01, 0.005]
        };
        for step in steps {
            let query = |place: [f32; 2]| Query {
                step: Some(*step),
                scheme,
                ..paper(place)
            };
            comparison.add(
                kind,
                &format!("paper, {name}, step {step}, f32"),
                false,
                size,
                model,
                query,
            )?;
        }
    }
    type Change = fn(&mut Contents, u32);
    let changes: [(&str, &[u32], Change); 2] = [
        ("M", &[6, 8, 10, 16, 20], |contents, value| {
            contents.paper.neighbours = value
        }),
        ("m_u and m_v", &[4, 8, 16], |contents, value| {
            contents.paper.displacement_rank = value;
            contents.paper.velocity_rank = value;
        }),
    ];
    for (setting, values, change) in changes {
        for value in few(values) {
            let bytes = changed(model, |contents| change(contents, *value))?;
            let name = format!("paper, {setting} = {value}, f32");
            comparison.add(
                "paper, other M and ranks",
                &name,
                false,
                size,
                &Model::open(&bytes)?,
                paper,
            )?;
        }
    }
    Ok([comparison.time(sheet)?, comparison.size(sheet)?])
}

/// The kind of the ways that differ in the model's size.
const TOLERANCE: &str = "direct, other tolerances";

impl Comparison {
    /// Measures one way: at each configuration the least time of a query with a trajectory, as another program may be
    /// in the way; of these the median.
    fn add<T: Real>(
        &mut self,
        kind: &'static str,
        name: &str,
        default: bool,
        bytes: usize,
        model: &Model,
        query: impl Fn([T; 2]) -> Query<T>,
    ) -> Result<(), StudyError> {
        let errors = errors(model, &self.truths, &query)?;
        let mut workspace = Box::new(Workspace::<T>::new());
        let mut playback = Playback::new(vec![T::ZERO; playback_len(model)]);
        let end = f64::from(model.end_time());
        let times: Vec<T> = (1..=INSTANTS)
            .map(|i| T::from_f64(end * i as f64 / INSTANTS as f64))
            .collect();
        let mut nodes = vec![[T::ZERO; 3]; times.len() * model.mesh().nodes()];
        let mut durations = Vec::new();
        for truth in &self.truths {
            let query = Query {
                extrapolate: true,
                ..query(truth.parameters.map(T::from_f64))
            };
            let mut least = f64::INFINITY;
            for _ in 0..self.repetitions {
                // A repeated query would be answered from the workspace.
                workspace.invalidate();
                let start = Instant::now();
                let mut evaluator = Evaluator::new(model, &mut workspace)?;
                evaluator.prepare(&query)?;
                for (t, out) in times.iter().zip(nodes.chunks_exact_mut(model.mesh().nodes())) {
                    evaluator.frame(*t, Frame::Laboratory, &mut playback, out)?;
                }
                least = least.min(start.elapsed().as_secs_f64() * 1e6);
            }
            durations.push(least);
        }
        durations.sort_by(f64::total_cmp);
        self.ways.push(Way {
            kind,
            name: name.to_owned(),
            default,
            bytes,
            microseconds: durations[durations.len() / 2],
            mean: 100.0 * errors.mean()[1],
            max: 100.0 * errors.max()[1],
        });
        Ok(())
    }

    /// Points of the ways, a series for each kind, then the defaults.
    fn series(&self, wanted: impl Fn(&Way) -> bool, point: impl Fn(&Way) -> (f64, f64)) -> Vec<Series> {
        let mut series: Vec<Series> = Vec::new();
        for way in self.ways.iter().filter(|way| wanted(way)) {
            match series.iter_mut().find(|(kind, _, _)| kind == way.kind) {
                Some((_, _, points)) => points.push(point(way)),
                None => series.push((way.kind.to_owned(), Mark::Dots, vec![point(way)])),
            }
        }
        let defaults = self.ways.iter().filter(|way| way.default && wanted(way));
        series.push(("defaults".to_owned(), Mark::Rings, defaults.map(point).collect()));
        series
    }

    fn time(&self, sheet: &mut Sheet) -> Result<Section, StudyError> {
        let mut section = Section::new(
            "Run time against error",
            &format!(
                "Time of a new query and {INSTANTS} instants with all nodes on one core of this machine, against the \
                 mean error at t = 8 \
                 over {} configurations that the model does not contain (distance of corresponding nodes in the \
                 laboratory frame). \
                 The median over the configurations of the least of {} times. The default step of the paper's method \
                 is a \
                 thousandth of the end time.",
                self.truths.len(),
                self.repetitions
            ),
        );
        let curves = Curves {
            title: "Run time against error".to_owned(),
            axes: [
                Axis::logarithmic("us a trajectory"),
                Axis::logarithmic("mean error at t = 8 / % of a"),
            ],
            same_scale: false,
            series: self.series(|_| true, |way| (way.microseconds, way.mean)),
        };
        section.curves(
            sheet,
            "pareto_points.csv",
            "Every method and setting; rings mark the defaults",
            curves,
        )?;
        let rows = self.ways.iter().map(|way| {
            let numbers = [
                format!("{:.0}", way.microseconds),
                format!("{:.4}", way.mean),
                format!("{:.4}", way.max),
                way.bytes.to_string(),
            ];
            let default = if way.default { "default" } else { "" };
            [vec![way.name.clone()], numbers.to_vec(), vec![default.to_owned()]].concat()
        });
        let heading = [
            "way",
            "us a trajectory",
            "mean error %",
            "greatest error %",
            "model bytes",
            "default",
        ];
        section.table(sheet, "pareto.csv", &heading, rows.collect())?;
        Ok(section)
    }

    fn size(&self, sheet: &mut Sheet) -> Result<Section, StudyError> {
        let mut section = Section::new(
            "Size against error",
            "Models of the same samples with other tolerances of the truncation, direct evaluation; the rows of the \
             table above that \
             are called tolerance.",
        );
        let of_size = |way: &Way| way.kind == TOLERANCE || way.kind == "direct";
        let curves = Curves {
            title: "Size against error".to_owned(),
            axes: [
                Axis::linear("size of the model / kB"),
                Axis::logarithmic("mean error at t = 8 / % of a"),
            ],
            same_scale: false,
            series: self.series(of_size, |way| (way.bytes as f64 / 1e3, way.mean)),
        };
        section.curves(sheet, "size.csv", "Size of the model against error", curves)?;
        Ok(section)
    }
}

/// The cost of each kind of answer.
pub(super) fn scenes(sheet: &mut Sheet, subject: &Subject, model: &Model) -> Result<Section, StudyError> {
    let limits = Limits::measure(subject.model.len());
    let questions = questions(model, if subject.quick { 5 } else { 501 })?;
    let costs = costs(subject.model, &questions, &limits, !subject.quick)?;
    let mut section = Section::new(
        "What a scene costs",
        &format!(
            "Direct evaluation in single precision, medians over {} random questions, on one core of this machine, \
             which does at most \
             {:.0} operations a nanosecond ({:.0} with the instructions of any processor of its kind, by which all is \
             done but \
             products with panels) and reads {:.0} bytes of the model. Tasks called scene ask of prepared parameters; \
             the bytes are whole blocks of 256 of the model on which the answer depends.",
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
