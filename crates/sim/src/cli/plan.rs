//! `cohaul plan`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use cohaul_planner::certify::Violation;
use cohaul_planner::io::schedule::Statistics;
use cohaul_planner::outcome::Outcome;
use cohaul_planner::{car, instance};
use serde_json::{Value, json};

use super::ways;
use super::{DONE, FAILED, INTERRUPTED, USAGE, as_object, complain, say};
use crate::files::{self, FileError};
use crate::planning::{self, AnyPlan, Planner, Request, Source, report};
use crate::stopwatch::Stopwatch;

/// When bodies count as touching.
#[derive(Clone, Copy, ValueEnum)]
enum Model {
    /// As CL-CBS has it: discs at the ends of steps.
    Clcbs,
    /// Rectangles, all through every step.
    Exact,
}

#[derive(Args)]
pub(super) struct Instance {
    /// The map of a MovingAI scenario, instead of the one that it names.
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// What the bodies are like, a config.yaml as CL-CBS has it, instead of what the instance says.
    #[arg(long, value_name = "CONFIG")]
    vehicle: Option<PathBuf>,
    /// Only the first N agents.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    agents: Option<u32>,
    /// When bodies count as touching.
    #[arg(long, value_enum, default_value = "clcbs")]
    model: Model,
    /// Whether bodies may start inside an obstacle, as CL-CBS lets them.
    #[arg(long, value_enum, default_value = "checked")]
    starts: Starts,
}

/// Whether starts have to be clear of obstacles.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Starts {
    /// A start inside an obstacle makes the instance infeasible.
    Checked,
    /// A body may start inside an obstacle and stay there until it first moves.
    Free,
}

/// What assignments of goals to bodies that drive are judged by.
#[derive(Clone, Copy, ValueEnum)]
enum Metric {
    /// The shortest curve that the body can drive.
    Curve,
    /// |Δx| + |Δy|, and only the first assignment: assign first, plan then.
    Manhattan,
}

impl Instance {
    pub(super) const fn touching(&self) -> car::Model {
        match self.model {
            Model::Clcbs => car::Model::Clcbs,
            Model::Exact => car::Model::Exact,
        }
    }

    pub(super) fn source(&self) -> Source {
        Source {
            map: self.map.clone(),
            vehicle: self.vehicle.clone(),
            agents: self.agents.map(|agents| agents as usize),
            free_starts: self.starts == Starts::Free,
        }
    }
}

/// What is drawn of a plan, violations included.
#[derive(Args)]
pub(super) struct Drawn {
    /// Write a page that plays the plan, HTML.
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
    /// Write a picture of the plan, SVG.
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

impl Drawn {
    const fn is_wanted(&self) -> bool {
        self.page.is_some() || self.picture.is_some()
    }

    /// Writes what is wanted, under the name of `file`; gives where the page and the picture are.
    pub(super) fn write(
        &self,
        file: &Path,
        plan: &AnyPlan,
        instance: &instance::Instance,
        violations: &[Violation],
    ) -> Result<(Option<&Path>, Option<&Path>), FileError> {
        let title = file.file_stem().unwrap_or_default().display().to_string();
        if let Some(path) = &self.page {
            files::write_text(path, &plan.page(&title, instance, violations))?;
        }
        if let Some(path) = &self.picture {
            files::write_text(path, &plan.picture(&title, instance, violations))?;
        }
        Ok((self.page.as_deref(), self.picture.as_deref()))
    }
}

#[derive(Args)]
pub(super) struct Plan {
    /// Instance: YAML of libMultiRobotPlanning or CL-CBS, or a MovingAI .scen file beside its .map; or the scenario of a mission,
    /// whose loads with `plan: auto` get their ways.
    pub(super) file: PathBuf,
    /// Search: cbs or ecbs for grids (cbs-ta, ecbs-ta, ita-cbs or ita-ecbs where goals are to be assigned), cl-cbs for bodies that
    /// drive.
    #[arg(long, value_name = "NAME", value_parser = planner)]
    planner: Option<Planner>,
    /// By which factor the cost may exceed the lower bound. Usually 1.3 on grids; without it bodies that drive are planned
    /// fast, with a bound that comes out as it does.
    #[arg(long, value_name = "W", value_parser = bound)]
    bound: Option<f64>,
    /// Plan so many bodies that drive at once, later ones around earlier ones, instead of all.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    batch: Option<u32>,
    /// What assignments of goals to bodies that drive are judged by.
    #[arg(long, value_enum, default_value = "curve")]
    metric: Metric,
    /// CPU time after which to give up, s.
    #[arg(long, value_name = "S", default_value = "60", value_parser = timeout)]
    timeout: f64,
    /// Write the plan, in the layout of libMultiRobotPlanning.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    drawn: Drawn,
    #[command(flatten)]
    instance: Instance,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    pub(super) json: bool,
}

impl Plan {
    /// An option that was given and means nothing for missions.
    pub(super) fn of_no_use_for_missions(&self) -> Option<&'static str> {
        let given = [
            ("--planner", self.planner.is_some()),
            ("--bound", self.bound.is_some()),
            ("--batch", self.batch.is_some()),
            ("--out", self.out.is_some()),
            ("--page and --picture", self.drawn.is_wanted()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(flag, _)| flag)
    }
}

fn planner(text: &str) -> Result<Planner, String> {
    let names: Vec<&str> = Planner::NAMES.iter().map(|(name, _)| *name).collect();
    Planner::named(text).ok_or_else(|| format!("known are {}", names.join(", ")))
}

fn bound(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 1.0);
    value.ok_or_else(|| "a bound is a number of at least 1".to_owned())
}

