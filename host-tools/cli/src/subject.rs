//! What the studies of stability and of the report are about: options that both have.

use crate::model::ModelFile;
use crate::outputs::Outputs;
use anyhow::Result;
use capsule_database::Database;
use capsule_study::stability::Subject;
use clap::Args;
use std::borrow::Cow;
use std::path::PathBuf;

#[derive(Args)]
pub struct SubjectOptions {
    #[command(flatten)]
    model: ModelFile,
    /// Folder of the snapshot database
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    /// Folder of the configurations that the model does not contain
    #[arg(long, value_name = "DIR", default_value = "models/test-set")]
    tests: PathBuf,
    /// A minute instead of several, on a part of the data
    #[arg(long)]
    quick: bool,
}

/// The files that are named by the options.
pub struct Files {
    model: Cow<'static, [u8]>,
    database: Database,
    tests: Database,
    quick: bool,
}

impl SubjectOptions {
    /// Inputs, as the checks of outputs need them.
    pub fn reads(&self, outputs: Outputs) -> Outputs {
        outputs
            .reads("--model", self.model.path())
            .reads("--database", self.database.as_path())
            .reads("--tests", self.tests.as_path())
    }

    /// Opens them.
    pub fn open(&self) -> Result<Files> {
        Ok(Files {
            model: self.model.read()?,
            database: Database::open(&self.database)?,
            tests: Database::open(&self.tests)?,
            quick: self.quick,
        })
    }
}

impl Files {
    pub fn subject(&self) -> Subject<'_> {
        Subject {
            model: &self.model,
            database: &self.database,
            tests: &self.tests,
            quick: self.quick,
        }
    }
}
