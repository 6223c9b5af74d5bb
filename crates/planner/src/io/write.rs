//! Instances as YAML.

use std::fmt::Write as _;

use cohaul_core::se2::{self, Pose2};

use super::Heading;
use super::vehicle::{Config, drive_name};
use crate::instance::{CarInstance, GridInstance, Instance, Obstacle};

/// An instance as [`read_document`](super::read_document) reads it; yaws turn as `heading` says. What CL-CBS's files cannot say
/// is written only where it is needed, so that its program reads all others.
pub fn write(instance: &Instance, heading: Heading) -> String {
    let mut text = "agents:\n".to_owned();
    match instance {
        Instance::Grid(grid) => write_grid(&mut text, grid),
        Instance::Car(car) => write_car(&mut text, car, heading),
    }
    text
}

/// A name as a YAML scalar: as it is where nothing in it could be read as something else.
pub(super) fn quoted(name: &str) -> String {
    let plain = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && !matches!(
            name.to_ascii_lowercase().as_str(),
            "null" | "true" | "false" | "yes" | "no" | "on" | "off" | "y" | "n"
        );
    if plain {
        return name.to_owned();
    }
    let mut text = "\"".to_owned();
    for c in name.chars() {
        match c {
            '"' | '\\' => text.extend(['\\', c]),
            // control characters, and what YAML takes for line breaks or byte order marks
            c if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}') => {
                let _ = write!(text, "\\u{:04x}", c as u32);
            }
            c => text.push(c),
        }
    }
    text.push('"');
    text
}

fn write_grid(text: &mut String, grid: &GridInstance) {
    let cell = |cell: &crate::instance::Cell| format!("[{}, {}]", cell.x, cell.y);
    for agent in &grid.agents {
        let goals: Vec<String> = agent.goals.iter().map(cell).collect();
        write_agent(text, &agent.name, &cell(&agent.start), &goals, grid.assignment);
    }
    let _ = write!(text, "map:\n  dimensions: [{}, {}]\n  obstacles:", grid.width, grid.height);
    if !grid.blocked.contains(&true) {
        text.push_str(" []\n");
        return;
    }
    text.push('\n');
    let width = grid.width.max(1) as usize;
    for (index, _) in grid.blocked.iter().enumerate().filter(|(_, blocked)| **blocked) {
        let _ = writeln!(text, "  - [{}, {}]", index % width, index / width);
    }
}

fn write_agent(text: &mut String, name: &str, start: &str, goals: &[String], assignment: bool) {
    let _ = write!(text, "- name: {}\n  start: {start}\n", quoted(name));
    match goals {
        [goal] if !assignment => {
            let _ = writeln!(text, "  goal: {goal}");
        }
        [] => text.push_str("  potentialGoals: []\n"),
        goals => {
            text.push_str("  potentialGoals:\n");
            for goal in goals {
                let _ = writeln!(text, "  - {goal}");
            }
        }
    }
}

fn write_car(text: &mut String, car: &CarInstance, heading: Heading) {
    let pose = |pose: &Pose2| {
        let at = se2::position(pose);
        format!("[{}, {}, {}]", at.x, at.y, heading.turned(se2::yaw(pose)))
    };
    for agent in &car.agents {
        let goals: Vec<String> = agent.goals.iter().map(pose).collect();
        write_agent(text, &agent.name, &pose(&agent.start), &goals, car.assignment);
    }
    let _ = write!(text, "map:\n  dimensions: [{}, {}]\n  obstacles:", car.width, car.height);
    let mut radius = Config::default().obstacle_radius;
    let mut points = String::new();
    let mut polygons = String::new();
    for obstacle in &car.obstacles {
        match obstacle {
            Obstacle::Point { at, radius: kept } => {
                let _ = writeln!(points, "  - [{}, {}]", at.x, at.y);
                radius = *kept;
            }
            Obstacle::Polygon(corners) => {
                let corners: Vec<String> = corners.iter().map(|at| format!("[{}, {}]", at.x, at.y)).collect();
                let _ = writeln!(polygons, "  - [{}]", corners.join(", "));
            }
        }
    }
    text.push_str(if points.is_empty() { " []\n" } else { "\n" });
    text.push_str(&points);
    if !polygons.is_empty() {
        text.push_str("  polygons:\n");
        text.push_str(&polygons);
    }
    if heading == Heading::CounterClockwise {
        text.push_str("heading: counterclockwise\n");
    }
    write_vehicle(text, &Config { vehicle: car.vehicle, obstacle_radius: radius });
}

fn write_vehicle(text: &mut String, config: &Config) {
    let (vehicle, usual) = (&config.vehicle, Config::default());
    if *config == usual {
        return;
    }
    text.push_str("vehicle:\n");
    let numbers = [
        ("r", vehicle.turning_radius),
        ("deltat", vehicle.step_angle),
        ("penaltyTurning", vehicle.turning_penalty),
        ("penaltyReversing", vehicle.reversing_penalty),
        ("penaltyCOD", vehicle.switching_penalty),
        ("carWidth", vehicle.width),
        ("LF", vehicle.front),
        ("LB", vehicle.rear),
        ("obsRadius", config.obstacle_radius),
        ("stepTime", vehicle.step_time),
    ];
    for (key, value) in numbers {
        let _ = writeln!(text, "  {key}: {value}");
    }
    let _ = writeln!(text, "  drive: {}", drive_name(vehicle.drive));
}
