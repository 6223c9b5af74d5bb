//! `cohaul plan` for the scenario of a mission: ways of loads with `plan: auto`.

use cohaul_planner::load_path::{self, LoadPathError};
use serde_json::{Value, json};

use super::check::way;
use super::plan::Plan;
use super::{DONE, FAILED, USAGE, complain, say};
use crate::error::chain;
use crate::files::{self, FileError};
use crate::stopwatch::Stopwatch;

/// Plans the ways of a scenario as it is drawn for its own seed.
pub(super) fn plan(arguments: &Plan, watch: &Stopwatch) -> Result<i32, FileError> {
    if let Some(flag) = arguments.of_no_use_for_missions() {
        complain(&format!(
            "error: {flag} is of no use for the scenario of a mission; `cohaul run` drives and draws it"
        ));
        return Ok(USAGE);
    }
    let parsed = files::read_scenario(&arguments.file, &[])?;
    let drawn = files::draw_open(&parsed, None)?;
    let (ways, reason) = match load_path::resolve_with(&drawn) {
        Ok((_, _, ways)) => (ways, None),
        Err(
            error @ (LoadPathError::Start { .. }
            | LoadPathError::Goal { .. }
            | LoadPathError::NoPassage { .. }
            | LoadPathError::BudgetSpent { .. }),
        ) => (Vec::new(), Some(error)),
        Err(error) => return Err(error.into()),
    };
    let status = match &reason {
        None => "solved",
        Some(LoadPathError::BudgetSpent { .. }) => "budget_spent",
        Some(_) => "infeasible",
    };
    if arguments.json {
        let object = json!({
            "status": status,
            "reason": reason.as_ref().map(|error| chain(error)),
            "planner": "load-path",
            "file": arguments.file,
            "ways": ways.iter().map(way).collect::<Vec<Value>>(),
            "runtime_s": watch.seconds().0,
            "cpu_s": Stopwatch::process_seconds(),
        });
        say(&object.to_string());
    } else {
        say(&format!("{}: {status}", arguments.file.display()));
        if let Some(error) = &reason {
            say(&format!("  {}", chain(error)));
            say(&format!("  help: {}", error.remedy()));
        } else if ways.is_empty() {
            say("  no team has `plan: auto`: all waypoints are given");
        }
        for way in &ways {
            say(&way.to_string());
        }
    }
    Ok(if reason.is_none() { DONE } else { FAILED })
}
