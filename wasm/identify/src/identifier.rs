//! A model, its starts, and the last answer with its misfit.

use crate::said::Fields;
use capsule_core::{Model, OpenError};
use capsule_identify::{Grid, Misfit, Observable};
use capsule_measurement::{Answer, Bench, MeasurementError, Outline, Solved};
use self_cell::self_cell;
use serde::Serialize;
use std::path::Path;

self_cell!(
    /// The file's bytes with the model that reads them in place.
    struct File {
        owner: Vec<u8>,
        #[covariant]
        dependent: Model,
    }
);

/// The most points of a contour that are drawn.
const DRAWN: usize = 1000;
/// Half the range around the best fit that holds the regions, in standard deviations: a tenth more than 2.45, the root
/// of the level of 95 %.
const AROUND: f64 = 2.7;

/// Why there is no answer.
#[derive(Debug)]
pub(crate) enum Error {
    Open(OpenError),
    Measurement(MeasurementError),
    /// The page says what cannot be read.
    Said(serde_json::Error),
    /// The misfit is asked for before there is an answer.
    NoAnswer,
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Open(error) => error.fmt(f),
            Self::Measurement(error) => error.fmt(f),
            Self::Said(error) => error.fmt(f),
            Self::NoAnswer => f.write_str("there is no answer yet whose misfit could be told"),
        }
    }
}

impl std::error::Error for Error {}

impl From<MeasurementError> for Error {
    fn from(error: MeasurementError) -> Self {
        Self::Measurement(error)
    }
}

/// A model file, opened for identifications.
pub(crate) struct Identifier {
    file: File,
    bench: Bench,
    midplane: Option<Grid>,
    silhouette: Option<Grid>,
    last: Option<(Observable, Misfit)>,
}

/// An answer and what is drawn of it.
#[derive(Serialize)]
struct Identified<'a> {
    answer: &'a Answer,
    contour: Vec<[f64; 2]>,
    outline: Vec<[f64; 2]>,
    levels: [f64; 2],
    around: [[f64; 2]; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<Placed>,
}

/// A picture in the capsule's frame, in l: its upper left corner, and the ways of a pixel along a row and a column.
#[derive(Serialize)]
struct Placed {
    size: [u32; 2],
    corner: [f64; 2],
    ways: [[f64; 2]; 2],
}

impl Identifier {
    pub(crate) fn open(bytes: Vec<u8>) -> Result<Self, Error> {
        let file = File::try_new(bytes, |bytes| Model::open(bytes)).map_err(Error::Open)?;
        let mut bench = Bench::new(file.borrow_dependent());
        // It refuses a model of anything but capsules in the channel.
        let midplane = bench.grid(file.borrow_dependent(), Observable::Midplane)?;
        Ok(Self {
            bench,
            midplane: Some(midplane),
            silhouette: None,
            last: None,
            file,
        })
    }

    pub(crate) fn identify(&mut self, name: &str, bytes: &[u8], said: &str) -> Result<String, Error> {
        let fields: Fields = serde_json::from_str(said).map_err(Error::Said)?;
        self.last = None;
        let model = self.file.borrow_dependent();
        let mut warnings = Vec::new();
        let outline = Outline::read(Path::new(name), bytes, &fields.said(), &mut warnings)?;
        let observable = fields.observable();
        let known = match observable {
            Observable::Midplane => &mut self.midplane,
            Observable::Silhouette => &mut self.silhouette,
        };
        let grid = match known {
            Some(grid) => grid,
            None => known.insert(self.bench.grid(model, observable)?),
        };
        let request = fields.request();
        let solved = self.bench.identify(model, grid, &request, Some(&outline), warnings)?;
        let text = serde_json::to_string(&drawn(model, &outline, &solved)).map_err(Error::Said)?;
        self.last = Some((observable, solved.misfit));
        Ok(text)
    }

    pub(crate) fn misfit(&mut self, places: &[f64]) -> Result<Vec<f64>, Error> {
        let (observable, misfit) = self.last.as_ref().ok_or(Error::NoAnswer)?;
        let (mut shapes, _) = self.bench.shapes(self.file.borrow_dependent(), *observable);
        let (places, _) = places.as_chunks();
        let mut rise = |[ca, confinement]: [f64; 2]| {
            let found = misfit.rise(&mut shapes, [ca.ln(), confinement]);
            Ok(found.map_err(MeasurementError::Model)?.unwrap_or(f64::NAN))
        };
        places.iter().map(|place| rise(*place)).collect()
    }
}

/// What the page shows of an answer.
fn drawn<'a>(model: &Model<'_>, outline: &Outline, solved: &'a Solved) -> Identified<'a> {
    let Solved {
        found,
        shape,
        misfit,
        answer,
    } = solved;
    let step = outline.points_um.len().div_ceil(DRAWN).max(1);
    let contour = outline.points_um.iter().step_by(step);
    let ranges = model.parameters();
    let range = |d: usize, low: f64, high: f64| {
        let range = ranges.get(d);
        let [least, most] = range.map_or([low, high], |range| [range.min, range.max]);
        [low.max(least), high.min(most)]
    };
    let [ca, confinement] = found.deviations.map(|deviation| AROUND * deviation);
    let value = found.capillary_number.value;
    let picture = outline.seen.as_ref().map(|seen| {
        let pixel = seen.summary.pixel_um;
        let corner = found.frame.place([0.0; 2]);
        let ways = [[pixel, 0.0], [0.0, pixel]].map(|at| {
            let [x, r] = found.frame.place(at);
            [x - corner[0], r - corner[1]]
        });
        Placed {
            size: seen.picture.size(),
            corner,
            ways,
        }
    });
    Identified {
        answer,
        contour: contour.map(|point| found.frame.place(*point)).collect(),
        outline: shape.curve.points().to_vec(),
        levels: [0.6827, 0.95].map(|probability| misfit.level(probability)),
        around: [
            range(0, value * (-ca).exp(), value * ca.exp()),
            range(
                1,
                found.confinement.value - confinement,
                found.confinement.value + confinement,
            ),
        ],
        picture,
    }
}
