//! The heaviest load: by bisection in simulation, for both methods.
//!
//! # Source
//! [R2P2] §V-D: six robots on flat ground with friction 0.1 move up to 15 kg with R2P2 and up to 0.05 kg with VLF.
//!
//! # Deviations
//! The paper's largest masses are the largest that it tried. Here the mass is bisected for every seed, to 1 % between 0.01 and
//! 100 kg, on the mission of Table I; a mission that takes longer than 400 s counts as failed. The outcome that goes with it
//! is that of the heaviest mass that arrived.
//!
//! [R2P2]: cohaul_core::_documentation::references

use cohaul_core::scenario::document::Scenario;
use cohaul_core::time::Time;

use super::bisect::{Bracket, limit};
use super::design::{Design, SINGLE};
use super::table::markdown_table;
use super::trials::{Level, Trial, numbers};
use super::verdict::{self, Verdict};
use super::{Experiment, Measured, Results, Section};
use crate::episode::{self, NoRecorder};
use crate::files::FileError;
use crate::outcome::End;
use crate::statistics::{ascending, quantile};

/// Where the limit is sought, and how closely.
const BRACKET: Bracket = Bracket { low: 0.01, high: 100.0, resolution: 0.01 };

/// "A team of 6 robots with R2P2 can transport a box of mass upto 15 kg, while with VLF … only upto 0.05 kg."
fn at_most(results: &Results, method: &str, paper: f64) -> Verdict {
    let statement = format!("{method} moves {} {paper} kg", if method == "vlf" { "no more than" } else { "at least" });
    let level = Level::from(method);
    let masses =
        ascending(&numbers(results.trials.iter().filter(|t| t.key.level("method") == Some(&level)), "capacity_kg"));
    let (Some(least), Some(greatest)) = (masses.first(), masses.last()) else { return Verdict::unknown(&statement) };
    let agrees = if method == "vlf" { *greatest <= paper } else { *least >= paper };
    let evidence = format!(
        "bisected limit {:.2} kg, least {least:.2}, greatest {greatest:.2}, n {}{}",
        quantile(&masses, 0.5),
        masses.len(),
        if *least > paper { "; ours does better than the paper says" } else { "" },
    );
    Verdict { statement, agrees: Some(agrees), evidence }
}

/// `r2p2-capacity`.
pub struct Capacity;

impl Experiment for Capacity {
    fn name(&self) -> &'static str {
        "r2p2-capacity"
    }

    fn about(&self) -> &'static str {
        "§V-D: the largest mass that six robots move to a goal at 45° and 1 m on flat ground with friction 0.1, bisected for \
         every seed."
    }

    fn trials(&self) -> usize {
        5
    }

    fn cells(&self) -> Vec<Design> {
        let cell = |method: &str, controller: &str, paper: f64| {
            Design::new(SINGLE)
                .level("method", method)
                .goal(45.0, 1.0)
                .set("teams.0.mission.time_limit", 400)
                .set("teams.0.controller", controller)
                .paper("capacity_kg", paper)
        };
        vec![cell("r2p2", "{r2p2: {}}", 15.0), cell("vlf", "{vlf: {}}", 0.05)]
    }

    fn run(
        &self,
        trial: Trial,
        scenario: &Scenario,
        stop: &mut dyn FnMut(Time, Time) -> bool,
    ) -> Result<Measured, FileError> {
        let Some(found) = limit(scenario, 0, &[scenario.seed], &BRACKET, stop)? else { return Ok(None) };
        let mut heaviest = scenario.clone();
        heaviest.loads[0].mass = found.arrived.max(BRACKET.low);
        let outcome = episode::run(&heaviest, &mut NoRecorder, stop)?;
        if outcome.outcome == End::Interrupted {
            return Ok(None);
        }
        let mut trial = trial.with_outcome(&outcome)?;
        trial.push("capacity_kg", found.mass());
        Ok(Some(trial))
    }

    fn sections(&self, results: &Results) -> Vec<Section> {
        let rows: Vec<Vec<String>> = results
            .cells
            .iter()
            .map(|cell| {
                let masses = ascending(&numbers(results.trials.iter().filter(|t| t.key == cell.key), "capacity_kg"));
                let paper = cell.paper.as_ref().and_then(|p| p.get("capacity_kg")).map(ToString::to_string);
                vec![
                    cell.key.to_string(),
                    masses.len().to_string(),
                    format!("{:.2}", quantile(&masses, 0.5)),
                    format!("{:.2} to {:.2}", quantile(&masses, 0.0), quantile(&masses, 1.0)),
                    paper.unwrap_or_default(),
                ]
            })
            .collect();
        let header = ["method", "seeds", "largest mass kg, median", "least to greatest", "paper kg"];
        let table = Section::text("Largest mass", markdown_table(&header, &rows));
        vec![table, verdict::section(&self.verdicts(results))]
    }

    fn verdicts(&self, results: &Results) -> Vec<Verdict> {
        [("r2p2", 15.0), ("vlf", 0.05)].map(|(method, paper)| at_most(results, method, paper)).to_vec()
    }
}
