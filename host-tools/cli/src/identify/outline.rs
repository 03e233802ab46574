//! The file of an outline, with the options of the command.

use super::given::Given;
use super::rtdc::{self, Masks};
use anyhow::{Context, Result, anyhow, bail, ensure};
use capsule_contour::Picture;
use capsule_measurement::{Input, MeasurementError, Outline, Said, Seen, is_picture};
use std::path::Path;

/// Reads a file: a picture, a text, or a mask of an RT-DC file.
pub fn read(path: &Path, given: &Given, half_width_um: f64, warnings: &mut Vec<String>) -> Result<Outline> {
    let context = || path.display().to_string();
    if rtdc::is_one(path) {
        let picture = Masks::open(path)?.picture(given.capsule).with_context(context)?;
        return of_mask(picture, given, half_width_um, warnings).with_context(context);
    }
    let bytes = std::fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
    from(path, &bytes, given, half_width_um, warnings).with_context(context)
}

/// Adds the points along a dent line, a text.
pub fn add_dent_line(outline: &mut Outline, path: &Path, given: &Given) -> Result<()> {
    let bytes = std::fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
    let read = outline.read_dent_line(&bytes, given.unit()).map_err(with_option);
    read.with_context(|| path.display().to_string())
}

/// The outline of a mask, whose picture shows one event.
fn of_mask(picture: Picture, given: &Given, half_width_um: f64, warnings: &mut Vec<String>) -> Result<Outline> {
    ensure!(
        given.unit().is_none() && given.background.is_none(),
        "--unit and --background do not go with a mask"
    );
    let said = Said {
        capsule: None,
        ..said(given, half_width_um)?
    };
    let seen = Seen::find(picture, &said, warnings).map_err(with_option)?;
    warn_of_the_channel(given, warnings);
    Ok(seen.into())
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
    let outline = Outline::read(path, bytes, &said(given, half_width_um)?, warnings).map_err(with_option)?;
    if picture {
        warn_of_the_channel(given, warnings);
    }
    Ok(outline)
}

/// Information beside the file of an outline, from the options.
fn said(given: &Given, half_width_um: f64) -> Result<Said> {
    let background = given.background.as_deref().map(|path| {
        let bytes = std::fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
        Picture::read(&bytes).with_context(|| path.display().to_string())
    });
    Ok(Said {
        half_width_um,
        unit: given.unit(),
        pixel_um: given.pixel_um,
        direction: given.direction(),
        capsule: given.capsule,
        edge: given.edge(),
        background: background.transpose()?,
    })
}

fn warn_of_the_channel(given: &Given, warnings: &mut Vec<String>) {
    if !given.says_channel() {
        warnings.push(
            "a picture does not tell whether the channel is square, and in a round tube the numbers would be wrong: \
             say --channel square if it is"
                .to_owned(),
        );
    }
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
