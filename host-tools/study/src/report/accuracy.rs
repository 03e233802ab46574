//! Configurations that the model does not contain: coefficients in time (Figs. 10 and 11), profiles (Fig. 14), and the
//! stated errors against the true ones.

use capsule_core::{Evaluator, Frame, Method, Model, Nodes, Query, Scene, Workspace};
use capsule_database::Trajectory;
use capsule_offline::{Progress, one_minus_ric};
use capsule_plot::{Axis, Mark};
use faer::Mat;

use super::sheet::{Curves, Section, Series, Sheet};
use crate::StudyError;
use crate::stability::Subject;
use crate::test_set::HEADING;

/// The query that the paper shows.
const SHOWN: [f64; 2] = [0.10, 0.90];

/// Instants of the profiles.
const PROFILES: [f64; 4] = [0.0, 1.0, 2.0, 8.0];

/// All nodes of an instant.
pub(super) const ALL: Scene<'_> = Scene {
    nodes: Nodes::All,
    frame: Frame::Laboratory,
};

/// Configurations of the test set that are shown.
pub(super) struct Shown {
    /// The one closest to [`SHOWN`] at all its instants, and the model's answers there.
    trajectory: Trajectory,
    predicted: [Vec<Vec<[f64; 3]>>; 2],
    profiles: Vec<Profile>,
}

/// Outlines of the full-order model.
struct Profile {
    parameters: [f64; 2],
    /// At [`PROFILES`]: points (x, y), front to rear on the upper side.
    outlines: Vec<Vec<(f64, f64)>>,
}

impl Shown {
    pub(super) fn new(subject: &Subject, model: &Model) -> Result<Self, StudyError> {
        let database = subject.tests;
        let entries = database.entries()?;
        let steady = entries
            .iter()
            .filter(|entry| entry.status.is_steady() && entry.snapshots > 0);
        let parameters: Vec<[f64; 2]> = steady.map(|entry| [entry.parameters[0], entry.parameters[1]]).collect();
        let distance = |p: &[f64; 2]| (p[0] - SHOWN[0]).abs() * 10.0 + (p[1] - SHOWN[1]).abs();
        let closest = parameters
            .iter()
            .copied()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let closest = closest.ok_or(StudyError::NoTruth {
            database: database.directory().to_owned(),
        })?;
        let until = database
            .times()
            .iter()
            .copied()
            .filter(|t| *t < 10.0 + 1e-9)
            .collect::<Vec<_>>();
        let trajectory = database.read(&closest)?.extended(database.mesh(), &until)?;
        let field = |velocities: bool| -> Result<Vec<Vec<[f64; 3]>>, StudyError> {
            let mut workspace = Box::new(Workspace::<f64>::new());
            let mut evaluator = Evaluator::new(model, &mut workspace)?;
            evaluator.prepare(&Query::new(closest, Method::Direct))?;
            let at = |t: &f64| {
                let mut nodes = vec![[0.0; 3]; database.mesh().nodes.len()];
                let mut instant = evaluator.at(*t)?;
                if velocities {
                    instant.velocities(&ALL, &mut nodes)?;
                } else {
                    instant.positions(&ALL, &mut nodes)?;
                }
                Ok(nodes)
            };
            until.iter().map(at).collect()
        };
        let predicted = [field(false)?, field(true)?];
        let six = parameters.len().div_ceil(6);
        let outline = |place: &[f64; 2]| -> Result<Profile, StudyError> {
            let truth = database.read(place)?.extended(database.mesh(), &PROFILES)?;
            let on_it = model.node_set(capsule_core::MIDPLANE);
            let nodes: Vec<usize> = on_it.map_or_else(Vec::new, |set| set.iter().collect());
            let points = |positions: &Vec<[f64; 3]>| {
                nodes
                    .iter()
                    .map(|node| (positions[*node][0], positions[*node][1]))
                    .collect()
            };
            Ok(Profile {
                parameters: *place,
                outlines: truth.positions.iter().map(points).collect(),
            })
        };
        Ok(Shown {
            trajectory,
            predicted,
            profiles: parameters.iter().step_by(six).map(outline).collect::<Result<_, _>>()?,
        })
    }
}

