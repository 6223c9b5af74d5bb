//! An experiment run into a folder: trials, table, report, figures.

use std::path::{Path, PathBuf};

use super::runner::{self, Request};
use super::store::{self, Store};
use super::{Experiment, Results, report};
use crate::files::FileError;
use crate::stopwatch::Stopwatch;

/// An experiment that ran.
#[derive(Clone, Debug)]
pub struct Done {
    /// What it found.
    pub results: Results,
    /// Where its files are.
    pub folder: PathBuf,
    /// Computing time, s.
    pub cpu_s: f64,
    /// Time on the wall, s.
    pub wall_s: f64,
}

/// Runs what is missing of `request` in the folder NAME-WORLD of `out`, and writes the table (trials.parquet) and the report
/// (report.md) anew, and the figures once no trial is missing. `progress` and `interrupted` are as in [`runner::run`].
///
/// # Errors
/// Files that cannot be read or written, a folder of other trials, trials that cannot be run.
pub fn run_into(
    experiment: &dyn Experiment,
    request: &Request,
    out: &Path,
    progress: &mut dyn FnMut(usize, usize),
    interrupted: &dyn Fn() -> bool,
) -> Result<Done, FileError> {
    let watch = Stopwatch::start();
    let cells = runner::cells(experiment, request)?;
    let store = Store::open(out, &runner::header(experiment, request, &cells)?)?;
    let results = runner::run(experiment, request, &cells, &store, progress, interrupted)?;
    let folder = store.folder().to_owned();
    store::write_parquet(&folder.join(store::TABLE), &results.trials)?;
    store::write_text(&folder.join("report.md"), &report::markdown(experiment, &results))?;
    if results.complete {
        experiment.figures(&results, &folder)?;
    }
    let (cpu_s, wall_s) = watch.seconds();
    Ok(Done { results, folder, cpu_s, wall_s })
}
