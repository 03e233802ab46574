//! Three-vectors.

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The greatest length; NaN if one is not a number.
pub(crate) fn greatest(field: impl Iterator<Item = [f64; 3]>) -> f64 {
    field.map(|v| dot(v, v).sqrt()).fold(0.0, |greatest, length| {
        if greatest >= length || greatest.is_nan() {
            greatest
        } else {
            length
        }
    })
}
