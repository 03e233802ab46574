//! `capsule-rom fom shear`: a capsule in unbounded simple shear flow.

use crate::print;
use anyhow::Result;
use capsule_fom::{MembraneLaw, shear};
use clap::Args;
use serde::Serialize;

#[derive(Args)]
#[command(after_help = "Example:\n  capsule-rom fom shear --ca 0.3 --json")]
pub struct Options {
    /// Capillary number Ca = mu a (shear rate) / G_s
    #[arg(long, allow_negative_numbers = true)]
    ca: f64,
    /// Law of the membrane: neo-hookean or skalak:C
    #[arg(long, default_value = "neo-hookean")]
    law: MembraneLaw,
    /// Mesh frequency n: 8 n^2 elements
    #[arg(long, default_value_t = 8)]
    mesh: usize,
    /// Last instant, as a multiple of 1 / (shear rate)
    #[arg(long, default_value_t = 4.0)]
    end_time: f64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Shear {
    ca: f64,
    law: MembraneLaw,
    mesh: usize,
    t: Vec<f64>,
    taylor_deformation: Vec<f64>,
    inclination: Vec<f64>,
}

pub fn run(options: &Options) -> Result<()> {
    let settings = shear::Settings {
        mesh_frequency: options.mesh,
        law: options.law,
        end_time: options.end_time,
        ..Default::default()
    };
    let outcome = shear::shear(options.ca, &settings)?;
    if options.json {
        return print::json(&Shear {
            ca: options.ca,
            law: options.law,
            mesh: options.mesh,
            t: outcome.t,
            taylor_deformation: outcome.taylor_deformation,
            inclination: outcome.inclination,
        });
    }
    let rows: Vec<Vec<String>> = (0..outcome.t.len())
        .map(|i| {
            [outcome.t[i], outcome.taylor_deformation[i], outcome.inclination[i]]
                .iter()
                .map(|value| format!("{value:.4}"))
                .collect()
        })
        .collect();
    print::table(&["t", "taylor_deformation", "inclination"], &rows)
}
