//! `cohaul reproduce`.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;
use serde_json::{Value, json};

use super::progress::Counted;
use super::{DONE, INTERRUPTED, World, say};
use crate::experiment::report::{self, Evidence};
use crate::experiment::runner::{self, Request};
use crate::experiment::store::{self, Store};
use crate::experiment::{self, ALL, Experiment, Results};
use crate::files::FileError;
use crate::stopwatch::Stopwatch;

/// The name that stands for every experiment.
const EVERYTHING: &str = "all";

#[derive(Args)]
pub(super) struct Reproduce {
    /// Published table or figure, or `all`.
    #[arg(value_parser = names(), required_unless_present = "list", value_name = "NAME", hide_possible_values = true)]
    name: Option<String>,
    /// List the names with what they show, and end.
    #[arg(long)]
    list: bool,
    /// Trials per cell, instead of the experiment's own number.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    trials: Option<u32>,
    /// Seed of the first trial of every cell; the others follow.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Simulator.
    #[arg(long, value_enum, default_value = "planar")]
    world: World,
    /// Threads; as many as there are cores if it is not given.
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    jobs: usize,
    /// Folder; every experiment has a folder NAME-WORLD of its own in it, and goes on where it was interrupted.
    #[arg(long, default_value = "out/reproduce", value_name = "DIR")]
    out: PathBuf,
    /// Set a key of the scenario in every cell, such as sensors.latency=0.05; may be given several times. Use another --out.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    changes: Vec<String>,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    pub(super) json: bool,
}

fn names() -> PossibleValuesParser {
    ALL.iter().map(|experiment| experiment.name()).chain([EVERYTHING]).collect::<Vec<_>>().into()
}

pub(super) fn reproduce(arguments: &Reproduce, interrupted: &dyn Fn() -> bool) -> Result<i32, FileError> {
    let name = match &arguments.name {
        Some(name) if !arguments.list => name,
        _ => return Ok(list(arguments.json)),
    };
    let chosen: Vec<&dyn Experiment> = match experiment::find(name) {
        Some(experiment) => vec![experiment],
        None => ALL.to_vec(),
    };
    let mut objects = Vec::new();
    let mut evidence = Vec::new();
    for experiment in chosen {
        let watch = Stopwatch::start();
        let (results, folder) = one(experiment, arguments, interrupted)?;
        let (cpu_s, wall_s) = watch.seconds();
        let object = report::json(experiment, &results, wall_s, cpu_s);
        if name != EVERYTHING && !arguments.json {
            say(&report::markdown(experiment, &results));
        }
        if !arguments.json {
            say(&format!(
                "{}: {} trials in {wall_s:.1} s ({cpu_s:.1} CPU s), written to {}",
                results.name,
                results.trials.len(),
                folder.display()
            ));
        }
        objects.push(object);
        let complete = results.complete;
        evidence.push(Evidence { experiment, results });
        if !complete {
            if !arguments.json {
                say("interrupted; the same command goes on from here");
            } else {
                say(&wrapped(name, objects).to_string());
            }
            return Ok(INTERRUPTED);
        }
    }
    if name == EVERYTHING {
        let path = arguments.out.join(format!("report-{}.md", arguments.world.name()));
        store::write_text(&path, &report::whole(&evidence))?;
        if !arguments.json {
            say(&format!("the whole report: {}", path.display()));
        }
    }
    if arguments.json {
        say(&wrapped(name, objects).to_string());
    }
    Ok(DONE)
}

/// One experiment's object, or all of them in one.
fn wrapped(name: &str, mut objects: Vec<Value>) -> Value {
    if name == EVERYTHING { json!({ "experiments": objects }) } else { objects.pop().unwrap_or_default() }
}

fn list(json: bool) -> i32 {
    if json {
        let experiments: Vec<Value> = ALL
            .iter()
            .map(|e| json!({"name": e.name(), "about": e.about(), "cells": e.cells().len(), "trials": e.trials()}))
            .collect();
        say(&json!({ "experiments": experiments }).to_string());
        return DONE;
    }
    for experiment in ALL {
        let (cells, trials) = (experiment.cells().len(), experiment.trials());
        say(&format!("{} ({cells} cells × {trials} trials)\n    {}", experiment.name(), experiment.about()));
    }
    say(&format!("{EVERYTHING}\n    Every one of them, and a report that holds them all."));
    DONE
}

/// Runs one experiment and writes everything about it into its folder.
fn one(
    experiment: &dyn Experiment,
    arguments: &Reproduce,
    interrupted: &dyn Fn() -> bool,
) -> Result<(Results, PathBuf), FileError> {
    let request = Request {
        world: arguments.world.name().to_owned(),
        trials: arguments.trials.map_or_else(|| experiment.trials(), |trials| trials as usize),
        seed: arguments.seed,
        jobs: arguments.jobs,
        changes: arguments.changes.clone(),
    };
    let cells = runner::cells(experiment, &request)?;
    let (results, folder) = {
        let store = Store::open(&arguments.out, &runner::header(experiment, &request, &cells)?)?;
        let bar = Counted::new(experiment.name(), arguments.json);
        let results =
            runner::run(experiment, &request, &cells, &store, &mut |done, asked| bar.show(done, asked), interrupted)?;
        bar.clear();
        (results, store.folder().to_owned())
    };
    write(experiment, &results, &folder)?;
    Ok((results, folder))
}

fn write(experiment: &dyn Experiment, results: &Results, folder: &Path) -> Result<(), FileError> {
    store::write_parquet(&folder.join(store::TABLE), &results.trials)?;
    store::write_text(&folder.join("report.md"), &report::markdown(experiment, results))?;
    experiment.figures(results, folder)
}
