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
    /// The setup cannot be read.
    Said(serde_json::Error),
    /// No velocity is said, or several are.
    Velocities,
    /// The misfit is asked for before there is an answer.
    NoAnswer,
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Open(error) => error.fmt(f),
            Self::Measurement(error) => error.fmt(f),
            Self::Said(error) => {
                // The place in the text that JavaScript made of an object says nothing.
                let words = error.to_string();
                f.write_str(words.split(" at line ").next().unwrap_or_default())
            }
            Self::Velocities => f.write_str("give one of velocity_mm_s, flow_rate_ul_min and capsule_velocity_mm_s"),
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
        let request = fields.request()?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use capsule_identify::{Contour, Direction, Flow, Lengths, Measurement, Point, Priors, Setup, identify};
    use serde_json::Value;

    static FILE: &[u8] = include_bytes!("../../../models/capsule.crom");
    const HALF_WIDTH_UM: f64 = 25.0;

    /// The outline of a capsule of the model, both halves, in um.
    fn points(model: &Model<'_>, [ca, confinement]: [f64; 2]) -> Vec<[f64; 2]> {
        let mut bench = Bench::new(model);
        let (mut shapes, _) = bench.shapes(model, Observable::Midplane);
        let shape = shapes.at([ca.ln(), confinement]).unwrap();
        let half = shape.curve.points();
        let mirrored = half[1..half.len() - 1].iter().rev().map(|[x, r]| [*x, -r]);
        let all = half.iter().copied().chain(mirrored);
        all.map(|point| point.map(|at| 60.0 + HALF_WIDTH_UM * at)).collect()
    }

    fn text(points: &[[f64; 2]]) -> String {
        let lines: Vec<String> = points.iter().map(|[x, y]| format!("{x},{y}")).collect();
        format!("x_um,y_um\n{}\n", lines.join("\n"))
    }

    fn said(change: &[(&str, Value)]) -> String {
        let mut said = serde_json::json!({
            "half_width_um": HALF_WIDTH_UM, "velocity_mm_s": 5.0, "viscosity_pa_s": 0.8,
            "observable": "midplane", "unit": null, "pixel_um": null, "flow": "found", "capsule": null,
        });
        for (key, value) in change {
            said[key] = value.clone();
        }
        said.to_string()
    }

    #[test]
    fn answers_are_those_of_the_identification() {
        let model = Model::open(FILE).unwrap();
        let points = points(&model, [0.06, 0.95]);
        let mut identifier = Identifier::open(FILE.to_vec()).unwrap();
        let found = identifier.identify("a.csv", text(&points).as_bytes(), &said(&[]));
        let found: Value = serde_json::from_str(&found.unwrap()).unwrap();

        let mut bench = Bench::new(&model);
        let (mut shapes, _) = bench.shapes(&model, Observable::Midplane);
        let grid = Grid::new(&mut shapes).unwrap();
        let measurement = Measurement {
            setup: Setup {
                half_width_um: HALF_WIDTH_UM,
                flow: Flow::MeanVelocity(5e-3),
                viscosity_pa_s: 0.8,
            },
            contour: Some(Contour {
                points_um: &points,
                direction: Direction::Found,
                noise_um: None,
            }),
            dent_line_um: &[],
            lengths: Lengths::default(),
            priors: Priors::of_pixel(HALF_WIDTH_UM / 100.0),
        };
        let mut room = vec![Point::default(); points.len()];
        let expected = identify(&mut shapes, &grid, &measurement, &mut room).unwrap();
        let answer = &found["answer"];
        assert_eq!(answer["ca"].as_f64(), Some(expected.capillary_number.value));
        assert_eq!(
            answer["gs_n_per_m_95"][1].as_f64(),
            Some(expected.shear_modulus_n_per_m.interval_95.high)
        );
        assert_eq!(answer["verdict"], expected.verdict.name());
        assert_eq!(answer["model_digest"], format!("{:08x}", model.digest()));
        // Measured and fitted outline lie on each other in the capsule's frame.
        let drawn = |name: &str| -> Vec<[f64; 2]> { serde_json::from_value(found[name].clone()).unwrap() };
        let (contour, outline) = (drawn("contour"), drawn("outline"));
        assert_eq!(contour.len(), points.len());
        for (measured, fitted) in contour.iter().zip(&outline) {
            let apart = (measured[0] - fitted[0]).hypot(measured[1] - fitted[1]);
            assert!(apart < 3e-3, "{measured:?} {fitted:?}");
        }
        // The regions lie in the ranges around the best fit, and nothing is asked for outside the domain.
        let around: [[f64; 2]; 2] = serde_json::from_value(found["around"].clone()).unwrap();
        let levels: [f64; 2] = serde_json::from_value(found["levels"].clone()).unwrap();
        let best = [expected.capillary_number.value, expected.confinement.value];
        for end in 0..2 {
            let places = [
                around[0][end],
                best[1],
                best[0],
                around[1][end],
                best[0],
                best[1],
                5.0,
                0.9,
            ];
            let [ca, confinement, at_best, outside] = identifier.misfit(&places).unwrap()[..] else {
                panic!("four places, four rises");
            };
            assert!(
                ca > levels[1] && confinement > levels[1] && at_best < 0.1,
                "{ca} {confinement} {at_best}"
            );
            assert!(levels[0] < levels[1] && outside.is_nan());
        }
    }

    #[test]
    fn what_cannot_be_is_named() {
        assert!(Identifier::open(vec![0; 64]).is_err());
        let model = Model::open(FILE).unwrap();
        let text = text(&points(&model, [0.06, 0.95]));
        let mut identifier = Identifier::open(FILE.to_vec()).unwrap();
        let mut refused = |name: &str, text: &str, change: &[(&str, Value)]| {
            let error = identifier.identify(name, text.as_bytes(), &said(change)).unwrap_err();
            // Without an answer there is no misfit.
            assert!(identifier.misfit(&[0.1, 0.9]).is_err());
            error.to_string()
        };
        assert!(refused("a.csv", "1,2\n3,4\n", &[("unit", "um".into())]).contains("at least 12"));
        assert!(refused("a.csv", &text, &[("unit", "px".into())]).contains("headings say um"));
        assert!(refused("a.png", &text, &[]).contains("PNG, JPEG or TIFF"));
        assert!(refused("a.csv", &text, &[("half_width_um", 12.0.into())]).contains("wide"));
        assert!(refused("a.csv", &text, &[("viscosity_pa_s", (-1.0).into())]).contains("viscosity"));
        assert!(refused("a.csv", &text, &[("flow", "north".into())]).contains("north"));
        let both = refused("a.csv", &text, &[("flow_rate_ul_min", 0.75.into())]);
        assert!(both.starts_with("give one of velocity_mm_s"), "{both}");
        let wrong = refused("a.csv", &text, &[("viscosity", 0.8.into())]);
        assert!(
            wrong.contains("unknown field `viscosity`") && !wrong.contains("line"),
            "{wrong}"
        );
    }
}
