//! Scalars that describe the capsule at an instant.

/// Scalars of an instant, lengths in l, velocity in V; all from the two section outlines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observables<T> {
    /// max x - min x over both outlines.
    pub axial_length: T,
    /// max |y| in the plane z = 0.
    pub half_width: T,
    /// max sqrt(y^2 + z^2) in the plane y = z.
    pub half_diagonal: T,
    /// x of the rear pole on the axis - min x over both outlines, >= 0: the depth of the parachute.
    pub rear_depth: T,
    /// Axial velocity of the volume centroid.
    pub velocity: T,
    /// Axial position of the volume centroid in the laboratory frame.
    pub centroid: T,
}
