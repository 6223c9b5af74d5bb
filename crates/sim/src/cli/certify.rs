//! `cohaul certify`.

use std::path::PathBuf;

use clap::Args;
use cohaul_planner::certify::Violation;
use cohaul_planner::instance::Instance;
use serde_json::{Value, json};

use super::plan;
use super::{DONE, FAILED, say};
use crate::files::{self, FileError};
use crate::planning::{self, AnyPlan};

#[derive(Args)]
pub(super) struct Certify {
    /// Plan, in the layout of libMultiRobotPlanning or CL-CBS.
    plan: PathBuf,
    /// The instance that the plan is for.
    #[arg(long = "instance", value_name = "FILE")]
    file: PathBuf,
    /// Write a page that plays the plan and shows what is wrong with it, HTML.
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
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
    if let Some(path) = &arguments.page {
        let title = arguments.plan.file_stem().unwrap_or_default().display().to_string();
        files::write_text(path, &plan.page(&title, instance, &violations))?;
    }
    let ok = violations.is_empty();
    if arguments.json {
        let listed: Vec<Value> = violations.iter().map(|violation| as_json(violation, instance)).collect();
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

fn as_json(violation: &Violation, instance: &Instance) -> Value {
    let agents: Vec<String> = violation.agents.iter().map(|agent| planning::name(instance, *agent)).collect();
    json!({"kind": violation.kind.name(), "time": violation.time, "agents": agents, "detail": violation.detail})
}
