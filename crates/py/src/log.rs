//! Logs: decided anew, rescued, compared; trials too.

use std::path::PathBuf;

use cohaul_sim::files;
use cohaul_sim::replay::Difference;
use pyo3::prelude::*;

use crate::error;

/// Result of a replay, with the names of `cohaul replay --json`.
#[derive(IntoPyObject)]
pub struct Replayed {
    name: String,
    version: String,
    decisions: u64,
    different: u64,
    first_difference: Option<FirstDifference>,
}

/// The first decision that came out differently.
#[derive(IntoPyObject)]
struct FirstDifference {
    robot: u16,
    time_s: f64,
    recorded: String,
    decided: String,
}

impl From<Difference> for FirstDifference {
    fn from(Difference { robot, time_s, recorded, decided }: Difference) -> Self {
        let (recorded, decided) = (format!("{recorded:?}"), format!("{decided:?}"));
        Self { robot: robot.0 + 1, time_s, recorded, decided }
    }
}

/// Decides the log at `path` anew.
#[pyfunction]
pub fn replay(py: Python<'_>, path: PathBuf) -> PyResult<Replayed> {
    let found = py.detach(|| files::replay_log(&path)).map_err(error::file)?;
    let first_difference = found.first.map(FirstDifference::from);
    let (decisions, different) = (found.decisions, found.different);
    Ok(Replayed { name: found.name, version: found.version, decisions, different, first_difference })
}

/// What was rescued, with the names of `cohaul recover --json`.
#[derive(IntoPyObject)]
pub struct Recovered {
    messages: u64,
    missing: u64,
    skipped_bytes: u64,
    reason: Option<String>,
    log: PathBuf,
}

/// Makes a valid log, at `out` or beside it, of what is left of the log at `path`.
#[pyfunction]
#[pyo3(signature = (path, out))]
pub fn recover(py: Python<'_>, path: PathBuf, out: Option<PathBuf>) -> PyResult<Recovered> {
    let (found, log) = py.detach(|| files::recover_log(&path, out.as_deref())).map_err(error::file)?;
    let (messages, missing, skipped_bytes) = (found.messages, found.missing, found.skipped_bytes);
    Ok(Recovered { messages, missing, skipped_bytes, reason: found.lost_reason, log })
}

/// Compares two logs or two sets of trials; what `cohaul compare --json` prints.
#[pyfunction]
#[pyo3(signature = (a, b, fields, out))]
pub fn compare(py: Python<'_>, a: PathBuf, b: PathBuf, fields: Vec<String>, out: Option<PathBuf>) -> PyResult<String> {
    let compared = py.detach(|| files::compare(&a, &b, &fields, out.as_deref())).map_err(error::compare)?;
    Ok(compared.to_json())
}
