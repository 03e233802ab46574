//! Tolerances within which numbers count as equal.

/// Instants (l/V) closer than this are the same.
pub(crate) const SAME_TIME: f64 = 1e-9;

/// Confinements, or values of another parameter, closer than this are the same row of the design.
pub(crate) const SAME_ROW: f64 = 1e-6;

/// A field is symmetric if no component deviates by more (l or V). Databases keep fields to 2.4e-7.
pub(crate) const SYMMETRIC: f64 = 1e-6;

/// A node lies on a plane if its distance is less than this share of the radius.
pub(crate) const ON_PLANE: f64 = 1e-9;
