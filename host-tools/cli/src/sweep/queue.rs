//! State that the workers of a sweep share: the results so far, and the configurations in progress.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use capsule_database::Entry;
use capsule_fom::Configuration;

use super::row::Row;
use super::rule::Rule;

/// Hands out configurations, each once, lowest capillary number first over all rows.
pub struct Queue {
    rule: Rule,
    rows: Vec<Row>,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    /// Capillary number, confinement, and whether it is steady.
    results: Vec<(f64, f64, bool)>,
    running: Vec<(f64, f64)>,
    ended: bool,
}

/// Parameters this close are the same: file names hold six decimals.
const SAME: f64 = 5e-7;

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < SAME
}

impl Queue {
    /// A queue over rows, some of whose configurations a database may hold already.
    pub fn new(rule: Rule, rows: Vec<Row>, entries: &[Entry]) -> Self {
        let results = entries.iter().map(result).collect();
        Self {
            rule,
            rows,
            state: Mutex::new(State {
                results,
                ..State::default()
            }),
            changed: Condvar::new(),
        }
    }

    /// The next configuration; waits while the choice depends on one that is running. `None` when all are done or
    /// [`Queue::end`] was called.
    pub fn next(&self) -> Option<Configuration> {
        let mut state = self.lock();
        while !state.ended {
            let waiting = self.waiting(&state);
            let free = waiting.iter().find(|c| !state.runs(c)).copied();
            if let Some(configuration) = free {
                state
                    .running
                    .push((configuration.capillary_number, configuration.confinement));
                return Some(configuration);
            }
            if waiting.is_empty() {
                return None;
            }
            // The time-out is for Ctrl-C, which cannot signal.
            state = self
                .changed
                .wait_timeout(state, Duration::from_millis(100))
                .unwrap_or_else(PoisonError::into_inner)
                .0;
            if crate::interrupt::asked() {
                return None;
            }
        }
        None
    }

    /// Takes the result of a configuration.
    pub fn finish(&self, configuration: &Configuration, steady: bool) {
        let &Configuration {
            capillary_number,
            confinement,
        } = configuration;
        let mut state = self.lock();
        state
            .running
            .retain(|running| *running != (capillary_number, confinement));
        state.results.push((capillary_number, confinement, steady));
        drop(state);
        self.changed.notify_all();
    }

    /// Ends the sweep for all workers, because one failed.
    pub fn end(&self) {
        self.lock().ended = true;
        self.changed.notify_all();
    }

    /// Whether [`Queue::end`] was called.
    pub fn is_ended(&self) -> bool {
        self.lock().ended
    }

    /// How many configurations of these rows are done, and how many there are at most.
    pub fn count(&self) -> (usize, usize) {
        let state = self.lock();
        let rows = self.rows.iter();
        rows.fold((0, 0), |(done, all), row| {
            let known = state.results.iter().filter(|r| same(r.1, row.confinement)).count();
            let most = self.rule.at_most(row, &|ca| state.steady(ca, row.confinement));
            (done + known, all + most.max(known))
        })
    }

    /// The configurations that belong and have no result, lowest capillary number first.
    pub fn missing(&self) -> Vec<Configuration> {
        self.waiting(&self.lock())
    }

    fn waiting(&self, state: &State) -> Vec<Configuration> {
        let mut waiting: Vec<Configuration> = Vec::new();
        for row in &self.rows {
            let confinement = row.confinement;
            let wanted = self.rule.wanted(row, &|ca| state.steady(ca, confinement));
            waiting.extend(wanted.into_iter().map(|capillary_number| Configuration {
                capillary_number,
                confinement,
            }));
        }
        waiting.sort_by(|a, b| a.capillary_number.total_cmp(&b.capillary_number));
        waiting
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn result(entry: &Entry) -> (f64, f64, bool) {
    (entry.parameters[0], entry.parameters[1], entry.status.is_steady())
}

impl State {
    fn steady(&self, capillary_number: f64, confinement: f64) -> Option<bool> {
        let result = self
            .results
            .iter()
            .find(|(ca, a, _)| same(*ca, capillary_number) && same(*a, confinement));
        result.map(|(_, _, steady)| *steady)
    }

    fn runs(&self, configuration: &Configuration) -> bool {
        self.running
            .contains(&(configuration.capillary_number, configuration.confinement))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn queue() -> Queue {
        let rows = [0.8, 0.9].map(|confinement| Row {
            confinement,
            capillary_numbers: vec![0.1, 0.2, 0.3, 0.4, 0.5],
        });
        let rule = Rule {
            beyond: 1,
            bracket: 0.05,
        };
        Queue::new(rule, rows.to_vec(), &[])
    }

    #[test]
    fn workers_share_a_sweep_and_each_configuration_is_computed_once() {
        let queue = queue();
        let done = Mutex::new(Vec::new());
        std::thread::scope(|scope| {
            for _ in 0..3 {
                scope.spawn(|| {
                    while let Some(configuration) = queue.next() {
                        let Configuration {
                            capillary_number,
                            confinement,
                        } = configuration;
                        done.lock().unwrap().push((confinement, capillary_number));
                        queue.finish(&configuration, capillary_number < 0.27);
                    }
                });
            }
        });
        let mut done = done.into_inner().unwrap();
        done.sort_by(|a, b| a.partial_cmp(b).unwrap());
        let row = [0.1, 0.2, 0.25, 0.3, 0.4];
        let expected: Vec<(f64, f64)> = [0.8, 0.9].iter().flat_map(|a| row.map(|ca| (*a, ca))).collect();
        assert_eq!(done, expected);
        assert!(queue.missing().is_empty());
    }

    #[test]
    fn an_ended_queue_gives_nothing_more() {
        let queue = queue();
        assert_eq!(queue.next().map(|c| c.capillary_number), Some(0.1));
        queue.end();
        assert!(queue.next().is_none() && queue.is_ended());
    }
}
