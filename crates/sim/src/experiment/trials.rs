//! Trials: one run each, named by the cell of the experiment and the seed, with everything measured.
//!
//! A cell is a combination of levels of the experiment's factors ([`Key`]). A trial holds named values: every field of an
//! [`Outcome`] under its name of `--json`, and whatever else the experiment measures. Text and numbers survive
//! [`super::store`] bit for bit; a number that is not finite counts as missing, as in JSON.

use serde::Serialize;

use super::named::Named;
pub use super::named::{Key, Level, Value};
use crate::outcome::Outcome;

/// One run: where it belongs and what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Name of the experiment.
    pub experiment: String,
    /// Simulator, `planar` or `spatial`; another word where none is used.
    pub world: String,
    /// Its cell.
    pub key: Key,
    /// Its seed.
    pub seed: u64,
    pub(super) values: Named<Value>,
}

impl Trial {
    /// One of which nothing is measured yet.
    pub fn new(experiment: &str, world: &str, key: Key, seed: u64) -> Self {
        Self { experiment: experiment.to_owned(), world: world.to_owned(), key, seed, values: Named::default() }
    }

    /// With every field of an outcome, under its name.
    ///
    /// # Errors
    /// None with the outcomes of this version.
    pub fn with_outcome(mut self, outcome: &Outcome) -> Result<Self, TrialError> {
        self.record(outcome)?;
        Ok(self)
    }

    /// Adds every field of a struct, under its name and in its order; absent and non-finite ones are missing.
    ///
    /// # Errors
    /// What does not become a JSON object.
    pub fn record(&mut self, fields: &impl Serialize) -> Result<(), TrialError> {
        let text = serde_json::to_string(fields).map_err(TrialError::Fields)?;
        let named: Named<Value> = serde_json::from_str(&text).map_err(TrialError::Fields)?;
        named.0.into_iter().for_each(|(name, value)| self.push(&name, value));
        Ok(())
    }

    /// Adds a value; one of this name is replaced, a number that is not finite left out.
    pub fn push(&mut self, name: &str, value: impl Into<Value>) {
        let value = value.into();
        if !matches!(value, Value::Number(number) if !number.is_finite()) {
            self.values.set(name, value);
        }
    }

    /// What was measured, in order.
    pub fn values(&self) -> impl Iterator<Item = (&str, &Value)> {
        self.values.iter()
    }

    /// A value.
    pub fn value(&self, name: &str) -> Option<&Value> {
        self.values.value(name)
    }

    /// A value that is a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.value(name)?.number()
    }

    /// Whether its field `success` says so.
    pub fn success(&self) -> bool {
        self.value("success") == Some(&Value::Boolean(true))
    }

    /// Its field `outcome`, such as `reached`.
    pub fn outcome(&self) -> Option<&str> {
        match self.value("outcome")? {
            Value::Text(name) => Some(name),
            _ => None,
        }
    }
}

/// Trials that cannot be stored, read or joined.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrialError {
    /// What was measured is no list of named values.
    #[error("fields of a trial cannot be written out")]
    Fields(#[source] serde_json::Error),
    /// A line of a store is not one.
    #[error("line {line} of the trials is damaged")]
    Line {
        /// Counted from 1.
        line: usize,
        /// Why not.
        source: serde_json::Error,
    },
    /// A store without its first line.
    #[error("the trials have no header")]
    NoHeader,
    /// The folder belongs to other trials.
    #[error("{folder} holds trials of another {what}: {there}, not {here}; choose another --out or remove the folder")]
    Other {
        /// The folder.
        folder: String,
        /// What differs.
        what: &'static str,
        /// As in the folder.
        there: String,
        /// As asked for.
        here: String,
    },
    /// Two processes on one folder.
    #[error("another process writes trials into {folder}")]
    Busy {
        /// The folder.
        folder: String,
    },
    /// Factors and values of a table must have different names.
    #[error("column {name:?} would stand twice in the table of trials")]
    Column {
        /// The name.
        name: String,
    },
    /// A Parquet file that is damaged or holds something else.
    #[error("table of trials: {0}")]
    Table(String),
}

/// Hash of texts one after the other (64-bit FNV-1a, with the end of each text marked): that of the scenarios of an
/// experiment's cells tells whether old trials may be joined with new ones.
pub fn fingerprint<T: AsRef<str>>(texts: impl IntoIterator<Item = T>) -> u64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    texts.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, text| {
        let hash = text.as_ref().bytes().fold(hash, step);
        step(hash, 0xff) // a byte that UTF-8 never has
    })
}

/// Trials by cell, the cells in order of their first appearance.
pub fn cells(trials: &[Trial]) -> Vec<(&Key, Vec<&Trial>)> {
    let mut cells: Vec<(&Key, Vec<&Trial>)> = Vec::new();
    let mut places = std::collections::BTreeMap::new();
    for trial in trials {
        let place = *places.entry(&trial.key).or_insert(cells.len());
        match cells.get_mut(place) {
            Some((_, members)) => members.push(trial),
            None => cells.push((&trial.key, vec![trial])),
        }
    }
    cells
}

/// The numbers under `name`, of those trials that have one.
pub fn numbers<'a>(trials: impl IntoIterator<Item = &'a Trial>, name: &str) -> Vec<f64> {
    trials.into_iter().filter_map(|trial| trial.number(name)).collect()
}
