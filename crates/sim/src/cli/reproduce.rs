//! `cohaul reproduce`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use serde_json::{Value, json};

use super::progress::Counted;
use super::{DONE, INTERRUPTED, World, say};
use crate::experiment::folder::{self, Done};
use crate::experiment::report::{self, Evidence};
use crate::experiment::runner::Request;
use crate::experiment::{self, ALL, Experiment, Section, agreement, store};
use crate::files::FileError;

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
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(..=u64::MAX - 1_000_000))]
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
        let bar = Counted::new(experiment.name(), arguments.json);
        let mut progress = |done, asked| bar.show(done, asked);
        let done =
            folder::run_into(experiment, &request(experiment, arguments), &arguments.out, &mut progress, interrupted)?;
        bar.clear();
        let Done { results, folder, cpu_s, wall_s } = done;
        if !arguments.json {
            if name != EVERYTHING {
                say(&report::markdown(experiment, &results));
            }
            say(&format!(
                "{}: {} trials in {wall_s:.1} s ({cpu_s:.1} CPU s), written to {}",
                results.name,
                results.trials.len(),
                folder.display()
            ));
        }
        objects.push(report::json(experiment, &results, wall_s, cpu_s));
        let complete = results.complete;
        evidence.push(Evidence { experiment, results });
        if !complete {
            if arguments.json {
                say(&wrapped(name, objects).to_string());
            } else {
                say("interrupted; the same command goes on from here");
            }
            return Ok(INTERRUPTED);
        }
    }
    if name == EVERYTHING {
        let path = arguments.out.join(format!("report-{}.md", arguments.world.name()));
        store::write_text(&path, &report::whole(&evidence, &agreement(&evidence, arguments)))?;
        if !arguments.json {
            say(&format!("the whole report: {}", path.display()));
        }
    }
    if arguments.json {
        say(&wrapped(name, objects).to_string());
    }
    Ok(DONE)
}

fn request(experiment: &dyn Experiment, arguments: &Reproduce) -> Request {
    Request {
        world: arguments.world.name().to_owned(),
        trials: arguments.trials.map_or_else(|| experiment.trials(), |trials| trials as usize),
        seed: arguments.seed,
        jobs: arguments.jobs,
        changes: arguments.changes.clone(),
    }
}

/// The comparison of the two worlds, if the other one has run into the same folder.
fn agreement(evidence: &[Evidence], arguments: &Reproduce) -> Vec<Section> {
    let compared = "r2p2-generalize";
    let Some(here) = evidence.iter().find(|e| e.results.name == compared) else { return Vec::new() };
    let other = if arguments.world.name() == "planar" { "spatial" } else { "planar" };
    // a folder that is not there is no error: the other world has not run
    let mut trials = store::read_trials(&arguments.out.join(format!("{compared}-{other}"))).unwrap_or_default();
    let seeds = request(here.experiment, arguments).seeds();
    trials.retain(|trial| seeds.contains(&trial.seed));
    let (planar, spatial) =
        if other == "spatial" { (&here.results.trials, &trials) } else { (&trials, &here.results.trials) };
    agreement::section(planar, spatial, here.results.seed).into_iter().collect()
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
