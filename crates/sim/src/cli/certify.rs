//! `cohaul certify`.

use std::path::PathBuf;

use clap::Args;
use cohaul_planner::certify::{self, Violation};
use cohaul_planner::instance::Instance;
use serde_json::{Value, json};

use super::plan::{self, Model};
use super::{DONE, FAILED, say};
use crate::files::FileError;
use crate::planning::{self, AnyPlan};

#[derive(Args)]
pub(super) struct Certify {
    /// Plan, in the layout of libMultiRobotPlanning or CL-CBS.
    plan: PathBuf,
    /// The instance that the plan is for.
    #[arg(long = "instance", value_name = "FILE")]
    file: PathBuf,
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
    let violations = match (instance, &plan) {
        (Instance::Grid(instance), AnyPlan::Grid(plan)) => certify::grid(instance, plan),
        (Instance::Car(instance), AnyPlan::Car(plan)) => {
            let model = match arguments.instance.model {
                Model::Clcbs => certify::Model::Clcbs,
                Model::Exact => certify::Model::Exact,
            };
            certify::car(instance, plan, model)
        }
        // plans are read as the instance's kind has them
        _ => Vec::new(),
    };
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
