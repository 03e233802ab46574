//! The parameters of a query, as the command line gives them.

use crate::names;
use anyhow::{Context, Result, bail};
use capsule_core::Model;
use clap::Args;

#[derive(Args)]
pub struct QueryOptions {
    /// Capillary number Ca = mu V / G_s
    #[arg(long, allow_negative_numbers = true, required_unless_present = "parameters")]
    ca: Option<f64>,
    /// Confinement a/l
    #[arg(long, allow_negative_numbers = true, required_unless_present = "parameters")]
    confinement: Option<f64>,
    /// Parameters of a model of other people's data, by the names that it gives them; may be repeated, and a name may
    /// stand in quotes as in CSV
    #[arg(long, value_name = "NAME=VALUE,...", conflicts_with_all = ["ca", "confinement"])]
    parameters: Vec<String>,
}

/// Parameters with their names, in the model's order.
pub struct NamedParameters {
    pub names: Vec<String>,
    pub values: Vec<f64>,
}

impl QueryOptions {
    /// The parameters of the model, in its order.
    pub fn of(&self, model: &Model<'_>) -> Result<NamedParameters> {
        let ranges = model.parameters();
        let names: Vec<String> = ranges.iter().map(|range| range.name.to_owned()).collect();
        let mut given = Vec::new();
        for text in &self.parameters {
            given.extend(names::parse("--parameters", text, &names)?);
        }
        let own = [("capillary_number", self.ca), ("confinement", self.confinement)];
        for (name, value) in own.into_iter().filter_map(|(name, value)| Some((name, value?))) {
            let index = names.iter().position(|known| known == name);
            let index = index.with_context(|| {
                format!(
                    "the model has no parameter `{name}`: give its own by --parameters, {}",
                    names::listed(&names)
                )
            })?;
            given.push((index, value));
        }
        let value = |(index, name): (usize, &String)| {
            let mut found = given.iter().filter(|(other, _)| *other == index);
            match (found.next(), found.next()) {
                (Some((_, value)), None) => Ok(*value),
                (None, _) => bail!(
                    "parameter `{name}` is missing: the parameters are {}",
                    names::listed(&names)
                ),
                (Some(_), Some(_)) => bail!("parameter `{name}` is given twice"),
            }
        };
        let values: Vec<f64> = names.iter().enumerate().map(value).collect::<Result<_>>()?;
        Ok(NamedParameters { names, values })
    }
}

impl NamedParameters {
    /// Each name with its value.
    pub fn pairs(&self) -> impl Iterator<Item = (&str, f64)> {
        self.names.iter().map(String::as_str).zip(self.values.iter().copied())
    }

    /// As text, with the symbols of the channel's parameters.
    pub fn text(&self) -> String {
        let word = |(name, value): (&str, f64)| match name {
            "capillary_number" => format!("Ca = {value}"),
            "confinement" => format!("a/l = {value}"),
            name => format!("{name} = {value}"),
        };
        self.pairs().map(word).collect::<Vec<_>>().join(", ")
    }
}
