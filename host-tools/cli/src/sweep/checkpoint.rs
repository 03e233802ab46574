//! Checkpoints of interrupted runs, in a hidden folder of the database, where no file counts as data.

use anyhow::{Context, Result};
use capsule_database::Database;
use capsule_fom::{Configuration, Run, Settings};
use std::path::{Path, PathBuf};

/// The interrupted runs of one database under one solver.
pub struct Checkpoints {
    folder: PathBuf,
    /// Program and settings; a run is resumed only if they agree.
    solver: String,
}

impl Checkpoints {
    /// Those of a database.
    pub fn new(database: &Database, settings: &Settings) -> Result<Self> {
        let settings = serde_json::to_string(settings).context("could not record the solver's settings")?;
        Ok(Self {
            folder: database.directory().join(".interrupted"),
            solver: format!("{} {settings}", env!("CARGO_PKG_VERSION")),
        })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The interrupted run of a configuration, if there is a valid one by the same program and settings.
    pub fn read(&self, configuration: &Configuration) -> Option<Run> {
        let bytes = std::fs::read(self.file(configuration)).ok()?;
        let (solver, run): (String, Run) = postcard::from_bytes(&bytes).ok()?;
        (solver == self.solver && run.configuration() == configuration).then_some(run)
    }

    /// Saves an interrupted run.
    pub fn save(&self, run: &Run) -> Result<()> {
        let file = self.file(run.configuration());
        let bytes = postcard::to_stdvec(&(&self.solver, run)).context("could not encode an interrupted run")?;
        std::fs::create_dir_all(&self.folder).with_context(|| format!("cannot create {}", self.folder.display()))?;
        Ok(capsule_database::write_whole(&file, &bytes)?)
    }

    /// Forgets the run of a configuration, which has ended, and the folder with the last one.
    pub fn forget(&self, configuration: &Configuration) {
        // A missing file need not be removed, and a folder that is not empty stays.
        let _ = std::fs::remove_file(self.file(configuration));
        let _ = std::fs::remove_dir(&self.folder);
    }

    fn file(&self, configuration: &Configuration) -> PathBuf {
        let &Configuration {
            capillary_number,
            confinement,
        } = configuration;
        self.folder.join(format!("ca{capillary_number}_al{confinement}.run"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record;
    use capsule_fom::Solver;
    use capsule_fom::flow::DuctSettings;

    #[test]
    fn a_run_is_found_again_by_the_same_solver_alone() {
        let folder = tempfile::tempdir().unwrap();
        let settings = Settings {
            mesh_frequency: 2,
            duct: DuctSettings::coarse(),
            ..Settings::default()
        };
        let solver = Solver::new(settings.clone()).unwrap();
        let description = record::description(&settings).unwrap();
        let database = Database::create(folder.path(), description, record::mesh(&solver)).unwrap();
        let configuration = Configuration {
            capillary_number: 0.1,
            confinement: 0.8,
        };
        let digest = database.digest().unwrap();
        let checkpoints = Checkpoints::new(&database, &settings).unwrap();
        assert!(checkpoints.read(&configuration).is_none());
        let run = solver.start(&configuration).unwrap();
        checkpoints.save(&run).unwrap();
        assert_eq!(checkpoints.read(&configuration), Some(run));
        assert_eq!(database.digest().unwrap(), digest);
        assert!(database.entries().unwrap().is_empty());

        let others = Settings {
            end_time: 3.0,
            ..settings.clone()
        };
        let others = Checkpoints::new(&database, &others).unwrap();
        assert!(others.read(&configuration).is_none());
        let file = checkpoints.file(&configuration);
        let bytes = std::fs::read(&file).unwrap();
        std::fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
        assert!(checkpoints.read(&configuration).is_none());
        checkpoints.forget(&configuration);
        assert!(!checkpoints.folder().exists());
    }
}
