//! Instances from a seed: grids and cars, with goals of their own or to be assigned.
//!
//! The same seed gives the same instance on every machine: whole numbers are drawn from ChaCha8 by a rule that stands here.
//! Everything is feasible for each agent alone by construction: on grids all starts and goals lie in the largest connected
//! part; bodies stand clear of obstacles, of the border and of each other.
//!
//! # Source
//! Cars follow the distribution of the CL-CBS benchmark, measured on its files: starts and goals at whole numbers at least 2 m
//! from the border, a quarter to a half of the map's side between start and goal, all starts and goals at least 5.66, 7.81 or
//! 10.05 m apart on maps of 50, 100 and 300 m; yaws 0, 1.57, −1.57, 3.14 in turn, first the starts, then the goals; obstacles
//! anywhere, at least 1 m from each other and 2.75 m from every start and goal.
//!
//! # Deviations
//! A tenth of that benchmark's files with obstacles has a start or a goal inside an obstacle grown by its radius; here every
//! start and goal is clear of them. Bodies that only drive forwards stand further from the border and have a free
//! lane ahead of their starts and behind their goals, for one that faces something close could not turn away; that leaves some
//! that cannot reach their goals all the same.

use std::ops::RangeInclusive;

use cohaul_core::se2::{self, Pose2};
use nalgebra::Point2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::instance::{CarAgent, CarInstance, Cell, Drive, GridAgent, GridInstance, Obstacle, Vehicle, VehicleError};

/// Which goals an agent may take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Goals {
    /// One of its own.
    #[default]
    Own,
    /// Every goal.
    All,
    /// Agent i may take the goals i, i + 1, …, i + k − 1, counted around.
    Window(usize),
}

impl Goals {
    /// Indices of the goals of agent `agent` of `agents`.
    fn of(self, agent: usize, agents: usize) -> Vec<usize> {
        match self {
            Self::Own => vec![agent],
            Self::All => (0..agents).collect(),
            Self::Window(goals) => (0..goals.min(agents)).map(|step| (agent + step) % agents).collect(),
        }
    }
}

/// What a grid is to be like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridShape {
    /// Columns.
    pub width: i32,
    /// Rows.
    pub height: i32,
    /// Blocked cells.
    pub obstacles: usize,
    /// Agents.
    pub agents: usize,
    /// Their goals.
    pub goals: Goals,
}

/// What a plane with cars is to be like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarShape {
    /// Side of the square map, whole metres.
    pub size: i32,
    /// Points that are in the way.
    pub obstacles: usize,
    /// Distance that bodies keep from them, m.
    pub obstacle_radius: f64,
    /// Bodies.
    pub agents: usize,
    /// Their goals.
    pub goals: Goals,
    /// What they are like.
    pub vehicle: Vehicle,
}

impl CarShape {
    /// Least distance between any two of the starts and goals, m.
    pub fn separation(&self) -> f64 {
        // between whole numbers these are the distances √32, √61 and √101
        let usual = match self.size {
            ..=74 => 5.65,
            75..=199 => 7.81,
            _ => 10.04,
        };
        self.vehicle.separation().max(usual)
    }

    /// How far ahead of starts and behind goals no obstacle lies, m.
    fn lane(&self) -> f64 {
        match self.vehicle.drive {
            Drive::ForwardCar => 2.0 * self.vehicle.turning_radius,
            Drive::Car | Drive::Differential => 0.0,
        }
    }

    /// Least distance of starts and goals from the border, whole metres.
    fn border(&self) -> i32 {
        match self.vehicle.drive {
            Drive::ForwardCar => BORDER.max((self.vehicle.turning_radius + FORWARD_ROOM).ceil() as i32),
            Drive::Car | Drive::Differential => BORDER,
        }
    }
}

/// An instance that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// A number out of its range.
    #[error("{what} must be {range}, not {value}")]
    OutOfRange {
        /// Which.
        what: &'static str,
        /// The number.
        value: i64,
        /// What it must be.
        range: &'static str,
    },
    /// Too little room.
    #[error("found no room for {what} within {tries} tries; ask for fewer agents or obstacles, or a larger map")]
    NoRoom {
        /// For what.
        what: &'static str,
        /// How often it was tried.
        tries: u32,
    },
    /// A body that cannot be.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
}

