//! Single or double precision of the far sums.

/// The precision of the sums over sources that are well away from their target. All else is in double precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub enum Precision {
    /// Pairs, and the stored inverse of the walls' operator, in single precision; sums of many in double. The velocity
    /// changes by 3e-7 V, under the load of a stiff membrane by 1e-6 V.
    #[default]
    Mixed,
    /// Double precision everywhere.
    Double,
}
