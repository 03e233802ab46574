//! `capsule-rom offline build`: from a snapshot database or other people's data to a model file.

use crate::outputs::Outputs;
use crate::source::SourceOptions;
use crate::{print, progress};
use anyhow::Result;
use capsule_offline::{BuildReport, Spectrum, Truncation, one_minus_ric};
use capsule_plot::{Axis, Curve, Figure, Lines, Panel};
use clap::Args;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    #[command(flatten)]
    source: SourceOptions,
    /// Model file to write [default: models/capsule.crom; with --from the path of the data with .crom added]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Truncation: root mean square error of the displacement that the modes may leave in a span of time, in l, with
    /// --from in its unit of length [default: 1.2e-4 l; a five thousandth of the radius]
    #[arg(long, conflicts_with = "paper_ranks")]
    tolerance: Option<f64>,
    /// Truncation at the paper's larger ranks: 50 and 50, for displacement and velocity together
    #[arg(long)]
    paper_ranks: bool,
    /// Plot singular values and 1 - RIC (the paper's Figs. 8 and 9) into this folder
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom offline build
  capsule-rom offline build --database models/database --out smaller.crom --tolerance 1e-3
  capsule-rom offline build --paper-ranks --out paper.crom --plots plots/ --json
  capsule-rom offline build --design paper --out grid.crom
  capsule-rom offline build --from data.npz --out data.crom
  capsule-rom offline build --from series/ --split confinement=0.9 --out data.crom

Other people's data: see docs/guides/own-data.md.";

pub fn run(options: &Options) -> Result<()> {
    let out = match (&options.out, &options.source.from) {
        (Some(out), _) => out.clone(),
        (None, Some(from)) => beside(from),
        (None, None) => PathBuf::from("models/capsule.crom"),
    };
    let outputs = options.source.reads(Outputs::default());
    let outputs = outputs.file("--out", out.as_path());
    let mut outputs = outputs.folder("--plots", options.plots.as_deref()).checked()?;
    let (snapshots, mut settings) = options.source.open()?;
    settings.created_unix_s = now();
    if let Some(tolerance) = options.tolerance {
        settings.truncation = Truncation::Tolerance(tolerance);
    }
    if options.paper_ranks {
        settings.truncation = Truncation::PAPER;
    }
    let bar = progress::tasks(options.quiet);
    let (bytes, report) = capsule_offline::build(snapshots.source(), &settings, &|task, done, of| {
        progress::show(&bar, task, done, of)
    })?;
    bar.finish_and_clear();
    outputs.write(&out, |file| std::fs::write(file, &bytes))?;
    if let Some(folder) = &options.plots {
        outputs.write_into(folder, |folder| plot(folder, &report.spectra))?;
    }
    outputs.finish()?;
    if options.json {
        return print::json(&report);
    }
    tell(&report, &out)
}

/// Seconds since 1970, or SOURCE_DATE_EPOCH, so that a build can be repeated to the bit.
fn now() -> u32 {
    let fixed = std::env::var("SOURCE_DATE_EPOCH")
        .ok()
        .and_then(|text| text.parse().ok());
    let seconds = || {
        SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .ok()?
            .as_secs()
            .try_into()
            .ok()
    };
    fixed.or_else(seconds).unwrap_or_default()
}

/// Path of the model in the folder of the data: their name with `.crom` appended, so that `Ca0.05` and `Ca0.1` differ.
fn beside(from: &Path) -> PathBuf {
    // The path of `.` or `..` has no name.
    let named = from.file_name().map(|_| from.to_path_buf());
    let from = named.or_else(|| from.canonicalize().ok()).unwrap_or_default();
    let mut name = from.file_name().unwrap_or_default().to_owned();
    name.push(".crom");
    from.with_file_name(name)
}

