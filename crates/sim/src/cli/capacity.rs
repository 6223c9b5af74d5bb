//! `cohaul capacity`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::{Common, DONE, FAILED, parse, say, warnings};
use crate::capacity::{summary, table};
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
