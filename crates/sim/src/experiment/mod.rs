//! The published experiments, one file per table: `cohaul reproduce`.
//!
//! An [`Experiment`] describes its cells as changes to a scenario; [`runner`] runs every cell for every seed on all cores and
//! keeps each trial as it ends; [`report`] puts the numbers beside the paper's. Trials share nothing, so neither their order
//! nor the number of threads changes a result.

mod ablation;
pub mod agreement;
mod baseline;
pub mod bisect;
mod breakaway;
mod capacity;
mod clutter;
mod columns;
pub mod design;
pub mod figure;
pub mod folder;
mod generalize;
mod lines;
mod missions;
mod named;
pub mod report;
mod robustness;
pub mod rotation;
pub mod runner;
pub mod store;
pub mod summary;
pub mod table;
mod taguchi;
mod terrain;
mod tight;
pub mod trials;
pub mod verdict;

use std::path::Path;

use cohaul_core::scenario::document::Scenario;
use cohaul_core::time::Time;

use crate::episode::{self, NoRecorder};
use crate::files::FileError;
use crate::outcome::End;
use crate::statistics::median;
use design::Design;
use summary::CellSummary;
use trials::{Key, Level, Trial};
use verdict::Verdict;

/// A trial with what was measured; `None` if it was interrupted.
pub type Measured = Option<Trial>;

/// One published table or figure, as missions.
pub trait Experiment: Sync {
    /// Its name on the command line.
    fn name(&self) -> &'static str;

    /// What it shows, and what is ours about it: the first lines of its report.
    fn about(&self) -> &'static str;

    /// Trials per cell where the command line does not say.
    fn trials(&self) -> usize {
        20
    }

    /// Its cells, in the order of the table.
    fn cells(&self) -> Vec<Design>;

    /// Runs one trial of a scenario drawn for its seed; `stop` is as in [`episode::run`].
    ///
    /// # Errors
    /// A scenario that cannot be run.
    fn run(
        &self,
        trial: Trial,
        scenario: &Scenario,
        stop: &mut dyn FnMut(Time, Time) -> bool,
    ) -> Result<Measured, FileError> {
        let outcome = episode::run(scenario, &mut NoRecorder, stop)?;
        if outcome.outcome == End::Interrupted {
            return Ok(None);
        }
        let mut trial = trial.with_outcome(&outcome)?;
        self.measure(&mut trial);
        Ok(Some(trial))
    }

    /// Adds what the table needs beyond the outcome.
    fn measure(&self, _trial: &mut Trial) {}

    /// Writes the figures, NAME.svg and NAME.png, into `folder`.
    ///
    /// # Errors
    /// Files that cannot be written.
    fn figures(&self, results: &Results, folder: &Path) -> Result<(), FileError> {
        figure::cells(results, folder)
    }

    /// What the report says after the table of cells.
    fn sections(&self, _results: &Results) -> Vec<Section> {
        Vec::new()
    }

    /// Verdicts on the paper's statements, where the experiment bears on any.
    fn verdicts(&self, _results: &Results) -> Vec<Verdict> {
        Vec::new()
    }
}

/// Every experiment, in the order of the paper.
pub const ALL: [&dyn Experiment; 15] = [
    &terrain::TerrainMissions,
    &generalize::Generalize,
    &breakaway::Breakaway,
    &baseline::Baseline,
    &baseline::BaselineVariants,
    &tight::Tight,
    &capacity::Capacity,
    &rotation::Rotation,
    &taguchi::Taguchi,
    &missions::Hardware,
    &missions::Ten,
    &missions::TwoTeams,
    &clutter::Clutter,
    &robustness::Robustness,
    &ablation::Ablation,
];

/// The experiment of this name.
pub fn find(name: &str) -> Option<&'static dyn Experiment> {
    ALL.into_iter().find(|experiment| experiment.name() == name)
}

/// What an experiment found.
#[derive(Clone, Debug)]
pub struct Results {
    /// Name of the experiment.
    pub name: &'static str,
    /// World that it ran in.
    pub world: String,
    /// First seed.
    pub seed: u64,
    /// Trials per cell asked for.
    pub requested: usize,
    /// Keys set in every cell, as `--set` does.
    pub changes: Vec<String>,
    /// Whether every trial asked for is there.
    pub complete: bool,
    /// The trials, by cell, then by seed.
    pub trials: Vec<Trial>,
    /// The same, cell by cell, in the order of the table.
    pub cells: Vec<CellSummary>,
}

impl Results {
    /// Trials of a cell that reached the goal.
    pub fn reached<'a>(&'a self, key: &'a Key) -> impl Iterator<Item = &'a Trial> {
        self.trials.iter().filter(move |trial| trial.success() && trial.key == *key)
    }
}

/// The cell with these levels, the first if several have them.
pub(crate) fn summary_of<'a>(results: &'a Results, levels: &[(&str, Level)]) -> Option<&'a CellSummary> {
    results.cells.iter().find(|cell| levels.iter().all(|(factor, level)| cell.key.level(factor) == Some(level)))
}

/// Median of a field over the trials with these levels that reached the goal; NaN of none.
pub(crate) fn median_of(results: &Results, levels: &[(&str, Level)], field: &str) -> f64 {
    let matches = |trial: &&Trial| levels.iter().all(|(factor, level)| trial.key.level(factor) == Some(level));
    let values: Vec<f64> =
        results.trials.iter().filter(|t| t.success()).filter(matches).filter_map(|t| t.number(field)).collect();
    median(&values)
}

/// A part of a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// Markdown.
    pub text: String,
}

impl Section {
    /// A heading with Markdown under it.
    pub fn text(title: &str, text: impl Into<String>) -> Self {
        Self { title: title.to_owned(), text: text.into() }
    }
}
