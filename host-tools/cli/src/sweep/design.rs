//! The configurations of a sweep: rows of equal confinement, by rising capillary number.

use anyhow::{Result, bail};
use capsule_fom::Configuration;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

use super::points;
use super::row::Row;
use super::rule::Rule;

#[derive(Args)]
pub struct DesignOptions {
    /// Design of experiment
    #[arg(long, value_enum)]
    design: Option<Named>,
    /// Capillary numbers of an own grid
    #[arg(
        long,
        value_delimiter = ',',
        allow_negative_numbers = true,
        conflicts_with = "design"
    )]
    ca: Vec<f64>,
    /// Confinements a/l of an own grid
    #[arg(
        long,
        value_delimiter = ',',
        allow_negative_numbers = true,
        conflicts_with = "design"
    )]
    confinement: Vec<f64>,
    /// Single configurations instead of a grid: a CSV file with the columns ca and confinement; `-` reads the standard
    /// input
    #[arg(long, value_name = "FILE", conflicts_with_all = ["design", "ca", "confinement", "beyond", "bracket"])]
    points: Option<PathBuf>,
    /// Grid points of a row to compute beyond the first one above its steady limit
    #[arg(long, default_value_t = 2, value_name = "N")]
    beyond: usize,
    /// Bracket the steady limit of each row to this width in Ca, by bisection; 0: do not
    #[arg(long, default_value_t = 0.002, value_name = "WIDTH", allow_negative_numbers = true)]
    bracket: f64,
    /// The i-th of n parts of the sweep, by rows: for n computers
    #[arg(long, value_name = "i/n", value_parser = Shard::parse)]
    shard: Option<Shard>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Named {
    /// The paper's grid: Ca 0.005, and 0.01 to 0.20 by 0.01; a/l 0.75 to 1.20 by 0.05
    Paper,
    /// The paper's grid and around it Ca 0.0025, 0.21, 0.22 and a/l 0.70, 1.25
    Full,
}

/// One of several parts of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shard {
    /// From 1 to `of`.
    index: usize,
    of: usize,
}

impl DesignOptions {
    /// Whether a design was named.
    pub fn is_given(&self) -> bool {
        self.design.is_some() || !self.ca.is_empty() || !self.confinement.is_empty() || self.points.is_some()
    }

    /// How rows end.
    pub fn rule(&self) -> Result<Rule> {
        if self.points.is_some() {
            return Ok(Rule::ALL);
        }
        // File names hold six decimals: a narrower bracket could not be told apart.
        if self.bracket != 0.0 && !(self.bracket >= 1e-5 && self.bracket.is_finite()) {
            bail!("--bracket is {}: it must be 0 or at least 1e-5", self.bracket);
        }
        Ok(Rule {
            beyond: self.beyond,
            bracket: self.bracket,
        })
    }

    /// The rows of the design, or of its part, by rising confinement.
    pub fn rows(&self) -> Result<Vec<Row>> {
        let rows = match &self.points {
            Some(file) => rows(points::read(file)?),
            None => self.grid()?,
        };
        Ok(rows
            .into_iter()
            .enumerate()
            .filter(|(index, _)| self.shard.is_none_or(|shard| shard.has(*index)))
            .map(|(_, row)| row)
            .collect())
    }

