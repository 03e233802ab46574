//! The data that a model is built from.

use capsule_database::{Collection, Database};

/// Source of the samples of a model.
#[derive(Debug, Clone, Copy)]
pub enum Source<'a> {
    /// Capsules in the channel, over (Ca, a/l).
    Database(&'a Database),
    /// Other people's data.
    Collection(&'a Collection),
}

impl Source<'_> {
    /// The parameters' names.
    #[must_use]
    pub fn parameter_names(&self) -> Vec<String> {
        match self {
            Source::Database(database) => database
                .description()
                .parameters
                .iter()
                .map(|p| p.name.clone())
                .collect(),
            Source::Collection(collection) => collection.parameter_names.clone(),
        }
    }
}

impl<'a> From<&'a Database> for Source<'a> {
    fn from(database: &'a Database) -> Self {
        Source::Database(database)
    }
}

impl<'a> From<&'a Collection> for Source<'a> {
    fn from(collection: &'a Collection) -> Self {
        Source::Collection(collection)
    }
}
