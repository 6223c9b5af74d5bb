//! Instances of cars that measurements share.

use cohaul_planner::generate::{self, CarShape, Goals};
use cohaul_planner::instance::{CarInstance, Vehicle};

/// Cars on a square map with points in the way, as in the CL-CBS benchmark.
pub fn cars(seed: u64, size: i32, agents: usize, obstacles: usize) -> CarInstance {
    let (vehicle, goals) = (Vehicle::default(), Goals::Own);
    let shape = CarShape { size, obstacles, obstacle_radius: 0.8, agents, goals, vehicle };
    generate::car(&shape, seed).unwrap_or_else(|error| panic!("seed {seed}: {error}"))
}
