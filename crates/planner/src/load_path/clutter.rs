//! Maps full of obstacles, each made from a seed: for experiments and tests.
//!
//! # Method
//! Between start and goal, ten metres apart in a walled field, lie 6 to 12 random convex polygons, one of them across the
//! straight line. A map is taken if the planner finds a way for the team of the scenario it is put into, within
//! [`TRIES`] draws; maps are thus feasible by construction.

use std::f64::consts::TAU;

use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::scenario::document::{Plan, Point, Scenario};
use cohaul_core::se2::unit;
use nalgebra::Vector2;

use super::{LoadPathError, resolve};
use crate::formation;

/// The field, as `terrain.walls`: x from, y from, x to, y to, m.
pub const FIELD: [f64; 4] = [-1.8, -4.5, 11.8, 4.5];
/// Where the load goes from the origin, m.
pub const GOAL: [f64; 2] = [10.0, 0.0];
/// Draws after which a seed is given up.
pub const TRIES: u64 = 200;
/// Fewest and most obstacles.
const COUNT: (u64, u64) = (6, 12);
/// Least and largest radius of an obstacle, m.
const RADIUS: (f64, f64) = (0.2, 0.6);
/// Room left around start and goal, m.
const ROOM: f64 = 1.6;

/// Obstacles of one map, as `terrain.obstacles`.
pub type Obstacles = Vec<Vec<[f64; 2]>>;

/// `scenario` on the map of `seed`: its first team's load goes from the origin to [`GOAL`] through obstacles in [`FIELD`], its
/// way to be planned.
///
/// # Errors
/// Why the last map drawn has no way, if none of [`TRIES`] has; a scenario without teams or with a bad one.
pub fn scenario(scenario: &Scenario, seed: u64) -> Result<Scenario, LoadPathError> {
    let mut cluttered = formation::resolve(scenario)?;
    cluttered.terrain.walls = Some(FIELD);
    let goal = Point { x: GOAL[0], y: GOAL[1] };
    for team in cluttered.teams.iter_mut().take(1) {
        team.mission.plan = Plan::Auto;
        team.mission.waypoints.clear();
        team.mission.goal = goal;
    }
    let mut attempt = 0;
    loop {
        cluttered.terrain.obstacles = draw(&mut Random(seed.wrapping_mul(TRIES).wrapping_add(attempt)));
        attempt += 1;
        match resolve(&cluttered) {
            Ok(_) => return Ok(cluttered),
            Err(LoadPathError::NoPassage { .. }) if attempt < TRIES => {}
            Err(error) => return Err(error),
        }
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [low, high).
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn draw(random: &mut Random) -> Obstacles {
    let count = COUNT.0 + random.next() % (COUNT.1 - COUNT.0 + 1);
    let [x_min, y_min, x_max, y_max] = FIELD;
    let goal = Vector2::from(GOAL);
    let mut obstacles = Obstacles::new();
    while (obstacles.len() as u64) < count {
        // the first one lies across the straight line
        let radius = random.between(RADIUS.0, RADIUS.1);
        let middle = if obstacles.is_empty() {
            Vector2::new(random.between(0.3, 0.7) * goal.x, random.between(-0.2, 0.2))
        } else {
            Vector2::new(random.between(x_min, x_max), random.between(y_min, y_max))
        };
        let corners = 3 + random.next() % 5;
        let first = random.between(0.0, TAU);
        let angle = |k: u64, random: &mut Random| first + TAU * (k as f64 + random.between(0.0, 0.6)) / corners as f64;
        let polygon: Vec<[f64; 2]> = (0..corners)
            .map(|k| {
                let at = middle + radius * unit(angle(k, random));
                // centimetres are enough, and read better
                [(100.0 * at.x).round() / 100.0, (100.0 * at.y).round() / 100.0]
            })
            .collect();
        let points: Vec<Vector2<f64>> = polygon.iter().map(|at| Vector2::from(*at)).collect();
        let clear = middle.norm() > ROOM + radius && (middle - goal).norm() > ROOM + radius;
        if clear && ConvexPolygon::new(&points).is_ok() {
            obstacles.push(polygon);
        }
    }
    obstacles
}
