//! `capsule-rom predict`: the reduced-order model at chosen instants.

use crate::bending_effect::{BendingEffect, bending_effect};
use crate::fields::{Field, Surface, Totals};
use crate::membrane::{Mechanics, surface};
use crate::model::{self, ModelFile};
use crate::outputs::Outputs;
use crate::parameters::QueryOptions;
use crate::{outlines, print};
use anyhow::{Context, Result, anyhow, ensure};
use capsule_core::model::{Reference, Units};
use capsule_core::{Domain, EvaluateError, Evaluator, Method, Model, Parameters, Query, Real, Workspace};
use capsule_database::fields::{write_csv, write_npz};
use capsule_database::{stl, table, vtu};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    #[command(flatten)]
    query: QueryOptions,
    /// Instants from 0 on, in l/V (or the unit of time of --model); answered in rising order, equal ones once
    #[arg(long, value_delimiter = ',', required = true, allow_negative_numbers = true)]
    t: Vec<f64>,
    /// Method of evaluation [default: the model's]
    #[arg(long, value_enum)]
    method: Option<MethodName>,
    /// Answer outside the sampled domain too
    #[arg(long)]
    extrapolate: bool,
    #[command(flatten)]
    model: ModelFile,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Mechanics of the membrane: at the nodes in --vtu, --csv and --npz, their totals in the answer
    #[arg(long, value_enum, value_delimiter = ',', value_name = "FIELD,...")]
    fields: Vec<Field>,
    /// Write the table as CSV; with --fields a row for each instant and node instead of each instant
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write the nodes' positions, velocities and fields as arrays for NumPy
    #[arg(long, value_name = "FILE")]
    npz: Option<PathBuf>,
    /// Write the surfaces as a ParaView series (PVD and VTU) into this folder
    #[arg(long, value_name = "DIR")]
    vtu: Option<PathBuf>,
    /// Write the surface at the one instant of --t as binary STL
    #[arg(long, value_name = "FILE")]
    stl: Option<PathBuf>,
    /// Plot the sections z = 0 and y = z (.png or .svg)
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom predict --ca 0.10 --confinement 0.90 --t 0.4,3,6,9
  capsule-rom predict --ca 0.03 --confinement 1.10 --t 8 --method paper --json
  capsule-rom predict --ca 0.10 --confinement 0.90 --t 0,3,9 --vtu paraview/ --plot sections.svg
  capsule-rom predict --ca 0.05 --confinement 1.00 --t 5 --fields tension,load --vtu paraview/
  capsule-rom predict --ca 0.10 --confinement 0.90 --t 8 --stl capsule.stl
  capsule-rom predict --model data.crom --parameters flow_rate=1.2,stiffness=0.4 --t 0.5,1
  capsule-rom predict --model data.crom --parameters '\"Q, flow\"=1.2' --parameters G=0.4 --t 0.5,1

Capsules in the channel are computed in single precision: the same bits as in the browser and on a microcontroller. \
expected_error is the distance to the full-order model (with the law and the bending stiffness that the answer \
names) as a fraction of a: modified Hausdorff distance in the laboratory frame. 95 of 100 errors are below \
error_bound. With --extrapolate expected_error is a guess and there is no bound. Of a model of other people's data it \
is the mean distance of the nodes to their solution.";

#[derive(Clone, Copy, ValueEnum)]
pub enum MethodName {
    /// Interpolated coefficients, evaluated at the instant
    Direct,
    /// Algorithm 2 of the paper: local POD, learned manifold, forward Euler
    Paper,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Direct => Self::Direct,
            MethodName::Paper => Self::Paper,
        }
    }
}

/// The scalar in which a model is evaluated.
trait Precision: Real + Serialize {
    /// Parameters as they were given.
    fn parameters(given: &[f64]) -> Option<Parameters<Self>>;
}

impl Precision for f32 {
    fn parameters(given: &[f64]) -> Option<Parameters<Self>> {
        Parameters::from_doubles(given)
    }
}

impl Precision for f64 {
    fn parameters(given: &[f64]) -> Option<Parameters<Self>> {
        Parameters::new(given)
    }
}

#[derive(Serialize)]
struct Prediction<'a, T> {
    #[serde(skip_serializing_if = "Option::is_none")]
    ca: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    confinement: Option<f64>,
    parameters: BTreeMap<&'a str, f64>,
    units: Units<'a>,
    model_digest: String,
    method: &'static str,
    domain: &'static str,
    extrapolated: bool,
    errors_against: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    bending_effect: Option<BendingEffect>,
    instants: Vec<InstantRow<T>>,
}

