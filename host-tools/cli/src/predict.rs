//! `capsule-rom predict`: the reduced-order model at chosen instants.

use crate::fields::{self, Column, Field, Surface, Totals};
use crate::model::{self, ModelFile};
use crate::outputs::Outputs;
use crate::parameters::QueryOptions;
use crate::{outlines, print};
use anyhow::{Result, anyhow, ensure};
use capsule_core::mechanics::{self, Deformation, Stencil};
use capsule_core::model::wire::{Reference, Units};
use capsule_core::{EvaluateError, Evaluator, Frame, Method, Model, Nodes, Query, Scene, Workspace};
use capsule_database::fields::{write_csv, write_npz};
use capsule_database::{table, vtu};
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
    t: Vec<f32>,
    /// How the answer is computed [default: the model's]
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
    /// Plot the sections z = 0 and y = z (.png or .svg)
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom predict --ca 0.10 --confinement 0.90 --t 0.4,3,6,9
  capsule-rom predict --ca 0.03 --confinement 1.10 --t 8 --method paper --json
  capsule-rom predict --ca 0.10 --confinement 0.90 --t 0,0.4,3,6,9 --vtu paraview/ --csv table.csv --plot sections.png
  capsule-rom predict --ca 0.05 --confinement 1.00 --t 5 --fields tension,load,energy --vtu paraview/ --json
  capsule-rom predict --model data.crom --parameters flow_rate=1.2,stiffness=0.4 --t 0.5,1
  capsule-rom predict --model data.crom --parameters '\"Q, flow\"=1.2' --parameters stiffness=0.4 --t 0.5,1

Computed in single precision: the same bits as in the browser and on a microcontroller.
expected_error is a fraction of a (modified Hausdorff distance in the laboratory frame); 95 of 100 errors are below
error_bound.";

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

#[derive(Serialize)]
struct Prediction<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    ca: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    confinement: Option<f32>,
    parameters: BTreeMap<&'a str, f32>,
    units: Units<'a>,
    model_digest: String,
    method: &'static str,
    instants: Vec<InstantRow>,
}

#[derive(Serialize)]
struct InstantRow {
    t: f32,
    axial_length: f32,
    half_width: f32,
    half_diagonal: f32,
    rear_depth: f32,
    velocity: f32,
    volume: f32,
    expected_error: f32,
    error_bound: f32,
    #[serde(flatten)]
    totals: Option<Totals<f32>>,
}

impl InstantRow {
    /// The table's columns.
    fn cells(&self) -> Vec<(&'static str, f32)> {
        let mut cells = vec![
            ("t", self.t),
            ("axial_length", self.axial_length),
            ("half_width", self.half_width),
            ("half_diagonal", self.half_diagonal),
            ("rear_depth", self.rear_depth),
            ("velocity", self.velocity),
            ("volume", self.volume),
            ("expected_error", self.expected_error),
            ("error_bound", self.error_bound),
        ];
        if let Some(totals) = self.totals {
            cells.extend([
                ("area", totals.area),
                ("energy", totals.energy),
                ("pressure_drop", totals.pressure_drop),
                ("max_stretch", totals.max_stretch),
                ("max_tension", totals.max_tension),
                ("min_tension", totals.min_tension),
            ]);
        }
        cells
    }
}

pub fn run(options: &Options) -> Result<()> {
    let mut outputs = Outputs::default()
        .reads("--model", options.model.path())
        .folder("--vtu", options.vtu.as_deref())
        .file("--csv", options.csv.as_deref())
        .file("--npz", options.npz.as_deref())
        .figure("--plot", options.plot.as_deref())
        .checked()?;
    let times = rising(&options.t)?;
    let bytes = options.model.read()?;
    let model = options.model.open(&bytes)?;
    let method = options.method.map_or(model.contents().default_method, Method::from);
    let parameters = options.query.of(&model)?;
    let mut workspace = Box::new(Workspace::<f32>::new());
    let mut evaluator = Evaluator::new(&model, &mut workspace)?;
    let query = Query {
        extrapolate: options.extrapolate,
        ..Query::new(parameters.values, method)
    };
    let prepared = evaluator.prepare(&query);
    prepared.map_err(|error| anyhow!("{}", error.named(&model)))?;

    let mut mechanics = Mechanics::new(&model, &options.fields, parameters.values.get(0))?;
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
    let units = model.contents().metadata.units;
    let prediction = Prediction {
        ca: of_channel("capillary_number"),
        confinement: of_channel("confinement"),
        parameters: parameters.pairs().collect(),
        units,
        model_digest: model::digest(&model),
        method: method_name(method),
        instants,
    };
    let title = format!(
        "capsule-rom predict; {}; method {}; model {}; lengths in {}, velocities in {}, times in {}",
        parameters.text(),
        prediction.method,
        prediction.model_digest,
        units.length,
        units.velocity,
        units.time
    );
    let nodal_csv = options.csv.as_deref().filter(|_| mechanics.is_some());
    if options.vtu.is_some() || options.npz.is_some() || nodal_csv.is_some() {
        let surfaces = times
            .iter()
            .map(|&t| surface(&model, &mut evaluator, mechanics.as_mut(), t))
            .collect::<Result<Vec<_>>>()?;
        let instants: Vec<_> = surfaces.iter().map(Surface::instant).collect();
        let mesh = database_mesh(&model);
        if let Some(folder) = &options.vtu {
            outputs.write_into(folder, |folder| {
                Ok(vtu::Series::write(folder, "capsule", &mesh, &instants)?)
            })?;
        }
        if let Some(file) = &options.npz {
            outputs.write(file, |file| write_npz(file, &mesh, &instants))?;
        }
        if let Some(file) = nodal_csv {
            outputs.write(file, |file| write_csv(file, &title, &instants))?;
        }
    }
    if let (Some(file), None) = (&options.csv, nodal_csv) {
        let text = instants_csv(&title, &prediction.instants)?;
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
    println!(
        "{}, method {}, model {}; lengths in {}, velocities in {}, times in {}",
        parameters.text(),
        prediction.method,
        prediction.model_digest,
        units.length,
        units.velocity,
        units.time
    );
    let rows: Vec<_> = prediction.instants.iter().map(InstantRow::cells).collect();
    let heading: Vec<_> = rows.iter().take(1).flatten().map(|(name, _)| *name).collect();
    let row = |cells: &Vec<(_, f32)>| cells.iter().map(|(_, value)| format!("{value:.5}")).collect();
    print::table(&heading, &rows.iter().map(row).collect::<Vec<_>>())
}

/// The instants in rising order, each once, as a series must have them.
fn rising(given: &[f32]) -> Result<Vec<f32>> {
    for &t in given {
        ensure!(
            t.is_finite() && t >= 0.0,
            "--t {t}: an instant must be a finite number from 0 on"
        );
    }
    // The sum makes a 0 of a -0.
    let mut times: Vec<f32> = given.iter().map(|t| t + 0.0).collect();
    times.sort_by(f32::total_cmp);
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

fn instant(evaluator: &mut Evaluator<'_, f32>, mechanics: Option<&mut Mechanics>, t: f32) -> Result<InstantRow> {
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
        expected_error: instant.expected_error(),
        error_bound: instant.error_bound(),
        totals,
    })
}

