//! `cohaul generate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use cohaul_planner::generate::{self, CarShape, Goals, GridShape};
use cohaul_planner::instance::{Drive, Instance, Vehicle};
use cohaul_planner::io::{self, Heading, movingai};
use serde_json::json;

use super::{DONE, say};
use crate::files::{self, FileError};

/// What kind of instances.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Kind {
    /// Agents on a grid, YAML of libMultiRobotPlanning.
    Grid,
    /// The same, every agent may take any goal.
    GridAll,
    /// The same, agent i may take the goals i to i + window − 1.
    GridWindow,
    /// Agents on a grid, MovingAI .map and .scen.
    Movingai,
    /// Cars, YAML of CL-CBS, with the distribution of its benchmark.
    Car,
    /// Cars that may take any goal.
    CarAll,
    /// Cars that may take the goals i to i + window − 1.
    CarWindow,
    /// Cars that only drive forwards.
    ForwardCar,
    /// Robots that turn in place.
    Differential,
}

#[derive(Args)]
pub(super) struct Generate {
    /// What kind of instances.
    #[arg(value_enum)]
    kind: Kind,
    /// How many agents each.
    #[arg(long, value_name = "N", default_value = "10")]
    agents: usize,
    /// Side of the square map: cells for grids (32 if not given), metres for bodies (100).
    #[arg(long, value_name = "S")]
    size: Option<u16>,
    /// How many obstacles: a fifth of the cells if not given; 25, 50 or 100 for bodies on maps of 50, 100, 300 m.
    #[arg(long, value_name = "N")]
    obstacles: Option<usize>,
    /// How many goals an agent may take, for the kinds with windows.
    #[arg(long, value_name = "K", default_value = "3")]
    window: usize,
    /// Seed of the first instance; the others have the following ones.
    #[arg(long, value_name = "N", default_value = "1")]
    seed: u64,
    /// How many instances.
    #[arg(long, value_name = "K", default_value = "1")]
    count: u64,
    /// Folder for the files.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    pub(super) json: bool,
}

pub(super) fn generate(arguments: &Generate) -> Result<i32, FileError> {
    files::create_folder(&arguments.out)?;
    let mut written = Vec::new();
    for number in 0..arguments.count {
        let seed = arguments.seed.wrapping_add(number);
        for (name, text) in made(arguments, seed)? {
            let path = arguments.out.join(name);
            files::write_text(&path, &text)?;
            if !arguments.json {
                say(&path.display().to_string());
            }
            written.push(path);
        }
    }
    if arguments.json {
        say(&json!({ "files": written, "seed": arguments.seed, "count": arguments.count }).to_string());
    }
    Ok(DONE)
}

/// Names and texts of the files of one instance.
fn made(arguments: &Generate, seed: u64) -> Result<Vec<(String, String)>, FileError> {
    let (agents, window) = (arguments.agents, arguments.window);
    let (goals, ending) = match arguments.kind {
        Kind::GridAll | Kind::CarAll => (Goals::All, "_all".to_owned()),
        Kind::GridWindow | Kind::CarWindow => (Goals::Window(window), format!("_win{window}")),
        Kind::ForwardCar => (Goals::Own, "_forward".to_owned()),
        Kind::Differential => (Goals::Own, "_differential".to_owned()),
        Kind::Grid | Kind::Movingai | Kind::Car => (Goals::Own, String::new()),
    };
    let is_grid = matches!(arguments.kind, Kind::Grid | Kind::GridAll | Kind::GridWindow | Kind::Movingai);
    let side = arguments.size.unwrap_or(if is_grid { 32 } else { 100 });
    let size = i32::from(side);
    let cells = usize::from(side) * usize::from(side);
    let obstacles = arguments.obstacles.unwrap_or(match (is_grid, side) {
        // as many as the benchmarks have
        (true, _) => cells / 5,
        (false, ..75) => 25,
        (false, 75..200) => 50,
        (false, 200..) => 100,
    });
    let name = format!("map_{size}by{size}_obst{obstacles}_agents{agents}_ex{seed}{ending}");
    if is_grid {
        let shape = GridShape { width: size, height: size, obstacles, agents, goals };
        let instance = generate::grid(&shape, seed)?;
        if arguments.kind == Kind::Movingai {
            let (map, scenario) = movingai::write(&instance, &format!("{name}.map"));
            return Ok(vec![(format!("{name}.map"), map), (format!("{name}.scen"), scenario)]);
        }
        return Ok(vec![(format!("{name}.yaml"), io::write(&Instance::Grid(instance), Heading::default()))]);
    }
    let vehicle = match arguments.kind {
        Kind::ForwardCar => Vehicle { drive: Drive::ForwardCar, ..Vehicle::default() },
        // of the same size, turning about its middle
        Kind::Differential => Vehicle { drive: Drive::Differential, front: 1.5, rear: 1.5, ..Vehicle::default() },
        _ => Vehicle::default(),
    };
    let shape = CarShape { size, obstacles, obstacle_radius: 0.8, agents, goals, vehicle };
    let instance = generate::car(&shape, seed)?;
    Ok(vec![(format!("{name}.yaml"), io::write(&Instance::Car(instance), Heading::default()))])
}