#[derive(Serialize)]
struct InstantRow<T> {
    t: T,
    axial_length: T,
    half_width: T,
    half_diagonal: T,
    rear_depth: T,
    velocity: T,
    volume: T,
    expected_error: T,
    /// None outside the sampled domain.
    error_bound: Option<T>,
    #[serde(flatten)]
    totals: Option<Totals<T>>,
}

impl<T: Real> InstantRow<T> {
    /// The table's columns.
    fn cells(&self) -> Vec<(&'static str, Option<T>)> {
        let mut cells = vec![
            ("t", self.t),
            ("axial_length", self.axial_length),
            ("half_width", self.half_width),
            ("half_diagonal", self.half_diagonal),
            ("rear_depth", self.rear_depth),
            ("velocity", self.velocity),
            ("volume", self.volume),
            ("expected_error", self.expected_error),
        ];
        let mut totals = Vec::new();
        if let Some(found) = self.totals {
            totals.extend([
                ("area", found.area),
                ("energy", found.energy),
                ("pressure_drop", found.pressure_drop),
                ("max_stretch", found.max_stretch),
                ("max_tension", found.max_tension),
                ("min_tension", found.min_tension),
            ]);
        }
        let known = |(name, value)| (name, Some(value));
        let bound = [("error_bound", self.error_bound)];
        cells
            .drain(..)
            .map(known)
            .chain(bound)
            .chain(totals.into_iter().map(known))
            .collect()
    }
}

pub fn run(options: &Options) -> Result<()> {
    let outputs = Outputs::default()
        .reads("--model", options.model.path())
        .folder("--vtu", options.vtu.as_deref())
        .file("--csv", options.csv.as_deref())
        .file("--npz", options.npz.as_deref())
        .file("--stl", options.stl.as_deref())
        .figure("--plot", options.plot.as_deref())
        .checked()?;
    let times = rising(&options.t)?;
    ensure!(
        options.stl.is_none() || times.len() == 1,
        "--stl holds the surface at one instant: name one by --t instead of {}",
        times.len()
    );
    let bytes = options.model.read()?;
    let model = options.model.open(&bytes)?;
    match model.reference() {
        Reference::Sphere => answer::<f32>(options, &model, &times, outputs),
        Reference::Shape { .. } => answer::<f64>(options, &model, &times, outputs),
    }
}

