//! The `cohaul` command, shared by the binary and the Python package's console script.
//!
//! Exit status: 0 done and succeeded, 1 ran and failed, 2 usage, 3 bad input file, 130 interrupted. With `--json` one
//! object goes to stdout and nothing else; progress goes to stderr, and only to a terminal.

mod capacity;
mod certify;
mod check;
mod compare;
mod generate;
mod plan;
mod progress;
mod recover;
mod replay;
mod reproduce;
mod run;
mod ways;

use std::io::{IsTerminal, Write, stderr, stdout};
use std::path::Path;

use clap::{Args, Parser, Subcommand, ValueEnum};
use cohaul_core::record::RecordError;
use cohaul_core::scenario::{self, Override, Parsed, ScenarioError, Warning};
use cohaul_planner::capacity::CapacityError;
use cohaul_planner::formation::ReformError;
use cohaul_planner::generate::GenerateError;
use cohaul_planner::io::FormatError;
use serde_json::{Map, Value, json};

use crate::error::{SimError, chain};
use crate::files::{self, FileError};

/// Everything done, and it succeeded.
pub const DONE: i32 = 0;
/// It ran, and failed.
pub const FAILED: i32 = 1;
/// The command line makes no sense.
pub const USAGE: i32 = 2;
/// An input file or an override is bad.
pub const BAD_INPUT: i32 = 3;
/// Stopped by Ctrl-C.
pub const INTERRUPTED: i32 = 130;

/// Teams of mobile robots that move loads by pushing them together.
#[derive(Parser)]
#[command(name = "cohaul", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Run a mission: check the scenario, simulate it, write its log and its replay page.
    Run(run::Run),
    /// Re-run a published table and print it beside the paper's numbers.
    Reproduce(reproduce::Reproduce),
    /// Check a scenario file without running it.
    Check(check::Check),
    /// Tell before driving what a team can move: whether it can, with which margin, and where it ends.
    Capacity(capacity::Capacity),
    /// Print the JSON Schema of scenario files.
    Schema,
    /// Decide a log anew from its observations and compare every decision bit for bit.
    Replay(replay::Replay),
    /// Make a valid log of an unfinished or damaged one.
    Recover(recover::Recover),
    /// Plan ways for many agents: on grids, with goals to be assigned, for cars.
    Plan(plan::Plan),
    /// Check a plan independently of the planners, ours or a foreign one.
    Certify(certify::Certify),
    /// Make planning instances from a seed.
    Generate(generate::Generate),
    /// Compare two sets of trials pair by pair, or the ways that loads took in two logs.
    Compare(compare::Compare),
}

#[derive(Args)]
struct Common {
    /// Set a key of the scenario, such as loads.0.mass=3.3; may be given several times.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    overrides: Vec<String>,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum World {
    /// Rigid bodies in the plane.
    Planar,
    /// Rigid bodies in space.
    Spatial,
}

impl World {
    /// As in scenario files.
    const fn name(self) -> &'static str {
        match self {
            Self::Planar => "planar",
            Self::Spatial => "spatial",
        }
    }
}

/// Runs the command line `args`, the program's name first; `interrupted` is asked now and then whether to stop. Gives the
/// exit status.
pub fn main(args: Vec<String>, interrupted: &dyn Fn() -> bool) -> i32 {
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(error) => {
            // help and version are no errors
            let status = if error.use_stderr() { USAGE } else { DONE };
            let _ = error.print();
            return status;
        }
    };
    let (done, json) = match cli.command {
        Verb::Run(arguments) => (run::run(&arguments, interrupted), arguments.common.json),
        Verb::Reproduce(arguments) => (reproduce::reproduce(&arguments, interrupted), arguments.json),
        Verb::Check(arguments) => (check::check(&arguments), arguments.common.json),
        Verb::Capacity(arguments) => (capacity::capacity(&arguments), arguments.common.json),
        Verb::Schema => {
            say(&scenario::schema());
            (Ok(DONE), false)
        }
        Verb::Replay(arguments) => (replay::replay(&arguments), arguments.json),
        Verb::Recover(arguments) => (recover::recover(&arguments), arguments.json),
        Verb::Plan(arguments) => (plan::plan(&arguments, interrupted), arguments.json),
        Verb::Certify(arguments) => (certify::certify(&arguments), arguments.json),
        Verb::Generate(arguments) => (generate::generate(&arguments), arguments.json),
        Verb::Compare(arguments) => (compare::compare(&arguments), arguments.json),
    };
    done.unwrap_or_else(|error| report(&error, json))
}

