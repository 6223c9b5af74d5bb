//! `cohaul recover`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::{DONE, FAILED, say};
use crate::files::{self, FileError};

#[derive(Args)]
pub(super) struct Recover {
    /// Log file.
    pub(super) log: PathBuf,
    /// The new log; NAME.recovered.mcap beside the old one if it is not given.
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    pub(super) json: bool,
}

pub(super) fn recover(arguments: &Recover) -> Result<i32, FileError> {
    let (recovered, output) = files::recover_log(&arguments.log, arguments.out.as_deref())?;
    if arguments.json {
        let object = json!({
            "messages": recovered.messages,
            "missing": recovered.missing,
            "skipped_bytes": recovered.skipped_bytes,
            "reason": recovered.lost_reason,
            "log": output,
        });
        say(&object.to_string());
    } else {
        say(&format!("{} messages recovered into {}", recovered.messages, output.display()));
        if recovered.missing > 0 {
            say(&format!("{} messages in between are lost", recovered.missing));
        }
        match &recovered.lost_reason {
            Some(reason) => say(&format!("what was wrong: {reason}")),
            None => say("nothing was wrong with the log"),
        }
    }
    Ok(if recovered.messages > 0 { DONE } else { FAILED })
}
