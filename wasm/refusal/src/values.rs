//! The numbers and names in the text of an error of the core, in their order there and written as there.

use capsule_core::{EvaluateError, OpenError};

/// Of an error of a query; `name` gives those of the parameters, where they are known.
pub(crate) fn of_evaluation<'a>(error: &EvaluateError, name: impl Fn(usize) -> Option<&'a str>) -> Vec<String> {
    use EvaluateError as E;
    let name = |index: usize| name(index).map_or_else(|| format!("parameter {}", index + 1), str::to_owned);
    match *error {
        E::Capacity {
            limit,
            required,
            capacity,
        } => texts![required, limit, capacity],
        E::Value { what, value, min, max } => texts![what, value, min, max],
        E::Parameter { index, value, min, max } => texts![name(index), value, min, max],
        E::OutsideDomain {
            index,
            value,
            range: [min, max],
        } => texts![name(index), value, min, max],
        E::ParameterCount { expected, found } => texts![expected, found],
        E::UnknownParameter { index, count } => texts![index, count],
        E::FarFromSamples { ratio } => texts![format!("{ratio:.1}")],
        E::BeyondExtrapolation { distance, limit } => texts![format!("{distance:.1}"), limit],
        E::BeyondSteadyLimit {
            capillary_number,
            confinement,
            limit,
        } => texts![capillary_number, confinement, limit],
        E::WrongVolume { volume, min, max } => texts![volume, min, max],
        E::BeyondWall { reach } => texts![reach],
        E::Weights { sum } => texts![sum],
        E::UnknownNode { node, nodes } => texts![node, nodes],
        E::StencilTooSmall { node } => texts![node],
        E::BufferTooShort { required, found } => texts![found, required],
        _ => Vec::new(),
    }
}

/// Of a model file that is refused.
pub(crate) fn of_opening(error: &OpenError) -> Vec<String> {
    use OpenError as E;
    match *error {
        E::Truncated { expected, found } => texts![expected, found],
        E::Magic { found } => texts![format!("{found:02x?}")],
        E::Version { found, supported } => texts![found, supported],
        E::Checksum { expected, found } => texts![format!("{expected:08x}"), format!("{found:08x}")],
        E::TrailingBytes { found } => texts![found],
        E::Rows { what, expected, found }
        | E::Columns { what, expected, found }
        | E::Dimension { what, expected, found }
        | E::Length { what, expected, found } => texts![what, expected, found],
        E::Index {
            what,
            index,
            value,
            bound,
        } => texts![what, index, value, bound],
        E::Number {
            what,
            index,
            value,
            expected,
        } => texts![what, index, value, expected],
        E::Setting { what, value, min, max } => texts![what, value, min, max],
        E::NoImage { node } => texts![node],
        E::ShortOutline { name } => texts![name],
        E::DuplicateSample { first, second } => texts![first, second],
        _ => Vec::new(),
    }
}
