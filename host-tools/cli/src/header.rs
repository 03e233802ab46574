//! `capsule-rom header`: the dimensions of a model for the C preprocessor.

use crate::model::{ModelFile, digest};
use anyhow::Result;
use capsule_core::{Capacities, DIAGONAL, MIDPLANE, Model};
use clap::Args;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Model file [default: the shipped model]
    model: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom header models/capsule.crom > capsule_model.h
  capsule-rom header | grep NODES

The header is for buffers of a program in C or C++, beside capsule.h: core/capi/examples/static_buffers.c uses it.";

const INTRODUCTION: &str = "\
/* Dimensions of a model file, for buffers that are static. Written by `capsule-rom header`. */

#ifndef CAPSULE_MODEL_H
#define CAPSULE_MODEL_H
";

pub fn run(options: &Options) -> Result<()> {
    let model = ModelFile::new(options.model.clone());
    let bytes = model.read()?;
    let text = header(&model.open(&bytes)?)?;
    Ok(std::io::stdout().lock().write_all(text.as_bytes())?)
}

/// The header's text.
fn header(model: &Model<'_>) -> Result<String> {
    let (mesh, file) = (model.mesh(), model.file());
    let Capacities {
        modes,
        local_modes,
        neighbours,
    } = Capacities::of(model);
    let points = |outline| model.node_set(outline).map_or(0, |nodes| nodes.len());
    let samples: usize = model.clusters().map(|cluster| cluster.parameters().rows()).sum();
    let version = file.as_chunks::<4>().0.get(1).copied().unwrap_or_default();
    let lines = [
        (
            "CRC-32 of the content: capsule_description.digest",
            "DIGEST",
            format!("0x{}u", digest(model)),
        ),
        (
            "Version of the file format",
            "FORMAT_VERSION",
            u32::from_le_bytes(version).to_string(),
        ),
        ("Bytes of the file", "FILE_SIZE", file.len().to_string()),
        ("Constitutive law of the membrane", "LAW", literal(model.membrane_law())),
        (
            "Parameters of a query",
            "PARAMETERS",
            model.parameters().len().to_string(),
        ),
        (
            "The last instant, in the unit of time",
            "END_TIME",
            format!("{:?}f", model.end_time()),
        ),
        ("Stored instants", "INSTANTS", model.times().rows().to_string()),
        ("Samples of all clusters", "SAMPLES", samples.to_string()),
        (
            "Modes of a field, the translation included: at most CAPSULE_MAX_MODES",
            "MODES",
            modes.to_string(),
        ),
        (
            "Local modes of the paper's method: at most CAPSULE_MAX_LOCAL_MODES",
            "LOCAL_MODES",
            local_modes.to_string(),
        ),
        (
            "Samples that take part in a query: at most CAPSULE_MAX_NEIGHBOURS",
            "NEIGHBOURS",
            neighbours.to_string(),
        ),
        ("Elements of the surface", "ELEMENTS", mesh.elements().len().to_string()),
        (
            "Nodes of the surface: three numbers each in capsule_positions_at",
            "NODES",
            mesh.nodes().to_string(),
        ),
        (
            "Nodes that symmetry does not give: three numbers each in the scratch of capsule_membrane_at",
            "SECTOR_NODES",
            mesh.sector_nodes().len().to_string(),
        ),
        (
            "Points of CAPSULE_OUTLINE_MIDPLANE: two numbers each in capsule_outline_at",
            "MIDPLANE_POINTS",
            points(MIDPLANE).to_string(),
        ),
        (
            "Points of CAPSULE_OUTLINE_DIAGONAL",
            "DIAGONAL_POINTS",
            points(DIAGONAL).to_string(),
        ),
    ];
    let mut text = INTRODUCTION.to_owned();
    for (meaning, name, value) in lines {
        write!(text, "\n/* {meaning} */\n#define CAPSULE_MODEL_{name} {value}\n")?;
    }
    text.push_str("\n#endif\n");
    Ok(text)
}

/// A text as a string literal of C: what could end it, or mean something else, as octal numbers.
fn literal(text: &str) -> String {
    let character = |byte: u8| match byte {
        b' '..=b'~' if !b"\"\\?".contains(&byte) => char::from(byte).to_string(),
        _ => format!("\\{byte:03o}"),
    };
    let inside: String = text.bytes().map(character).collect();
    format!("\"{inside}\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_ends_its_literal() {
        assert_eq!(literal("neo-Hookean"), "\"neo-Hookean\"");
        assert_eq!(literal("a\"\\\n\u{e9}??/1"), r#""a\042\134\012\303\251\077\077/1""#);
    }
}
