//! Progress bars: hidden when asked to be quiet or when the standard error is not a terminal.

use capsule_fom::{Configuration, Progress};
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::Duration;

/// A bar of this length, drawn by an indicatif template.
pub fn bar(quiet: bool, length: u64, template: &str) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    ProgressBar::new(length).with_style(style(template))
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// A bar over named tasks that follow each other.
pub fn tasks(quiet: bool) -> ProgressBar {
    bar(quiet, 0, "{bar:40} {pos}/{len} {msg}, {elapsed} gone, {eta} to go")
}

/// Shows that `done` of `of` steps of `task` are done.
pub fn show(bar: &ProgressBar, task: &str, done: usize, of: usize) {
    bar.set_message(task.to_owned());
    bar.set_length(of as u64);
    bar.set_position(done as u64);
}

/// The style of a full-order run's bar.
const RUN: &str = "{bar:25} {prefix}{msg}, {eta} to go";

/// The bar of one full-order run to `end_time`.
pub fn run(quiet: bool) -> ProgressBar {
    bar(quiet, 0, RUN)
}

/// Shows where a full-order run stands. Its bar counts thousandths of l/V.
pub fn show_run(bar: &ProgressBar, now: &Progress) {
    let thousandths = |t: f64| (1000.0 * t) as u64;
    bar.set_length(thousandths(now.end_time));
    bar.set_position(thousandths(now.t));
    bar.set_message(format!(
        "t = {:.3} of {}, step {}, {} evaluations, normal velocity {:.1e}",
        now.t, now.end_time, now.steps, now.velocity_evaluations, now.residual
    ));
}

/// The bars of a sweep: one for each configuration that runs, and one over all.
pub struct Sweep {
    bars: MultiProgress,
    all: ProgressBar,
}

impl Sweep {
    /// No bar yet but the one over all, with what is done already.
    pub fn new(quiet: bool, count: (usize, usize)) -> Self {
        let target = if quiet {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bars = MultiProgress::with_draw_target(target);
        let all = bars.add(ProgressBar::new(0));
        all.set_style(style(
            "{bar:25} {pos} of at most {len} configurations, {elapsed} gone, {eta} to go",
        ));
        let bars = Self { bars, all };
        bars.count(count);
        // The remaining time follows from what this sweep does, and the clock runs on between two results.
        bars.all.reset_eta();
        if !bars.bars.is_hidden() {
            bars.all.enable_steady_tick(Duration::from_secs(1));
        }
        bars
    }

    /// Shows how many configurations are done, of how many at most.
    pub fn count(&self, (done, most): (usize, usize)) {
        self.all.set_length(most as u64);
        self.all.set_position(done as u64);
    }

    /// The bar of a configuration that starts.
    pub fn start(&self, configuration: &Configuration) -> ProgressBar {
        let bar = self.bars.insert_before(&self.all, ProgressBar::new(0));
        bar.set_style(style(RUN));
        bar.set_prefix(format!(
            "Ca = {}, a/l = {}: ",
            configuration.capillary_number, configuration.confinement
        ));
        bar
    }

    /// A warning above the bars, or alone where there are none.
    pub fn warn(&self, text: &str) {
        self.bars.suspend(|| eprintln!("warning: {text}"));
    }

    /// Takes all bars away.
    pub fn clear(&self) {
        self.all.finish_and_clear();
    }
}
