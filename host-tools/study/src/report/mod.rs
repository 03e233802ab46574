//! One page with everything: our versions of the paper's Figs. 7 to 14, run time against error, the cost of scenes, the
//! stability study, and how well the expected error is calibrated; with its data as CSV beside it.

mod accuracy;
mod cost;
mod offline;
mod page;
mod shapes;
mod sheet;

use std::path::Path;

use capsule_core::Model;
use capsule_offline::Progress;

use crate::StudyError;
use crate::stability::{Subject, file_name, panels, stability};
use sheet::{Section, Sheet};

/// Writes `index.html` and its data into `folder`.
///
/// # Errors
/// Those of the studies, and files that cannot be written.
pub fn report(subject: &Subject, folder: &Path, progress: Progress) -> Result<(), StudyError> {
    const PARTS: usize = 6;
    let step = |done: usize, name: &str| progress(name, done, PARTS);
    std::fs::create_dir_all(folder).map_err(|source| StudyError::Write {
        path: folder.to_owned(),
        source,
    })?;
    let model = Model::open(subject.model)?;
    let temporary = tempfile::tempdir().map_err(|source| StudyError::Write {
        path: std::env::temp_dir(),
        source,
    })?;
    let mut sheet = Sheet::new(folder);
    step(0, "design");
    let mut sections = vec![offline::design(&mut sheet, subject, &model)?];
    step(1, "leave one out");
    sections.extend(offline::reduction(&mut sheet, subject, temporary.path(), progress)?);
    step(2, "test set");
    let shown = accuracy::Shown::new(subject, &model)?;
    sections.push(accuracy::evolution(&mut sheet, subject, &shown)?);
    sections.push(shapes::section(&mut sheet, &model)?);
    sections.push(accuracy::profiles(&mut sheet, &model, &shown)?);
    sections.push(accuracy::calibration(&mut sheet, subject, &model, progress)?);
    step(3, "run time against error");
    sections.extend(cost::pareto(&mut sheet, subject, &model, progress)?);
    step(4, "scenes");
    sections.push(cost::scenes(&mut sheet, subject, &model)?);
    step(5, "stability");
    let found = stability(subject, temporary.path(), &|task, done, of| progress(task, done, of))?;
    sections.push(stable(&mut sheet, &found)?);
    step(PARTS, "done");
    let path = folder.join("index.html");
    std::fs::write(&path, page::page(&model, &sections)).map_err(|source| StudyError::Write { path, source })
}

/// The stability study.
fn stable(sheet: &mut Sheet, found: &crate::stability::Stability) -> Result<Section, StudyError> {
    let mut section = Section::new(
        "Numerical stability",
        "Errors are the mean distance of corresponding nodes in the laboratory frame, in per cent of a, over \
         configurations that the model does not contain. \
         A failure is no answer, or one that is wrong by more than a. On logarithmic axes 0 is shown at 1e-10.",
    );
    let text = |value: f64| format!("{value:.6}");
    let rows = found.rows.iter().map(|row| {
        let errors = [
            row.mean_percent[0],
            row.max_percent[0],
            row.mean_percent[1],
            row.max_percent[1],
        ];
        let head = [row.setting.clone(), row.value.to_string(), row.by.clone()];
        let counts = [row.failures, row.configurations].map(|count| count.to_string());
        head.into_iter().chain(errors.map(text)).chain(counts).collect()
    });
    let heading = [
        "setting",
        "value",
        "by",
        "mean_2",
        "max_2",
        "mean_8",
        "max_8",
        "failures",
        "configurations",
    ];
    sheet.csv("stability_settings.csv", &heading, rows)?;
    let places = found.places.iter().map(|place| {
        let values = [
            place.capillary_number,
            place.confinement,
            place.direct_lebesgue,
            place.paper_lebesgue,
        ];
        let values = values.into_iter().chain([place.condition, place.single_precision]);
        values.map(|value| value.to_string()).collect()
    });
    let heading = [
        "ca",
        "confinement",
        "lebesgue_direct",
        "lebesgue_paper",
        "condition",
        "single_precision",
    ];
    sheet.csv("stability_map.csv", &heading, places)?;
    for (name, panel) in panels(found) {
        let setting = found.rows.iter().find(|row| name == file_name(&row.setting));
        let (caption, data) = match setting {
            Some(row) => (format!("Error against {}", row.setting), "stability_settings.csv"),
            None => (name.replace('_', " "), "stability_map.csv"),
        };
        section.panel(panel, &caption, data)?;
    }
    let checks = found.checks.iter().map(|check| {
        let counts = [check.cases, check.answered, check.refused, check.violations].map(|count| count.to_string());
        std::iter::once(check.question.clone())
            .chain(counts)
            .chain([check.worst.clone()])
            .collect()
    });
    let heading = ["question", "cases", "answered", "refused", "violations", "worst"];
    section.table(sheet, "stability_checks.csv", &heading, checks.collect())?;
    Ok(section)
}
