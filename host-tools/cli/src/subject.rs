//! Options that `study stability` and `study report` share: the model and the data.

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
    /// Folder of the test set, configurations that are not samples of the model
    #[arg(long, value_name = "DIR", default_value = "models/test-set")]
    tests: PathBuf,
    /// Use a part of the data: one minute instead of several
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
