//! What the page says of an outline.

use capsule_contour::text::Unit;
use capsule_identify::{Direction, Flow, Lengths, Observable, Setup};
use capsule_measurement::{Request, Said};
use serde::Deserialize;

/// The fields of the page, in the units of their names.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Fields {
    half_width_um: f64,
    mean_velocity_mm_s: f64,
    viscosity_pa_s: f64,
    observable: Kind,
    unit: Option<Length>,
    pixel_um: Option<f64>,
    flow: Way,
    capsule: Option<usize>,
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

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Way {
    Right,
    Left,
    Up,
    Down,
    Found,
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
            edge: None,
            background: None,
        }
    }

    pub(crate) fn request(&self) -> Request {
        Request {
            observable: self.observable(),
            setup: Setup {
                half_width_um: self.half_width_um,
                flow: Flow::MeanVelocity(1e-3 * self.mean_velocity_mm_s),
                viscosity_pa_s: self.viscosity_pa_s,
            },
            lengths: Lengths::default(),
            noise_um: None,
            pixel_um: self.pixel_um,
            edge_px: None,
            scale_error: None,
            exposure_ms: None,
        }
    }
}
