//! The parameters of a query and the values at which a domain is split, as the command line gives them.

use anyhow::{Context, Result, bail};
use capsule_core::{Model, Parameters};
use clap::Args;
use std::str::FromStr;

/// A named number: `NAME=VALUE`.
#[derive(Clone, Debug)]
pub struct Named {
    pub name: String,
    pub value: f64,
}

impl FromStr for Named {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
        let value = value.trim().parse().map_err(|_| format!("`{value}` is not a number"))?;
        Ok(Self {
            name: name.trim().to_owned(),
            value,
        })
    }
}

#[derive(Args)]
pub struct QueryOptions {
    /// Capillary number Ca = mu V / G_s
    #[arg(long, allow_negative_numbers = true, required_unless_present = "parameters")]
    ca: Option<f64>,
    /// Confinement a/l
    #[arg(long, allow_negative_numbers = true, required_unless_present = "parameters")]
    confinement: Option<f64>,
    /// Parameters of a model of other people's data, by the names that it gives them
    #[arg(long, value_name = "NAME=VALUE,...", value_delimiter = ',', conflicts_with_all = ["ca", "confinement"])]
    parameters: Vec<Named>,
}

/// Parameters with their names, in the model's order.
pub struct NamedParameters {
    pub names: Vec<String>,
    pub values: Parameters<f32>,
}

impl QueryOptions {
    /// The parameters that the model asks for.
    pub fn of(&self, model: &Model<'_>) -> Result<NamedParameters> {
        let own = [("capillary_number", self.ca), ("confinement", self.confinement)];
        let own = own.into_iter().filter_map(|(name, value)| Some((name, value?)));
        let given: Vec<(&str, f64)> = self
            .parameters
            .iter()
            .map(|named| (named.name.as_str(), named.value))
            .chain(own)
            .collect();
        let ranges = &model.contents().metadata.parameters;
        let names: Vec<String> = ranges.iter().map(|range| range.name.to_owned()).collect();
        if let Some((name, _)) = given.iter().find(|(name, _)| !names.iter().any(|known| known == name)) {
            bail!(
                "the model has no parameter `{name}`: its parameters are {}",
                names.join(", ")
            );
        }
        let value = |name: &String| {
            let mut found = given.iter().filter(|(known, _)| known == name);
            match (found.next(), found.next()) {
                (Some((_, value)), None) => Ok(*value as f32),
                (None, _) => bail!(
                    "parameter `{name}` is missing: give --parameters {}",
                    names.join("=...,") + "=..."
                ),
                (Some(_), Some(_)) => bail!("parameter `{name}` is given twice"),
            }
        };
        let values: Vec<f32> = names.iter().map(value).collect::<Result<_>>()?;
        let values = Parameters::new(&values).context("the model has no parameters")?;
        Ok(NamedParameters { names, values })
    }
}

impl NamedParameters {
    /// Each name with its value.
    pub fn pairs(&self) -> impl Iterator<Item = (&str, f32)> {
        self.names
            .iter()
            .map(String::as_str)
            .zip(self.values.as_slice().iter().copied())
    }

    /// In words, with the letters of the channel's parameters.
    pub fn text(&self) -> String {
        let word = |(name, value): (&str, f32)| match name {
            "capillary_number" => format!("Ca = {value}"),
            "confinement" => format!("a/l = {value}"),
            name => format!("{name} = {value}"),
        };
        self.pairs().map(word).collect::<Vec<_>>().join(", ")
    }
}
