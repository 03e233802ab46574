//! The made-up family on a grid of parameters, as a database.

use std::path::Path;

use capsule_database::{Database, Description};

use crate::support::{octahedral, trajectory};

/// A database of the family on a grid of five capillary numbers and five confinements, up to t = 2.
pub fn database(directory: &Path) -> Database {
    of_law(directory, "neo-Hookean")
}

/// The same with a membrane of another law.
pub fn of_law(directory: &Path, law: &str) -> Database {
    let description = Description::new(
        (0..=10).map(|i| 0.2 * f64::from(i)).collect(),
        serde_json::json!({ "family": "made up", "law": law }),
    );
    let database = Database::create(directory, description, octahedral(2)).unwrap();
    for ca in [0.02, 0.05, 0.08, 0.11, 0.14] {
        for a in [0.8, 0.85, 0.9, 0.95, 1.0] {
            database
                .write(&trajectory(database.mesh(), [ca, a], database.times()))
                .unwrap();
        }
    }
    database
}
