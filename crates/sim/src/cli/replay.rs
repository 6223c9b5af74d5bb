//! `cohaul replay`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::{DONE, FAILED, say};
use crate::files::{self, FileError};

#[derive(Args)]
pub(super) struct Replay {
    /// Log file.
    pub(super) log: PathBuf,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    pub(super) json: bool,
}

pub(super) fn replay(arguments: &Replay) -> Result<i32, FileError> {
    let replayed = files::replay_log(&arguments.log)?;
    if arguments.json {
        let first = replayed.first.as_ref().map(|first| {
            json!({
                "robot": first.robot.0 + 1,
                "time_s": first.time_s,
                "recorded": format!("{:?}", first.recorded),
                "decided": format!("{:?}", first.decided),
            })
        });
        let object = json!({
            "ok": replayed.different == 0,
            "name": replayed.name,
            "version": replayed.version,
            "decisions": replayed.decisions,
            "different": replayed.different,
            "first_difference": first,
        });
        say(&object.to_string());
    } else {
        say(&format!("{}: {} decisions, {} different", replayed.name, replayed.decisions, replayed.different));
        if let Some(first) = &replayed.first {
            say(&format!("first difference: robot {} at {:.3} s", first.robot.0 + 1, first.time_s));
            say(&format!("  recorded {:?}", first.recorded));
            say(&format!("  decided  {:?}", first.decided));
            if replayed.version != crate::mission::VERSION {
                say(&format!(
                    "the log was written by version {}, this is {}",
                    replayed.version,
                    crate::mission::VERSION
                ));
            }
        }
    }
    Ok(if replayed.different == 0 { DONE } else { FAILED })
}
