//! An experiment's results as Markdown, the paper's numbers beside ours.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::store::TABLE;
use super::summary::CellSummary;
use super::table::markdown_table;
use super::verdict::{self, Verdict};
use super::{Experiment, Results, Section};
use crate::mission::{REVISION, VERSION};
use crate::statistics::wilson;

/// Cells above which a report has no table of them.
const MOST_CELLS: usize = 100;

/// The report of one experiment.
pub fn markdown(experiment: &dyn Experiment, results: &Results) -> String {
    let mut text = format!("# {}\n\n{}\n\n{}\n", results.name, experiment.about(), provenance(results));
    let table = if results.cells.len() > MOST_CELLS {
        format!("{} cells, too many for a table: they are in {TABLE}.\n", results.cells.len())
    } else {
        cells(results)
    };
    let _ = write!(text, "\n## Cells\n\n{table}");
    for section in experiment.sections(results) {
        let _ = write!(text, "\n## {}\n\n{}\n", section.title, section.text.trim_end());
    }
    text
}

/// An experiment with what it found.
pub struct Evidence {
    /// The experiment.
    pub experiment: &'static dyn Experiment,
    /// Its results.
    pub results: Results,
}

/// The report of several experiments: a summary, the verdicts, `sections` of other origin, then each report.
pub fn whole(evidence: &[Evidence], sections: &[Section]) -> String {
    let world = evidence.first().map_or("", |e| e.results.world.as_str());
    let mut text = format!(
        "# R2P2, re-run in the {world} world\n\nEvery number below was written by the commands that it names.\n"
    );
    let rows: Vec<Vec<String>> = evidence
        .iter()
        .map(|Evidence { results, .. }| {
            let reached = results.cells.iter().map(|cell| cell.reached).sum::<usize>();
            let (low, high) = wilson(reached, results.trials.len());
            vec![
                results.name.to_owned(),
                results.cells.len().to_string(),
                results.requested.to_string(),
                format!("{reached}/{}", results.trials.len()),
                format!("{low:.3} to {high:.3}"),
                results
                    .cells
                    .iter()
                    .map(|cell| cell.reached * 1000 / cell.n.max(1))
                    .min()
                    .map_or_else(String::new, |least| format!("{:.0} %", least as f64 / 10.0)),
            ]
        })
        .collect();
    let header = ["experiment", "cells", "trials per cell", "reached", "95 %", "least of a cell"];
    let _ = write!(text, "\n## Summary\n\n{}", markdown_table(&header, &rows));
    let verdicts: Vec<Verdict> = evidence.iter().flat_map(|e| e.experiment.verdicts(&e.results)).collect();
    let verdicts = verdict::section(&verdicts);
    let _ = write!(text, "\n## {}\n\n{}", verdicts.title, verdicts.text);
    for section in sections {
        let _ = write!(text, "\n## {}\n\n{}\n", section.title, section.text.trim_end());
    }
    for Evidence { experiment, results } in evidence {
        let _ = write!(text, "\n{}", markdown(*experiment, results).replace("\n#", "\n##").replacen('#', "##", 1));
    }
    text
}

/// How the numbers came about.
fn provenance(results: &Results) -> String {
    let Results { name, world, seed, requested, .. } = results;
    let changes: String = results.changes.iter().map(|change| format!(" --set '{change}'")).collect();
    let last = seed + (*requested as u64).max(1) - 1;
    let missing =
        if results.complete { "" } else { " Some trials are missing: run the command again to complete them." };
    format!(
        "Written by `cohaul reproduce {name} --world {world} --trials {requested} --seed {seed}{changes}`, version {VERSION} ({REVISION}): \
         {} trials, seeds {seed} to {last} in each of {} cells.{missing}",
        results.trials.len(),
        results.cells.len(),
    )
}

/// One row per cell: levels, success with its 95 % interval, times, the paper's values.
pub fn cells(results: &Results) -> String {
    let Some(first) = results.cells.first() else { return "No trial has finished.\n".to_owned() };
    let mut header: Vec<String> = first.key.iter().map(|(factor, _)| factor.to_owned()).collect();
    header.extend(
        ["reached", "95 %", "how the others ended", "median s", "quartiles s", "95 % of the median", "repositioning"]
            .map(String::from),
    );
    let mut papers: Vec<&String> = Vec::new();
    for paper in results.cells.iter().filter_map(|cell| cell.paper.as_ref()) {
        for name in paper.keys() {
            if !papers.contains(&name) {
                papers.push(name);
            }
        }
    }
    header.extend(papers.iter().map(|name| format!("paper: {name}")));
    let rows: Vec<Vec<String>> = results
        .cells
        .iter()
        .map(|cell| {
            let mut row: Vec<String> = cell.key.iter().map(|(_, level)| level.to_string()).collect();
            row.extend(numbers(cell));
            row.extend(papers.iter().map(|name| {
                let value = cell.paper.as_ref().and_then(|paper| paper.get(*name));
                value.map_or_else(String::new, |value| value.as_str().map_or_else(|| value.to_string(), str::to_owned))
            }));
            row
        })
        .collect();
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    markdown_table(&header, &rows)
}

fn numbers(cell: &CellSummary) -> Vec<String> {
    let seconds = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.1}"));
    let [low, high] = cell.wilson;
    let others: Vec<String> = cell
        .outcomes
        .iter()
        .filter(|(outcome, _)| *outcome != "reached")
        .map(|(outcome, count)| format!("{count} {}", outcome.replace('_', " ")))
        .collect();
    vec![
        format!("{}/{}", cell.reached, cell.n),
        format!("{low:.2} to {high:.2}"),
        others.join(", "),
        seconds(cell.median_time_s),
        format!("{} to {}", seconds(cell.q25_time_s), seconds(cell.q75_time_s)),
        cell.median_interval_s.map_or_else(|| "–".to_owned(), |[low, high]| format!("{low:.1} to {high:.1}")),
        cell.reposition_share.map_or_else(|| "–".to_owned(), |share| format!("{:.0} %", 100.0 * share)),
    ]
}

/// The results with the names of `--json`.
pub fn json(experiment: &dyn Experiment, results: &Results, wall_s: f64, cpu_s: f64) -> Value {
    json!({
        "name": results.name,
        "world": results.world,
        "seed": results.seed,
        "trials": results.requested,
        "set": results.changes,
        "complete": results.complete,
        "wall_s": wall_s,
        "cpu_s": cpu_s,
        "cells": results.cells,
        "verdicts": experiment.verdicts(results),
    })
}
