//! `cohaul capacity`.

use std::path::PathBuf;

use clap::Args;
use cohaul_planner::capacity;
use serde_json::{Map, Value, json};

use super::{Common, DONE, FAILED, as_object, parse, say, warnings};
use crate::files::{self, FileError};

#[derive(Args)]
pub(super) struct Capacity {
    /// Scenario file.
    pub(super) file: PathBuf,
    /// Leave out a robot, counted from 1 over all teams, and let the others of its team form anew; may be given several
    /// times.
    #[arg(long, value_name = "N")]
    pub(super) without: Vec<usize>,
    #[command(flatten)]
    pub(super) common: Common,
}

pub(super) fn capacity(arguments: &Capacity) -> Result<i32, FileError> {
    let parsed = parse(&arguments.file, &arguments.common, None)?;
    let teams = files::capacity(&parsed, &arguments.without)?;
    let feasible = teams.iter().all(|team| team.feasible);
    if arguments.common.json {
        let mut object = summary(&teams);
        object.insert("name".to_owned(), json!(parsed.scenario.name));
        object.insert("warnings".to_owned(), warnings(&parsed.warnings));
        say(&Value::Object(object).to_string());
    } else {
        say(&parsed.scenario.name);
        for team in &teams {
            say(&table(team));
        }
    }
    Ok(if feasible { DONE } else { FAILED })
}

/// The numbers of the team with the least margin, and those of every team.
pub fn summary(teams: &[capacity::Capacity]) -> Map<String, Value> {
    let worst = teams.iter().min_by(|a, b| a.margin.total_cmp(&b.margin));
    let mut object = as_object(serde_json::to_value(worst).unwrap_or_default());
    object.insert("feasible".to_owned(), json!(teams.iter().all(|team| team.feasible)));
    object.insert("teams".to_owned(), serde_json::to_value(teams).unwrap_or_default());
    object
}

/// Rows of a table for people.
pub fn table(team: &capacity::Capacity) -> String {
    let robots = |count: usize| format!("{count} robot{}", if count == 1 { "" } else { "s" });
    let rows = [
        ("feasible", if team.feasible { "yes" } else { "no" }.to_owned()),
        ("margin", format!("{:.2} × the load of {} kg", team.margin, team.mass_kg)),
        ("largest mass", format!("{:.2} kg", team.max_mass_kg)),
        (
            "steepest slope",
            team.max_slope_deg.map_or_else(|| "not even flat ground".to_owned(), |slope| format!("{slope:.1}°")),
        ),
        ("smallest team", team.min_robots.map_or_else(|| "more than 12 robots".to_owned(), robots)),
        ("why", team.explanation.clone()),
    ];
    let mut text = format!("team `{}`, {}", team.team, robots(team.robots));
    for (label, value) in rows {
        text += &format!("\n  {label:<16}{value}");
    }
    text
}
