//! What teams can move, as data and as a table.

use cohaul_planner::capacity::Capacity;
use serde_json::{Map, Value, json};

/// The numbers of the team with the least margin under the names of `--json`, and those of every team in `teams`. The whole is
/// feasible where every team is.
pub fn summary(teams: &[Capacity]) -> Map<String, Value> {
    let worst = teams.iter().min_by(|a, b| a.margin.total_cmp(&b.margin));
    let mut object = match serde_json::to_value(worst) {
        Ok(Value::Object(object)) => object,
        _ => Map::new(),
    };
    object.insert("feasible".to_owned(), json!(teams.iter().all(|team| team.feasible)));
    object.insert("teams".to_owned(), serde_json::to_value(teams).unwrap_or_default());
    object
}

/// The same as one JSON object.
pub fn to_json(teams: &[Capacity]) -> String {
    Value::Object(summary(teams)).to_string()
}

/// Rows of a table for people.
pub fn table(team: &Capacity) -> String {
    let robots = |count: usize| format!("{count} robot{}", if count == 1 { "" } else { "s" });
    let rows = [
        ("feasible", if team.feasible { "yes" } else { "no" }.to_owned()),
        ("margin", format!("{:.2} × the load of {} kg", team.margin, team.mass_kg)),
        ("largest mass", format!("{:.2} kg", team.max_mass_kg)),
        (
            "steepest slope",
            team.max_slope_deg
                .map_or_else(|| "not even flat ground".to_owned(), |slope| format!("{slope:.1}°, whichever way is up")),
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
