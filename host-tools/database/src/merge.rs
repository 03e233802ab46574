//! Several databases of the same settings as one.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::{Database, DatabaseError, Entry, Staging};

/// The parts of a database, checked to belong together, before they are written.
#[derive(Debug)]
pub struct Merge {
    parts: Vec<Database>,
    /// The configurations, each with the part that holds it.
    entries: BTreeMap<String, (Entry, usize)>,
    repeated: usize,
}

impl Merge {
    /// Reads all parts: same settings, same mesh, every file sound, and a configuration that is in several the same in
    /// all of them.
    ///
    /// # Errors
    /// [`DatabaseError::NothingToMerge`], [`DatabaseError::Different`] with the setting, [`DatabaseError::Conflict`]
    /// with the file, or an error of a part.
    pub fn gather(directories: &[PathBuf]) -> Result<Self, DatabaseError> {
        let parts: Vec<Database> = directories
            .iter()
            .map(|d| Database::open(d))
            .collect::<Result<_, _>>()?;
        let Some(first) = parts.first() else {
            return Err(DatabaseError::NothingToMerge);
        };
        let mut merge = Merge {
            entries: BTreeMap::new(),
            repeated: 0,
            parts: Vec::new(),
        };
        for (index, part) in parts.iter().enumerate() {
            if let Some(difference) = first.difference(part) {
                return Err(DatabaseError::Different {
                    path: part.directory().to_path_buf(),
                    difference,
                });
            }
            for entry in part.entries()? {
                if entry.snapshots > 0 {
                    part.read(&entry.parameters)?;
                }
                let Some((_, other)) = merge.entries.get(&entry.file) else {
                    merge.entries.insert(entry.file.clone(), (entry, index));
                    continue;
                };
                let paths = [&parts[*other], part].map(|part| part.directory().join(&entry.file));
                if bytes(&paths[0])? != bytes(&paths[1])? {
                    let [first, second] = paths;
                    return Err(DatabaseError::Conflict { first, second });
                }
                merge.repeated += 1;
            }
        }
        merge.parts = parts;
        Ok(merge)
    }

    /// The configurations of all parts, ascending in their files' names.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.entries.values().map(|(entry, _)| entry)
    }

    /// How many files were in several parts.
    #[must_use]
    pub fn repeated(&self) -> usize {
        self.repeated
    }

    /// Checks that a database can be made in `directory`: it must not exist or be empty.
    ///
    /// # Errors
    /// [`DatabaseError::Occupied`]
    pub fn check(directory: &Path) -> Result<(), DatabaseError> {
        let path = directory.to_path_buf();
        match std::fs::read_dir(directory).is_ok_and(|mut content| content.next().is_some()) {
            true => Err(DatabaseError::Occupied { path }),
            false => Ok(()),
        }
    }

    /// Writes the database to `directory`, which must not exist or be empty: whole or not at all.
    ///
    /// # Errors
    /// [`DatabaseError::Occupied`], or [`DatabaseError::Io`] when it cannot be written.
    pub fn write(&self, directory: &Path) -> Result<(), DatabaseError> {
        Self::check(directory)?;
        // An empty directory makes way, so that the whole appears by one renaming.
        let _ = std::fs::remove_dir(directory);
        let mut staging = Staging::default();
        let whole = staging.place(directory)?;
        std::fs::create_dir(&whole).map_err(DatabaseError::io("create", directory))?;
        let common = ["mesh.npz", "database.json"].map(|file| (file, 0));
        let files = self.entries.iter().map(|(file, (_, part))| (file.as_str(), *part));
        for (file, part) in files.chain(common) {
            let bytes = bytes(&self.parts[part].directory().join(file))?;
            std::fs::write(whole.join(file), bytes).map_err(DatabaseError::io("write", directory))?;
        }
        staging.finish()
    }
}

fn bytes(path: &Path) -> Result<Vec<u8>, DatabaseError> {
    std::fs::read(path).map_err(DatabaseError::io("read", path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::octahedral;
    use crate::trajectory::tests::relaxing;
    use crate::{Description, Status, Trajectory};

    fn part(directory: &Path, tolerance: f64) -> Database {
        let solver = serde_json::json!({ "integrator": { "tolerance": tolerance } });
        Database::create(directory, Description::new(vec![0.0, 0.2], solver), octahedral(2)).unwrap()
    }

    fn trajectory(capillary_number: f64, confinement: f64) -> Trajectory {
        Trajectory {
            parameters: vec![capillary_number, confinement],
            ..relaxing(&octahedral(2), &[0.0, 0.2])
        }
    }

    #[test]
    fn parts_become_the_database_that_was_never_parted() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let [whole, a, b] = ["whole", "a", "b"].map(|name| part(&at(name), 1e-5));
        for k in 0..6 {
            let one = trajectory(0.01 * f64::from(k + 1), 0.9);
            whole.write(&one).unwrap();
            if k % 2 == 0 { &a } else { &b }.write(&one).unwrap();
        }
        a.write(&trajectory(0.02, 0.9)).unwrap();
        b.write(&trajectory(0.03, 0.9)).unwrap();
        let merge = Merge::gather(&[at("a"), at("b")]).unwrap();
        assert_eq!((merge.entries().count(), merge.repeated()), (6, 2));
        merge.write(&at("merged")).unwrap();
        let merged = Database::open(&at("merged")).unwrap();
        assert_eq!(merged.digest().unwrap(), whole.digest().unwrap());
        assert_eq!(
            std::fs::read_dir(folder.path()).unwrap().count(),
            4,
            "nothing temporary is left"
        );
        assert!(matches!(
            merge.write(&at("merged")),
            Err(DatabaseError::Occupied { .. })
        ));
    }

    #[test]
    fn what_does_not_belong_together_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let gather = |parts: &[&str]| Merge::gather(&parts.iter().map(|p| at(p)).collect::<Vec<_>>()).unwrap_err();
        assert!(matches!(gather(&[]), DatabaseError::NothingToMerge));
        let a = part(&at("a"), 1e-5);
        a.write(&trajectory(0.1, 0.9)).unwrap();

        part(&at("tolerant"), 1e-4);
        let error = gather(&["a", "tolerant"]).to_string();
        assert!(
            error.contains("tolerant") && error.contains("solver.integrator.tolerance"),
            "{error}"
        );

        let description = part(&at("other"), 1e-5).description().clone();
        Database::create(&at("finer"), description, octahedral(3)).unwrap();
        assert!(gather(&["a", "finer"]).to_string().contains("mesh"));

        let changed = Trajectory {
            status: Status::Unsteady,
            ..trajectory(0.1, 0.9)
        };
        part(&at("b"), 1e-5).write(&changed).unwrap();
        let error = gather(&["a", "b"]).to_string();
        assert!(error.contains("ca0.1000_al0.9000.npz"), "{error}");

        let file = at("a").join("ca0.1000_al0.9000.npz");
        let whole = std::fs::read(&file).unwrap();
        std::fs::write(&file, &whole[..whole.len() / 2]).unwrap();
        assert!(matches!(gather(&["a"]), DatabaseError::Corrupt { .. }));
        assert!(matches!(gather(&["nowhere"]), DatabaseError::NotADatabase { .. }));
    }
}
