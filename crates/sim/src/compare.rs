//! Two results side by side: sets of trials, pair by pair, or the ways that loads took in two logs.

use serde::Serialize;

use crate::files::FileError;
use crate::plot::PlotError;

pub mod pairs;
pub mod paths;
mod picture;

pub use pairs::Pairs;
pub use paths::{Paths, Track};
pub use picture::draw;

/// Two results that cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// A file that cannot be read, or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A log and trials, or an option for the other kind.
    #[error("{0}")]
    Usage(String),
    /// A field that no trial has as a number.
    #[error("no trial of both sides has a number {field:?}; there are {}", known.join(", "))]
    Field {
        /// The field asked for.
        field: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// A set in which a cell and seed stands twice.
    #[error("{side} holds seed {seed} of the cell [{cell}] twice: give one experiment in one world")]
    Twice {
        /// `A` or `B`.
        side: char,
        /// The cell.
        cell: String,
        /// The seed.
        seed: u64,
    },
    /// Nothing in common.
    #[error("nothing to compare: {0}")]
    Nothing(String),
    /// A picture that cannot be made.
    #[error(transparent)]
    Plot(#[from] PlotError),
}

/// What a comparison found.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Compared {
    /// Two sets of trials.
    Trials(Pairs),
    /// Two logs.
    Logs(Paths),
}

/// A table: header and rows.
pub type Table = (Vec<String>, Vec<Vec<String>>);

impl Compared {
    /// As one JSON object.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// What is compared, in a few lines.
    pub fn heading(&self) -> Vec<String> {
        match self {
            Self::Trials(pairs) => pairs.heading(),
            Self::Logs(paths) => paths.heading(),
        }
    }

    /// The numbers.
    pub fn table(&self) -> Table {
        match self {
            Self::Trials(pairs) => pairs.table(),
            Self::Logs(paths) => paths.table(),
        }
    }
}

/// A number for people, with four digits that count.
fn number(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let digits = (3.0 - value.abs().max(1e-3).log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.digits$}");
    // no negative zero, and the minus of print
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        text.trim_start_matches('-').to_owned()
    } else {
        text.replace('-', "−")
    }
}

/// A number with its interval.
fn with_interval(value: f64, (low, high): (f64, f64)) -> String {
    if value.is_finite() { format!("{} [{}, {}]", number(value), number(low), number(high)) } else { number(value) }
}