/// Coefficients of the query's own modes in time, of the model and of the truth (Fig. 10), and their decay (Fig. 11).
pub(super) fn evolution(sheet: &mut Sheet, subject: &Subject, shown: &Shown) -> Result<Section, StudyError> {
    let (truth, reference) = (&shown.trajectory, &subject.tests.mesh().nodes);
    let [ca, confinement] = [truth.parameters[0], truth.parameters[1]];
    let mut section = Section::new(
        "One query in time (Figs. 10 and 11)",
        &format!(
            "Ca = {ca}, a/l = {confinement}: the configuration closest to the paper's (0.10, 0.90) that is not in the \
             model. Local modes by the \
             POD of the predicted snapshots; the truth is projected onto them."
        ),
    );
    let displaced = |positions: &Vec<[f64; 3]>| -> Vec<[f64; 3]> {
        let nodes = positions.iter().zip(reference);
        nodes
            .map(|(p, x)| std::array::from_fn(|d| p[d] - confinement * x[d]))
            .collect()
    };
    let fields = [
        (
            "displacement",
            truth.positions.iter().map(displaced).collect(),
            shown.predicted[0].iter().map(displaced).collect(),
        ),
        ("velocity", truth.velocities.clone(), shown.predicted[1].clone()),
    ];
    let mut decay: Vec<Series> = Vec::new();
    for (part, unit, (field, exact, found)) in ["a", "b"]
        .into_iter()
        .zip(["l", "V"])
        .zip::<[(&str, Vec<Vec<[f64; 3]>>, Vec<Vec<[f64; 3]>>); 2]>(fields)
        .map(|((part, unit), of_field)| (part, unit, of_field))
    {
        let matrix = |snapshots: &[Vec<[f64; 3]>]| {
            Mat::from_fn(3 * reference.len(), snapshots.len(), |row, i| {
                snapshots[i][row / 3][row % 3]
            })
        };
        let (exact, found) = (matrix(&exact), matrix(&found));
        let svd = found.thin_svd().map_err(|_| StudyError::NoConvergence)?;
        let values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
        let points = one_minus_ric(&values)
            .into_iter()
            .take(20)
            .enumerate()
            .map(|(k, rest)| ((k + 1) as f64, rest));
        decay.push((field.to_owned(), Mark::Line, points.collect()));
        let mut series = Vec::new();
        for (k, which) in ["first", "second", "third"].into_iter().enumerate() {
            for (by, snapshots) in [("ROM", &found), ("FOM", &exact)] {
                let coefficient = |i: usize| {
                    (0..snapshots.nrows())
                        .map(|row| svd.U()[(row, k)] * snapshots[(row, i)])
                        .sum::<f64>()
                };
                let points = truth.times.iter().enumerate().map(|(i, t)| (*t, coefficient(i)));
                let every = if by == "FOM" { 6 } else { 1 };
                series.push((
                    format!("{which}, {by}"),
                    if by == "ROM" { Mark::Line } else { Mark::Dots },
                    points.step_by(every).collect(),
                ));
            }
        }
        let curves = Curves {
            title: format!("Coefficients of the {field}"),
            axes: [Axis::linear("t V/l"), Axis::linear(&format!("coefficient / {unit}"))],
            same_scale: false,
            series,
        };
        section.curves(
            sheet,
            &format!("fig10{part}.csv"),
            &format!("Fig. 10 ({part}): first three coefficients of the {field}"),
            curves,
        )?;
    }
    decay.push(("1e-7".to_owned(), Mark::Line, vec![(1.0, 1e-7), (20.0, 1e-7)]));
    let curves = Curves {
        title: "1 - RIC of the query's snapshots".to_owned(),
        axes: [Axis::linear("rank"), Axis::logarithmic("1 - RIC")],
        same_scale: false,
        series: decay,
    };
    section.curves(
        sheet,
        "fig11.csv",
        "Fig. 11: decay of the query's own modes; the paper reads ranks 3 and 8 at 1e-7",
        curves,
    )?;
    Ok(section)
}