struct Random(ChaCha8Rng);

impl Random {
    fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// A whole number of 0..below.
    fn below(&mut self, below: usize) -> usize {
        // the bias is below 2⁻³² for everything that is asked for here
        ((u128::from(self.0.next_u64()) * below as u128) >> 64) as usize
    }

    /// A number of [0, 1).
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (-53_f64).exp2()
    }
}

fn in_range(
    what: &'static str,
    value: i64,
    within: RangeInclusive<i64>,
    range: &'static str,
) -> Result<(), GenerateError> {
    if within.contains(&value) { Ok(()) } else { Err(GenerateError::OutOfRange { what, value, range }) }
}

fn name(agent: usize) -> String {
    format!("agent{agent}")
}

/// A grid: obstacles in any cells, starts and goals in different cells of the largest connected part.
///
/// # Errors
/// Numbers out of range, or too little room.
pub fn grid(shape: &GridShape, seed: u64) -> Result<GridInstance, GenerateError> {
    const TRIES: u32 = 100;
    let sides = "between 1 and 4096";
    in_range("the width", shape.width.into(), 1..=4096, sides)?;
    in_range("the height", shape.height.into(), 1..=4096, sides)?;
    in_range("the number of agents", shape.agents as i64, 1..=100_000, "between 1 and 100000")?;
    let cells = shape.width as usize * shape.height as usize;
    let mut random = Random::new(seed);
    for _ in 0..TRIES {
        let mut order: Vec<usize> = (0..cells).collect();
        let mut blocked = vec![false; cells];
        for taken in 0..shape.obstacles.min(cells) {
            order.swap(taken, taken + random.below(cells - taken));
            blocked[order[taken]] = true;
        }
        let mut free = largest_part(&blocked, shape.width as usize);
        let parts = free.len();
        if parts < shape.agents {
            continue;
        }
        let mut draw = || {
            for taken in 0..shape.agents {
                free.swap(taken, taken + random.below(parts - taken));
            }
            let cell = |index: &usize| Cell {
                x: (index % shape.width as usize) as i32,
                y: (index / shape.width as usize) as i32,
            };
            free[..shape.agents].iter().map(cell).collect::<Vec<_>>()
        };
        let (starts, ends) = (draw(), draw());
        let agents = starts.iter().enumerate().map(|(agent, start)| {
            let goals = shape.goals.of(agent, shape.agents).into_iter().map(|goal| ends[goal]).collect();
            GridAgent { name: name(agent), start: *start, goals }
        });
        return Ok(GridInstance {
            width: shape.width,
            height: shape.height,
            agents: agents.collect(),
            blocked,
            assignment: shape.goals != Goals::Own,
        });
    }
    Err(GenerateError::NoRoom { what: "the agents", tries: TRIES })
}

/// Cells of the largest 4-connected part; of several the one that holds the first cell.
fn largest_part(blocked: &[bool], width: usize) -> Vec<usize> {
    let mut seen = blocked.to_vec();
    let mut largest = Vec::new();
    for first in 0..blocked.len() {
        if seen[first] {
            continue;
        }
        seen[first] = true;
        let mut part = vec![first];
        let mut next = 0;
        while let Some(&cell) = part.get(next) {
            next += 1;
            let (x, up, down) = (cell % width, cell.wrapping_sub(width), cell + width);
            let left = if x > 0 { cell - 1 } else { usize::MAX };
            let right = if x + 1 < width { cell + 1 } else { usize::MAX };
            for neighbour in [left, right, up, down] {
                if seen.get(neighbour) == Some(&false) {
                    seen[neighbour] = true;
                    part.push(neighbour);
                }
            }
        }
        if part.len() > largest.len() {
            largest = part;
        }
    }
    largest.sort_unstable();
    largest
}

/// Yaws of the benchmark, counter-clockwise; its files have them with the other sign.
#[expect(clippy::approx_constant, reason = "as those files have it")]
const YAWS: [f64; 4] = [0.0, -1.57, 1.57, -3.14];
/// Least distance from the border, m.
const BORDER: i32 = 2;
/// What a body that only drives forwards needs beyond its turning radius to get away from the border, m.
const FORWARD_ROOM: f64 = 1.0;
/// Least distance of two obstacles, and of an obstacle from starts and goals, m.
const APART: f64 = 1.0;
const CLEAR: f64 = 2.75;

