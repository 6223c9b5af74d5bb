//! Logs: decided anew, rescued, compared; trials too.

use std::path::PathBuf;

use cohaul_sim::files;
use cohaul_sim::recording;
use cohaul_sim::replay::Difference;
use pyo3::prelude::*;

use crate::{convert, error};

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

/// A log as the mission that it recorded.
#[pyclass(frozen, module = "cohaul._cohaul")]
pub struct Recording {
    recording: recording::Recording,
}

#[pymethods]
impl Recording {
    /// Reads the log at `path`.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let recording = py.detach(|| files::read_log(&path)).map_err(error::file)?;
        Ok(Self { recording })
    }

    /// What happened: arrays by name.
    fn traces<'py>(&self, py: Python<'py>) -> PyResult<convert::Traces<'py>> {
        convert::traces(py, &self.recording.frames)
    }

    /// Bodies, teams and their waypoints.
    fn layout<'py>(&self, py: Python<'py>) -> PyResult<convert::Layout<'py>> {
        convert::layout(py, &self.recording.scenario)
    }
}
