//! `cohaul check`.

use std::path::PathBuf;

use clap::Args;
use cohaul_planner::formation::Chosen;
use cohaul_planner::load_path::{self, Planned};
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
    // as drawn for its own seed: slots and ways may depend on what is drawn
    let drawn = files::draw_open(&parsed, None)?;
    let (_, chosen, planned) = load_path::resolve_with(&drawn)?;
    let robots: usize = scenario.teams.iter().map(|team| team.robots.count).sum();
    if arguments.common.json {
        let object = json!({
            "ok": true,
            "name": scenario.name,
            "loads": scenario.loads.len(),
            "teams": scenario.teams.len(),
            "robots": robots,
            "formations": chosen.iter().map(choice).collect::<Vec<_>>(),
            "ways": planned.iter().map(way).collect::<Vec<_>>(),
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
        for way in &planned {
            say(&way.to_string());
        }
    }
    Ok(DONE)
}

pub(super) fn way(planned: &Planned) -> Value {
    let path = &planned.path;
    json!({
        "team": planned.team,
        "waypoints": path.waypoints.iter().map(|at| [at.x, at.y]).collect::<Vec<_>>(),
        "length_m": path.length,
        "turning_rad": path.turning,
        "clearance_m": planned.clearance.least,
        "nearest": planned.clearance.nearest.map(|nearest| nearest.to_string()),
    })
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
