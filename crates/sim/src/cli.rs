//! The `cohaul` command, shared by the binary and the Python package's console script.
//!
//! Exit status: 0 done and succeeded, 1 ran and failed, 2 usage, 3 bad input file, 130 interrupted. With `--json` one
//! object goes to stdout and nothing else; progress goes to stderr, and only to a terminal.

use std::io::{IsTerminal, Write, stderr, stdout};
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};
use cohaul_core::record::RecordError;
use cohaul_core::scenario::{self, Override, Parsed, ScenarioError, Warning};
use cohaul_core::time::Time;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Map, Value, json};

use crate::error::{SimError, chain};
use crate::files::{self, FileError};
use crate::outcome::End;
use crate::stopwatch::Stopwatch;

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
    Run(Run),
    /// Check a scenario file without running it.
    Check(Check),
    /// Print the JSON Schema of scenario files.
    Schema,
    /// Decide a log anew from its observations and compare every decision bit for bit.
    Replay(Replay),
    /// Make a valid log of an unfinished or damaged one.
    Recover(Recover),
}

#[derive(Args)]
struct Run {
    /// Scenario file.
    file: PathBuf,
    /// Seed of everything random, instead of the scenario's.
    #[arg(long)]
    seed: Option<u64>,
    /// Simulator, instead of the scenario's.
    #[arg(long, value_enum)]
    world: Option<World>,
    /// Folder for NAME.mcap and NAME.html.
    #[arg(long, default_value = "out", value_name = "DIR")]
    out: PathBuf,
    /// Write a picture of the mission too, NAME.svg.
    #[arg(long)]
    picture: bool,
    #[command(flatten)]
    common: Common,
}

#[derive(Args)]
struct Check {
    /// Scenario file.
    file: PathBuf,
    #[command(flatten)]
    common: Common,
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

#[derive(Args)]
struct Replay {
    /// Log file.
    log: PathBuf,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
struct Recover {
    /// Log file.
    log: PathBuf,
    /// The new log; NAME.recovered.mcap beside the old one if it is not given.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
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
    match cli.command {
        Verb::Run(arguments) => {
            run(&arguments, interrupted).unwrap_or_else(|error| report(&error, arguments.common.json))
        }
        Verb::Check(arguments) => check(&arguments).unwrap_or_else(|error| report(&error, arguments.common.json)),
        Verb::Schema => {
            say(&scenario::schema());
            DONE
        }
        Verb::Replay(arguments) => replay(&arguments).unwrap_or_else(|error| report(&error, arguments.json)),
        Verb::Recover(arguments) => recover(&arguments).unwrap_or_else(|error| report(&error, arguments.json)),
    }
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
        let name = match world {
            World::Planar => "planar",
            World::Spatial => "spatial",
        };
        changes.push(Override::parse(&format!("world={name}"))?);
    }
    let parsed = files::read_scenario(file, &changes)?;
    if !common.json {
        for warning in &parsed.warnings {
            complain(&rendered(warning));
        }
    }
    Ok(parsed)
}

fn run(arguments: &Run, interrupted: &dyn Fn() -> bool) -> Result<i32, FileError> {
    let parsed = parse(&arguments.file, &arguments.common, arguments.world)?;
    let scenario = files::draw(&parsed, arguments.seed)?;
    let (seed, world) = (scenario.seed, crate::mission::world_name(scenario.world));
    let progress = Progress::new(&scenario.name);
    let watch = Stopwatch::start();
    let (mission, written) = files::run_into(scenario, &arguments.out, arguments.picture, &mut |now, limit| {
        progress.show(now, limit);
        interrupted()
    })?;
    let (cpu_s, wall_s) = watch.seconds();
    progress.clear();
    let outcome = &mission.outcome;
    if arguments.common.json {
        let mut object = as_object(serde_json::to_value(outcome).unwrap_or_default());
        let rest = json!({
            "seed": seed,
            "world": world,
            "log": written.log,
            "page": written.page,
            "picture": written.picture,
            "records": mission.records,
            "cpu_s": cpu_s,
            "wall_s": wall_s,
            "real_time_factor": outcome.time_s / wall_s,
            "warnings": warnings(&parsed.warnings),
        });
        object.extend(as_object(rest));
        say(&Value::Object(object).to_string());
    } else {
        say(&format!("{} (seed {seed}, {world} world)", mission.scenario.name));
        for (label, value) in outcome.rows() {
            say(&format!("  {label:<26}{value}"));
        }
        say(&format!("  {:<26}{wall_s:.2} s ({:.0} × real time)", "computed in", outcome.time_s / wall_s));
        say(&format!("  {:<26}{}", "log", written.log.display()));
        say(&format!("  {:<26}{}", "page", written.page.display()));
        if let Some(picture) = &written.picture {
            say(&format!("  {:<26}{}", "picture", picture.display()));
        }
    }
    Ok(match outcome.outcome {
        End::Reached => DONE,
        End::Interrupted => INTERRUPTED,
        _ => FAILED,
    })
}

fn check(arguments: &Check) -> Result<i32, FileError> {
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

fn replay(arguments: &Replay) -> Result<i32, FileError> {
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

fn recover(arguments: &Recover) -> Result<i32, FileError> {
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

/// Reports an error and gives its exit status.
fn report(error: &FileError, json: bool) -> i32 {
    let scenario = match error {
        FileError::Scenario(error) | FileError::Sim(SimError::Parse(error)) => Some(error),
        _ => None,
    };
    if json {
        let object = scenario.map_or_else(
            || json!({"message": chain(error), "file": null, "line": null, "column": null, "remedy": null}),
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
    }
    match error {
        FileError::Scenario(_) | FileError::Io { action: "read", .. } => BAD_INPUT,
        FileError::Sim(SimError::Record(RecordError::NotALog)) => BAD_INPUT,
        _ => FAILED,
    }
}

/// Simulated time on a terminal.
struct Progress(Option<ProgressBar>);

impl Progress {
    fn new(name: &str) -> Self {
        if !stderr().is_terminal() {
            return Self(None);
        }
        let bar = ProgressBar::new(1);
        if let Ok(style) =
            ProgressStyle::with_template("{prefix} {spinner} {pos} s simulated of at most {len} s {wide_bar}")
        {
            bar.set_style(style);
        }
        bar.set_prefix(name.to_owned());
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(Some(bar))
    }

    fn show(&self, now: Time, limit: Time) {
        if let Some(bar) = &self.0 {
            bar.set_length(limit.seconds() as u64);
            bar.set_position(now.seconds() as u64);
        }
    }

    fn clear(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}