    /// The rows of a grid, by rising confinement.
    fn grid(&self) -> Result<Vec<Row>> {
        let own = !self.ca.is_empty() || !self.confinement.is_empty();
        let full = !own && !matches!(self.design, Some(Named::Paper));
        let grid = |given: &[f64], paper: Vec<f64>, ring: &[f64]| {
            let mut values = if given.is_empty() { paper } else { given.to_vec() };
            if full {
                values.extend(ring);
            }
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        let hundredths = |range: std::ops::RangeInclusive<i32>| range.map(|i| f64::from(i) / 100.0);
        let paper = std::iter::once(0.005).chain(hundredths(1..=20)).collect();
        let capillary_numbers = grid(&self.ca, paper, &[0.0025, 0.21, 0.22]);
        let paper = hundredths(75..=120).step_by(5).collect();
        let confinements = grid(&self.confinement, paper, &[0.70, 1.25]);
        for &capillary_number in &capillary_numbers {
            for &confinement in &confinements {
                Configuration {
                    capillary_number,
                    confinement,
                }
                .validate()?;
            }
        }
        let rows = confinements.into_iter().map(|confinement| Row {
            confinement,
            capillary_numbers: capillary_numbers.clone(),
        });
        Ok(rows.collect())
    }
}

/// Single configurations as rows, by rising confinement.
fn rows(mut points: Vec<Configuration>) -> Vec<Row> {
    points.sort_by(|a, b| {
        let by_confinement = a.confinement.total_cmp(&b.confinement);
        by_confinement.then(a.capillary_number.total_cmp(&b.capillary_number))
    });
    points.dedup();
    let row = |row: &[Configuration]| Row {
        confinement: row[0].confinement,
        capillary_numbers: row.iter().map(|c| c.capillary_number).collect(),
    };
    points
        .chunk_by(|a, b| a.confinement == b.confinement)
        .map(row)
        .collect()
}

impl Shard {
    fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/');
        let numbers = parts.and_then(|(i, n)| Some((i.trim().parse().ok()?, n.trim().parse().ok()?)));
        match numbers {
            Some((index, of)) if (1..=of).contains(&index) => Ok(Self { index, of }),
            _ => Err(format!(
                "\"{text}\" is no part of a sweep: it must be i/n with 1 <= i <= n, such as 2/8"
            )),
        }
    }

    /// Rows are dealt out in alternating order, because their cost varies steadily along the design.
    fn has(self, row: usize) -> bool {
        let place = row % (2 * self.of);
        let index = if place < self.of {
            place
        } else {
            2 * self.of - 1 - place
        };
        index + 1 == self.index
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        design: DesignOptions,
    }

    fn design(arguments: &str) -> DesignOptions {
        Command::parse_from(std::iter::once("sweep").chain(arguments.split_whitespace())).design
    }

    #[test]
    fn the_full_design_is_the_papers_and_a_ring() {
        let paper = design("--design paper").rows().unwrap();
        let full = design("").rows().unwrap();
        assert_eq!((paper.len(), paper[0].capillary_numbers.len()), (10, 21));
        assert_eq!((full.len(), full[0].capillary_numbers.len()), (12, 24));
        let ends = |values: &[f64]| (values[0], values[values.len() - 1]);
        assert_eq!((full[0].confinement, full[11].confinement), (0.70, 1.25));
        assert_eq!(ends(&full[0].capillary_numbers), (0.0025, 0.22));
        assert_eq!(ends(&paper[0].capillary_numbers), (0.005, 0.20));
        assert_eq!((paper[0].confinement, paper[9].confinement), (0.75, 1.20));
        assert_eq!(full[1..11].iter().map(|row| row.confinement).collect::<Vec<_>>(), {
            paper.iter().map(|row| row.confinement).collect::<Vec<_>>()
        });
    }

    #[test]
    fn an_own_grid_is_sorted_and_checked() {
        let rows = design("--ca 0.2,0.1,0.1 --confinement 0.9").rows().unwrap();
        assert_eq!(rows.len(), 1);
        assert_eq!(rows[0].capillary_numbers, [0.1, 0.2]);
        for bad in ["0", "-0.1", "NaN", "inf"] {
            let error = design(&format!("--ca {bad} --confinement 0.9")).rows().unwrap_err();
            assert!(error.to_string().contains("capillary number"), "{error}");
        }
    }

    #[test]
    fn shards_share_the_rows_evenly() {
        let all = design("").rows().unwrap();
        for of in [1, 2, 3, 5, 12, 40] {
            let parts: Vec<Vec<Row>> = (1..=of)
                .map(|i| design(&format!("--shard {i}/{of}")).rows().unwrap())
                .collect();
            let mut together: Vec<Row> = parts.iter().flatten().cloned().collect();
            together.sort_by(|a, b| a.confinement.total_cmp(&b.confinement));
            assert_eq!(together, all);
            let sizes = parts.iter().map(Vec::len);
            assert!(sizes.clone().max().unwrap() - sizes.min().unwrap() <= 1, "{of}");
        }
    }

    #[test]
    fn wrong_shards_are_refused() {
        for bad in ["0/3", "4/3", "1", "a/b", "1/0", "-1/3", ""] {
            assert!(Shard::parse(bad).unwrap_err().contains("1 <= i <= n"), "{bad}");
        }
        assert_eq!(Shard::parse("2/8"), Ok(Shard { index: 2, of: 8 }));
    }
}
