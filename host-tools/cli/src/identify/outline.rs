//! The file of an outline, with the options of the command.

use super::given::Given;
use anyhow::{Context, Result, anyhow, bail, ensure};
use capsule_contour::Picture;
use capsule_measurement::{Input, MeasurementError, Outline, Said, is_picture};
use std::path::Path;

/// Reads a file: a picture or a text.
pub fn read(path: &Path, given: &Given, half_width_um: f64, warnings: &mut Vec<String>) -> Result<Outline> {
    let bytes = std::fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
    from(path, &bytes, given, half_width_um, warnings).with_context(|| path.display().to_string())
}

fn from(path: &Path, bytes: &[u8], given: &Given, half_width_um: f64, warnings: &mut Vec<String>) -> Result<Outline> {
    let picture = is_picture(path, bytes);
    if picture {
        ensure!(
            given.unit().is_none(),
            "--unit is for text files, and this is a picture"
        );
    } else if let Some(option) = given.of_pictures() {
        bail!("{option} is for pictures, and this is a text");
    }
    let background = given.background.as_deref().map(|path| {
        let bytes = std::fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
        Picture::read(&bytes).with_context(|| path.display().to_string())
    });
    let said = Said {
        half_width_um,
        unit: given.unit(),
        pixel_um: given.pixel_um,
        direction: given.direction(),
        capsule: given.capsule,
        edge: given.edge(),
        background: background.transpose()?,
    };
    let outline = Outline::read(path, bytes, &said, warnings).map_err(with_option)?;
    if picture && !given.says_channel() {
        warnings.push(
            "a picture does not tell whether the channel is square, and in a round tube the numbers would be wrong: \
             say --channel square if it is"
                .to_owned(),
        );
    }
    Ok(outline)
}

/// The error with the option that it asks for.
fn with_option(error: MeasurementError) -> anyhow::Error {
    let option = error.asks_for().map(|input| match input {
        Input::Unit => "--unit um or --pixel-um",
        Input::Pixel => "--pixel-um",
        Input::Capsule => "--capsule",
    });
    match option {
        Some(option) => anyhow!("{error} ({option})"),
        None => error.into(),
    }
}
