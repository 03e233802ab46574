//! How well a capsule is identified: on outlines of the full-order model that no sample shares, with and without noise,
//! and on the model's own outlines, whose truth is exact.

mod laws;
mod raster;
mod trials;
mod truth;

use std::path::Path;

use capsule_core::{Domain, Model};
use capsule_database::{Database, table};
use capsule_identify::{Grid, Observable, Point, Priors, Shapes};
use capsule_measurement::Bench;
use serde::Serialize;

use crate::StudyError;
use crate::random::Random;
pub use laws::{LawSeries, identify_laws};
use trials::{Known, Trial, by_contour, by_frames, by_lengths};
use truth::{Drawing, HALF_WIDTH_UM, Truth, contour, contour_and_line, normal};

/// Pixels per l, unless a series says otherwise.
const PIXELS: f64 = 100.0;
/// Pixels per l of the series over the size of a pixel: 0.2, 0.5 and 1 um in a channel of 50 um.
const COARSER: [f64; 3] = [125.0, 50.0, 25.0];
/// Noise of the pictures, of the contrast.
const PICTURE_NOISE: f64 = 0.02;
/// Room for the points of a contour.
const MOST_POINTS: usize = 4096;
/// The seed of all trials.
const SEED: u64 = 7;
/// Share by which Ca may be off the border of buckling for a configuration to count as beside it.
const BESIDE: f64 = 0.3;

/// Errors and intervals of a series of trials.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Series {
    /// "midplane" or "silhouette".
    pub observable: &'static str,
    /// The series of trials.
    pub name: &'static str,
    /// Pixels per l.
    pub pixels: f64,
    /// Number of trials that were answered.
    pub trials: usize,
    /// Trials that were refused with an error, such as a contour that is wider than the channel.
    pub refused: usize,
    /// Errors of Ca, per cent: median, 90 % quantile, greatest.
    pub ca_percent: [f64; 3],
    /// Errors of a.
    pub radius_percent: [f64; 3],
    /// The same away from the border of buckling.
    pub away_ca_percent: [f64; 3],
    /// The same away from the border of buckling.
    pub away_radius_percent: [f64; 3],
    /// Share of the 68 % intervals of Ca and of a that hold the truth, per cent.
    pub held_68_percent: [f64; 2],
    /// Share of the 95 % intervals.
    pub held_95_percent: [f64; 2],
    /// Root mean square of the errors of ln Ca and a/l in their standard deviations, without those beyond five, which
    /// are counted: with the model's own outlines and known noise, the spread in that of the bound of Cramer and Rao.
    pub spread: [f64; 2],
    /// Trials that err by more than five standard deviations.
    pub lost: usize,
    /// Median standard deviations, per cent of Ca and of a.
    pub deviation_percent: [f64; 2],
    /// Median time of a fit, in milliseconds.
    pub time_ms: f64,
    /// Tenth percentile of the time: on a busy machine nearer to what one fit takes.
    pub fast_ms: f64,
    /// Median number of outlines that the model computed.
    pub evaluations: f64,
    /// How often each verdict was given.
    pub verdicts: std::collections::BTreeMap<&'static str, usize>,
}

/// Heading of the table of all trials.
const HEADING: [&str; 13] = [
    "observable",
    "series",
    "pixels",
    "capillary_number",
    "confinement",
    "found_capillary_number",
    "found_confinement",
    "ca_95_low",
    "ca_95_high",
    "confinement_95_low",
    "confinement_95_high",
    "structure",
    "verdict",
];

