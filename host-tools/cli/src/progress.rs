//! Progress bars: hidden when asked to be quiet or when the standard error is not a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of this length, drawn by an indicatif template.
pub fn bar(quiet: bool, length: u64, template: &str) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style)
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
