//! Codes and values of the errors of an identification.

use crate::identifier::Error;
use capsule_contour::PictureError;
use capsule_contour::text::TextError;
use capsule_identify::{ContourError, IdentifyError, MAX_GAP, MIN_POINTS};
use capsule_measurement::MeasurementError;
use capsule_refusal::{Refusal, texts};

/// A code, and the numbers and names in the text of the error, in their order there and written as there.
type Reason = (&'static str, Vec<String>);

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        let text = error.to_string();
        let (code, values) = match error {
            Error::Open(error) => return error.into(),
            Error::Measurement(
                MeasurementError::Model(error) | MeasurementError::Identify(IdentifyError::Model(error)),
            ) => return error.into(),
            Error::Measurement(error) => of_measurement(&error),
            Error::Said(_) => ("setup", texts![text]),
            Error::Velocities => ("setup-velocities", Vec::new()),
            Error::NoAnswer => ("no-answer", Vec::new()),
        };
        Self::new(code, values, text)
    }
}

fn of_measurement(error: &MeasurementError) -> Reason {
    use MeasurementError as E;
    match error {
        E::Text(error) => of_text(error),
        E::Picture(error) => of_picture(error),
        E::Contour(error) | E::Identify(IdentifyError::Contour(error)) => of_contour(error),
        E::Identify(error) => of_identification(error),
        E::Capsule { count, places } => ("picture-capsules", texts![count, places.join(", ")]),
        E::Pixel(size) => ("setup-pixel", texts![size]),
        E::NoScale => ("picture-scale", Vec::new()),
        E::TooManyPoints { found, most } => ("contour-long", texts![found, most]),
        _ => ("measurement", texts![error]),
    }
}

fn of_text(error: &TextError) -> Reason {
    use TextError as E;
    match error {
        E::NoPoints => ("text-empty", Vec::new()),
        E::NoNumber { line, cell } => ("text-number", texts![line, cell]),
        E::Columns { width, names } => ("text-columns", texts![width, names]),
        E::Units { named, given } => ("text-units", texts![named, given]),
        E::NoUnit => ("text-unit", Vec::new()),
        E::NoScale => ("text-scale", Vec::new()),
        _ => ("measurement", texts![error]),
    }
}

fn of_picture(error: &PictureError) -> Reason {
    use PictureError as E;
    match error {
        E::Unreadable { reason } => ("picture-unreadable", texts![reason]),
        E::TooSmall { width, height, least } => ("picture-small", texts![width, height, least]),
        E::NoCapsule { least } => ("picture-empty", texts![least]),
        E::TouchesBorder => ("picture-border", Vec::new()),
        E::EndsDiffer => ("picture-ends", Vec::new()),
        // Those of a background, which this module does not take.
        _ => ("measurement", texts![error]),
    }
}

fn of_contour(error: &ContourError) -> Reason {
    use ContourError as E;
    let percent = |share: f64| format!("{:.0}", 100.0 * share);
    match *error {
        E::TooFewPoints { found } => ("contour-short", texts![found, MIN_POINTS]),
        E::TooManyPoints { found, capacity } => ("contour-long", texts![found, capacity]),
        E::NotFinite { index } => ("contour-number", texts![index + 1]),
        E::SelfCrossing { first, second } => ("contour-crossing", texts![first + 1, second + 1]),
        E::WiderThanChannel { width_um, channel_um } => (
            "contour-wide",
            texts![format!("{width_um:.4}"), format!("{channel_um:.4}")],
        ),
        E::Open { share } => ("contour-open", texts![percent(share), percent(MAX_GAP)]),
        E::NoArea => ("contour-area", Vec::new()),
        _ => ("measurement", texts![error]),
    }
}

fn of_identification(error: &IdentifyError) -> Reason {
    use IdentifyError as E;
    match error {
        E::Number { what, value } => ("setup-number", texts![what, value]),
        E::NoFit => ("no-fit", Vec::new()),
        // Those of lengths and of several frames, which this module does not take.
        _ => ("measurement", texts![error]),
    }
}
