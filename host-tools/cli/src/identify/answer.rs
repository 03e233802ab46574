//! The answer of `capsule-rom identify`, as JSON and as text.

use super::outline::Outline;
use super::picture::{Summary, turned};
use crate::{model, print};
use anyhow::Result;
use capsule_core::Model;
use capsule_identify::{Estimate, Identification, Interval};
use serde::Serialize;

/// Ends of an interval; none where it is open.
pub type Ends = [Option<f64>; 2];

/// The ends of an interval.
pub fn ends(interval: Interval) -> Ends {
    let [low, high] = interval.open;
    [(!low).then_some(interval.low), (!high).then_some(interval.high)]
}

/// Values with the ends of their intervals, in the units of their names.
#[derive(Serialize)]
pub struct Answer {
    verdict: &'static str,
    verdict_text: &'static str,
    ca: f64,
    ca_68: Ends,
    ca_95: Ends,
    confinement: f64,
    confinement_68: Ends,
    confinement_95: Ends,
    radius_um: f64,
    radius_um_68: Ends,
    radius_um_95: Ends,
    gs_n_per_m: f64,
    gs_n_per_m_68: Ends,
    gs_n_per_m_95: Ends,
    mean_velocity_mm_s: f64,
    correlation: f64,
    chi_squared: f64,
    degrees_of_freedom: f64,
    residual_um: f64,
    noise_um: f64,
    correlated_points: f64,
    structure: f64,
    edge_um: f64,
    scale_error: f64,
    tilt_degrees: f64,
    flow: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    blur_um: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alternative: Option<Other>,
    #[serde(skip_serializing_if = "Option::is_none")]
    contour: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<Summary>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
    model_digest: String,
    errors_against: String,
}

/// A second solution that fits as well.
#[derive(Serialize)]
struct Other {
    ca: f64,
    confinement: f64,
    rise_of_chi_squared: f64,
}

impl Answer {
    /// The answer with what was done to find it; `blur_um` is the way of the capsule in the exposure.
    pub fn new(
        model: &Model<'_>,
        found: &Identification,
        outline: Option<&Outline>,
        blur_um: Option<f64>,
        warnings: Vec<String>,
    ) -> Self {
        let seen = outline.and_then(|outline| outline.seen.as_ref());
        let direction = match seen {
            Some(_) => turned(found.direction),
            None => found.direction,
        };
        let three = |estimate: Estimate| (estimate.value, ends(estimate.interval_68), ends(estimate.interval_95));
        let (ca, ca_68, ca_95) = three(found.capillary_number);
        let (confinement, confinement_68, confinement_95) = three(found.confinement);
        let (radius_um, radius_um_68, radius_um_95) = three(found.radius_um);
        let (gs_n_per_m, gs_n_per_m_68, gs_n_per_m_95) = three(found.shear_modulus_n_per_m);
        Self {
            verdict: found.verdict.name(),
            verdict_text: found.verdict.text(),
            ca,
            ca_68,
            ca_95,
            confinement,
            confinement_68,
            confinement_95,
            radius_um,
            radius_um_68,
            radius_um_95,
            gs_n_per_m,
            gs_n_per_m_68,
            gs_n_per_m_95,
            mean_velocity_mm_s: 1e3 * found.mean_velocity_m_s,
            correlation: found.correlation,
            chi_squared: found.chi_squared,
            degrees_of_freedom: found.degrees_of_freedom,
            residual_um: found.residual_um,
            noise_um: found.noise_um,
            correlated_points: found.correlated_points,
            structure: found.structure,
            edge_um: found.edge_um,
            scale_error: found.scale_error,
            tilt_degrees: found.tilt.to_degrees(),
            flow: direction.name(),
            blur_um,
            alternative: found.alternative.map(|other| Other {
                ca: other.capillary_number,
                confinement: other.confinement,
                rise_of_chi_squared: other.rise,
            }),
            contour: outline.map(|outline| outline.note.clone()),
            picture: seen.map(|seen| seen.summary.clone()),
            warnings,
            model_digest: model::digest(model),
            errors_against: model.errors_against().to_string(),
        }
    }

    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Prints the answer as text.
    pub fn print(&self) -> Result<()> {
        if let Some(contour) = &self.contour {
            println!("contour: {contour}; flow: {}", self.flow);
        }
        println!("{}: {}", self.verdict, self.verdict_text);
        let row = |name: &str, value: f64, narrow: Ends, wide: Ends, digits: usize| {
            let end = |end: Option<f64>| end.map_or("open".to_owned(), |end| format!("{end:.digits$}"));
            let interval = |[low, high]: Ends| format!("{} to {}", end(low), end(high));
            vec![
                name.to_owned(),
                format!("{value:.digits$}"),
                interval(narrow),
                interval(wide),
            ]
        };
        let milli = |ends: Ends| ends.map(|end| end.map(|end| 1e3 * end));
        print::table(
            &["", "value", "68 %", "95 %"],
            &[
                row("Ca", self.ca, self.ca_68, self.ca_95, 5),
                row("a/l", self.confinement, self.confinement_68, self.confinement_95, 4),
                row("a / um", self.radius_um, self.radius_um_68, self.radius_um_95, 3),
                row(
                    "G_s / (mN/m)",
                    1e3 * self.gs_n_per_m,
                    milli(self.gs_n_per_m_68),
                    milli(self.gs_n_per_m_95),
                    3,
                ),
            ],
        )?;
        if self.contour.is_some() {
            println!(
                "residuals {:.3} um; edge {:+.3} um, scale {:+.2} %, tilt {:+.2} degrees; chi-squared {:.0} for {:.0}",
                self.residual_um,
                self.edge_um,
                100.0 * self.scale_error,
                self.tilt_degrees,
                self.chi_squared,
                self.degrees_of_freedom
            );
        }
        if let Some(other) = &self.alternative {
            println!(
                "another solution: Ca {:.5}, a/l {:.4}, chi-squared greater by {:.2}",
                other.ca, other.confinement, other.rise_of_chi_squared
            );
        }
        println!("against {}, model {}", self.errors_against, self.model_digest);
        Ok(())
    }
}
