//! The instants that all series have.

use super::pvd::Series;
use super::{SAME_TIME, malformed};
use crate::DatabaseError;

/// Leaves in each series the instants that all have, and returns them, counted from 0.
///
/// # Errors
/// [`DatabaseError::Malformed`] for a series that starts at another time, or that shares fewer than two instants.
pub(super) fn common(series: &mut [Series], notes: &mut Vec<String>) -> Result<Vec<f64>, DatabaseError> {
    let largest = |one: &Series| {
        one.frames
            .iter()
            .fold(0.0, |largest: f64, frame| largest.max(frame.time.abs()))
    };
    let tolerance = SAME_TIME * series.iter().map(largest).fold(f64::INFINITY, f64::min);
    let first = series[0].path.display().to_string();
    let mut times: Vec<f64> = series[0].frames.iter().map(|frame| frame.time).collect();
    let start = times[0];
    for one in &*series {
        let begin = one.frames[0].time;
        if (begin - start).abs() > tolerance {
            let reason =
                format!("starts at t = {begin}, {first} at t = {start}; expected the same start of all series");
            return Err(malformed(&one.path, reason));
        }
        times.retain(|time| nearest(one, *time, tolerance).is_some());
        if times.len() < 2 {
            let (found, others) = (times.len(), words(&series[0]));
            let reason = format!(
                "has {found} of the instants that the series before it share; expected at least 2 that all have \
                 ({first} has {others})"
            );
            return Err(malformed(&one.path, reason));
        }
    }
    let most = series.iter().map(|one| one.frames.len()).max().unwrap_or(0);
    if most > times.len() {
        notes.push(format!(
            "of up to {most} instants the {} count that all series have",
            times.len()
        ));
    }
    if start.abs() > tolerance {
        notes.push(format!("all series start at t = {start}: times are counted from there"));
    }
    for one in &mut *series {
        let chosen = times.iter().filter_map(|time| nearest(one, *time, tolerance));
        one.frames = chosen.map(|index| one.frames[index].clone()).collect();
    }
    Ok(times.iter().map(|time| time - start).collect())
}

/// The frame nearest to a time, if it is the same time.
fn nearest(series: &Series, time: f64, tolerance: f64) -> Option<usize> {
    let distance = |index: &usize| (series.frames[*index].time - time).abs();
    let indices = 0..series.frames.len();
    let index = indices.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    (distance(&index) <= tolerance).then_some(index)
}

/// The first instants of a series.
fn words(series: &Series) -> String {
    let times = series.frames.iter().take(5).map(|frame| frame.time.to_string());
    let more = (series.frames.len() > 5).then(|| "...".to_owned());
    times.chain(more).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::super::pvd::Frame;
    use super::*;
    use std::path::PathBuf;

    fn series(name: &str, times: &[f64]) -> Series {
        let frame = |time: &f64| {
            let files = vec![PathBuf::from(format!("{name}{time}"))];
            Frame { time: *time, files }
        };
        Series {
            path: name.into(),
            frames: times.iter().map(frame).collect(),
        }
    }

    fn files(series: &Series) -> Vec<String> {
        let files = series.frames.iter().map(|frame| frame.files[0].display().to_string());
        files.collect()
    }

    #[test]
    fn times_that_text_has_rounded_are_the_same() {
        let mut all = [
            series("a", &[0.0, 1.0 / 3.0, 0.5, 2.0 / 3.0, 1.0]),
            series("b", &[0.0, 0.333333, 0.666667, 0.9, 1.0]),
        ];
        let mut notes = Vec::new();
        let times = common(&mut all, &mut notes).unwrap();
        assert_eq!(times, [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0]);
        assert_eq!(files(&all[1]), ["b0", "b0.333333", "b0.666667", "b1"]);
        assert!(
            notes.len() == 1 && notes[0].contains("up to 5 instants the 4"),
            "{notes:?}"
        );
    }

    #[test]
    fn a_long_series_does_not_blur_a_short_one() {
        let mut all = [series("a", &[0.0, 0.5, 1.0]), series("b", &[0.0, 0.4, 0.5, 1.0, 3e6])];
        assert_eq!(common(&mut all, &mut Vec::new()).unwrap(), [0.0, 0.5, 1.0]);
        assert_eq!(files(&all[1]), ["b0", "b0.5", "b1"]);
    }

    #[test]
    fn times_that_start_late_are_counted_from_there() {
        let mut notes = Vec::new();
        let times = common(
            &mut [series("a", &[5.0, 5.5, 6.0]), series("b", &[5.0, 5.5, 6.0])],
            &mut notes,
        );
        assert_eq!(times.unwrap(), [0.0, 0.5, 1.0]);
        assert!(notes.len() == 1 && notes[0].contains("t = 5"), "{notes:?}");
    }

    #[test]
    fn series_that_do_not_fit_are_named() {
        for (times, words) in [
            (&[0.5, 1.0][..], &["b: ", "starts at t = 0.5", "a at t = 0"][..]),
            (&[0.0, 0.7, 1.4], &["b: ", "has 1 of the instants", "a has 0, 0.5, 1"]),
            (&[0.0], &["b: ", "has 1 of the instants"]),
        ] {
            let mut all = [series("a", &[0.0, 0.5, 1.0]), series("b", times)];
            let error = common(&mut all, &mut Vec::new()).unwrap_err().to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
    }
}
