//! Design (Fig. 7), decay of the singular values (Figs. 8 and 9), leave-one-out errors (Fig. 13).

use std::path::Path;

use capsule_core::{Method, Model};
use capsule_offline::{BuildReport, Progress, Settings, Spectrum, build, one_minus_ric};
use capsule_plot::{Axis, Cells, Mark, Panel};

use super::sheet::{Curves, Section, Series, Sheet};
use crate::stability::Subject;
use crate::stability::data::Small;
use crate::{StudyError, name};

/// The samples, the clusters, the steady limit and the border of the jump.
pub(super) fn design(sheet: &mut Sheet, subject: &Subject, model: &Model) -> Result<Section, StudyError> {
    let clusters: Vec<_> = model.clusters().collect();
    let mut groups: [Series; 3] =
        ["first cluster", "second cluster", "both"].map(|name| (name.to_owned(), Mark::Dots, vec![]));
    let same = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-6;
    for (index, cluster) in clusters.iter().enumerate() {
        for sample in cluster.parameters().pairs::<f64>() {
            let others = clusters.iter().enumerate().filter(|(other, _)| *other != index);
            let shared = others
                .flat_map(|(_, other)| other.parameters().pairs())
                .any(|other| same(other, sample));
            match (shared, index) {
                (true, 0) => groups[2].2.push((sample[0], sample[1])),
                (true, _) => {}
                (false, index) => groups[index.min(1)].2.push((sample[0], sample[1])),
            }
        }
    }
    let heights = (0..=60).map(|i| 0.7 + 0.55 * f64::from(i) / 60.0);
    let limit = heights
        .clone()
        .filter_map(|a| Some((model.steady_limit(a)?, a)))
        .collect();
    let curve = model.jump_curve();
    let border = heights
        .filter(|a| curve.below([1.0, *a]).is_some())
        .filter_map(|a| Some((curve.at(a)?, a)))
        .collect();
    let entries = subject.tests.entries()?;
    let tests = entries
        .iter()
        .map(|entry| (entry.parameters[0], entry.parameters[1]))
        .collect();
    let mut series: Vec<Series> = groups.into();
    series.push(("test set, not in the model".to_owned(), Mark::Dots, tests));
    series.push(("steady limit".to_owned(), Mark::Line, limit));
    series.push(("border of the jump".to_owned(), Mark::Line, border));
    series.retain(|(_, _, points)| !points.is_empty());
    let mut section = Section::new(
        "The design (Fig. 7)",
        "Configurations of the full-order model that the reduced-order model is built from, in two clusters that share \
         a row; beyond the \
         steady limit the capsule elongates for ever; at the border the rear of the membrane buckles with a jump.",
    );
    let curves = Curves {
        title: "Samples".to_owned(),
        axes: [Axis::linear("Ca"), Axis::linear("a/l")],
        same_scale: false,
        series,
    };
    section.curves(
        sheet,
        "fig07_design.csv",
        "Fig. 7: samples, clusters, steady limit, border",
        curves,
    )?;
    Ok(section)
}

/// A model of the paper's design alone, or of a small part of it, and its errors without each sample.
pub(super) fn reduction(
    sheet: &mut Sheet,
    subject: &Subject,
    folder: &Path,
    progress: Progress,
) -> Result<[Section; 2], StudyError> {
    let (built, design) = if subject.quick {
        (Small::new(subject)?.whole(folder)?.1, "A small part of the design")
    } else {
        let settings = Settings {
            error_times: vec![1.0, 2.0, 4.0, 8.0],
            ..Settings::of_paper_design()
        };
        (
            build(subject.database, &settings, progress)?.1,
            "The paper's design alone",
        )
    };
    Ok([spectra(sheet, &built, design)?, left_out(sheet, &built, design)?])
}

/// A number for each entry of a series of singular values.
type OfValues = fn(&[f64]) -> Vec<f64>;

