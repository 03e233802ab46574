//! The source of the snapshots for a model: a database of this project, or other people's data.

use crate::names;
use crate::outputs::Outputs;
use anyhow::{Context, Result, bail};
use capsule_database::{Collection, Database};
use capsule_offline::{Settings, Source, Split};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Args)]
pub struct SourceOptions {
    /// Folder of the snapshot database
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    /// Other people's data instead: a .npz or .h5 file, or a folder of VTU series with parameters.csv
    #[arg(long, value_name = "PATH", conflicts_with = "database")]
    pub from: Option<PathBuf>,
    /// Configurations of the database that take part
    #[arg(long, value_enum, default_value_t = Samples::All, conflicts_with = "from")]
    design: Samples,
    /// Split the domain of --from where the solution has a kink or a jump: samples there belong to both parts. The name
    /// may stand in quotes as in CSV
    #[arg(long, value_name = "NAME=VALUE", requires = "from")]
    split: Option<String>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Samples {
    /// All of the database
    All,
    /// Only the steady ones on the paper's grid, without the ring around it
    Paper,
}

/// Snapshots in memory or on the disk.
pub enum Snapshots {
    Database(Box<Database>),
    Collection(Collection),
}

impl SourceOptions {
    /// Inputs, as the checks of outputs need them.
    pub fn reads(&self, outputs: Outputs) -> Outputs {
        match &self.from {
            Some(from) => outputs.reads("--from", from.as_path()),
            None => outputs.reads("--database", self.database.as_path()),
        }
    }

    /// Opens the snapshots, with the default settings for them.
    pub fn open(&self) -> Result<(Snapshots, Settings)> {
        let Some(path) = &self.from else {
            let database = Database::open(&self.database)?;
            let settings = match self.design {
                Samples::All => Settings::of_database(&database),
                Samples::Paper => Settings::of_paper_design(),
            };
            return Ok((Snapshots::Database(Box::new(database)), settings));
        };
        let (collection, notes) = Collection::read(path)?;
        notes.iter().for_each(|note| eprintln!("warning: {note}"));
        let mut settings = Settings::of_collection(&collection)?;
        if let Some(text) = &self.split {
            settings.split = Some(split(text, &collection)?);
        }
        Ok((Snapshots::Collection(collection), settings))
    }
}

/// The split that `NAME=VALUE` asks for, between samples of the collection.
fn split(text: &str, collection: &Collection) -> Result<Split> {
    let names = &collection.parameter_names;
    let [(parameter, value)] = names::parse("--split", text, names)?[..] else {
        bail!("--split {text}: expected one NAME=VALUE");
    };
    Split::between(collection, parameter, value).with_context(|| format!("--split {text}"))
}

impl Snapshots {
    /// The source for the offline stage.
    pub fn source(&self) -> Source<'_> {
        match self {
            Snapshots::Database(database) => Source::Database(database),
            Snapshots::Collection(collection) => Source::Collection(collection),
        }
    }
}
