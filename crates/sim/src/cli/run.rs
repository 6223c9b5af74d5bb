//! `cohaul run`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::progress::Simulated;
use super::{Common, DONE, FAILED, INTERRUPTED, World, as_object, parse, say, warnings};
use crate::files::{self, FileError};
use crate::outcome::End;
use crate::stopwatch::Stopwatch;

#[derive(Args)]
pub(super) struct Run {
    /// Scenario file.
    pub(super) file: PathBuf,
    /// Seed of everything random, instead of the scenario's.
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// Simulator, instead of the scenario's.
    #[arg(long, value_enum)]
    pub(super) world: Option<World>,
    /// Folder for NAME.mcap and NAME.html.
    #[arg(long, default_value = "out", value_name = "DIR")]
    pub(super) out: PathBuf,
    /// Write a picture of the mission too, NAME.svg.
    #[arg(long)]
    pub(super) picture: bool,
    #[command(flatten)]
    pub(super) common: Common,
}

pub(super) fn run(arguments: &Run, interrupted: &dyn Fn() -> bool) -> Result<i32, FileError> {
    let parsed = parse(&arguments.file, &arguments.common, arguments.world)?;
    let scenario = files::draw(&parsed, arguments.seed)?;
    let (seed, world) = (scenario.seed, crate::mission::world_name(scenario.world));
    let progress = Simulated::new(&scenario.name);
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
