//! The description that all configurations of a database share: `database.json`.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::{DatabaseError, atomic, compact};

/// The format that this program reads and writes.
const VERSION: u64 = 2;

/// A parameter of the configurations.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Parameter {
    /// Its name, such as `capillary_number`.
    pub name: String,
    /// Its letters in file names, such as `ca`.
    pub symbol: String,
}

/// The description that all configurations share, stored in `database.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// The parameters, in the order of [`crate::Trajectory::parameters`].
    pub parameters: Vec<Parameter>,
    /// The instants at which a complete trajectory has snapshots, from 0 to the end time, in l/V.
    pub times: Vec<f64>,
    /// The settings of the solver.
    pub solver: Value,
}

/// The content of `database.json`.
#[derive(Serialize, Deserialize)]
struct File {
    format: String,
    version: u64,
    #[serde(flatten)]
    description: Description,
    units: Units,
    position_step: f64,
    velocity_step: f64,
}

#[derive(Serialize, Deserialize)]
struct Units {
    length: String,
    velocity: String,
    time: String,
    pressure: String,
}

impl Description {
    /// The description of a database over capillary number and confinement, (Ca, a/l).
    #[must_use]
    pub fn new(times: Vec<f64>, solver: Value) -> Self {
        let parameter = |name: &str, symbol: &str| Parameter {
            name: name.to_owned(),
            symbol: symbol.to_owned(),
        };
        let parameters = vec![parameter("capillary_number", "ca"), parameter("confinement", "al")];
        Description {
            parameters,
            times,
            solver,
        }
    }

    /// The bending stiffness of the membrane in G_s a^2, as far as the solver's settings tell.
    #[must_use]
    pub fn bending_stiffness(&self) -> Option<f64> {
        self.solver.pointer("/membrane/harmonics/bending")?.as_f64()
    }

    /// The law of the membrane. The solver's settings name every law but the neo-Hookean one.
    #[must_use]
    pub fn membrane_law(&self) -> &str {
        self.solver.get("law").and_then(Value::as_str).unwrap_or("neo-Hookean")
    }

    /// Writes `database.json` into `directory`.
    pub(crate) fn write(&self, directory: &Path) -> Result<(), DatabaseError> {
        let path = path(directory);
        let file = File {
            format: "capsule-database".to_owned(),
            version: VERSION,
            description: self.clone(),
            units: Units {
                length: "l".to_owned(),
                velocity: "V".to_owned(),
                time: "l/V".to_owned(),
                pressure: "mu V/l".to_owned(),
            },
            position_step: compact::POSITION_STEP,
            velocity_step: compact::VELOCITY_STEP,
        };
        let text = serde_json::to_string_pretty(&file).map_err(DatabaseError::json(&path))? + "\n";
        atomic::write(&path, text.as_bytes())
    }

    /// Reads the `database.json` of `directory`.
    pub(crate) fn read(directory: &Path) -> Result<Self, DatabaseError> {
        let path = path(directory);
        let text = match std::fs::read_to_string(&path) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                return Err(DatabaseError::NotADatabase {
                    path: directory.to_path_buf(),
                });
            }
            other => other.map_err(DatabaseError::io("read", &path))?,
        };
        let value: Value = serde_json::from_str(&text).map_err(DatabaseError::json(&path))?;
        let version = value.get("version").and_then(Value::as_u64);
        if let Some(found) = version.filter(|v| *v != VERSION) {
            return Err(DatabaseError::WrongVersion {
                path,
                found,
                supported: VERSION,
            });
        }
        let file: File = serde_json::from_value(value).map_err(DatabaseError::json(&path))?;
        Ok(file.description)
    }

    /// The first entry in which this description differs from another, such as `solver.duct.order`.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Option<Difference> {
        let value = |description: &Self| serde_json::to_value(description).unwrap_or_default();
        difference("", &value(self), &value(other))
    }
}

/// An entry in which two descriptions differ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// Its name, such as `solver.duct.order`.
    pub entry: String,
    /// Its value here.
    pub here: String,
    /// Its value there.
    pub there: String,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({} and {})", self.entry, self.here, self.there)
    }
}

fn path(directory: &Path) -> PathBuf {
    directory.join("database.json")
}

fn difference(name: &str, here: &Value, there: &Value) -> Option<Difference> {
    // A number that was read may be the neighbour of the one that was written.
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs();
    if here == there || matches!((here.as_f64(), there.as_f64()), (Some(a), Some(b)) if close(a, b)) {
        return None;
    }
    if let (Value::Array(a), Value::Array(b)) = (here, there)
        && a.len() == b.len()
    {
        let pairs = a.iter().zip(b).enumerate();
        return pairs
            .into_iter()
            .find_map(|(i, (a, b))| difference(&format!("{name}[{i}]"), a, b));
    }
    if let (Value::Object(a), Value::Object(b)) = (here, there) {
        return a.keys().chain(b.keys()).find_map(|key| {
            let name = if name.is_empty() {
                key.clone()
            } else {
                format!("{name}.{key}")
            };
            difference(
                &name,
                a.get(key).unwrap_or(&Value::Null),
                b.get(key).unwrap_or(&Value::Null),
            )
        });
    }
    let short = |value: &Value| match value {
        Value::Array(list) => format!("{} values", list.len()),
        Value::Null => "nothing".to_owned(),
        other => other.to_string(),
    };
    Some(Difference {
        entry: name.to_owned(),
        here: short(here),
        there: short(there),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_setting_that_differs_is_named() {
        let of = |solver| Description::new(vec![0.0, 0.1 + 0.2], solver);
        let (a, b) = (
            json!({ "duct": { "order": 8 }, "n": 0.1 }),
            json!({ "duct": { "order": 6 }, "n": 0.1 }),
        );
        assert_eq!(of(a.clone()).difference(&of(a.clone())), None);
        let difference = of(a.clone()).difference(&of(b)).unwrap().to_string();
        assert_eq!(difference, "solver.duct.order (8 and 6)");
        let more = json!({ "duct": { "order": 8 }, "n": 0.1, "bending": 0.5 });
        assert_eq!(
            of(a).difference(&of(more)).unwrap().to_string(),
            "solver.bending (nothing and 0.5)"
        );
    }

    #[test]
    fn the_law_is_neo_hookean_unless_another_is_named() {
        let law = |solver| Description::new(vec![0.0], solver).membrane_law().to_owned();
        assert_eq!(law(json!({ "mesh_frequency": 8 })), "neo-Hookean");
        assert_eq!(law(json!({ "law": "Skalak, C = 1" })), "Skalak, C = 1");
    }

    #[test]
    fn a_description_read_equals_the_one_written() {
        let directory = tempfile::tempdir().unwrap();
        let times = (0..=100).map(|i| f64::from(i) * 0.2).collect();
        let description = Description::new(times, json!({ "tolerance": 1e-5, "third": 1.0 / 3.0 }));
        description.write(directory.path()).unwrap();
        let read = Description::read(directory.path()).unwrap();
        assert_eq!(read.difference(&description), None);
    }
}
