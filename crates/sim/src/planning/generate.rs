//! Files of planning instances, made from a seed.

use clap::ValueEnum;
use cohaul_planner::generate::{self, CarShape, GenerateError, Goals, GridShape};
use cohaul_planner::instance::{Drive, Instance, Vehicle};
use cohaul_planner::io::{self, Heading, movingai};

/// What kind of instances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
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

impl Kind {
    /// The one called `name`, as the command has it.
    pub fn named(name: &str) -> Option<Self> {
        Self::from_str(name, false).ok()
    }
}

/// What an instance is to be like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// What kind of instance.
    pub kind: Kind,
    /// How many agents.
    pub agents: usize,
    /// Side of the square map, cells or m; the benchmarks' usual ones without it.
    pub size: Option<u16>,
    /// How many obstacles; as many as the benchmarks have without it.
    pub obstacles: Option<usize>,
    /// How many goals an agent may take, for the kinds with windows.
    pub window: usize,
}

/// Names and texts of the files of one instance.
///
/// # Errors
/// Numbers out of range, or too little room.
pub fn made(wanted: &Wanted, seed: u64) -> Result<Vec<(String, String)>, GenerateError> {
    let (agents, window) = (wanted.agents, wanted.window);
    let (goals, ending) = match wanted.kind {
        Kind::GridAll | Kind::CarAll => (Goals::All, "_all".to_owned()),
        Kind::GridWindow | Kind::CarWindow => (Goals::Window(window), format!("_win{window}")),
        Kind::ForwardCar => (Goals::Own, "_forward".to_owned()),
        Kind::Differential => (Goals::Own, "_differential".to_owned()),
        Kind::Grid | Kind::Movingai | Kind::Car => (Goals::Own, String::new()),
    };
    let is_grid = matches!(wanted.kind, Kind::Grid | Kind::GridAll | Kind::GridWindow | Kind::Movingai);
    let side = wanted.size.unwrap_or(if is_grid { 32 } else { 100 });
    let size = i32::from(side);
    let cells = usize::from(side) * usize::from(side);
    let obstacles = wanted.obstacles.unwrap_or(match (is_grid, side) {
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
        if wanted.kind == Kind::Movingai {
            let (map, scenario) = movingai::write(&instance, &format!("{name}.map"));
            return Ok(vec![(format!("{name}.map"), map), (format!("{name}.scen"), scenario)]);
        }
        return Ok(vec![(format!("{name}.yaml"), io::write(&Instance::Grid(instance), Heading::default()))]);
    }
    let vehicle = match wanted.kind {
        Kind::ForwardCar => Vehicle { drive: Drive::ForwardCar, ..Vehicle::default() },
        // of the same size, turning about its middle
        Kind::Differential => Vehicle { drive: Drive::Differential, front: 1.5, rear: 1.5, ..Vehicle::default() },
        _ => Vehicle::default(),
    };
    let shape = CarShape { size, obstacles, obstacle_radius: 0.8, agents, goals, vehicle };
    let instance = generate::car(&shape, seed)?;
    Ok(vec![(format!("{name}.yaml"), io::write(&Instance::Car(instance), Heading::default()))])
}
