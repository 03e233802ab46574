//! The setup of a measured outline.

use crate::identifier::Error;
use capsule_contour::Edge;
use capsule_contour::text::Unit;
use capsule_identify::{Direction, Flow, Lengths, Observable, Setup};
use capsule_measurement::{Request, Said};
use serde::Deserialize;

/// The options of the command, by their names.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Fields {
    half_width_um: f64,
    velocity_mm_s: Option<f64>,
    flow_rate_ul_min: Option<f64>,
    capsule_velocity_mm_s: Option<f64>,
    viscosity_pa_s: f64,
    observable: Kind,
    unit: Option<Length>,
    pixel_um: Option<f64>,
    #[serde(default)]
    flow: Way,
    capsule: Option<usize>,
    edge: Option<Criterion>,
    noise_um: Option<f64>,
    edge_px: Option<f64>,
    scale_error: Option<f64>,
    exposure_ms: Option<f64>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Midplane,
    Silhouette,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Length {
    Um,
    Px,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Way {
    Right,
    Left,
    Up,
    Down,
    #[default]
    Found,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Criterion {
    Gradient,
    HalfLevel,
}

impl Fields {
    pub(crate) fn observable(&self) -> Observable {
        match self.observable {
            Kind::Midplane => Observable::Midplane,
            Kind::Silhouette => Observable::Silhouette,
        }
    }

    pub(crate) fn said(&self) -> Said {
        Said {
            half_width_um: self.half_width_um,
            unit: self.unit.map(|unit| match unit {
                Length::Um => Unit::Um,
                Length::Px => Unit::Px,
            }),
            pixel_um: self.pixel_um,
            direction: match self.flow {
                Way::Right => Direction::Right,
                Way::Left => Direction::Left,
                Way::Up => Direction::Up,
                Way::Down => Direction::Down,
                Way::Found => Direction::Found,
            },
            capsule: self.capsule,
            edge: self.edge.map(|edge| match edge {
                Criterion::Gradient => Edge::Gradient,
                Criterion::HalfLevel => Edge::HalfLevel,
            }),
            background: None,
        }
    }

    /// # Errors
    /// No velocity, or several.
    pub(crate) fn request(&self) -> Result<Request, Error> {
        let flow = match (self.velocity_mm_s, self.flow_rate_ul_min, self.capsule_velocity_mm_s) {
            (Some(velocity), None, None) => Flow::MeanVelocity(1e-3 * velocity),
            (None, Some(rate), None) => Flow::Rate(rate * 1e-9 / 60.0),
            (None, None, Some(velocity)) => Flow::CapsuleVelocity(1e-3 * velocity),
            _ => return Err(Error::Velocities),
        };
        Ok(Request {
            observable: self.observable(),
            setup: Setup {
                half_width_um: self.half_width_um,
                flow,
                viscosity_pa_s: self.viscosity_pa_s,
            },
            lengths: Lengths::default(),
            noise_um: self.noise_um,
            pixel_um: self.pixel_um,
            edge_px: self.edge_px,
            scale_error: self.scale_error,
            exposure_ms: self.exposure_ms,
        })
    }
}
