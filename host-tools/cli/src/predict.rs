//! `capsule-rom predict`: the reduced-order model at chosen instants.

use crate::{model, outlines, print};
use anyhow::{Context, Result};
use capsule_core::{Evaluator, Frame, Method, Model, Nodes, Query, Scene, Workspace};
use capsule_database::vtu;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Capillary number Ca = mu V / G_s
    #[arg(long, allow_negative_numbers = true)]
    ca: f32,
    /// Confinement a/l
    #[arg(long, allow_negative_numbers = true)]
    confinement: f32,
    /// Instants, in l/V
    #[arg(long, value_delimiter = ',', required = true, allow_negative_numbers = true)]
    t: Vec<f32>,
    /// How the answer is computed [default: the model's]
    #[arg(long, value_enum)]
    method: Option<MethodName>,
    /// Answer outside the sampled domain too
    #[arg(long)]
    extrapolate: bool,
    /// Model file [default: the shipped model]
    #[arg(long)]
    model: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write the table as CSV
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
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

Computed in single precision: the same bits as in the browser and on a microcontroller.
expected_error is a fraction of a (modified Hausdorff distance in the laboratory frame).";

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
struct Prediction {
    ca: f32,
    confinement: f32,
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
}

impl InstantRow {
    const HEADING: [&'static str; 8] = [
        "t",
        "axial_length",
        "half_width",
        "half_diagonal",
        "rear_depth",
        "velocity",
        "volume",
        "expected_error",
    ];

    fn cells(&self) -> [f32; 8] {
        [
            self.t,
            self.axial_length,
            self.half_width,
            self.half_diagonal,
            self.rear_depth,
            self.velocity,
            self.volume,
            self.expected_error,
        ]
    }
}

pub fn run(options: &Options) -> Result<()> {
    let path = options.model.as_deref();
    let bytes = model::read(path)?;
    let model = model::open(&bytes, path)?;
    let method = options.method.map_or(model.contents().default_method, Method::from);
    let mut workspace = Box::new(Workspace::<f32>::new());
    let mut evaluator = Evaluator::new(&model, &mut workspace)?;
    evaluator.prepare(&Query {
        extrapolate: options.extrapolate,
        ..Query::new(options.ca, options.confinement, method)
    })?;

    let instants = options
        .t
        .iter()
        .map(|&t| instant(&mut evaluator, t))
        .collect::<Result<Vec<_>>>()?;
    let prediction = Prediction {
        ca: options.ca,
        confinement: options.confinement,
        model_digest: model::digest(&model),
        method: method_name(method),
        instants,
    };
    if let Some(file) = &options.csv {
        write_csv(file, &prediction)?;
    }
    if let Some(folder) = &options.vtu {
        write_vtu(folder, &model, &mut evaluator, &options.t)?;
    }
    if let Some(file) = &options.plot {
        outlines::plot(file, &mut evaluator, &options.t, options.ca, options.confinement)?;
    }
    if options.json {
        return print::json(&prediction);
    }
    println!(
        "Ca = {}, a/l = {}, method {}, model {}",
        prediction.ca, prediction.confinement, prediction.method, prediction.model_digest
    );
    let row = |instant: &InstantRow| instant.cells().iter().map(|value| format!("{value:.5}")).collect();
    print::table(
        &InstantRow::HEADING,
        &prediction.instants.iter().map(row).collect::<Vec<_>>(),
    )
}

/// The method's name in JSON and in tables.
pub fn method_name(method: Method) -> &'static str {
    match method {
        Method::Direct => "direct",
        Method::Paper => "paper",
    }
}

fn instant(evaluator: &mut Evaluator<'_, f32>, t: f32) -> Result<InstantRow> {
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
    })
}

fn write_csv(file: &Path, prediction: &Prediction) -> Result<()> {
    let mut text = format!(
        "# capsule-rom predict; Ca = {}; a/l = {}; method {}; model {}\n{}\n",
        prediction.ca,
        prediction.confinement,
        prediction.method,
        prediction.model_digest,
        InstantRow::HEADING.join(",")
    );
    for instant in &prediction.instants {
        let cells: Vec<String> = instant.cells().iter().map(f32::to_string).collect();
        text += &cells.join(",");
        text.push('\n');
    }
    std::fs::write(file, text).with_context(|| format!("could not write {}", file.display()))
}

fn write_vtu(folder: &Path, model: &Model<'_>, evaluator: &mut Evaluator<'_, f32>, times: &[f32]) -> Result<()> {
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let mesh = &model.contents().mesh;
    let mut nodes = vec![[0.0_f32; 3]; mesh.nodes as usize];
    let indices: Vec<u32> = mesh
        .elements
        .data
        .chunks_exact(2)
        .map(|pair| u32::from(u16::from_le_bytes([pair[0], pair[1]])))
        .collect();
    evaluator.at(0.0)?.positions(&scene, &mut nodes)?;
    let mesh = capsule_database::Mesh {
        nodes: wide(&nodes),
        elements: indices.as_chunks::<6>().0.to_vec(),
    };
    let mut series = vtu::Series::create(folder, "capsule")?;
    for &t in times {
        let mut instant = evaluator.at(t)?;
        instant.positions(&scene, &mut nodes)?;
        let positions = wide(&nodes);
        instant.velocities(&scene, &mut nodes)?;
        series.add(
            f64::from(t),
            &mesh,
            &positions,
            &[vtu::PointData::Vector("velocity", &wide(&nodes))],
        )?;
    }
    series.finish()?;
    Ok(())
}

fn wide(points: &[[f32; 3]]) -> Vec<[f64; 3]> {
    points.iter().map(|point| point.map(f64::from)).collect()
}
