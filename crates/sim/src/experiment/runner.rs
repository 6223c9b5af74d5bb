//! Runs an experiment: every cell for every seed, on all cores, each trial kept as it ends.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use super::design::Cell;
use super::store::{Header, Store};
use super::summary::summarise;
use super::trials::{Key, Trial};
use super::{Experiment, Measured, Results};
use crate::files::{self, FileError};

/// What is asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// `planar` or `spatial`.
    pub world: String,
    /// Trials per cell.
    pub trials: usize,
    /// Seed of the first trial of every cell; the others follow.
    pub seed: u64,
    /// Threads; as many as there are cores for 0.
    pub jobs: usize,
    /// Keys set in every cell, as `--set` does.
    pub changes: Vec<String>,
}

impl Request {
    /// Seeds of every cell's trials.
    pub fn seeds(&self) -> std::ops::Range<u64> {
        self.seed..self.seed.saturating_add(self.trials as u64)
    }
}

/// The cells of an experiment, their scenarios read.
///
/// # Errors
/// A change that a scenario does not take.
pub fn cells(experiment: &dyn Experiment, request: &Request) -> Result<Vec<Cell>, FileError> {
    let mut cells = Vec::new();
    for design in experiment.cells() {
        cells.push(design.cell(&request.world, &request.changes)?);
    }
    Ok(cells)
}

/// What names the content of a result folder.
///
/// # Errors
/// None for scenarios that were read.
pub fn header(experiment: &dyn Experiment, request: &Request, cells: &[Cell]) -> Result<Header, FileError> {
    let mut texts = Vec::new();
    for cell in cells {
        texts.push(cell.scenario.scenario.to_yaml().map_err(crate::error::SimError::from)?);
    }
    Ok(Header::new(experiment.name(), &request.world, request.seed, texts))
}

/// Runs what `store` lacks. `progress` gets the number of trials done and asked for; `interrupted` is asked now and then
/// whether to stop: what is finished is kept, and [`Results::complete`] says that something is missing.
///
/// # Errors
/// The first trial that cannot be run or kept.
pub fn run(
    experiment: &dyn Experiment,
    request: &Request,
    cells: &[Cell],
    store: &Store,
    progress: &mut dyn FnMut(usize, usize),
    interrupted: &dyn Fn() -> bool,
) -> Result<Results, FileError> {
    let asked = cells.len() * request.trials;
    let tasks: Vec<(&Cell, u64)> = cells
        .iter()
        .flat_map(|cell| request.seeds().map(move |seed| (cell, seed)))
        .filter(|(cell, seed)| store.trial(&cell.key, *seed).is_none())
        .collect();
    let mut done = asked - tasks.len();
    progress(done, asked);
    let pool = ThreadPoolBuilder::new().num_threads(request.jobs).build();
    let pool = pool.map_err(|error| FileError::Threads(error.to_string()))?;
    let stop = AtomicBool::new(false);
    let mut failure = None;
    let (sender, receiver) = mpsc::channel::<Result<Measured, FileError>>();
    std::thread::scope(|scope| {
        let (stop, pool) = (&stop, &pool);
        scope.spawn(move || {
            pool.install(|| {
                tasks.par_iter().for_each_with(sender, |sender, (cell, seed)| {
                    if !stop.load(Ordering::Relaxed) {
                        // the other end is gone only when nobody waits for the result any more
                        let _ = sender.send(trial(experiment, &request.world, cell, *seed, stop));
                    }
                });
            });
        });
        loop {
            match receiver.recv_timeout(Duration::from_millis(50)) {
                Ok(Ok(Some(trial))) => match store.append(trial) {
                    Ok(()) => {
                        done += 1;
                        progress(done, asked);
                    }
                    Err(error) => {
                        stop.store(true, Ordering::Relaxed);
                        failure.get_or_insert(error);
                    }
                },
                Ok(Ok(None)) | Err(RecvTimeoutError::Timeout) => {}
                Ok(Err(error)) => {
                    stop.store(true, Ordering::Relaxed);
                    failure.get_or_insert(error);
                }
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if interrupted() {
                stop.store(true, Ordering::Relaxed);
            }
        }
    });
    match failure {
        Some(error) => Err(error),
        None => Ok(collect(experiment, request, cells, store)),
    }
}

/// What `store` has of what is asked for.
pub fn collect(experiment: &dyn Experiment, request: &Request, cells: &[Cell], store: &Store) -> Results {
    let seeds = request.seeds();
    let of_cell = |key: &Key| seeds.clone().filter_map(|seed| store.trial(key, seed)).collect::<Vec<Trial>>();
    let trials: Vec<Trial> = cells.iter().flat_map(|cell| of_cell(&cell.key)).collect();
    let mut summaries = summarise(&trials);
    for summary in &mut summaries {
        let cell = cells.iter().find(|cell| cell.key == summary.key);
        summary.paper = cell.map(|cell| cell.paper.clone()).filter(|paper| !paper.is_empty());
    }
    Results {
        name: experiment.name(),
        world: request.world.clone(),
        seed: request.seed,
        requested: request.trials,
        changes: request.changes.clone(),
        complete: trials.len() == cells.len() * request.trials,
        trials,
        cells: summaries,
    }
}

fn trial(
    experiment: &dyn Experiment,
    world: &str,
    cell: &Cell,
    seed: u64,
    stop: &AtomicBool,
) -> Result<Measured, FileError> {
    let scenario = files::draw(&cell.scenario, Some(seed))?;
    let trial = Trial::new(experiment.name(), world, cell.key.clone(), seed);
    experiment.run(trial, &scenario, &mut |_, _| stop.load(Ordering::Relaxed))
}
