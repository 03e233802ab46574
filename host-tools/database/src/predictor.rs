//! A linear prediction with stored coefficients, exact in integers.
//!
//! A row of integers is predicted as a base row plus a combination of known columns. The combination that fits best in
//! the sense of least squares is found when a file is written; its coefficients are stored as multiples of 2^-24, and
//! the prediction is evaluated in 64-bit integers alone, so that every reader on every machine finds the same.

/// One vector of integers a node.
pub(crate) type Row = Vec<[i64; 3]>;

/// The coefficients are multiples of 2^-SHIFT.
const SHIFT: u32 = 24;

/// `base + round(sum of coefficient * column)`
pub(crate) fn predict(base: &Row, columns: &[Row], coefficients: &[i32]) -> Row {
    let mut sum = vec![[1i64 << (SHIFT - 1); 3]; base.len()];
    for (column, &coefficient) in columns.iter().zip(coefficients) {
        for (s, c) in sum.as_flattened_mut().iter_mut().zip(column.as_flattened()) {
            *s = s.wrapping_add(c.wrapping_mul(i64::from(coefficient)));
        }
    }
    for (s, b) in sum.as_flattened_mut().iter_mut().zip(base.as_flattened()) {
        *s = b.wrapping_add(*s >> SHIFT);
    }
    sum
}

/// The coefficients with which `base` plus the columns comes closest to `row`.
pub(crate) fn fit(row: &Row, base: &Row, columns: &[Row]) -> Vec<i32> {
    let size = columns.len();
    let target: Vec<f64> = row
        .as_flattened()
        .iter()
        .zip(base.as_flattened())
        .map(|(r, b)| r.wrapping_sub(*b) as f64)
        .collect();
    let product =
        |a: &[i64], b: &dyn Fn(usize) -> f64| a.iter().enumerate().map(|(i, v)| *v as f64 * b(i)).sum::<f64>();
    let mut matrix = vec![vec![0.0; size]; size];
    let mut solution = vec![0.0; size];
    for i in 0..size {
        let column = columns[i].as_flattened();
        solution[i] = product(column, &|k| target[k]);
        for j in 0..=i {
            let other = columns[j].as_flattened();
            matrix[i][j] = product(column, &|k| other[k] as f64);
            matrix[j][i] = matrix[i][j];
        }
        // The integers are rounded, so that a column says nothing about what is below one.
        matrix[i][i] += row.len() as f64;
    }
    solve(&mut matrix, &mut solution);
    solution
        .iter()
        .map(|c| (c * f64::from(1 << SHIFT)).round() as i32)
        .collect()
}

/// Solves a symmetric positive definite system in place.
fn solve(matrix: &mut [Vec<f64>], vector: &mut [f64]) {
    let size = vector.len();
    for k in 0..size {
        for i in k + 1..size {
            let factor = matrix[i][k] / matrix[k][k];
            for j in k..size {
                matrix[i][j] -= factor * matrix[k][j];
            }
            vector[i] -= factor * vector[k];
        }
    }
    for k in (0..size).rev() {
        let known: f64 = (k + 1..size).map(|j| matrix[k][j] * vector[j]).sum();
        vector[k] = (vector[k] - known) / matrix[k][k];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(frequency: f64) -> Row {
        (0..50)
            .map(|i| [0.0, 1.0, 2.0].map(|d| (1e5 * (frequency * f64::from(i) + d).sin()) as i64))
            .collect()
    }

    #[test]
    fn a_combination_of_the_columns_is_found() {
        let (base, columns) = (wave(0.3), [wave(0.7), wave(1.1)]);
        let row: Row = (0..50)
            .map(|i| std::array::from_fn(|d| base[i][d] + 2 * columns[0][i][d] - columns[1][i][d] / 2))
            .collect();
        let predicted = predict(&base, &columns, &fit(&row, &base, &columns));
        let worst = predicted.iter().flatten().zip(row.iter().flatten());
        assert!(worst.map(|(p, r)| (p - r).abs()).max() <= Some(1));
    }

    #[test]
    fn columns_that_depend_on_each_other_or_are_empty_do_no_harm() {
        let (base, row) = (wave(0.3), wave(0.4));
        let columns = [wave(0.4), wave(0.4), vec![[0; 3]; 50], wave(0.3)];
        let predicted = predict(&base, &columns, &fit(&row, &base, &columns));
        let worst = predicted.iter().flatten().zip(row.iter().flatten());
        assert!(worst.map(|(p, r)| (p - r).abs()).max() <= Some(2));
        assert_eq!(predict(&base, &[], &[]), base);
    }

    #[test]
    fn the_largest_integers_wrap_instead_of_failing() {
        let row = vec![[i64::MAX, i64::MIN, 1]];
        let columns = [vec![[i64::MIN, i64::MAX, i64::MAX]]];
        let coefficients = fit(&row, &vec![[0; 3]], &columns);
        predict(&row, &columns, &coefficients);
    }
}