/// Cars with the distribution of the CL-CBS benchmark, or bodies of other kinds in their places.
///
/// # Errors
/// Numbers out of range, a body that cannot be, or too little room.
pub fn car(shape: &CarShape, seed: u64) -> Result<CarInstance, GenerateError> {
    const TRIES: u32 = 200;
    in_range("the size", shape.size.into(), 10..=10_000, "between 10 and 10000")?;
    in_range("the number of agents", shape.agents as i64, 1..=10_000, "between 1 and 10000")?;
    shape.vehicle.validate()?;
    let mut random = Random::new(seed);
    let mut what = "the agents";
    for _ in 0..TRIES {
        let Some((starts, ends)) = places(shape, &mut random) else { continue };
        what = "the obstacles";
        let Some(points) = obstacles(shape, &mut random, &starts, &ends) else { continue };
        let agents = starts.iter().enumerate().map(|(agent, start)| {
            let goals = shape.goals.of(agent, shape.agents).into_iter().map(|goal| ends[goal]).collect();
            CarAgent { name: name(agent), start: *start, goals }
        });
        let radius = shape.obstacle_radius;
        return Ok(CarInstance {
            free_starts: false,
            width: shape.size.into(),
            height: shape.size.into(),
            obstacles: points.into_iter().map(|at| Obstacle::Point { at, radius }).collect(),
            vehicle: shape.vehicle,
            agents: agents.collect(),
            assignment: shape.goals != Goals::Own,
        });
    }
    Err(GenerateError::NoRoom { what, tries: TRIES })
}

/// Starts and goals, or nothing where they did not find room.
fn places(shape: &CarShape, random: &mut Random) -> Option<(Vec<Pose2>, Vec<Pose2>)> {
    const TRIES: u32 = 20_000;
    let side = f64::from(shape.size);
    let separation = shape.separation();
    let border = shape.border();
    if 2 * border > shape.size {
        return None;
    }
    let mut taken: Vec<Point2<f64>> = Vec::with_capacity(2 * shape.agents);
    for number in 0..2 * shape.agents {
        let place = (0..TRIES).find_map(|_| {
            let mut draw = || f64::from(border) + random.below((shape.size - 2 * border + 1) as usize) as f64;
            let at = Point2::new(draw(), draw());
            let far = |other: &Point2<f64>| (at - other).norm() >= separation;
            let own_way = number.checked_sub(shape.agents).is_none_or(|agent| {
                let way = (at - taken[agent]).norm();
                (side / 4.0..=side / 2.0).contains(&way)
            });
            (own_way && taken.iter().all(far)).then_some(at)
        })?;
        taken.push(place);
    }
    let pose = |(number, at): (usize, &Point2<f64>)| se2::pose(at.x, at.y, YAWS[number % 4]);
    let mut poses: Vec<Pose2> = taken.iter().enumerate().map(pose).collect();
    let ends = poses.split_off(shape.agents);
    Some((poses, ends))
}

