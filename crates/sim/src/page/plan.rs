//! A plan for many agents as a replay: time runs in steps.

use std::collections::BTreeMap;

use cohaul_core::se2::{Pose2, position, yaw};
use cohaul_planner::certify::Violation;
use cohaul_planner::instance::{CarInstance, Cell, Drive, GridInstance, Obstacle};
use cohaul_planner::plan::{CarPlan, Claims, GridPlan};

use super::{Frame, Kind, Replay, ReplayConflict, ReplayRobot, RobotFrame};

/// Side of the square that stands for an agent on a grid, cells.
const AGENT: f64 = 0.7;
/// Instants within a step at which bodies that drive on arcs are drawn, at most; straight lines lie between.
const INSTANTS_MAX: usize = 8;
/// Bodies times instants that are worth their bytes.
const BODY_FRAMES: usize = 90_000;
/// Bodies times steps that are kept at most.
const BODY_STEPS_MAX: usize = 1_000_000;

/// A plan with the instance that it solves.
#[derive(Clone, Copy, Debug)]
pub enum Planned<'a> {
    /// On a grid; the drawing has x to the right and y upwards, a cell is 1 m wide.
    Grid(&'a GridInstance, &'a GridPlan),
    /// For bodies that drive.
    Car(&'a CarInstance, &'a CarPlan),
}

/// The page that plays a plan, with the violations that a certifier found in it.
///
/// It is the page of missions ([`render`](super::render)), where time runs in steps and every body has its own colour; the
/// agents of a violation are red around its time.
///
/// ```
/// use cohaul_planner::instance::{Cell, GridAgent, GridInstance};
/// use cohaul_planner::plan::{Claims, GridPlan, Route};
/// use cohaul_sim::page::{Planned, plan_page, plan_picture};
///
/// let (start, goal) = (Cell { x: 0, y: 0 }, Cell { x: 1, y: 0 });
/// let agent = GridAgent { name: "a".into(), start, goals: vec![goal] };
/// let instance =
///     GridInstance { width: 2, height: 1, blocked: vec![false; 2], agents: vec![agent], assignment: false };
/// let route = Route { name: "a".into(), goal: Some(0), states: vec![start, goal] };
/// let plan = GridPlan { routes: vec![route], claims: Claims::default() };
/// let planned = Planned::Grid(&instance, &plan);
/// assert!(plan_page("one step", planned, &[]).starts_with("<!doctype html>"));
/// assert!(plan_picture("one step", planned, &[]).starts_with("<svg"));
/// ```
pub fn plan_page(title: &str, planned: Planned<'_>, violations: &[Violation]) -> String {
    super::render(&replay(title, planned, violations))
}

/// The drawing of a plan: obstacles, ways, bodies at their starts, goals, and bodies where they violate something.
pub fn plan_picture(title: &str, planned: Planned<'_>, violations: &[Violation]) -> String {
    super::plan_picture::picture(&replay(title, planned, violations))
}

/// Everything the page shows of a plan.
pub(super) fn replay(title: &str, planned: Planned<'_>, violations: &[Violation]) -> Replay {
    let mut replay = match planned {
        Planned::Grid(instance, plan) => grid(instance, plan),
        Planned::Car(instance, plan) => car(instance, plan),
    };
    let places = places(planned);
    replay.title = title.to_owned();
    replay.version = env!("CARGO_PKG_VERSION").to_owned();
    replay.kind = Kind::Plan;
    replay.success = violations.is_empty();
    replay.conflicts = violations
        .iter()
        .map(|violation| ReplayConflict {
            time: violation.time,
            kind: violation.kind.name().to_owned(),
            robots: violation.agents.iter().filter_map(|agent| places.get(*agent).copied().flatten()).collect(),
            text: violation.detail.clone(),
        })
        .collect();
    replay
}

/// Which route is that of each agent of the instance: the one in its place if it has its name, else the first that has it.
fn places(planned: Planned<'_>) -> Vec<Option<usize>> {
    let (agents, routes): (Vec<&str>, Vec<&str>) = match planned {
        Planned::Grid(instance, plan) => (
            instance.agents.iter().map(|agent| agent.name.as_str()).collect(),
            plan.routes.iter().map(|route| route.name.as_str()).collect(),
        ),
        Planned::Car(instance, plan) => (
            instance.agents.iter().map(|agent| agent.name.as_str()).collect(),
            plan.routes.iter().map(|route| route.name.as_str()).collect(),
        ),
    };
    let mut by_name = BTreeMap::new();
    for (place, name) in routes.iter().enumerate().rev() {
        by_name.insert(*name, place);
    }
    let place = |(agent, name): (usize, &&str)| {
        if routes.get(agent) == Some(name) { Some(agent) } else { by_name.get(name).copied() }
    };
    agents.iter().enumerate().map(place).collect()
}

