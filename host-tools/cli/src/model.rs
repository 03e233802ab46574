//! The model file that a command works with: the shipped one, or the user's.

use anyhow::{Context, Result};
use capsule_core::Model;
use capsule_model::SHIPPED;
use clap::Args;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// The model that a command works with.
#[derive(Args)]
pub struct ModelFile {
    /// Model file [default: the shipped model]
    #[arg(long = "model", value_name = "FILE")]
    path: Option<PathBuf>,
}

impl ModelFile {
    /// A file, or the shipped model.
    pub fn new(path: Option<PathBuf>) -> Self {
        Self { path }
    }

    /// The user's file.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// The bytes of the file, or of the shipped model.
    pub fn read(&self) -> Result<Cow<'static, [u8]>> {
        match &self.path {
            None => Ok(Cow::Borrowed(SHIPPED)),
            Some(path) => {
                Ok(Cow::Owned(std::fs::read(path).with_context(|| {
                    format!("could not read the model {}", path.display())
                })?))
            }
        }
    }

    /// The model in its bytes.
    pub fn open<'a>(&self, bytes: &'a [u8]) -> Result<Model<'a>> {
        Model::open(bytes)
            .map_err(anyhow::Error::new)
            .with_context(|| match &self.path {
                None => "the shipped model".to_owned(),
                Some(path) => format!("the model {}", path.display()),
            })
    }
}

/// The digest as eight hexadecimal digits.
pub fn digest(model: &Model<'_>) -> String {
    format!("{:08x}", model.digest())
}