fn timeout(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0);
    value.ok_or_else(|| "a time is a number of seconds, not negative".to_owned())
}

pub(super) fn plan(arguments: &Plan, interrupted: &dyn Fn() -> bool) -> Result<i32, FileError> {
    let watch = Stopwatch::start();
    if planning::is_mission(&arguments.file)? {
        return ways::plan(arguments, &watch);
    }
    let document = planning::read(&arguments.file, &arguments.instance.source())?;
    let instance = &document.instance;
    let planner = arguments.planner.unwrap_or_else(|| Planner::for_instance(instance));
    let model = arguments.instance.touching();
    let metric = match arguments.metric {
        Metric::Curve => car::Metric::Curve,
        Metric::Manhattan => car::Metric::Manhattan,
    };
    let batch = arguments.batch.map(|batch| batch as usize);
    let request = Request { planner, bound: arguments.bound, model, batch, metric, timeout: arguments.timeout };
    let Some(answer) = planning::solve(instance, &request, &watch, interrupted) else {
        let usual = Planner::for_instance(instance).name();
        let message = format!("{} is not for an instance of this kind; use {usual}", planner.name());
        if arguments.json {
            let object = json!({"message": message, "file": null, "line": null, "column": null, "remedy": null});
            say(&json!({ "error": object }).to_string());
        } else {
            complain(&format!("error: {message}"));
        }
        return Ok(USAGE);
    };
    let written = match (&answer.outcome, &arguments.out) {
        (Outcome::Solved(plan), Some(path)) => {
            let statistics = Statistics { effort: answer.effort, runtime: Some(answer.runtime) };
            files::write_text(path, &plan.to_text(document.heading, &statistics))?;
            Some(path.as_path())
        }
        _ => None,
    };
    let (page, picture) = match &answer.outcome {
        Outcome::Solved(plan) if arguments.drawn.is_wanted() => {
            arguments.drawn.write(&arguments.file, plan, instance, &plan.violations(instance, model))?
        }
        _ => (None, None),
    };
    let reasons = report::reasons(&answer, instance);
    if arguments.json {
        let mut object = as_object(report::summary(&answer, &reasons, arguments.timeout));
        let rest = json!({
            "file": arguments.file,
            "agents": instance.agents(),
            "planner": planner.name(),
            "cpu_s": Stopwatch::process_seconds(),
            "wall_s": watch.seconds().1,
            "plan": written,
            "page": page,
            "picture": picture,
        });
        object.extend(as_object(rest));
        say(&Value::Object(object).to_string());
    } else {
        let agents = instance.agents();
        say(&format!("{}: {agents} agents, {}", arguments.file.display(), planner.name()));
        for (label, value) in report::rows(&answer, &reasons, arguments.timeout) {
            say(&format!("  {label:<14}{value}"));
        }
        if let (None, Some(path)) = (written, &arguments.out)
            && files::exists(path)
        {
            say(&format!("  {:<14}not written; what is in {} is older", "plan", path.display()));
        }
        for (label, path) in [("plan", written), ("page", page), ("picture", picture)] {
            if let Some(path) = path {
                say(&format!("  {label:<14}{}", path.display()));
            }
        }
    }
    Ok(match answer.outcome {
        _ if interrupted() => INTERRUPTED,
        Outcome::Solved(_) => DONE,
        _ => FAILED,
    })
}
