//! `capsule-rom study stability`: where the methods lose accuracy, and whether they report it.

use crate::outputs::Outputs;
use crate::subject::SubjectOptions;
use crate::{print, progress};
use anyhow::{Context, Result, bail};
use capsule_plot::Figure;
use capsule_study::stability::{Stability, panels, stability};
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    #[command(flatten)]
    subject: SubjectOptions,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Plot errors and maps into this folder
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom study stability --plots plots/
  capsule-rom study stability --quick --json

Errors are the mean distance of corresponding nodes in the laboratory frame, in per cent of a, over configurations \
that the model does not contain; a failure is no answer, or one that is wrong by more than a. It ends with exit code \
1 when a question was answered wrongly instead of being refused.";

pub fn run(options: &Options) -> Result<()> {
    let outputs = options.subject.reads(Outputs::default());
    let mut outputs = outputs.folder("--plots", options.plots.as_deref()).checked()?;
    let files = options.subject.open()?;
    let bar = progress::tasks(options.quiet);
    let folder = tempfile::tempdir().context("could not create a temporary folder")?;
    let found = stability(&files.subject(), folder.path(), &|task, done, of| {
        progress::show(&bar, task, done, of)
    })?;
    bar.finish_and_clear();
    drop(folder);
    if let Some(folder) = &options.plots {
        outputs.write_into(folder, |folder| plot(folder, &found))?;
    }
    outputs.finish()?;
    if options.json {
        print::json(&found)?;
    } else {
        tell(&found)?;
    }
    let violations: usize = found.checks.iter().map(|check| check.violations).sum();
    if violations > 0 {
        bail!("{violations} questions were answered wrongly, or refused without need");
    }
    Ok(())
}

/// One file for each panel.
fn plot(folder: &Path, found: &Stability) -> Result<()> {
    for (name, panel) in panels(found) {
        Figure::new(vec![panel]).save(&folder.join(format!("stability_{name}.svg")))?;
    }
    Ok(())
}

fn tell(found: &Stability) -> Result<()> {
    let percent = |value: f64| format!("{value:.4}");
    let rows = found.rows.iter().map(|row| {
        let errors = [
            row.mean_percent[0],
            row.max_percent[0],
            row.mean_percent[1],
            row.max_percent[1],
        ];
        let head = [row.setting.clone(), row.value.to_string(), row.by.clone()];
        let failures = format!("{} of {}", row.failures, row.configurations);
        head.into_iter().chain(errors.map(percent)).chain([failures]).collect()
    });
    let heading = [
        "setting", "value", "by", "mean t=2", "max t=2", "mean t=8", "max t=8", "failures",
    ];
    print::table(&heading, &rows.collect::<Vec<_>>())?;
    println!();
    let greatest =
        |value: fn(&capsule_study::stability::Place) -> f64| found.places.iter().map(value).fold(0.0, f64::max);
    println!(
        "over {} queries at most: Lebesgue constant {:.2} (direct) and {:.2} (paper), condition number {:.1e}, error \
         of a \
         weight in single precision {:.1e}",
        found.places.len(),
        greatest(|place| place.direct_lebesgue),
        greatest(|place| place.paper_lebesgue),
        greatest(|place| place.condition),
        greatest(|place| place.single_precision)
    );
    println!();
    let checks = found.checks.iter().map(|check| {
        let counts = [check.cases, check.answered, check.refused, check.violations].map(|count| count.to_string());
        let counts: Vec<String> = counts.into_iter().collect();
        [counts, vec![check.question.clone(), check.worst.clone()]].concat()
    });
    print::table(
        &["cases", "answered", "refused", "violations", "question", "worst"],
        &checks.collect::<Vec<_>>(),
    )
}