/// One line, or several, to stdout; a closed pipe is nobody's error.
fn say(text: &str) {
    let _ = writeln!(stdout(), "{}", text.trim_end_matches('\n'));
}

fn complain(text: &str) {
    let _ = writeln!(stderr(), "{}", text.trim_end_matches('\n'));
}

fn overrides(texts: &[String]) -> Result<Vec<Override>, ScenarioError> {
    texts.iter().map(|text| Override::parse(text)).collect()
}

fn parse(file: &Path, common: &Common, world: Option<World>) -> Result<Parsed, FileError> {
    let mut changes = overrides(&common.overrides)?;
    if let Some(world) = world {
        changes.push(Override::parse(&format!("world={}", world.name()))?);
    }
    let parsed = files::read_scenario(file, &changes)?;
    if !common.json {
        for warning in &parsed.warnings {
            complain(&rendered(warning));
        }
    }
    Ok(parsed)
}

fn as_object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(object) => object,
        _ => Map::new(),
    }
}

fn warnings(list: &[Warning]) -> Value {
    list.iter()
        .map(|w| {
            json!({
                "message": w.message(), "file": w.file(), "line": w.line(), "column": w.column(), "remedy": w.remedy(),
            })
        })
        .collect()
}

/// A diagnostic with its snippet, in colour on a terminal.
fn rendered(diagnostic: &dyn miette::Diagnostic) -> String {
    let theme = if stderr().is_terminal() {
        miette::GraphicalTheme::unicode()
    } else {
        miette::GraphicalTheme::unicode_nocolor()
    };
    let mut text = String::new();
    let handler = miette::GraphicalReportHandler::new_themed(theme).with_width(120);
    match handler.render_report(&mut text, diagnostic) {
        Ok(()) => text,
        Err(_) => diagnostic.to_string(),
    }
}

/// What to do about an error that no place in the file explains.
fn remedy(error: &FileError) -> Option<String> {
    match error {
        FileError::Formation(error) | FileError::Capacity(CapacityError::Formation(error)) => Some(error.remedy()),
        FileError::Reform(ReformError::Formation(error)) => Some(error.remedy()),
        FileError::Format(error) => Some(error.remedy()),
        FileError::LoadPath(error) | FileError::Capacity(CapacityError::LoadPath(error)) => Some(error.remedy()),
        _ => None,
    }
}

/// Reports an error and gives its exit status.
fn report(error: &FileError, json: bool) -> i32 {
    let scenario = match error {
        FileError::Scenario(error) | FileError::Sim(SimError::Parse(error)) => Some(error),
        _ => None,
    };
    if json {
        let object = scenario.map_or_else(
            || {
                let place = match error {
                    FileError::Format(error) => Some(error),
                    _ => None,
                };
                json!({
                    "message": place.map_or_else(|| chain(error), FormatError::message),
                    "file": place.map(FormatError::file),
                    "line": place.map(FormatError::line),
                    "column": place.map(FormatError::column),
                    "remedy": remedy(error),
                })
            },
            |e| {
                json!({
                    "message": e.message(), "file": e.file(), "line": e.line(), "column": e.column(),
                    "remedy": e.remedy(),
                })
            },
        );
        say(&json!({ "error": object }).to_string());
    } else if let Some(error) = scenario {
        complain(&format!("error: {error}"));
        complain(&rendered(error));
    } else {
        complain(&format!("error: {}", chain(error)));
        if let Some(remedy) = remedy(error) {
            complain(&format!("  help: {remedy}"));
        }
    }
    match error {
        FileError::Trials(_) | FileError::Format(_) => BAD_INPUT,
        FileError::Generate(GenerateError::OutOfRange { .. }) => USAGE,
        FileError::Scenario(_) | FileError::Formation(_) | FileError::LoadPath(_) | FileError::Capacity(_) => BAD_INPUT,
        FileError::Reform(ReformError::NoSuchRobot { .. } | ReformError::NoSuchTeam { .. }) => BAD_INPUT,
        FileError::Io { action: "read", .. } => BAD_INPUT,
        FileError::Sim(SimError::Record(RecordError::NotALog)) => BAD_INPUT,
        _ => FAILED,
    }
}
