//! The outcome of a call, and a text for each.

use core::ffi::CStr;

/// Outcome of a call.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// A pointer is null.
    Null = 1,
    /// A pointer is not aligned for what it points to.
    Misaligned = 2,
    /// A buffer is too short: `found` entries or bytes, `least` are needed.
    Short = 3,
    /// Two of the pointers point to the same memory, one to write to points into the model's file, or a buffer goes
    /// beyond the end of memory.
    Overlap = 4,
    /// The model was not opened.
    NoModel = 5,
    /// The workspace was not initialised.
    NoWorkspace = 6,
    /// A method, frame, outline or index that does not exist: `found`, it must be at most `greatest`.
    Choice = 7,
    /// The number of parameters is not the model's: `found`, `least` are needed.
    ParameterCount = 8,

    /// The file is truncated: `found` bytes, `least` are needed.
    Truncated = 20,
    /// The file is no model: it does not start with "CROM".
    Magic = 21,
    /// The file has the format `found`; this library knows `greatest`.
    Version = 22,
    /// The file is damaged: its CRC-32 is `found`, `least` was written.
    Checksum = 23,
    /// The file does not decode as its format says.
    Undecodable = 24,
    /// `found` bytes follow the end of the model.
    TrailingBytes = 25,
    /// The file contradicts itself in `what`: `found`.
    Inconsistent = 26,

    /// The model has `found` of `what`; the workspace holds `greatest`.
    Capacity = 40,
    /// `what` is `found`; it must be between `least` and `greatest`.
    Value = 41,
    /// The parameters lie outside the sampled domain: `what` is `found`.
    OutsideDomain = 42,
    /// No steady state exists at the parameters: `found` is beyond the limit `greatest`.
    BeyondSteadyLimit = 43,
    /// The samples near the query are too close to each other: their weights sum to `found` instead of 1.
    Weights = 44,
    /// No query was prepared with this model in this workspace.
    NotPrepared = 45,
    /// Node `found` does not exist: the model has `greatest` nodes.
    UnknownNode = 46,
    /// The result is not finite: the parameters are too far from all samples.
    NotFinite = 47,
    /// The mechanics of the membrane is not that of the model: it needs the neo-Hookean law and a stress-free sphere.
    UnsupportedReference = 48,
    /// The model has no such outline.
    NoOutline = 49,
    /// The answer is extrapolated: no bound of its error is known.
    NoBound = 50,
    /// No capsule has the extrapolated shape: `what` is `found`, it must be between `least` and `greatest`.
    ImpossibleShape = 51,
    /// An error that this version of the interface has no name for.
    Other = 99,
}

impl Status {
    const TEXTS: [(Self, &CStr); 29] = [
        (Self::Ok, c"done"),
        (Self::Null, c"a pointer is null"),
        (Self::Misaligned, c"a pointer is not aligned for what it points to"),
        (Self::Short, c"a buffer is too short"),
        (
            Self::Overlap,
            c"a buffer shares memory with another or with the model's file, or goes beyond the end of memory",
        ),
        (Self::NoModel, c"the model was not opened"),
        (Self::NoWorkspace, c"the workspace was not initialised"),
        (Self::Choice, c"there is no such method, frame, outline or index"),
        (Self::ParameterCount, c"the model has another number of parameters"),
        (Self::Truncated, c"the model file is truncated"),
        (Self::Magic, c"not a model file: it does not start with \"CROM\""),
        (
            Self::Version,
            c"the model file has a format that this library does not know",
        ),
        (Self::Checksum, c"the model file is damaged: its CRC-32 is wrong"),
        (Self::Undecodable, c"the model file does not decode as its format says"),
        (Self::TrailingBytes, c"bytes follow the end of the model file"),
        (Self::Inconsistent, c"the model file contradicts itself"),
        (Self::Capacity, c"the model does not fit into the workspace"),
        (Self::Value, c"a number lies outside its range"),
        (Self::OutsideDomain, c"the parameters lie outside the sampled domain"),
        (Self::BeyondSteadyLimit, c"no steady state exists at the parameters"),
        (Self::Weights, c"the samples near the query are too close to each other"),
        (
            Self::NotPrepared,
            c"no query was prepared with this model in this workspace",
        ),
        (Self::UnknownNode, c"the model has no such node"),
        (
            Self::NotFinite,
            c"the result is not finite: the parameters are too far from all samples",
        ),
        (
            Self::UnsupportedReference,
            c"the model does not know the membrane's stress-free state",
        ),
        (Self::NoOutline, c"the model has no such outline"),
        (
            Self::NoBound,
            c"the answer is extrapolated: no bound of its error is known",
        ),
        (Self::ImpossibleShape, c"no capsule has the extrapolated shape"),
        (
            Self::Other,
            c"an error that this version of the interface has no name for",
        ),
    ];

    /// The status of a number; [`Other`](Self::Other) for one that has no meaning.
    pub(crate) fn from_number(number: u32) -> Self {
        let mut named = Self::TEXTS.iter().map(|(status, _)| *status);
        named.find(|status| *status as u32 == number).unwrap_or(Self::Other)
    }

    /// The meaning, as a sentence.
    pub fn text(self) -> &'static CStr {
        let named = Self::TEXTS.iter().find(|(status, _)| *status == self);
        named.map_or(c"", |(_, text)| text)
    }
}
