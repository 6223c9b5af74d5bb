//! `cohaul certify`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::plan;
use super::{DONE, FAILED, say};
use crate::files::FileError;
use crate::planning::{self, AnyPlan, report};

#[derive(Args)]
pub(super) struct Certify {
    /// Plan, in the layout of libMultiRobotPlanning or CL-CBS.
    plan: PathBuf,
    /// The instance that the plan is for.
    #[arg(long = "instance", value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    drawn: plan::Drawn,
    #[command(flatten)]
    instance: plan::Instance,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    pub(super) json: bool,
}

pub(super) fn certify(arguments: &Certify) -> Result<i32, FileError> {
    let document = planning::read(&arguments.file, &arguments.instance.source())?;
    let instance = &document.instance;
    let plan = AnyPlan::read(&arguments.plan, &document)?;
    let violations = plan.violations(instance, arguments.instance.touching());
    arguments.drawn.write(&arguments.plan, &plan, instance, &violations)?;
    let ok = violations.is_empty();
    if arguments.json {
        let listed = report::violations(&violations, instance);
        say(&json!({ "ok": ok, "violations": listed }).to_string());
    } else if let Some(first) = violations.first() {
        say(&format!("{}: {first}", arguments.plan.display()));
        if violations.len() > 1 {
            say(&format!("  and {} more; --json lists them", violations.len() - 1));
        }
    } else {
        say(&format!("{}: ok", arguments.plan.display()));
    }
    Ok(if ok { DONE } else { FAILED })
}
