//! L D L^T solution of a symmetric positive definite system of three equations, written out: optimised for size, loops
//! over three numbers keep them in memory.

use crate::Real;

/// QuantizedRef a matrix, of which the upper half is read, and returns its solution operator: right-hand side to
/// solution. Directions with a pivot of 0 get the component 0.
pub(crate) fn factor<T: Real>([[a, b, c], [_, d, e], [_, _, f]]: [[T; 3]; 3]) -> impl Fn([T; 3]) -> [T; 3] {
    let a = reciprocal(a);
    let (l, m) = (a * b, a * c);
    let e = e - l * c;
    let d = reciprocal(d - l * b);
    let n = d * e;
    let f = reciprocal(f - m * c - n * e);
    move |[x, y, z]| {
        let y = y - l * x;
        let z = f * (z - m * x - n * y);
        let y = d * y - n * z;
        [a * x - l * y - m * z, y, z]
    }
}

/// 1/x, or 0 for 0.
pub(crate) fn reciprocal<T: Real>(x: T) -> T {
    if x > T::ZERO { T::ONE / x } else { T::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::dot_in_order;

    #[test]
    fn the_solution_satisfies_the_equations() {
        let matrix: [[f64; 3]; 3] = [[4.0, 1.0, -2.0], [1.0, 3.0, 0.5], [-2.0, 0.5, 5.0]];
        let right = [1.0, -2.0, 3.0];
        let x = factor(matrix)(right);
        for (row, right) in matrix.iter().zip(right) {
            assert!((dot_in_order(row, &x) - right).abs() < 1e-14);
        }
    }
}