/// Steps of which a frame is made: all, or every so many where they are absurdly many, and the last.
fn kept_steps(steps: usize, bodies: usize) -> impl Iterator<Item = usize> {
    let stride = (steps.saturating_mul(bodies) / BODY_STEPS_MAX).max(1);
    (0..steps).filter(move |step| step % stride == 0 || step + 1 == steps)
}

fn grid(instance: &GridInstance, plan: &GridPlan) -> Replay {
    let steps = plan.routes.iter().map(|route| route.states.len()).max().unwrap_or(0);
    let at = |cell: Cell| [f64::from(cell.x), f64::from(cell.y), 0.0];
    let half = AGENT / 2.0;
    let square = vec![[-half, -half], [half, -half], [half, half], [-half, half]];
    let goals = |agent: usize, goal: Option<usize>| {
        let given = instance.agents.get(agent)?;
        let index = if instance.assignment { goal? } else { goal.unwrap_or(0) };
        given.goals.get(index).map(|cell| at(*cell))
    };
    let robots = robots(plan.routes.iter().map(|r| (r.name.as_str(), r.goal)), &square, goals);
    let frames = kept_steps(steps, plan.routes.len())
        .map(|step| {
            let poses =
                plan.routes.iter().map(|route| state(&route.states, step).map_or([f64::NAN; 3], |cell| at(*cell)));
            frame(step as f64, poses)
        })
        .collect();
    let (width, height) = (f64::from(instance.width), f64::from(instance.height));
    Replay {
        description: described(
            instance.agents.len(),
            &format!("a grid of {} × {} cells", instance.width, instance.height),
        ),
        world: "grid".to_owned(),
        obstacles: blocked(instance),
        walls: Some([-0.5, -0.5, width - 0.5, height - 0.5]),
        robots,
        frames,
        outcome: outcome(&plan.claims, steps, ""),
        ..Replay::default()
    }
}

fn car(instance: &CarInstance, plan: &CarPlan) -> Replay {
    let steps = plan.routes.iter().map(|route| route.states.len()).max().unwrap_or(0);
    let vehicle = &instance.vehicle;
    let side = 0.5 * vehicle.width;
    let body = vec![[-vehicle.rear, -side], [vehicle.front, -side], [vehicle.front, side], [-vehicle.rear, side]];
    let goals = |agent: usize, goal: Option<usize>| {
        let given = instance.agents.get(agent)?;
        let index = if instance.assignment { goal? } else { goal.unwrap_or(0) };
        given.goals.get(index).map(numbers)
    };
    let robots = robots(plan.routes.iter().map(|r| (r.name.as_str(), r.goal)), &body, goals);
    let within = (BODY_FRAMES / (steps * plan.routes.len()).max(1)).clamp(1, INSTANTS_MAX);
    let mut frames = Vec::new();
    for step in kept_steps(steps, plan.routes.len()) {
        // nothing lies after the last
        for part in 0..if step + 1 < steps { within } else { 1 } {
            let share = part as f64 / within as f64;
            let poses = plan.routes.iter().map(|route| between(&route.states, step, share));
            frames.push(frame(step as f64 + share, poses));
        }
    }
    let kind = match vehicle.drive {
        Drive::Car => "cars",
        Drive::ForwardCar => "cars that only drive forwards",
        Drive::Differential => "robots that turn in place",
    };
    Replay {
        description: described(instance.agents.len(), &format!("{kind}, {} × {} m", instance.width, instance.height)),
        world: "plane".to_owned(),
        obstacles: instance.obstacles.iter().map(outline).collect(),
        workspace: Some([0.0, 0.0, instance.width, instance.height]),
        robots,
        frames,
        outcome: outcome(&plan.claims, steps, " m"),
        ..Replay::default()
    }
}

fn described(agents: usize, place: &str) -> String {
    format!("{agents} {}, {place}", if agents == 1 { "agent" } else { "agents" })
}

fn robots<'a>(
    routes: impl Iterator<Item = (&'a str, Option<usize>)>,
    body: &[[f64; 2]],
    goal: impl Fn(usize, Option<usize>) -> Option<[f64; 3]>,
) -> Vec<ReplayRobot> {
    let radius = body.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
    routes
        .enumerate()
        .map(|(agent, (name, taken))| ReplayRobot {
            name: name.to_owned(),
            radius,
            polygon: body.to_vec(),
            goal: goal(agent, taken),
            ..ReplayRobot::default()
        })
        .collect()
}

/// The state in this step; after the last one, the last.
fn state<S>(states: &[S], step: usize) -> Option<&S> {
    states.get(step).or(states.last())
}

