//! `capsule-rom identify --frames`: one capsule from several outlines.

use super::given::Given;
use crate::model::digest;
use crate::print;
use anyhow::Result;
use capsule_core::Model;
use capsule_identify::{Contour, Estimate, Grid, Point, Sequence, SequenceIdentification, identify_sequence};
use capsule_measurement::{Bench, Ends, Other, Outline, ends};
use serde::Serialize;

/// A quantity with the ends of its intervals; none where an interval reaches the edge of the domain.
#[derive(Serialize)]
struct Quantity {
    value: f64,
    interval_68: Ends,
    interval_95: Ends,
}

impl From<Estimate> for Quantity {
    fn from(estimate: Estimate) -> Self {
        Self {
            value: estimate.value,
            interval_68: ends(estimate.interval_68),
            interval_95: ends(estimate.interval_95),
        }
    }
}

#[derive(Serialize)]
struct Instant {
    t: f64,
    deviation: f64,
}

#[derive(Serialize)]
struct Answer {
    ca: Quantity,
    confinement: Quantity,
    radius_um: Quantity,
    gs_n_per_m: Quantity,
    /// Of each frame, in l/V since the capsule was a sphere; none for steady frames.
    instants: Option<Vec<Instant>>,
    noise_um: f64,
    drift: f64,
    drift_freedom: f64,
    drifts: bool,
    alternative: Option<Other>,
    verdict: &'static str,
    verdict_text: String,
    model_digest: String,
}

/// Identifies the capsule that several outlines show and prints what was found.
pub fn run(model: &Model<'_>, given: &Given, outlines: &[&Outline], transient: bool, json: bool) -> Result<()> {
    let request = given.request(&mut Vec::new())?;
    let contours = outlines.iter().map(|outline| Contour {
        points_um: &outline.points_um,
        direction: outline.direction,
        noise_um: given.noise_um,
    });
    let contours: Vec<_> = contours.collect();
    contours.iter().try_for_each(Contour::crossing)?;
    let scaled = outlines.iter().copied().find(|outline| outline.pixel_um.is_some());
    let sequence = Sequence {
        setup: request.setup,
        contours: &contours,
        priors: request.priors(request.pixel_um(scaled)),
        steady: !transient,
    };
    let longest = outlines.iter().map(|outline| outline.points_um.len()).max();
    let mut points = vec![Point::default(); longest.unwrap_or(0)];
    let mut bench = Bench::new(model);
    let (mut shapes, _) = bench.shapes(model, given.observable());
    let grid = Grid::new(&mut shapes)?;
    let found = identify_sequence(&mut shapes, &grid, &sequence, &mut points)?;
    let count = sequence.contours.len();
    let instants = found.instants.iter().take(count).map(|[t, deviation]| Instant {
        t: *t,
        deviation: *deviation,
    });
    let answer = Answer {
        ca: found.capillary_number.into(),
        confinement: found.confinement.into(),
        radius_um: found.radius_um.into(),
        gs_n_per_m: found.shear_modulus_n_per_m.into(),
        instants: (!sequence.steady).then(|| instants.collect()),
        noise_um: found.noise_um,
        drift: found.drift,
        drift_freedom: found.drift_freedom,
        drifts: found.drifts(),
        alternative: found.alternative.map(Other::from),
        verdict: found.verdict.name(),
        verdict_text: found.verdict.text(model.membrane_law()).to_string(),
        model_digest: digest(model),
    };
    if json {
        return print::json(&answer);
    }
    print_text(&answer, &found)
}

fn print_text(answer: &Answer, found: &SequenceIdentification) -> Result<()> {
    println!("{}: {}", answer.verdict, answer.verdict_text);
    let row = |name: &str, quantity: &Quantity, factor: f64, digits: usize| {
        let end = |end: Option<f64>| end.map_or("open".to_owned(), |end| format!("{:.digits$}", factor * end));
        let interval = |[low, high]: Ends| format!("{} to {}", end(low), end(high));
        vec![
            name.to_owned(),
            format!("{:.digits$}", factor * quantity.value),
            interval(quantity.interval_68),
            interval(quantity.interval_95),
        ]
    };
    print::table(
        &["", "value", "68 %", "95 %"],
        &[
            row("Ca", &answer.ca, 1.0, 5),
            row("a/l", &answer.confinement, 1.0, 4),
            row("a / um", &answer.radius_um, 1.0, 3),
            row("G_s / (mN/m)", &answer.gs_n_per_m, 1e3, 3),
        ],
    )?;
    for (number, Instant { t, deviation }) in answer.instants.iter().flatten().enumerate() {
        println!("frame {}: t = {t:.3} +- {deviation:.3} l/V", number + 1);
    }
    if let Some(other) = &answer.alternative {
        println!(
            "another solution: Ca {:.5}, a/l {:.4}, chi-squared greater by {:.2}",
            other.ca, other.confinement, other.rise_of_chi_squared
        );
    }
    println!(
        "noise {:.3} um; drift: chi-squared {:.1} for {:.0}",
        found.noise_um, found.drift, found.drift_freedom
    );
    Ok(())
}
