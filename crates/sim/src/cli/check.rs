//! `cohaul check`.

use std::path::PathBuf;

use clap::Args;
use cohaul_planner::formation::{self, Chosen};
use serde_json::{Value, json};

use super::{Common, DONE, parse, say, warnings};
use crate::files::{self, FileError};

#[derive(Args)]
pub(super) struct Check {
    /// Scenario file.
    pub(super) file: PathBuf,
    #[command(flatten)]
    pub(super) common: Common,
}

pub(super) fn check(arguments: &Check) -> Result<i32, FileError> {
    let parsed = parse(&arguments.file, &arguments.common, None)?;
    let scenario = &parsed.scenario;
    // as drawn for its own seed: slots may depend on what is drawn
    let drawn = files::draw_open(&parsed, None)?;
    let (_, chosen) = formation::resolve_with(&drawn)?;
    let robots: usize = scenario.teams.iter().map(|team| team.robots.count).sum();
    if arguments.common.json {
        let object = json!({
            "ok": true,
            "name": scenario.name,
            "loads": scenario.loads.len(),
            "teams": scenario.teams.len(),
            "robots": robots,
            "formations": chosen.iter().map(choice).collect::<Vec<_>>(),
            "warnings": warnings(&parsed.warnings),
        });
        say(&object.to_string());
    } else {
        let loads = scenario.loads.len();
        let (s, t) = (if robots == 1 { "" } else { "s" }, if loads == 1 { "" } else { "s" });
        say(&format!("{}: ok, {robots} robot{s}, {loads} load{t}", arguments.file.display()));
        for choice in &chosen {
            say(&choice.to_string());
        }
    }
    Ok(DONE)
}

fn choice(chosen: &Chosen) -> Value {
    json!({
        "team": chosen.team,
        "slots": chosen.slots,
        "margin": chosen.margin,
        "limited_by": chosen.limited_by.to_string(),
        "gaps": chosen.gaps.iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}
