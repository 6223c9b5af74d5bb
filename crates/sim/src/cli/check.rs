//! `cohaul check`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::{Common, DONE, parse, say, warnings};
use crate::files::FileError;

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
    let robots: usize = scenario.teams.iter().map(|team| team.robots.count).sum();
    if arguments.common.json {
        let object = json!({
            "ok": true,
            "name": scenario.name,
            "loads": scenario.loads.len(),
            "teams": scenario.teams.len(),
            "robots": robots,
            "warnings": warnings(&parsed.warnings),
        });
        say(&object.to_string());
    } else {
        let loads = scenario.loads.len();
        let (s, t) = (if robots == 1 { "" } else { "s" }, if loads == 1 { "" } else { "s" });
        say(&format!("{}: ok, {robots} robot{s}, {loads} load{t}", arguments.file.display()));
    }
    Ok(DONE)
}
