//! Where a row ends, and how its steady limit is bracketed.
//!
//! Above its steady limit a row has no steady state. It is followed to `beyond` grid points after the first one without
//! a steady state above one with; a single run that stops early between steady ones, or a film too thin at the lowest
//! capillary numbers, does not end it. Then the limit is bisected between the last steady grid point and the one after.
//!
//! The next configurations are a function of the known results, and none is chosen that might turn out not to belong:
//! the set of configurations does not depend on the order in which they are computed.

use super::row::Row;

/// How rows end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rule {
    /// How many grid points are computed beyond the first one above the limit.
    pub beyond: usize,
    /// The width to which the limit is bracketed; 0 for none.
    pub bracket: f64,
}

impl Rule {
    /// All that a row holds, whatever comes of it, and nothing else.
    pub const ALL: Self = Self {
        beyond: usize::MAX,
        bracket: 0.0,
    };

    /// The capillary numbers of a row that belong to the sweep for certain and whose result is not known. `steady`
    /// gives the results that are known. None are left only when the row is complete.
    pub fn wanted(&self, row: &Row, steady: &dyn Fn(f64) -> Option<bool>) -> Vec<f64> {
        let grid = self.certain(row, steady);
        let wanted: Vec<f64> = grid.iter().copied().filter(|ca| steady(*ca).is_none()).collect();
        if !wanted.is_empty() || self.bracket == 0.0 {
            return wanted;
        }
        let Some(last) = grid.iter().rposition(|ca| steady(*ca) == Some(true)) else {
            return wanted;
        };
        let (mut low, Some(&(mut high))) = (grid[last], grid.get(last + 1)) else {
            return wanted;
        };
        while high - low > self.bracket * (1.0 + 1e-9) {
            let middle = midpoint(low, high);
            match steady(middle) {
                None => return vec![middle],
                Some(true) => low = middle,
                Some(false) => high = middle,
            }
        }
        wanted
    }

    /// How many configurations the row has at most, as far as the results tell.
    pub fn at_most(&self, row: &Row, steady: &dyn Fn(f64) -> Option<bool>) -> usize {
        let known = |ca: f64| Some(steady(ca).unwrap_or(true));
        let grid = self.certain(row, &known).len();
        let bisections = |width: f64| (width / self.bracket).log2().ceil().max(0.0) as usize;
        match (self.bracket > 0.0, row.capillary_numbers.as_slice()) {
            (true, [.., before, last]) => grid + bisections(last - before),
            _ => grid,
        }
    }

    /// The grid points that belong whatever the unknown results are.
    fn certain<'a>(&self, row: &'a Row, steady: &dyn Fn(f64) -> Option<bool>) -> &'a [f64] {
        let (mut above_steady, mut without) = (false, 0);
        for (i, &ca) in row.capillary_numbers.iter().enumerate() {
            if without > self.beyond {
                return &row.capillary_numbers[..i];
            }
            let result = steady(ca);
            without = if above_steady && result != Some(true) {
                without + 1
            } else {
                0
            };
            above_steady |= result != Some(false);
        }
        &row.capillary_numbers
    }
}

/// To the six decimals that file names have.
fn midpoint(low: f64, high: f64) -> f64 {
    (0.5 * (low + high) * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    fn row() -> Row {
        Row {
            confinement: 1.0,
            capillary_numbers: (1..=12).map(|i| f64::from(i) / 100.0).collect(),
        }
    }

    /// Computes a row whose results are `truth`, taking of the wanted ones that which `choose` picks.
    fn complete(rule: Rule, truth: &dyn Fn(f64) -> bool, choose: &mut dyn FnMut(usize) -> usize) -> Vec<(u64, bool)> {
        let mut known: BTreeMap<u64, bool> = BTreeMap::new();
        loop {
            let wanted = rule.wanted(&row(), &|ca| known.get(&ca.to_bits()).copied());
            if wanted.is_empty() {
                return known.into_iter().collect();
            }
            let ca = wanted[choose(wanted.len())];
            assert!(known.insert(ca.to_bits(), truth(ca)).is_none(), "{ca} twice");
        }
    }

    const RULE: Rule = Rule {
        beyond: 2,
        bracket: 0.002,
    };

    fn values(known: &[(u64, bool)]) -> Vec<f64> {
        known.iter().map(|(bits, _)| f64::from_bits(*bits)).collect()
    }

    #[test]
    fn a_row_goes_beyond_its_limit_and_brackets_it() {
        let known = complete(RULE, &|ca| ca < 0.0537, &mut |_| 0);
        assert_eq!(
            values(&known),
            [0.01, 0.02, 0.03, 0.04, 0.05, 0.0525, 0.05375, 0.055, 0.06, 0.07, 0.08]
        );
        let steady: Vec<f64> = values(&known).into_iter().filter(|ca| *ca < 0.0537).collect();
        assert_eq!(steady.last(), Some(&0.0525));
        let plain = Rule {
            beyond: 0,
            bracket: 0.0,
        };
        assert_eq!(
            values(&complete(plain, &|ca| ca < 0.035, &mut |_| 0)),
            [0.01, 0.02, 0.03, 0.04]
        );
    }

    #[test]
    fn a_failure_below_the_limit_does_not_end_the_row() {
        // The film is too thin at the first two, and one stops early in between.
        let known = complete(RULE, &|ca| ca > 0.025 && ca < 0.105 && ca != 0.05, &mut |_| 0);
        let grid = values(&known).iter().filter(|ca| (**ca * 100.0).fract() < 1e-9).count();
        assert_eq!(known.len() - grid, 3);
        assert!(values(&known).contains(&0.12));
    }

    #[test]
    fn a_row_without_a_limit_is_the_grid() {
        assert_eq!(complete(RULE, &|_| true, &mut |_| 0).len(), 12);
        assert_eq!(complete(RULE, &|_| false, &mut |_| 0).len(), 12);
    }

    #[test]
    fn several_may_run_at_once() {
        assert_eq!(RULE.wanted(&row(), &|_| None), [0.01, 0.02, 0.03, 0.04]);
    }

    proptest! {
        #[test]
        fn the_set_does_not_depend_on_the_order(
            unsteady in proptest::collection::vec(any::<bool>(), 12),
            choices in proptest::collection::vec(any::<u16>(), 64),
            beyond in 0..4usize,
        ) {
            let rule = Rule { beyond, bracket: 0.002 };
            let truth = |ca: f64| !unsteady[(ca * 100.0 + 1e-6) as usize % 12];
            let first = complete(rule, &truth, &mut |_| 0);
            let mut k = 0;
            let other = complete(rule, &truth, &mut |n| { k += 1; usize::from(choices[k % 64]) % n });
            prop_assert_eq!(first, other);
        }
    }
}