/// The membrane's mechanics, if they are asked for.
struct Mechanics<'o> {
    fields: &'o [Field],
    capillary_number: f32,
    /// Of the sector's nodes.
    stencils: Vec<Stencil<f32>>,
    sector: Vec<[f32; 3]>,
}

impl<'o> Mechanics<'o> {
    fn new(model: &Model<'_>, fields: &'o [Field], capillary_number: f32) -> Result<Option<Self>> {
        if fields.is_empty() {
            return Ok(None);
        }
        if !matches!(model.contents().mesh.reference, Reference::Sphere) {
            return Err(EvaluateError::NoSphere.into());
        }
        let mesh = model.mesh();
        let nodes = mesh.sector_nodes();
        let stencils = nodes.iter().map(|node| Stencil::at(&mesh, node));
        Ok(Some(Self {
            fields,
            capillary_number,
            stencils: stencils.collect::<Result<_, _>>()?,
            sector: vec![[0.0; 3]; nodes.len()],
        }))
    }

    /// The deformations at the sector's nodes.
    fn deformations(&mut self, evaluator: &mut Evaluator<'_, f32>, t: f32) -> Result<Vec<Deformation<f32>>> {
        let membrane = evaluator.at(t)?.membrane(&mut self.sector)?;
        let deformations = self.stencils.iter().map(|stencil| membrane.deformation(stencil));
        Ok(deformations.collect::<Result<_, _>>()?)
    }

    fn totals(&mut self, evaluator: &mut Evaluator<'_, f32>, t: f32) -> Result<Totals<f32>> {
        let [max_stretch, max_tension, min_tension] = fields::extremes(&self.deformations(evaluator, t)?);
        let mechanics::Totals {
            area,
            energy,
            pressure_drop,
        } = evaluator.at(t)?.membrane(&mut self.sector)?.totals()?;
        Ok(Totals {
            area,
            energy,
            pressure_drop,
            max_stretch,
            max_tension,
            min_tension,
        })
    }
}

/// All nodes at an instant, with velocities and what is asked of the membrane.
fn surface(
    model: &Model<'_>,
    evaluator: &mut Evaluator<'_, f32>,
    mechanics: Option<&mut Mechanics>,
    t: f32,
) -> Result<Surface> {
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let mesh = model.mesh();
    let mut nodes = vec![[0.0_f32; 3]; mesh.nodes()];
    let mut instant = evaluator.at(t)?;
    instant.positions(&scene, &mut nodes)?;
    let positions = nodes.iter().map(|point| point.map(f64::from)).collect();
    instant.velocities(&scene, &mut nodes)?;
    let mut columns = vec![Column::vectors("velocity", nodes)];
    if let Some(mechanics) = mechanics {
        let sector = mechanics.deformations(evaluator, t)?;
        let carried = |(index, operation): (usize, u8)| sector[index].carried(operation);
        let full: Vec<_> = (0..mesh.nodes())
            .filter_map(|node| mesh.origin(node))
            .map(carried)
            .collect();
        let load = || Ok(full.iter().map(|at| at.load(mechanics.capillary_number)).collect());
        columns.extend(fields::columns(mechanics.fields, &full, load)?);
    }
    Ok(Surface {
        time: t.into(),
        positions,
        columns,
    })
}

fn instants_csv(title: &str, instants: &[InstantRow]) -> Result<Vec<u8>> {
    let rows: Vec<_> = instants.iter().map(InstantRow::cells).collect();
    let heading = rows.iter().take(1).flatten().map(|(name, _)| *name);
    let texts = |row: &Vec<(_, f32)>| row.iter().map(|(_, value)| value.to_string()).collect::<Vec<_>>();
    Ok(table::csv(Some(title), heading, rows.iter().map(texts))?)
}

/// The model's mesh as the writers take it.
fn database_mesh(model: &Model<'_>) -> capsule_database::Mesh {
    let mesh = model.mesh();
    let reference = |node| mesh.reference(node).unwrap_or_default().map(f64::from);
    capsule_database::Mesh {
        nodes: (0..mesh.nodes()).map(reference).collect(),
        elements: mesh.elements().map(|element| element.map(u32::from)).collect(),
    }
}