fn obstacles(shape: &CarShape, random: &mut Random, starts: &[Pose2], ends: &[Pose2]) -> Option<Vec<Point2<f64>>> {
    const TRIES: u32 = 2_000;
    let (side, radius, vehicle) = (f64::from(shape.size), shape.obstacle_radius, &shape.vehicle);
    let lane = shape.lane();
    let mut points: Vec<Point2<f64>> = Vec::with_capacity(shape.obstacles);
    for _ in 0..shape.obstacles {
        let place = (0..TRIES).find_map(|_| {
            let at = Point2::new(random.unit() * side, random.unit() * side);
            // `ahead` and `behind` are what is needed beyond the body's own length
            let clear = |pose: &Pose2, ahead: f64, behind: f64| {
                let seen = pose.inverse_transform_point(&at);
                let in_length = (-vehicle.rear - radius - behind..=vehicle.front + radius + ahead).contains(&seen.x);
                seen.coords.norm() >= CLEAR && !(in_length && seen.y.abs() <= vehicle.width / 2.0 + radius)
            };
            let apart = |other: &Point2<f64>| (at - other).norm() >= APART;
            let off_starts = || starts.iter().all(|pose| clear(pose, lane, 0.0));
            let off_ends = || ends.iter().all(|pose| clear(pose, 0.0, lane));
            (points.iter().all(apart) && off_starts() && off_ends()).then_some(at)
        })?;
        points.push(place);
    }
    Some(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instance::Instance;
    use crate::io;

    fn cars(size: i32, agents: usize, obstacles: usize) -> CarShape {
        let (vehicle, goals) = (Vehicle::default(), Goals::Own);
        CarShape { size, obstacles, obstacle_radius: 0.8, agents, goals, vehicle }
    }

    #[test]
    fn the_same_seed_gives_the_same_instance() {
        let shape = GridShape { width: 8, height: 8, obstacles: 12, agents: 5, goals: Goals::Own };
        assert_eq!(grid(&shape, 7), grid(&shape, 7));
        assert_ne!(grid(&shape, 7), grid(&shape, 8));
        assert_eq!(car(&cars(50, 5, 25), 7), car(&cars(50, 5, 25), 7));
    }

    #[test]
    fn grids_are_as_asked_for_and_connected() {
        for seed in 0..50 {
            let shape = GridShape { width: 9, height: 7, obstacles: 20, agents: 8, goals: Goals::Window(3) };
            let grid = grid(&shape, seed).unwrap();
            assert_eq!(grid.blocked.iter().filter(|blocked| **blocked).count(), 20);
            assert!(grid.assignment);
            let part = largest_part(&grid.blocked, 9);
            for (index, agent) in grid.agents.iter().enumerate() {
                assert_eq!(agent.goals.len(), 3);
                assert_eq!(agent.goals[1], grid.agents[(index + 1) % 8].goals[0]);
                for cell in agent.goals.iter().chain([&agent.start]) {
                    assert!(part.contains(&grid.index(*cell).unwrap()));
                }
                assert!(grid.agents[..index].iter().all(|other| other.start != agent.start));
            }
        }
    }

    /// The distribution of the benchmark (see the head of this module), five seeds for each size.
    #[test]
    fn cars_stand_as_in_the_benchmark() {
        for (size, agents, obstacles, least) in [(50, 20, 25, 32.0_f64), (100, 50, 50, 61.0), (300, 100, 100, 101.0)] {
            for seed in 0..5 {
                let made = car(&cars(size, agents, obstacles), seed).unwrap();
                let side = f64::from(size);
                let starts = made.agents.iter().map(|agent| agent.start);
                let poses: Vec<Pose2> = starts.chain(made.agents.iter().map(|agent| agent.goals[0])).collect();
                for (index, pose) in poses.iter().enumerate() {
                    let at = se2::position(pose);
                    assert!(at.iter().all(|x| x.fract() == 0.0 && (2.0..=side - 2.0).contains(x)));
                    assert_eq!(se2::yaw(pose), YAWS[index % 4]);
                    let squared = |other: &Pose2| (se2::position(other) - at).norm_squared();
                    assert!(poses[..index].iter().all(|other| squared(other) >= least));
                }
                for agent in &made.agents {
                    let way = (se2::position(&agent.start) - se2::position(&agent.goals[0])).norm();
                    assert!((side / 4.0..=side / 2.0).contains(&way));
                }
                assert_eq!(made.obstacles.len(), obstacles);
            }
        }
    }

    #[test]
    fn files_bring_back_what_was_made() {
        let made = Instance::Car(car(&cars(50, 10, 25), 3).unwrap());
        let text = io::write(&made, io::Heading::Clockwise);
        assert!(text.contains("goal: ") && text.contains(", 1.57]") && text.contains(", -1.57]"), "{text}");
        assert_eq!(io::read(&text, "made.yaml", &io::Options::default()).unwrap(), made);
    }

    #[test]
    fn what_cannot_be_made_is_said() {
        let crowd = GridShape { width: 3, height: 3, obstacles: 5, agents: 6, goals: Goals::Own };
        assert_eq!(grid(&crowd, 0), Err(GenerateError::NoRoom { what: "the agents", tries: 100 }));
        assert!(matches!(car(&cars(5, 1, 0), 0), Err(GenerateError::OutOfRange { what: "the size", .. })));
    }
}
