//! The names of the errors: those of their variants, as JavaScript writes words.

use capsule_core::{EvaluateError, OpenError};

/// The name of a variant: "outside-domain" of `OutsideDomain { .. }`.
fn of_variant(error: &impl core::fmt::Debug) -> String {
    let text = format!("{error:?}");
    let mut name = String::new();
    for letter in text.chars().take_while(char::is_ascii_alphanumeric) {
        if letter.is_ascii_uppercase() && !name.is_empty() {
            name.push('-');
        }
        name.push(letter.to_ascii_lowercase());
    }
    name
}

#[test]
fn an_error_of_a_query_is_named_as_its_variant() {
    use EvaluateError::*;
    let (what, index, value, min, max) = ("t", 0, 1.0, 0.0, 1.0);
    for error in [
        Capacity {
            limit: "modes",
            required: 1,
            capacity: 0,
        },
        Value { what, value, min, max },
        ParameterCount { expected: 2, found: 1 },
        Parameter { index, value, min, max },
        UnknownParameter { index, count: 0 },
        NoDerivatives,
        OutsideDomain {
            index,
            value,
            range: [min, max],
        },
        FarFromSamples { ratio: 2.0 },
        BeyondExtrapolation {
            distance: 2.0,
            limit: 1.0,
        },
        BeyondSteadyLimit {
            capillary_number: 1.0,
            confinement: 1.0,
            limit: 0.5,
        },
        NoBound,
        WrongVolume { volume: 2.0, min, max },
        BeyondWall { reach: 2.0 },
        Weights { sum: 2.0 },
        NotPrepared,
        UnknownNode { node: 1, nodes: 1 },
        UnsupportedReference,
        StencilTooSmall { node: 1 },
        UnknownNodeSet,
        BufferTooShort { required: 3, found: 2 },
        NotFinite,
    ] {
        assert_eq!(error.name(), of_variant(&error));
    }
}

#[test]
fn an_error_of_a_file_is_named_as_its_variant() {
    use OpenError::*;
    let (what, expected, found) = ("modes", 2, 1);
    for error in [
        Truncated { expected, found },
        Magic { found: *b"RIFF" },
        Version { found: 1, supported: 2 },
        Checksum { expected: 2, found: 1 },
        Undecodable,
        TrailingBytes { found },
        Rows { what, expected, found },
        Columns { what, expected, found },
        Dimension { what, expected, found },
        Length { what, expected, found },
        Index {
            what,
            index: 0,
            value: 2,
            bound: 2,
        },
        Number {
            what,
            index: 0,
            value: 1.0,
            expected: "2",
        },
        Setting {
            what,
            value: 2.0,
            min: 0.0,
            max: 1.0,
        },
        NoImage { node: 1 },
        ShortOutline { name: what },
        DuplicateSample { first: 0, second: 1 },
    ] {
        assert_eq!(error.name(), of_variant(&error));
    }
}