fn frame(time: f64, poses: impl Iterator<Item = [f64; 3]>) -> Frame {
    let robots = poses.map(|pose| RobotFrame { pose, ..RobotFrame::default() }).collect();
    Frame { time, robots, ..Frame::default() }
}

fn numbers(pose: &Pose2) -> [f64; 3] {
    let place = position(pose);
    [place.x, place.y, yaw(pose)]
}

/// The pose at `share` of the step: the body keeps its velocity in its own frame, which makes arcs of arcs.
fn between(states: &[Pose2], step: usize, share: f64) -> [f64; 3] {
    let (Some(from), Some(to)) = (state(states, step), state(states, step + 1)) else { return [f64::NAN; 3] };
    if share == 0.0 {
        return numbers(from);
    }
    let mut twist = cohaul_core::se2::log(&(from.inverse() * to));
    twist.linear *= share;
    twist.angular *= share;
    numbers(&(from * cohaul_core::se2::exp(&twist)))
}

/// Corners of an obstacle.
fn outline(obstacle: &Obstacle) -> Vec<[f64; 2]> {
    match obstacle {
        Obstacle::Polygon(corners) => corners.iter().map(|corner| [corner.x, corner.y]).collect(),
        // the disc around the point, with enough corners to look like one
        Obstacle::Point { at, radius } => (0..16)
            .map(|k| {
                let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 8.0).sin_cos();
                [at.x + radius * cos, at.y + radius * sin]
            })
            .collect(),
    }
}

/// The blocked cells as rectangles: runs in a row, and equal runs in rows above each other.
fn blocked(instance: &GridInstance) -> Vec<Vec<[f64; 2]>> {
    let mut rectangles = Vec::new();
    // (first column, column after the last) of what goes on from the row before, and its first row
    let mut open: BTreeMap<(i32, i32), i32> = BTreeMap::new();
    let mut close = |(from, to): (i32, i32), first: i32, row: i32| {
        let [x0, x1, y0, y1] = [from, to, first, row].map(|edge| f64::from(edge) - 0.5);
        rectangles.push(vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
    };
    let width = usize::try_from(instance.width).unwrap_or(0).max(1);
    let mut row = 0;
    for cells in instance.blocked.chunks(width) {
        let mut runs = BTreeMap::new();
        let mut column = 0;
        for run in cells.chunk_by(|a, b| a == b) {
            let end = column + run.len() as i32;
            if run[0] {
                runs.insert((column, end), open.remove(&(column, end)).unwrap_or(row));
            }
            column = end;
        }
        for (span, first) in std::mem::replace(&mut open, runs) {
            close(span, first, row);
        }
        row += 1;
    }
    for (span, first) in open {
        close(span, first, row);
    }
    rectangles
}

/// What the plan says of itself.
fn outcome(claims: &Claims, steps: usize, unit: &str) -> Vec<(String, String)> {
    let number = |value: f64| format!("{}", (value * 1e3).round() / 1e3);
    let rows = [("Cost", claims.cost, ""), ("Makespan", claims.makespan, unit), ("Flowtime", claims.flowtime, unit)];
    let bounds = [("Lower bound", claims.lower_bound, ""), ("Bound", claims.bound, "")];
    let mut outcome = vec![("Steps".to_owned(), steps.saturating_sub(1).to_string())];
    outcome.extend(
        rows.iter()
            .chain(&bounds)
            .filter_map(|(name, value, unit)| Some(((*name).to_owned(), format!("{}{unit}", number((*value)?))))),
    );
    outcome
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul_core::se2::pose;

    /// ```text
    /// # # .
    /// # # #
    /// . # #
    /// ```
    #[test]
    fn blocked_cells_are_few_rectangles() {
        let blocked_cells = [1, 1, 0, 1, 1, 1, 0, 1, 1].map(|cell| cell == 1).to_vec();
        let instance = GridInstance { width: 3, height: 3, blocked: blocked_cells, agents: vec![], assignment: false };
        let rectangles = blocked(&instance);
        let area: f64 = rectangles.iter().map(|r| (r[2][0] - r[0][0]) * (r[2][1] - r[0][1])).sum();
        assert_eq!((rectangles.len(), area), (3, 7.0));
    }

    /// A quarter circle of radius 2 about (0, 2): halfway at 45°.
    #[test]
    fn bodies_are_drawn_on_their_arcs() {
        let states = [pose(0.0, 0.0, 0.0), pose(2.0, 2.0, std::f64::consts::FRAC_PI_2)];
        let [x, y, heading] = between(&states, 0, 0.5);
        let root = std::f64::consts::SQRT_2;
        assert!((x - root).abs() < 1e-12 && (y - (2.0 - root)).abs() < 1e-12); // rounding only
        assert!((heading - std::f64::consts::FRAC_PI_4).abs() < 1e-12);
    }
}