/// Runs the study: `repeats` noisy trials of each configuration, of all series or of those with a name. Writes all
/// trials as `trials.csv` and the series as `series.json` into the folder.
///
/// # Errors
/// Those of the database and of the model; a name that no series has; a folder that cannot be written.
pub fn identify(
    model: &Model<'_>,
    tests: &Database,
    (repeats, name): (usize, Option<&str>),
    out: &Path,
    progress: capsule_offline::Progress,
) -> Result<Vec<Series>, StudyError> {
    let mut plans = plans();
    if let Some(name) = name {
        let known: Vec<&str> = plans.iter().map(|plan| plan.name).collect();
        if !known.contains(&name) {
            return Err(StudyError::UnknownSeries {
                name: name.to_owned(),
                known: known.join("\", \""),
            });
        }
        plans.retain(|plan| plan.name == name);
    }
    let mut all = Vec::new();
    let mut rows = Vec::new();
    let steps = 2 * plans.len();
    for observable in [Observable::Midplane, Observable::Silhouette] {
        let truths = Truth::all(model, tests, observable)?;
        if truths.is_empty() {
            return Err(StudyError::NothingToCompare);
        }
        let mut bench = Bench::new(model);
        bench.make_room(MOST_POINTS);
        let (mut shapes, points) = bench.shapes(model, observable);
        let grid = Grid::new(&mut shapes)?;
        for plan in plans.iter().filter(|plan| plan.shows(observable)) {
            progress("identify", all.len(), steps);
            let (trials, refused) = plan.run(model, &truths, repeats, (&mut shapes, &grid, points))?;
            let observable = shown(observable);
            rows.extend(trials.iter().map(|trial| trial.row(observable, plan.name, plan.pixels)));
            all.push(Series {
                refused,
                ..Series::new(model, observable, plan, &trials)
            });
        }
    }
    progress("identify", steps, steps);
    write(out, &all, rows)?;
    Ok(all)
}

/// The name of an observable in tables.
fn shown(observable: Observable) -> &'static str {
    match observable {
        Observable::Midplane => "midplane",
        Observable::Silhouette => "silhouette",
    }
}

/// Writes all trials as `trials.csv` and the series as `series.json` into the folder.
fn write(out: &Path, series: &impl Serialize, rows: Vec<Vec<String>>) -> Result<(), StudyError> {
    let write = |name: &str, bytes: Vec<u8>| {
        let path = out.join(name);
        std::fs::write(&path, bytes).map_err(|source| StudyError::Write { path, source })
    };
    write("trials.csv", table::csv(None, HEADING, rows)?)?;
    write("series.json", serde_json::to_vec_pretty(series).unwrap_or_default())
}

/// Where a trial's outline comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum From {
    FullOrder,
    Own,
    Lengths,
    /// A picture of the full-order model's outline, in which it is found.
    Picture,
    /// The full-order model's silhouette and the line of its dent, if it has one.
    DentLine,
    /// Three frames of the steady capsule.
    Steady,
    /// Three frames of its transient, whose instants are not told.
    Transient,
}

#[derive(Debug, Clone, Copy)]
struct Plan {
    name: &'static str,
    from: From,
    /// Pixels per l.
    pixels: f64,
    /// Noise, in pixels, or of the contrast of a picture.
    noise: f64,
    /// Whether edge, scale and tilt are drawn at random and fitted; else they are exact and known to be.
    unknown_frame: bool,
    /// By how much the half width that is told is too great, relative.
    half_width_error: f64,
}

fn plans() -> Vec<Plan> {
    let plan = Plan::new;
    let mut plans = vec![
        plan("no noise", From::FullOrder, 0.0, false),
        plan("no noise, frame fitted", From::FullOrder, 0.0, true),
        plan("0.1 px, own outlines", From::Own, 0.1, true),
        plan("0.1 px", From::FullOrder, 0.1, true),
        plan("1 px", From::FullOrder, 1.0, true),
        plan("lengths to 1 px", From::Lengths, 1.0, false),
        plan("0.1 px, with dent line", From::DentLine, 0.1, true),
        plan("1 px, with dent line", From::DentLine, 1.0, true),
        plan("1 px, 3 steady frames", From::Steady, 1.0, true),
        plan("1 px, 3 frames of a transient", From::Transient, 1.0, true),
    ];
    for pixels in COARSER {
        for (name, from, noise) in [
            ("0.1 px", From::FullOrder, 0.1),
            ("1 px", From::FullOrder, 1.0),
            ("picture", From::Picture, PICTURE_NOISE),
        ] {
            plans.push(Plan {
                pixels,
                ..plan(name, from, noise, true)
            });
        }
    }
    for (name, half_width_error) in [
        ("0.1 px, half width 2 % too great", 0.02),
        ("0.1 px, half width 5 % too great", 0.05),
    ] {
        plans.push(Plan {
            half_width_error,
            ..plan(name, From::FullOrder, 0.1, true)
        });
    }
    plans
}

impl Plan {
    fn new(name: &'static str, from: From, noise: f64, unknown_frame: bool) -> Self {
        Self {
            name,
            from,
            pixels: PIXELS,
            noise,
            unknown_frame,
            half_width_error: 0.0,
        }
    }

    /// Whether an observable has the series: the dent is a part of a section's outline.
    fn shows(&self, observable: Observable) -> bool {
        self.from != From::DentLine || observable == Observable::Silhouette
    }

