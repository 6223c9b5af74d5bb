//! The published experiments.

use std::path::PathBuf;

use cohaul_sim::experiment::folder::{self, Done};
use cohaul_sim::experiment::runner::Request;
use cohaul_sim::experiment::{ALL, find, report};
use pyo3::prelude::*;

use crate::command::Signals;
use crate::error;

/// Names of the experiments with what each of them shows.
#[pyfunction]
pub fn experiments() -> Vec<(&'static str, &'static str)> {
    ALL.iter().map(|experiment| (experiment.name(), experiment.about())).collect()
}

/// Runs an experiment into a folder; gives what `cohaul reproduce --json` prints, and the folder.
#[pyfunction]
#[pyo3(signature = (name, trials, seed, world, jobs, out, changes))]
#[expect(clippy::too_many_arguments, reason = "Python gathers them")]
pub fn reproduce(
    py: Python<'_>,
    name: &str,
    trials: Option<usize>,
    seed: u64,
    world: String,
    jobs: usize,
    out: PathBuf,
    changes: Vec<String>,
) -> PyResult<(String, PathBuf)> {
    let known = || ALL.iter().map(|experiment| experiment.name()).collect::<Vec<_>>().join(", ");
    let experiment =
        find(name).ok_or_else(|| error::experiment(format!("no experiment `{name}`; there are {}", known())))?;
    let trials = trials.unwrap_or_else(|| experiment.trials());
    let request = Request { world, trials, seed, jobs, changes };
    let mut signals = Signals::default();
    let done = py.detach(|| {
        let signals = std::cell::RefCell::new(&mut signals);
        folder::run_into(experiment, &request, &out, &mut |_, _| {}, &|| signals.borrow_mut().are_raised())
    });
    signals.check()?;
    let Done { results, folder, cpu_s, wall_s } = done.map_err(error::file)?;
    Ok((report::json(experiment, &results, wall_s, cpu_s).to_string(), folder))
}