fn spectra(sheet: &mut Sheet, built: &BuildReport, design: &str) -> Result<Section, StudyError> {
    const MAX: usize = 100;
    let mut section = Section::new(
        "Decay of the singular values (Figs. 8 and 9)",
        &format!(
            "{design}, in the laboratory frame as in the paper. S: parameter modes, T: space modes; u: displacement, \
             v: velocity. The \
             paper reads the rank at 1 - RIC = 1e-7: 7 and 23 parameter modes, 7 and 56 space modes."
        ),
    );
    let whole: Vec<&Spectrum> = built
        .spectra
        .iter()
        .filter(|spectrum| spectrum.cluster.is_none())
        .collect();
    let quantities: [(&str, &str, OfValues); 2] = [
        ("8", "1 - RIC", one_minus_ric),
        ("9", "sigma_K / sigma_1", |values| {
            values.iter().map(|value| value / values[0]).collect()
        }),
    ];
    for (figure, label, of) in quantities {
        for (part, kind, modes) in [("a", 'S', "parameter modes"), ("b", 'T', "space modes")] {
            let series = whole
                .iter()
                .filter(|spectrum| spectrum.matrix.starts_with(kind))
                .map(|spectrum| {
                    let points = of(&spectrum.singular_values).into_iter().take(MAX).enumerate();
                    (
                        spectrum.matrix.to_owned(),
                        Mark::Line,
                        points.map(|(k, value)| ((k + 1) as f64, value)).collect(),
                    )
                });
            let mut series: Vec<Series> = series.collect();
            if figure == "8" {
                series.push(("1e-7".to_owned(), Mark::Line, vec![(1.0, 1e-7), (MAX as f64, 1e-7)]));
            }
            let curves = Curves {
                title: format!("{label}, {modes}"),
                axes: [Axis::linear("truncation rank K"), Axis::logarithmic(label)],
                same_scale: false,
                series,
            };
            let caption = format!("Fig. {figure} ({part}): {label} of the {modes}");
            section.curves(sheet, &format!("fig0{figure}{part}.csv"), &caption, curves)?;
        }
    }
    Ok(section)
}

fn left_out(sheet: &mut Sheet, built: &BuildReport, design: &str) -> Result<Section, StudyError> {
    let mut section = Section::new(
        "Leave-one-out errors (Fig. 13)",
        &format!(
            "{design}: each sample is predicted by a model that was built without it. Modified Hausdorff distance in \
             the laboratory \
             frame, in per cent of a. Configurations whose run was not steady by its end have no cell. The paper \
             states a mean \
             below 0.2 % and a maximum of 3.3 %."
        ),
    );
    let mut rows = Vec::new();
    for method in [Method::Direct, Method::Paper] {
        let errors: Vec<_> = built
            .left_out
            .iter()
            .filter(|e| e.answers && e.inside && e.method == method)
            .collect();
        for (i, t) in built.error_times.iter().enumerate() {
            let values: Vec<f64> = errors.iter().map(|e| 100.0 * e.laboratory[i]).collect();
            let shapes: Vec<f64> = errors.iter().map(|e| 100.0 * e.shape[i]).collect();
            let (mean, max) = mean_and_max(&values);
            let (shape_mean, shape_max) = mean_and_max(&shapes);
            let numbers = [mean, max, shape_mean, shape_max].map(|value| format!("{value:.4}"));
            rows.push(
                [
                    vec![name(method).to_owned(), t.to_string(), values.len().to_string()],
                    numbers.to_vec(),
                ]
                .concat(),
            );
            let cells = errors
                .iter()
                .zip(&values)
                .map(|(e, value)| (e.parameters[0], e.parameters[1], *value));
            let title = format!("{}, t = {t}", name(method));
            let map = Cells::new(&title, "Ca", "a/l", "% of a", (0.01, 0.05), cells.collect());
            let panel = Panel::Cells(map.logarithmic());
            let caption = format!("Fig. 13: {title}; mean {mean:.3} %, greatest {max:.2} % of a");
            section.panel(panel, &caption, "fig13_leave_one_out.csv")?;
        }
    }
    let heading = ["method", "ca", "confinement", "t", "lab_percent", "shape_percent"];
    let all = built.left_out.iter().filter(|e| e.answers && e.inside).flat_map(|e| {
        built.error_times.iter().enumerate().map(move |(i, t)| {
            let numbers = [
                e.parameters[0],
                e.parameters[1],
                *t,
                100.0 * e.laboratory[i],
                100.0 * e.shape[i],
            ];
            std::iter::once(name(e.method).to_owned())
                .chain(numbers.map(|n| n.to_string()))
                .collect()
        })
    });
    sheet.csv("fig13_leave_one_out.csv", &heading, all)?;
    let heading = [
        "method",
        "t",
        "samples",
        "lab mean %",
        "lab max %",
        "shape mean %",
        "shape max %",
    ];
    section.table(sheet, "leave_one_out.csv", &heading, rows)?;
    Ok(section)
}

fn mean_and_max(values: &[f64]) -> (f64, f64) {
    let sum: f64 = values.iter().sum();
    (
        sum / values.len().max(1) as f64,
        values.iter().copied().fold(0.0, f64::max),
    )
}
