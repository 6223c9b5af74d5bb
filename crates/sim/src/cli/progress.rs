//! What a terminal shows while the command works; nothing where stderr is no terminal.

use std::io::{IsTerminal, stderr};
use std::time::Duration;

use cohaul_core::time::Time;
use indicatif::{ProgressBar, ProgressStyle};

/// Simulated time on a terminal.
pub(super) struct Simulated(Option<ProgressBar>);

impl Simulated {
    pub(super) fn new(name: &str) -> Self {
        if !stderr().is_terminal() {
            return Self(None);
        }
        let bar = ProgressBar::new(1);
        if let Ok(style) =
            ProgressStyle::with_template("{prefix} {spinner} {pos} s simulated of at most {len} s {wide_bar}")
        {
            bar.set_style(style);
        }
        bar.set_prefix(name.to_owned());
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(Some(bar))
    }

    pub(super) fn show(&self, now: Time, limit: Time) {
        if let Some(bar) = &self.0 {
            bar.set_length(limit.seconds() as u64);
            bar.set_position(now.seconds() as u64);
        }
    }

    pub(super) fn clear(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

/// Trials of an experiment on a terminal.
pub(super) struct Counted(Option<ProgressBar>);

impl Counted {
    pub(super) fn new(name: &str, quiet: bool) -> Self {
        if quiet || !stderr().is_terminal() {
            return Self(None);
        }
        let bar = ProgressBar::new(1);
        if let Ok(style) =
            ProgressStyle::with_template("{prefix} {pos}/{len} trials {wide_bar} {elapsed} of about {duration}")
        {
            bar.set_style(style);
        }
        bar.set_prefix(name.to_owned());
        Self(Some(bar))
    }

    pub(super) fn show(&self, done: usize, asked: usize) {
        if let Some(bar) = &self.0 {
            bar.set_length(asked as u64);
            bar.set_position(done as u64);
        }
    }

    pub(super) fn clear(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}