    /// The trials of all truths, and how many were refused.
    fn run(
        &self,
        model: &Model<'_>,
        truths: &[Truth],
        repeats: usize,
        (shapes, grid, points): (&mut Shapes<'_, '_>, &Grid, &mut [Point]),
    ) -> Result<(Vec<Trial>, usize), StudyError> {
        let mut random = Random(SEED);
        let (mut trials, mut refused) = (Vec::new(), 0);
        for _ in 0..if self.noise > 0.0 { repeats } else { 1 } {
            for truth in truths {
                let trial = match self.from {
                    From::Lengths => {
                        let deviation_um = self.noise * self.drawing(0.0).pixel_um();
                        by_lengths(shapes, grid, truth, deviation_um, &mut random)
                    }
                    From::Steady | From::Transient => self.by_frames(shapes, grid, points, truth, &mut random),
                    From::FullOrder | From::Own | From::Picture | From::DentLine => {
                        let drawing = self.drawn(&mut random);
                        let (parameters, outline) = if self.from == From::Own {
                            let [ca, confinement] = anywhere(model, &mut random);
                            let shape = shapes.at([ca.ln(), confinement])?;
                            let outline = (0..=2000).map(|i| shape.curve.position(f64::from(i) / 2000.0));
                            ([ca, confinement], outline.collect())
                        } else {
                            (truth.parameters, truth.outline.clone())
                        };
                        let known = self.known(&drawing);
                        let drawn = match self.from {
                            From::Picture => picture(&outline, &drawing, &mut random).map(|found| [found, Vec::new()]),
                            From::DentLine => Ok(contour_and_line([&outline, &truth.dent_line], &drawing, &mut random)),
                            _ => Ok([contour(&outline, &drawing, &mut random), Vec::new()]),
                        };
                        drawn.and_then(|[drawn, line]| {
                            by_contour(shapes, grid, points, parameters, [&drawn, &line], &known)
                        })
                    }
                };
                match trial {
                    Ok(trial) => trials.push(trial),
                    Err(StudyError::Identify(_) | StudyError::Picture(_)) => refused += 1,
                    Err(error) => return Err(error),
                }
            }
        }
        Ok((trials, refused))
    }

    /// Frames by one camera: edge and scale are the same in all, the tilt is not.
    fn by_frames(
        &self,
        shapes: &mut Shapes<'_, '_>,
        grid: &Grid,
        points: &mut [Point],
        truth: &Truth,
        random: &mut Random,
    ) -> Result<Trial, StudyError> {
        let steady = self.from == From::Steady;
        let camera = self.drawn(random);
        let drawn = truth.transient.each_ref().map(|moving| {
            let tilt = self.drawn(random).tilt;
            let outline = if steady { &truth.outline } else { moving };
            contour(outline, &Drawing { tilt, ..camera }, random)
        });
        by_frames(
            shapes,
            grid,
            points,
            truth.parameters,
            (&drawn, steady),
            &self.known(&camera),
        )
    }

    /// A drawing with a frame at random, where that is not known.
    fn drawn(&self, random: &mut Random) -> Drawing {
        let exact = self.drawing(self.noise);
        if !self.unknown_frame {
            return exact;
        }
        Drawing {
            edge: 0.25 * normal(random),
            scale: 0.005 * normal(random),
            tilt: 0.02 * normal(random),
            ..exact
        }
    }

    fn drawing(&self, noise: f64) -> Drawing {
        Drawing {
            pixels: self.pixels,
            noise,
            edge: 0.0,
            scale: 0.0,
            tilt: 0.0,
        }
    }

    fn known(&self, drawing: &Drawing) -> Known {
        let usual = Priors::of_pixel(drawing.pixel_um());
        let own = self.from == From::Own;
        let factor = if self.unknown_frame { 1.0 } else { 0.0 };
        Known {
            priors: Priors {
                edge_um: factor * usual.edge_um,
                scale: factor * usual.scale,
                tilt: 0.02,
                // Its own outlines have no error of the model.
                model: if own { 0.0 } else { 1.0 },
            },
            noise_um: own.then(|| drawing.noise * drawing.pixel_um()),
            half_width_um: HALF_WIDTH_UM * (1.0 + self.half_width_error),
        }
    }
}

