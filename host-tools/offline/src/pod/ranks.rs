//! How much of a decomposition a tolerance keeps.

/// Number of leading terms to keep, of `end`, so that the errors of the others sum to no more than a budget.
pub(super) fn trailing(end: usize, budget: f64, error: impl Fn(usize) -> f64) -> usize {
    let mut sum = 0.0;
    let within = (0..end).rev().take_while(|k| {
        sum += error(*k);
        sum <= budget
    });
    end - within.count()
}

/// The least rank beyond which the singular values add up to no more than the tolerance, root mean square over `count`.
pub(super) fn rank(values: &[f64], tolerance: f64, count: usize) -> usize {
    let budget = tolerance * tolerance * count as f64;
    let mut tail = 0.0;
    let dropped = values.iter().rev().take_while(|s| {
        tail += **s * **s;
        tail <= budget
    });
    values.len() - dropped.count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_gives_the_least_rank_that_keeps_it() {
        let values = [10.0, 3.0, 2.0, 1.0];
        let tail = |k: usize| (values[k..].iter().map(|s| s * s).sum::<f64>() / 7.0).sqrt();
        for k in 0..4 {
            assert_eq!(rank(&values, 1.0001 * tail(k), 7), k);
            assert_eq!(rank(&values, 0.9999 * tail(k), 7), k + 1);
        }
        assert_eq!(rank(&values, 0.0, 7), 4);
    }
}
