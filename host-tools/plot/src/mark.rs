//! Marks of a series.

/// How the points of a series are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Joined by straight lines.
    Line,
    /// As dots.
    Dots,
    /// As rings around what else is there.
    Rings,
}