fn tell(report: &BuildReport, out: &Path) -> Result<()> {
    println!(
        "{}: {} samples ({} unsteady), {} bytes, digest {:08x}, from database {}",
        out.display(),
        report.samples,
        report.unsteady_samples,
        report.bytes,
        report.digest,
        report.database_digest
    );
    if !report.late.is_empty() {
        let late: Vec<String> = report.late.iter().map(|p| format!("({}, {})", p[0], p[1])).collect();
        println!("no samples, because they buckle late: {}", late.join(", "));
    }
    println!(
        "{} instants to t = {}; symmetry of order {}",
        report.instants, report.end_time, report.symmetry
    );
    let mut rows = Vec::new();
    for cluster in &report.clusters {
        let reduced = &cluster.field;
        rows.push(vec![
            format!("{:.2} to {:.2}", cluster.range[0], cluster.range[1]),
            cluster.samples.to_string(),
            reduced.space_rank.to_string(),
            reduced
                .parameter_ranks
                .iter()
                .map(usize::to_string)
                .collect::<Vec<_>>()
                .join(" "),
            format!("{:.1e}", reduced.space_error),
            format!("{:.1e}", reduced.parameter_error),
            reduced.controls.to_string(),
            reduced.rows.to_string(),
            format!("{:.4} %", 100.0 * cluster.floor[0]),
        ]);
    }
    print::table(
        &[
            &report.cluster_parameter,
            "samples",
            "K_x",
            "K_c",
            "space error",
            "parameter error",
            "controls",
            "core rows",
            "error at samples / a",
        ],
        &rows,
    )?;
    println!();
    let text = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.4}"));
    let rows: Vec<Vec<String>> = report
        .steady_limit
        .iter()
        .map(|row| {
            let bracket = [row.largest_steady_ca, row.smallest_unsteady_ca, row.limit];
            std::iter::once(format!("{:.3}", row.confinement))
                .chain(bracket.map(text))
                .collect()
        })
        .collect();
    if !rows.is_empty() {
        print::table(&["a/l", "steady to Ca", "unsteady from Ca", "limit"], &rows)?;
    }
    if !report.jumps.is_empty() {
        println!();
        let rows: Vec<Vec<String>> = report
            .jumps
            .iter()
            .map(|jump| {
                let numbers = [jump.largest_smooth_ca, jump.smallest_dented_ca].map(|ca| format!("{ca:.4}"));
                std::iter::once(format!("{:.3}", jump.confinement))
                    .chain(numbers)
                    .collect()
            })
            .collect();
        print::table(&["a/l", "smooth rear to Ca", "dented from Ca"], &rows)?;
    }
    println!();
    let heading = [
        "matrix",
        "K with 1-RIC <= 1e-7",
        "sigma_2/sigma_1",
        "sigma_10/sigma_1",
        "sigma_40/sigma_1",
    ];
    let rows: Vec<Vec<String>> = report.spectra.iter().map(spectrum_row).collect();
    print::table(&heading, &rows)
}

fn name(spectrum: &Spectrum) -> String {
    match spectrum.cluster {
        None => format!("{}, laboratory frame", spectrum.matrix),
        Some([low, high]) => format!("{}, cluster {low:.2} to {high:.2}", spectrum.matrix),
    }
}

fn spectrum_row(spectrum: &Spectrum) -> Vec<String> {
    let values = &spectrum.singular_values;
    let rank = one_minus_ric(values)
        .iter()
        .position(|&rest| rest <= 1e-7)
        .map_or("-".to_owned(), |k| (k + 1).to_string());
    let ratio = |k: usize| {
        values
            .get(k - 1)
            .map_or("-".to_owned(), |value| format!("{:.1e}", value / values[0]))
    };
    vec![name(spectrum), rank, ratio(2), ratio(10), ratio(40)]
}

/// Figures 8 and 9 of the paper: 1 - RIC (eq. 50) and the singular values (eq. 51), parameter modes and space modes.
fn plot(folder: &Path, spectra: &[Spectrum]) -> Result<()> {
    let panel = |title: &str, kind: char, y: &str, of: &dyn Fn(&[f64]) -> Vec<f64>| {
        let axes = Lines::new(title, Axis::linear("truncation rank K"), Axis::logarithmic(y));
        let shown = spectra.iter().filter(|spectrum| spectrum.matrix.starts_with(kind));
        Panel::Lines(shown.fold(axes, |lines, spectrum| {
            let points = of(&spectrum.singular_values).into_iter().enumerate().take(100);
            lines.with(Curve::line(
                &name(spectrum),
                points.map(|(k, value)| ((k + 1) as f64, value)).collect(),
            ))
        }))
    };
    let ratio = |values: &[f64]| values.iter().map(|value| value / values[0]).collect();
    let figures = [
        ("ric", "1 - RIC", &one_minus_ric as &dyn Fn(&[f64]) -> Vec<f64>),
        ("singular_values", "sigma_K / sigma_1", &ratio),
    ];
    for (file, y, of) in figures {
        let panels = vec![panel("Parameter modes", 'S', y, of), panel("Space modes", 'T', y, of)];
        Figure::new(panels).save(&folder.join(format!("{file}.svg")))?;
    }
    Ok(())
}
