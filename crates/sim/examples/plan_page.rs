//! Writes the pages and pictures of two plans made by hand into a folder: `cargo run --release --example plan_page -- out`.
//!
//! One on a grid that is right, one for cars of which two are wrong.
#![expect(clippy::disallowed_methods, reason = "a program, which writes files")]

use std::path::PathBuf;

use cohaul_core::se2::{Pose2, pose};
use cohaul_planner::certify::{self, Model};
use cohaul_planner::instance::{CarAgent, CarInstance, Cell, GridAgent, GridInstance, Obstacle, Vehicle};
use cohaul_planner::plan::{CarPlan, Claims, GridPlan, Route};
use cohaul_sim::page::{Planned, plan_page, plan_picture};
use nalgebra::Point2;

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let (instance, plan) = grid();
    let violations = certify::grid(&instance, &plan);
    write(&folder, "grid", Planned::Grid(&instance, &plan), &violations)?;
    let (instance, plan) = cars();
    let violations = certify::car(&instance, &plan, Model::Exact);
    write(&folder, "cars", Planned::Car(&instance, &plan), &violations)
}

fn write(
    folder: &std::path::Path,
    name: &str,
    planned: Planned<'_>,
    violations: &[certify::Violation],
) -> std::io::Result<()> {
    std::fs::write(folder.join(format!("{name}.html")), plan_page(name, planned, violations))?;
    std::fs::write(folder.join(format!("{name}.svg")), plan_picture(name, planned, violations))
}

/// A ring of agents that goes round by three quarters, with walls inside.
fn grid() -> (GridInstance, GridPlan) {
    let (size, last) = (9_i32, 8_i32);
    // the cells along the border, once round
    let ring: Vec<Cell> = (0..last)
        .map(|x| Cell { x, y: 0 })
        .chain((0..last).map(|y| Cell { x: last, y }))
        .chain((0..last).map(|k| Cell { x: last - k, y: last }))
        .chain((0..last).map(|k| Cell { x: 0, y: last - k }))
        .collect();
    let blocked = (0..size * size)
        .map(|cell| {
            let (x, y) = (cell % size, cell / size);
            (2..=6).contains(&x) && (2..=6).contains(&y) && !(x == 4 || y == 4)
        })
        .collect();
    let agents = 16;
    let steps = 24;
    let cell = |agent: usize, step: usize| ring[(2 * agent + step) % ring.len()];
    let instance = GridInstance {
        width: size,
        height: size,
        blocked,
        agents: (0..agents)
            .map(|k| GridAgent { name: format!("agent{k}"), start: cell(k, 0), goals: vec![cell(k, steps)] })
            .collect(),
        assignment: false,
    };
    let routes = (0..agents)
        .map(|k| Route {
            name: format!("agent{k}"),
            goal: Some(0),
            states: (0..=steps).map(|step| cell(k, step)).collect(),
        })
        .collect();
    let cost = (agents * steps) as f64;
    let claims = Claims { cost: Some(cost), makespan: Some(steps as f64), flowtime: Some(cost), ..Claims::default() };
    (instance, GridPlan { routes, claims })
}

/// Cars of the CL-CBS benchmark on arcs; the second drives over the third, which is parked.
fn cars() -> (CarInstance, CarPlan) {
    let vehicle = Vehicle::default();
    let (step, angle) = (vehicle.step_length(), vehicle.step_angle);
    let drives: [(Pose2, &[(f64, f64)]); 4] = [
        (
            pose(10.0, 10.0, 0.0),
            &[(1.0, 1.0), (1.0, 1.0), (1.0, 0.0), (1.0, -1.0), (1.0, -1.0), (1.0, 0.0), (1.0, 0.0)],
        ),
        (pose(8.0, 30.0, -0.4), &[(1.0, 0.0), (1.0, 1.0), (1.0, 0.0), (1.0, 0.0), (1.0, 0.0), (1.0, 0.0), (1.0, 0.0)]),
        (pose(22.0, 31.0, 1.57), &[(0.0, 0.0), (-1.0, 0.0)]),
        (pose(38.0, 12.0, 2.0), &[(1.0, -1.0), (-1.0, 1.0), (0.0, 0.0), (1.0, -1.0), (1.0, 0.0), (0.6, 0.0)]),
    ];
    let mut agents = Vec::new();
    let mut routes = Vec::new();
    for (number, (start, steps)) in drives.into_iter().enumerate() {
        let mut states = vec![start];
        let mut at = start;
        for (length, side) in steps {
            let turn = side * length.abs() * angle;
            let twist = cohaul_core::se2::Twist2::new(length * step, 0.0, turn);
            at *= cohaul_core::se2::exp(&twist);
            states.push(at);
        }
        let name = format!("car{number}");
        agents.push(CarAgent { name: name.clone(), start, goals: vec![at] });
        routes.push(Route { name, goal: Some(0), states });
    }
    let corners = [(26.0, 18.0), (32.0, 16.0), (34.0, 21.0), (29.0, 23.0)];
    let obstacles = vec![
        Obstacle::Polygon(corners.iter().map(|(x, y)| Point2::new(*x, *y)).collect()),
        Obstacle::Point { at: Point2::new(20.0, 20.0), radius: 0.8 },
        Obstacle::Point { at: Point2::new(5.0, 18.0), radius: 0.8 },
        Obstacle::Point { at: Point2::new(40.0, 30.0), radius: 0.8 },
    ];
    let instance =
        CarInstance { width: 45.0, height: 40.0, obstacles, vehicle, agents, assignment: false, free_starts: false };
    (instance, CarPlan { routes, claims: Claims::default() })
}