/// Sections of the capsule in the channel (Fig. 14).
pub(super) fn profiles(sheet: &mut Sheet, model: &Model, shown: &Shown) -> Result<Section, StudyError> {
    let mut section = Section::new(
        "Profiles (Fig. 14)",
        "Sections z = 0 at t = 0, 1, 2 and 8: full-order model (lines) and prediction by direct evaluation (dots). \
         None of these configurations is in the model.",
    );
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    for (index, profile) in shown.profiles.iter().enumerate() {
        let [ca, confinement] = profile.parameters;
        evaluator.prepare(&Query {
            extrapolate: true,
            ..Query::new([ca, confinement], Method::Direct)
        })?;
        let closed = |points: &[(f64, f64)]| {
            points
                .iter()
                .copied()
                .chain(points.iter().rev().map(|(x, y)| (*x, -y)))
                .collect::<Vec<_>>()
        };
        let (mut exact, mut found) = (Vec::new(), Vec::new());
        let mut rows = Vec::new();
        for (t, outline) in PROFILES.into_iter().zip(&profile.outlines) {
            let mut points = vec![[0.0; 2]; outline.len()];
            evaluator
                .at(t)?
                .outline(capsule_core::MIDPLANE, Frame::Laboratory, &mut points)?;
            let points: Vec<(f64, f64)> = points.iter().map(|[x, y]| (*x, *y)).collect();
            for (by, points) in [("FOM", outline), ("ROM", &points)] {
                let row = |(x, y): &(f64, f64)| vec![by.to_owned(), t.to_string(), x.to_string(), y.to_string()];
                rows.extend(points.iter().map(row));
            }
            exact.push(("FOM".to_owned(), Mark::Line, closed(outline)));
            found.extend(closed(&points).into_iter().step_by(3));
        }
        let end = exact
            .iter()
            .flat_map(|(_, _, points): &Series| points)
            .map(|(x, _)| *x)
            .fold(0.0, f64::max);
        let walls = [-1.0, 1.0].map(|y| ("walls".to_owned(), Mark::Line, vec![(-1.5, y), (end + 0.5, y)]));
        let mut series: Vec<Series> = exact;
        series.push(("ROM".to_owned(), Mark::Dots, found));
        series.extend(walls);
        let title = format!("Ca = {ca}, a/l = {confinement}");
        let curves = Curves {
            title: title.clone(),
            axes: [Axis::linear("x / l"), Axis::linear("y / l")],
            same_scale: true,
            series,
        };
        let file = format!("fig14_{}.csv", index + 1);
        sheet.csv(&file, &["by", "t", "x", "y"], rows.into_iter())?;
        section.panel(curves.panel(), &format!("Fig. 14 ({}): {title}", index + 1), &file)?;
    }
    Ok(section)
}

/// Errors at the configurations of the test set, and the errors that the model states there.
pub(super) fn calibration(
    sheet: &mut Sheet,
    subject: &Subject,
    model: &Model,
    progress: Progress,
) -> Result<Section, StudyError> {
    let errors = crate::test_set(model, subject.tests, None, &crate::TEST_TIMES, progress)?;
    let mut section = Section::new(
        "True and stated errors",
        &format!(
            "{} configurations that no sample shares. Modified Hausdorff distance to {} in per cent of a. The model \
             states an expected error and a bound that 95 % of the errors shall keep: these lie below the diagonal.",
            errors.samples,
            model.errors_against()
        ),
    );
    sheet.csv("test_set.csv", &HEADING, errors.rows().into_iter())?;
    let mut rows = Vec::new();
    for (method, instants) in &errors.methods {
        let mut series: Vec<Series> = Vec::new();
        let stated = &errors.stated[method];
        for ((i, instant), at) in instants.iter().enumerate().zip(&stated.instants) {
            let numbers = [
                instant.lab_mean_percent,
                instant.lab_max_percent,
                instant.shape_mean_percent,
                instant.shape_max_percent,
                at.expected_mean_percent,
                at.bound_mean_percent,
            ];
            let numbers: Vec<String> = numbers.iter().map(|value| format!("{value:.4}")).collect();
            let below = format!("{:.0}", at.below_bound_percent);
            rows.push([vec![(*method).to_owned(), instant.t.to_string()], numbers, vec![below]].concat());
            let points = errors.compared[method]
                .iter()
                .map(|c| (100.0 * c.bound[i], 100.0 * c.laboratory[i]));
            series.push((format!("t = {}", instant.t), Mark::Dots, points.collect()));
        }
        let places = series
            .iter()
            .flat_map(|(_, _, points)| points)
            .flat_map(|(x, y)| [*x, *y]);
        let [low, high] = places
            .filter(|v| *v > 0.0)
            .fold([f64::INFINITY, 0.0], |[a, b]: [f64; 2], v| [a.min(v), b.max(v)]);
        series.push(("equal".to_owned(), Mark::Line, vec![(low, low), (high, high)]));
        let curves = Curves {
            title: format!("True error and its 95 % bound, {method}"),
            axes: [
                Axis::logarithmic("bound / % of a"),
                Axis::logarithmic("true error / % of a"),
            ],
            same_scale: false,
            series,
        };
        let caption = format!(
            "Calibration, {method}: {:.1} % of all errors are below their bound",
            stated.below_bound_percent
        );
        section.curves(sheet, &format!("calibration_{method}.csv"), &caption, curves)?;
    }
    let heading = [
        "method",
        "t",
        "lab mean %",
        "lab max %",
        "shape mean %",
        "shape max %",
        "mean expected %",
        "mean bound %",
        "below the bound %",
    ];
    section.table(sheet, "test_set_summary.csv", &heading, rows)?;
    Ok(section)
}
