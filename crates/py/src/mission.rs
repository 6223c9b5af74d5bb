//! Scenarios and the missions that they describe.

use std::path::PathBuf;

use cohaul_core::scenario::{self, Override, Parsed};
use cohaul_sim::files::{self, FileError};
use cohaul_sim::page::{self, Replay};
use cohaul_sim::stopwatch::Stopwatch;
use cohaul_sim::{capacity, error::SimError, mission};
use pyo3::prelude::*;

use crate::command::Signals;
use crate::{convert, error};

/// JSON Schema of scenario files.
#[pyfunction]
pub fn schema() -> String {
    scenario::schema()
}

fn overrides(texts: &[String]) -> PyResult<Vec<Override>> {
    texts.iter().map(|text| Override::parse(text).map_err(|e| error::scenario(&e))).collect()
}

/// A valid scenario.
#[pyclass(frozen, module = "cohaul._cohaul")]
pub struct Scenario {
    parsed: Parsed,
}

#[pymethods]
impl Scenario {
    /// Reads and checks the file at `path`; `changes` are `path=value`.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf, changes: Vec<String>) -> PyResult<Self> {
        let overrides = overrides(&changes)?;
        let parsed = py.detach(|| files::read_scenario(&path, &overrides)).map_err(error::file)?;
        Ok(Self { parsed })
    }

    /// Checks the YAML `text`; `changes` are `path=value`.
    #[staticmethod]
    fn parse(py: Python<'_>, text: &str, changes: Vec<String>) -> PyResult<Self> {
        let overrides = overrides(&changes)?;
        let parsed = py.detach(|| scenario::parse("scenario", text.as_bytes(), &overrides));
        Ok(Self { parsed: parsed.map_err(|e| error::scenario(&e))? })
    }

    /// What is allowed, but probably not meant: a list of `ScenarioWarning`.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyAny>> {
        self.parsed.warnings.iter().map(|w| error::warning(w).into_value(py).into_bound(py).into_any()).collect()
    }

    /// What every team can move once the robots `without` (from 1) are gone: a JSON object, and a table per team.
    fn capacity(&self, py: Python<'_>, without: Vec<usize>) -> PyResult<(String, Vec<String>)> {
        let teams = py.detach(|| files::capacity(&self.parsed, &without)).map_err(error::file)?;
        Ok((capacity::to_json(&teams), teams.iter().map(capacity::table).collect()))
    }

    /// Runs the mission without holding the interpreter; writes log and page into the folder `out`, if any.
    fn run(&self, py: Python<'_>, out: Option<PathBuf>) -> PyResult<Mission> {
        let mut signals = Signals::default();
        let done = py.detach(|| run(&self.parsed, out, &mut signals));
        signals.check()?;
        done.map_err(error::file)
    }
}

fn run(parsed: &Parsed, out: Option<PathBuf>, signals: &mut Signals) -> Result<Mission, FileError> {
    let scenario = files::draw(parsed, None)?;
    let watch = Stopwatch::start();
    let mut stop = |_, _| signals.are_raised();
    let (mission, written) = match out {
        Some(folder) => files::run_into(scenario, &folder, false, &mut stop).map(|(m, w)| (m, Some(w)))?,
        None => (mission::Mission::run(scenario, None, &mut stop)?, None),
    };
    Ok(Mission { mission, files: written.map(|w| (w.log, w.page)), seconds: watch.seconds() })
}

/// A finished mission.
#[pyclass(frozen, module = "cohaul._cohaul")]
pub struct Mission {
    mission: mission::Mission,
    /// Log and page.
    #[pyo3(get)]
    files: Option<(PathBuf, PathBuf)>,
    /// CPU and wall time, s.
    #[pyo3(get)]
    seconds: (f64, f64),
}

impl Mission {
    fn drawn(&self, py: Python<'_>, draw: fn(&Replay) -> String) -> PyResult<String> {
        py.detach(|| Ok(draw(&self.mission.replay()?))).map_err(|e: SimError| error::sim(&e))
    }
}

#[pymethods]
impl Mission {
    #[getter]
    fn name(&self) -> &str {
        &self.mission.scenario.name
    }

    #[getter]
    fn seed(&self) -> u64 {
        self.mission.scenario.seed
    }

    #[getter]
    fn world(&self) -> &'static str {
        mission::world_name(self.mission.scenario.world)
    }

    /// Records in the log, 0 without one.
    #[getter]
    fn records(&self) -> u64 {
        self.mission.records
    }

    /// The scenario as YAML, everything drawn and every key written out.
    #[getter]
    fn scenario(&self) -> PyResult<String> {
        self.mission.scenario.to_yaml().map_err(|e| error::sim(&e.into()))
    }

    /// How it ended, as a JSON object.
    fn json(&self) -> String {
        self.mission.outcome.to_json()
    }

    /// What happened: arrays by name.
    fn traces<'py>(&self, py: Python<'py>) -> PyResult<convert::Traces<'py>> {
        convert::traces(py, &self.mission.frames)
    }

    /// Bodies, teams and their waypoints.
    fn layout<'py>(&self, py: Python<'py>) -> PyResult<convert::Layout<'py>> {
        convert::layout(py, &self.mission.scenario)
    }

    /// Label and value of every row of the table of results.
    fn rows(&self) -> Vec<(String, String)> {
        self.mission.outcome.rows()
    }

    /// The replay page.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        self.drawn(py, page::render)
    }

    /// The picture, SVG.
    fn picture(&self, py: Python<'_>) -> PyResult<String> {
        self.drawn(py, page::picture)
    }
}
