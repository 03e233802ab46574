//! The answer: values, intervals and units, for people and programs.

use crate::outline::Outline;
use crate::seen::{Summary, turned};
use capsule_core::Model;
use capsule_identify::{Alternative, Estimate, Identification, Interval};
use serde::Serialize;

/// Ends of an interval; none where it is open.
pub type Ends = [Option<f64>; 2];

/// The ends of an interval.
pub fn ends(interval: Interval) -> Ends {
    let [low, high] = interval.open;
    [(!low).then_some(interval.low), (!high).then_some(interval.high)]
}

/// Values with the ends of their intervals, in the units of their names.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// Kind of answer.
    pub verdict: &'static str,
    /// The same in a sentence.
    pub verdict_text: String,
    /// Capillary number mu V / G_s.
    pub ca: f64,
    /// The 68 % interval.
    pub ca_68: Ends,
    /// The 95 % interval.
    pub ca_95: Ends,
    /// a/l.
    pub confinement: f64,
    /// The 68 % interval.
    pub confinement_68: Ends,
    /// The 95 % interval.
    pub confinement_95: Ends,
    /// Radius a, in um.
    pub radius_um: f64,
    /// The 68 % interval.
    pub radius_um_68: Ends,
    /// The 95 % interval.
    pub radius_um_95: Ends,
    /// Surface shear modulus G_s, in N/m.
    pub gs_n_per_m: f64,
    /// The 68 % interval.
    pub gs_n_per_m_68: Ends,
    /// The 95 % interval.
    pub gs_n_per_m_95: Ends,
    /// Mean velocity of the liquid, in mm/s.
    pub mean_velocity_mm_s: f64,
    /// Correlation of the errors of ln Ca and a/l.
    pub correlation: f64,
    /// Sum of the squares of the residuals over their noise.
    pub chi_squared: f64,
    /// Points less what is fitted to them.
    pub degrees_of_freedom: f64,
    /// Root mean square of the residuals, in um.
    pub residual_um: f64,
    /// That of the points along a dent line, in um.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dent_line_residual_um: Option<f64>,
    /// Noise of a point, in um.
    pub noise_um: f64,
    /// How many neighbouring residuals count as one.
    pub correlated_points: f64,
    /// How much of the model's error the outline asks for.
    pub structure: f64,
    /// How far the edge seems to be drawn too far out, in um.
    pub edge_um: f64,
    /// Relative error of the scale.
    pub scale_error: f64,
    /// Angle of the channel's axis, in degrees.
    pub tilt_degrees: f64,
    /// Direction of the flow: in a picture, where y points down, as it is seen.
    pub flow: &'static str,
    /// Way of the capsule in the exposure, in um.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub blur_um: Option<f64>,
    /// A second solution that fits as well.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alternative: Option<Other>,
    /// Origin of the contour, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<String>,
    /// Findings in a picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<Summary>,
    /// Warnings, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Digest of the model.
    pub model_digest: String,
    /// The solution that the model's errors are taken against.
    pub errors_against: String,
}

/// A second solution that fits as well.
#[derive(Clone, Debug, Serialize)]
pub struct Other {
    /// Ca.
    pub ca: f64,
    /// a/l.
    pub confinement: f64,
    /// By how much its sum of squares is greater.
    pub rise_of_chi_squared: f64,
}

impl From<Alternative> for Other {
    fn from(other: Alternative) -> Self {
        Self {
            ca: other.capillary_number,
            confinement: other.confinement,
            rise_of_chi_squared: other.rise,
        }
    }
}

impl Answer {
    /// The answer with what was done to find it; `blur_um` is the way of the capsule in the exposure.
    pub(crate) fn new(
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
            verdict_text: found.verdict.text(model.membrane_law()).to_string(),
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
            dent_line_residual_um: found.dent_line_residual_um,
            noise_um: found.noise_um,
            correlated_points: found.correlated_points,
            structure: found.structure,
            edge_um: found.edge_um,
            scale_error: found.scale_error,
            tilt_degrees: found.tilt.to_degrees(),
            flow: direction.name(),
            blur_um,
            alternative: found.alternative.map(Other::from),
            contour: outline.map(|outline| outline.note.clone()),
            picture: seen.map(|seen| seen.summary.clone()),
            warnings,
            model_digest: format!("{:08x}", model.digest()),
            errors_against: model.errors_against().to_string(),
        }
    }
}