/// The contour that is found in a picture of an outline, in um.
fn picture(outline: &[[f64; 2]], drawing: &Drawing, random: &mut Random) -> Result<Vec<[f64; 2]>, StudyError> {
    // The camera finds the edge itself, so none is added; and it has errors of its own.
    let placed = Drawing {
        edge: 0.0,
        noise: 0.0,
        ..*drawing
    };
    let smooth = contour(
        outline,
        &Drawing {
            pixels: 1000.0,
            ..placed
        },
        random,
    );
    let smooth: Vec<[f64; 2]> = smooth.iter().map(|point| point.map(|x| x / HALF_WIDTH_UM)).collect();
    let found = raster::seen(&smooth, drawing.pixels, drawing.noise, random)?;
    Ok(found
        .iter()
        .map(|point| point.map(|x| x * drawing.pixel_um()))
        .collect())
}

impl Series {
    fn new(model: &Model<'_>, observable: &'static str, plan: &Plan, trials: &[Trial]) -> Self {
        let border = model.jump_curve();
        let away = |trial: &&Trial| {
            let [ca, confinement] = trial.truth;
            border
                .at(confinement)
                .is_none_or(|border| (ca / border - 1.0).abs() > BESIDE && ca > border)
        };
        let errors = |trials: &mut dyn Iterator<Item = &Trial>, d: usize| {
            let values: Vec<f64> = trials.map(|trial| 100.0 * trial.errors()[d].abs()).collect();
            [0.5, 0.9, 1.0].map(|share| quantile(&values, share))
        };
        let count = trials.len() as f64;
        let held = |level: usize| {
            [0, 1].map(|d| 100.0 * trials.iter().filter(|trial| trial.holds()[d][level]).count() as f64 / count)
        };
        let scores: Vec<[f64; 2]> = trials
            .iter()
            .map(|trial| {
                let found = &trial.found;
                [
                    (found.capillary_number.value / trial.truth[0]).ln() / found.deviations[0],
                    (found.confinement.value - trial.truth[1]) / found.deviations[1],
                ]
            })
            .collect();
        let lost = |score: &&[f64; 2]| score.iter().any(|score| score.is_nan() || score.abs() > 5.0);
        let kept: Vec<&[f64; 2]> = scores.iter().filter(|score| !lost(score)).collect();
        let median = |value: &dyn Fn(&Trial) -> f64, share: f64| {
            let values: Vec<f64> = trials.iter().map(value).collect();
            quantile(&values, share)
        };
        let mut verdicts = std::collections::BTreeMap::new();
        for trial in trials {
            *verdicts.entry(trial.found.verdict.name()).or_insert(0) += 1;
        }
        Self {
            observable,
            name: plan.name,
            pixels: plan.pixels,
            trials: trials.len(),
            refused: 0,
            ca_percent: errors(&mut trials.iter(), 0),
            radius_percent: errors(&mut trials.iter(), 1),
            away_ca_percent: errors(&mut trials.iter().filter(away), 0),
            away_radius_percent: errors(&mut trials.iter().filter(away), 1),
            held_68_percent: held(0),
            held_95_percent: held(1),
            spread: [0, 1].map(|d| {
                let squares: f64 = kept.iter().map(|score| score[d] * score[d]).sum();
                (squares / kept.len().max(1) as f64).sqrt()
            }),
            lost: scores.len() - kept.len(),
            deviation_percent: [
                median(&|trial| 100.0 * trial.found.deviations[0], 0.5),
                median(&|trial| 100.0 * trial.found.deviations[1] / trial.truth[1], 0.5),
            ],
            time_ms: median(&|trial| 1e3 * trial.seconds, 0.5),
            fast_ms: median(&|trial| 1e3 * trial.seconds, 0.1),
            evaluations: median(&|trial| f64::from(trial.found.evaluations), 0.5),
            verdicts,
        }
    }
}

/// A capsule somewhere in the domain, even in ln Ca and a/l.
fn anywhere(model: &Model<'_>, random: &mut Random) -> [f64; 2] {
    let [first, second, ..] = model.parameters() else {
        return [0.0; 2];
    };
    loop {
        let ca = random.between(first.min.ln(), first.max.ln()).exp();
        let place = [ca, random.between(second.min, second.max)];
        if model.domain(place) == Ok(Domain::Inside) {
            return place;
        }
    }
}

/// A quantile of some values, 0 of none.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = (sorted.len().saturating_sub(1) as f64 * share).round() as usize;
    sorted.get(place).copied().unwrap_or(0.0)
}
