//! Where the snapshots for a model come from: our database, or other people's data.

use crate::parameters::Named;
use anyhow::{Context, Result};
use capsule_database::{Collection, Database};
use capsule_offline::{Settings, Source, Split};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub struct SourceOptions {
    /// Folder of the snapshot database
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    /// Other people's data instead: a .npz or .h5 file, or a folder of VTU series with parameters.csv
    #[arg(long, value_name = "PATH", conflicts_with = "database")]
    pub from: Option<PathBuf>,
    /// Split the domain of --from where the solution has a kink or a jump: samples there belong to both parts
    #[arg(long, value_name = "NAME=VALUE", requires = "from")]
    split: Option<Named>,
}

/// Snapshots in memory or on the disk.
pub enum Snapshots {
    Database(Box<Database>),
    Collection(Collection),
}

impl SourceOptions {
    /// Opens the snapshots; the settings are those that suit them.
    pub fn open(&self) -> Result<(Snapshots, Settings)> {
        let Some(path) = &self.from else {
            let database = Database::open(&self.database)?;
            return Ok((Snapshots::Database(Box::new(database)), Settings::default()));
        };
        let (collection, notes) = Collection::read(path)?;
        notes.iter().for_each(|note| eprintln!("warning: {note}"));
        let mut settings = Settings::of_collection(&collection)?;
        if let Some(Named { name, value }) = &self.split {
            let names = &collection.parameter_names;
            let parameter = names.iter().position(|known| known == name);
            settings.split = Some(Split {
                parameter: parameter
                    .with_context(|| format!("no parameter `{name}`: the parameters are {}", names.join(", ")))?,
                value: *value,
            });
        }
        Ok((Snapshots::Collection(collection), settings))
    }
}

impl Snapshots {
    /// As the offline stage takes them.
    pub fn source(&self) -> Source<'_> {
        match self {
            Snapshots::Database(database) => Source::Database(database),
            Snapshots::Collection(collection) => Source::Collection(collection),
        }
    }
}