fn answer<T: Precision>(options: &Options, model: &Model<'_>, times: &[f64], mut outputs: Outputs) -> Result<()> {
    let times: Vec<T> = times.iter().map(|t| T::from_f64(*t)).collect();
    let method = options.method.map_or(model.default_method(), Method::from);
    let parameters = options.query.of(model)?;
    let mut workspace = Box::new(Workspace::<T>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    let given = T::parameters(&parameters.values).context("the model has no parameters")?;
    let query = Query {
        extrapolate: options.extrapolate,
        ..Query::new(given, method)
    };
    let prepared = evaluator.prepare(&query);
    let domain = prepared.map_err(|error| anyhow!("{}", model.describe(error)))?;

    let mut mechanics = Mechanics::new(model, &options.fields, given.get(0))?;
    let instants = times
        .iter()
        .map(|&t| instant(&mut evaluator, mechanics.as_mut(), t))
        .collect::<Result<Vec<_>>>()?;
    let of_channel = |name: &str| {
        parameters
            .pairs()
            .find(|(known, _)| *known == name)
            .map(|(_, value)| value)
    };
    let units = model.units();
    let prediction = Prediction {
        ca: of_channel("capillary_number"),
        confinement: of_channel("confinement"),
        parameters: parameters.pairs().collect(),
        units,
        model_digest: model::digest(model),
        method: method_name(method),
        domain: domain.name(),
        extrapolated: domain != Domain::Inside,
        errors_against: model.errors_against().to_string(),
        bending_effect: bending_effect(model, &parameters.values),
        instants,
    };
    let title = format!(
        "{}, method {}, model {}; lengths in {}, velocities in {}, times in {}; errors against {}{}",
        parameters.text(),
        prediction.method,
        prediction.model_digest,
        units.length,
        units.velocity,
        units.time,
        prediction.errors_against,
        if prediction.extrapolated { "; EXTRAPOLATED" } else { "" },
    );
    let nodal_csv = options.csv.as_deref().filter(|_| mechanics.is_some());
    if options.vtu.is_some() || options.npz.is_some() || options.stl.is_some() || nodal_csv.is_some() {
        let surfaces = times
            .iter()
            .map(|&t| surface(model, &mut evaluator, mechanics.as_mut(), t))
            .collect::<Result<Vec<_>>>()?;
        let instants: Vec<_> = surfaces.iter().map(Surface::instant).collect();
        let mesh = database_mesh(model);
        if let Some(folder) = &options.vtu {
            outputs.write_into(folder, |folder| {
                Ok(vtu::Series::write(folder, "capsule", &mesh, &instants)?)
            })?;
        }
        if let Some(file) = &options.npz {
            outputs.write(file, |file| write_npz(file, &mesh, &instants))?;
        }
        if let (Some(file), [surface]) = (&options.stl, &surfaces[..]) {
            outputs.write(file, |file| stl::write(file, &mesh, &surface.positions))?;
        }
        if let Some(file) = nodal_csv {
            let title = format!("capsule-rom predict; {title}");
            outputs.write(file, |file| write_csv(file, &title, &instants))?;
        }
    }
    if let (Some(file), None) = (&options.csv, nodal_csv) {
        let text = instants_csv(&format!("capsule-rom predict; {title}"), &prediction.instants)?;
        outputs.write(file, |file| std::fs::write(file, text))?;
    }
    if let Some(file) = &options.plot {
        let query = parameters.text();
        outputs.write(file, |file| {
            outlines::plot(file, &mut evaluator, &times, &query, units.length)
        })?;
    }
    outputs.finish()?;
    if options.json {
        return print::json(&prediction);
    }
    println!("{title}");
    let rows: Vec<_> = prediction.instants.iter().map(InstantRow::cells).collect();
    let heading: Vec<_> = rows.iter().take(1).flatten().map(|(name, _)| *name).collect();
    let text = |value: &Option<T>| value.map_or("none".to_owned(), |value| shown(value.to_f64()));
    let row = |cells: &Vec<(_, _)>| cells.iter().map(|(_, value)| text(value)).collect();
    print::table(&heading, &rows.iter().map(row).collect::<Vec<_>>())?;
    if let Some(effect) = &prediction.bending_effect {
        println!("{effect}");
    }
    if prediction.extrapolated {
        println!(
            "Outside the sampled domain ({}): expected_error is a guess, and no bound is known.",
            prediction.domain
        );
    }
    Ok(())
}

/// A number for tables: five decimals, or scientific notation where these would show too few or too many digits.
fn shown(value: f64) -> String {
    if value == 0.0 || (1e-4..1e7).contains(&value.abs()) {
        format!("{value:.5}")
    } else {
        format!("{value:.5e}")
    }
}

/// The instants in rising order, each once, as a series must have them.
fn rising(given: &[f64]) -> Result<Vec<f64>> {
    for &t in given {
        ensure!(
            t.is_finite() && t >= 0.0,
            "--t {t}: an instant must be a finite number from 0 on"
        );
    }
    // Adding 0 turns -0 into 0.
    let mut times: Vec<f64> = given.iter().map(|t| t + 0.0).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    Ok(times)
}

/// The method's name in JSON and in tables.
pub fn method_name(method: Method) -> &'static str {
    match method {
        Method::Direct => "direct",
        Method::Paper => "paper",
    }
}

fn instant<T: Real>(
    evaluator: &mut Evaluator<'_, T>,
    mechanics: Option<&mut Mechanics<T>>,
    t: T,
) -> Result<InstantRow<T>> {
    let totals = mechanics.map(|mechanics| mechanics.totals(evaluator, t)).transpose()?;
    let mut instant = evaluator.at(t)?;
    let observables = instant.observables()?;
    Ok(InstantRow {
        t,
        axial_length: observables.axial_length,
        half_width: observables.half_width,
        half_diagonal: observables.half_diagonal,
        rear_depth: observables.rear_depth,
        velocity: observables.velocity,
        volume: instant.volume()?,
        expected_error: instant.expected_error()?,
        error_bound: match instant.error_bound() {
            Err(EvaluateError::NoBound) => None,
            bound => Some(bound?),
        },
        totals,
    })
}

fn instants_csv<T: Real>(title: &str, instants: &[InstantRow<T>]) -> Result<Vec<u8>> {
    let rows: Vec<_> = instants.iter().map(InstantRow::cells).collect();
    let heading = rows.iter().take(1).flatten().map(|(name, _)| *name);
    let text = |value: &Option<T>| value.map_or(String::new(), |value| value.to_string());
    let texts = |row: &Vec<(_, _)>| row.iter().map(|(_, value)| text(value)).collect::<Vec<_>>();
    Ok(table::csv(Some(title), heading, rows.iter().map(texts))?)
}

/// The model's mesh for the writers.
fn database_mesh(model: &Model<'_>) -> capsule_database::Mesh {
    let mesh = model.mesh();
    let reference = |node| mesh.reference(node).unwrap_or_default().map(f64::from);
    capsule_database::Mesh {
        nodes: (0..mesh.nodes()).map(reference).collect(),
        elements: mesh.elements().map(|element| element.map(u32::from)).collect(),
    }
}
