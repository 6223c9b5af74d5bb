//! Instances in YAML: libMultiRobotPlanning's grids, CL-CBS's cars, and what we add to the latter.

use nalgebra::{Point2, Vector2};

use super::error::{FormatError, FormatProblem};
use super::vehicle::{Config, decode as decode_vehicle};
use super::yaml::{Node, Tree};
use super::{Heading, MAX_AGENTS, MAX_CELLS, MAX_COORDINATE, MAX_GOALS, MAX_OBSTACLES};
use crate::instance::{CarAgent, CarInstance, Cell, GridAgent, GridInstance, Instance, Obstacle};
use cohaul_core::se2::{self, Pose2};

/// How to read a file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// The body, in place of what the file says of it; otherwise the file's, otherwise the car of CL-CBS.
    pub config: Option<Config>,
    /// Only so many of the agents, the first ones.
    pub agents: Option<usize>,
}

/// An instance, and how its file speaks.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// What is asked.
    pub instance: Instance,
    /// How the file's yaws turn; a plan for it is written the same way.
    pub heading: Heading,
}

/// Reads an instance from `text`; `name` is the file's, for messages.
///
/// # Errors
/// What is wrong, and where. Files of other kinds are told apart: a plan, a mission, a MovingAI file (of which
/// [`movingai::read`](super::movingai::read) reads two at once).
pub fn read(text: &str, name: &str, options: &Options) -> Result<Instance, FormatError> {
    read_document(text, name, options).map(|document| document.instance)
}

/// Reads an instance and how its file speaks.
///
/// # Errors
/// As [`read`].
pub fn read_document(text: &str, name: &str, options: &Options) -> Result<Document, FormatError> {
    let first = text.lines().next().unwrap_or_default();
    if first.starts_with("type ") || first.starts_with("version ") {
        let found = "this is a MovingAI file, of which two make an instance";
        let remedy = "give the .scen file, with the .map file that it names";
        return Err(FormatError::new(name, 1, 1, FormatProblem::OtherKind { found, remedy }));
    }
    let tree = Tree::read(name, text)?;
    let root = tree.root();
    let others = [
        (
            "schedule",
            "this is a plan, not an instance",
            "give it to `cohaul certify`, or give the file it was made from",
        ),
        ("format", "this is the scenario of a mission, not an instance", "give it to `cohaul run`"),
    ];
    for (key, found, remedy) in others {
        if root.get(key).is_some() {
            return Err(root.error(FormatProblem::OtherKind { found, remedy }));
        }
    }
    let place = "the file";
    if root.is_null() {
        return Err(root.error(FormatProblem::MissingKey { key: "agents", place }));
    }
    let [agents, map, vehicle, heading] = root.fields(place, ["agents", "map", "vehicle", "heading"])?;
    let agents = agents.ok_or_else(|| root.error(FormatProblem::MissingKey { key: "agents", place }))?;
    let map = map.ok_or_else(|| root.error(FormatProblem::MissingKey { key: "map", place }))?;
    let places = "the map";
    let [dimensions, obstacles, polygons] = map.fields(places, ["dimensions", "obstacles", "polygons"])?;
    let dimensions =
        dimensions.ok_or_else(|| map.error(FormatProblem::MissingKey { key: "dimensions", place: places }))?;

    let agents = raw_agents(agents, options.agents)?;
    let is_car = match agents.first() {
        Some(agent) => agent.start.len() == 3,
        None => vehicle.is_some() || heading.is_some() || polygons.is_some() || options.config.is_some(),
    };
    if !is_car {
        for (node, key) in [(vehicle, "vehicle"), (heading, "heading"), (polygons, "polygons")] {
            if let Some(node) = node {
                let allowed = vec!["agents", "map", "dimensions", "obstacles"];
                let problem = FormatProblem::UnknownKey { key: key.to_owned(), place: "a file of cells", allowed };
                return Err(node.error(problem));
            }
        }
        let instance = grid(dimensions, obstacles, &agents)?;
        return Ok(Document { instance: Instance::Grid(instance), heading: Heading::default() });
    }
    let config = match (options.config, vehicle) {
        (Some(config), _) => config,
        (None, Some(node)) => decode_vehicle(node, "the vehicle")?,
        (None, None) => Config::default(),
    };
    let heading = heading.map(turning).transpose()?.unwrap_or_default();
    let (width, height) = plane(dimensions, &config)?;
    let mut obstacles = points(obstacles, config.obstacle_radius)?;
    obstacles.extend(convex_polygons(polygons)?);
    let assignment = agents.iter().any(|agent| agent.potential.is_some());
    let mut bodies = Vec::with_capacity(agents.len());
    for agent in &agents {
        let start = pose(agent.start, "start", heading)?;
        bodies.push(CarAgent {
            name: agent.name.clone(),
            start,
            goals: agent.goals(|node| pose(node, "goal", heading))?,
        });
    }
    let vehicle = config.vehicle;
    let instance = CarInstance { width, height, obstacles, vehicle, agents: bodies, assignment, free_starts: false };
    Ok(Document { instance: Instance::Car(instance), heading })
}

/// An agent before its numbers are read.
struct RawAgent<'a> {
    name: String,
    start: Node<'a>,
    goal: Option<Node<'a>>,
    potential: Option<Node<'a>>,
}

impl<'a> RawAgent<'a> {
    fn goals<T>(&self, read: impl Fn(Node<'a>) -> Result<T, FormatError>) -> Result<Vec<T>, FormatError> {
        match (self.goal, self.potential) {
            (Some(goal), _) => Ok(vec![read(goal)?]),
            (None, Some(list)) => list.items("potentialGoals")?.map(read).collect(),
            (None, None) => Ok(Vec::new()),
        }
    }
}

fn raw_agents(list: Node<'_>, asked: Option<usize>) -> Result<Vec<RawAgent<'_>>, FormatError> {
    let present = list.len();
    if present > MAX_AGENTS {
        return Err(list.error(FormatProblem::TooMany { what: "agents", count: present, most: MAX_AGENTS }));
    }
    if let Some(asked) = asked
        && asked > present
    {
        return Err(list.error(FormatProblem::TooFewAgents { asked, present }));
    }
    let mut agents = Vec::with_capacity(present);
    let mut goals = 0;
    for (index, node) in list.items("agents")?.enumerate().take(asked.unwrap_or(present)) {
        let place = "an agent";
        let [name, start, goal, potential] = node.fields(place, ["name", "start", "goal", "potentialGoals"])?;
        let start = start.ok_or_else(|| node.error(FormatProblem::MissingKey { key: "start", place }))?;
        match (goal, potential) {
            (None, None) => return Err(node.error(FormatProblem::MissingKey { key: "goal", place })),
            (Some(_), Some(_)) => return Err(node.error(FormatProblem::TwoKindsOfGoals)),
            _ => {}
        }
        goals += potential.map_or(1, Node::len);
        if goals > MAX_GOALS {
            return Err(node.error(FormatProblem::TooMany { what: "goals", count: goals, most: MAX_GOALS }));
        }
        let name = match name {
            Some(name) => name.text("name")?.to_owned(),
            None => format!("agent{index}"),
        };
        agents.push(RawAgent { name, start, goal, potential });
    }
    let mut order: Vec<usize> = (0..agents.len()).collect();
    order.sort_by(|a, b| agents[*a].name.cmp(&agents[*b].name).then(a.cmp(b)));
    if let Some(twice) = order.windows(2).find(|pair| agents[pair[0]].name == agents[pair[1]].name) {
        let agent = &agents[twice[1]];
        return Err(agent.start.error(FormatProblem::DuplicateName { name: agent.name.clone() }));
    }
    Ok(agents)
}

const CELL: &str = "a cell [x, y] of two whole numbers";
const POSE: &str = "a pose [x, y, yaw]";
const POINT: &str = "a point [x, y]";

fn cell(node: Node<'_>, what: &str) -> Result<Cell, FormatError> {
    let [x, y] = node.tuple(what, CELL)?;
    let read = |node: Node<'_>| {
        let value = node.whole(what)?;
        let range = "between -1000000000 and 1000000000";
        match i32::try_from(value) {
            Ok(value) if value.abs() <= 1_000_000_000 => Ok(value),
            _ => Err(node.error(FormatProblem::OutOfRange { what: what.to_owned(), value: value as f64, range })),
        }
    };
    Ok(Cell { x: read(x)?, y: read(y)? })
}

fn coordinate(node: Node<'_>, what: &str) -> Result<f64, FormatError> {
    let value = node.number(what)?;
    if value.abs() > MAX_COORDINATE {
        let range = "between -1000000 and 1000000";
        return Err(node.error(FormatProblem::OutOfRange { what: what.to_owned(), value, range }));
    }
    Ok(value)
}

fn point(node: Node<'_>, what: &str) -> Result<Point2<f64>, FormatError> {
    let [x, y] = node.tuple(what, POINT)?;
    Ok(Point2::new(coordinate(x, what)?, coordinate(y, what)?))
}

fn pose(node: Node<'_>, what: &str, heading: Heading) -> Result<Pose2, FormatError> {
    let [x, y, yaw] = node.tuple(what, POSE)?;
    Ok(se2::pose(coordinate(x, what)?, coordinate(y, what)?, heading.turned(coordinate(yaw, what)?)))
}

fn turning(node: Node<'_>) -> Result<Heading, FormatError> {
    let expected = "`clockwise` or `counterclockwise`";
    match node.text("heading").map_err(|_| node.wrong("heading", expected))? {
        "clockwise" => Ok(Heading::Clockwise),
        "counterclockwise" => Ok(Heading::CounterClockwise),
        _ => Err(node.wrong("heading", expected)),
    }
}

fn grid(
    dimensions: Node<'_>,
    obstacles: Option<Node<'_>>,
    agents: &[RawAgent<'_>],
) -> Result<GridInstance, FormatError> {
    let [width, height] = dimensions.tuple("dimensions", "two whole numbers [columns, rows]")?;
    let side = |node: Node<'_>| {
        let value = node.whole("dimensions")?;
        let range = "between 1 and 16777216";
        match i32::try_from(value) {
            Ok(value) if (1..=1 << 24).contains(&value) => Ok(value),
            _ => {
                Err(node.error(FormatProblem::OutOfRange { what: "dimensions".to_owned(), value: value as f64, range }))
            }
        }
    };
    let (width, height) = (side(width)?, side(height)?);
    let cells = width as usize * height as usize;
    if cells > MAX_CELLS {
        let (width, height) = (f64::from(width), f64::from(height));
        return Err(dimensions.error(FormatProblem::TooLarge { width, height, cells: cells as f64, most: MAX_CELLS }));
    }
    let assignment = agents.iter().any(|agent| agent.potential.is_some());
    let mut instance = GridInstance { width, height, blocked: vec![false; cells], agents: Vec::new(), assignment };
    if let Some(list) = obstacles {
        for node in list.items("obstacles")? {
            // as in the programs that the format is from, an obstacle outside blocks nothing
            if let Some(index) = instance.index(cell(node, "obstacles")?) {
                instance.blocked[index] = true;
            }
        }
    }
    instance.agents.reserve(agents.len());
    for agent in agents {
        let start = cell(agent.start, "start")?;
        let goals = agent.goals(|node| cell(node, "goal"))?;
        instance.agents.push(GridAgent { name: agent.name.clone(), start, goals });
    }
    Ok(instance)
}

fn plane(dimensions: Node<'_>, config: &Config) -> Result<(f64, f64), FormatError> {
    let [width, height] = dimensions.tuple("dimensions", "two numbers [width, height]")?;
    let side = |node: Node<'_>| {
        let value = node.number("dimensions")?;
        if !(value > 0.0 && value <= MAX_COORDINATE) {
            let range = "more than 0 and at most 1000000";
            return Err(node.error(FormatProblem::OutOfRange { what: "dimensions".to_owned(), value, range }));
        }
        Ok(value)
    };
    let (width, height) = (side(width)?, side(height)?);
    let step = config.vehicle.step_length();
    let cells = (width / step).ceil() * (height / step).ceil();
    if cells > MAX_CELLS as f64 {
        return Err(dimensions.error(FormatProblem::TooLarge { width, height, cells, most: MAX_CELLS }));
    }
    Ok((width, height))
}

fn limited(list: Node<'_>) -> Result<(), FormatError> {
    if list.len() > MAX_OBSTACLES {
        return Err(list.error(FormatProblem::TooMany { what: "obstacles", count: list.len(), most: MAX_OBSTACLES }));
    }
    Ok(())
}

fn points(list: Option<Node<'_>>, radius: f64) -> Result<Vec<Obstacle>, FormatError> {
    let Some(list) = list else { return Ok(Vec::new()) };
    limited(list)?;
    list.items("obstacles")?.map(|node| Ok(Obstacle::Point { at: point(node, "obstacles")?, radius })).collect()
}

fn convex_polygons(list: Option<Node<'_>>) -> Result<Vec<Obstacle>, FormatError> {
    let Some(list) = list else { return Ok(Vec::new()) };
    limited(list)?;
    let mut polygons = Vec::with_capacity(list.len());
    for node in list.items("polygons")? {
        let mut corners = node.items("polygons")?.map(|node| point(node, "polygons")).collect::<Result<Vec<_>, _>>()?;
        if corners.len() < 3 || corners.len() > 1000 {
            return Err(node.wrong("polygons", "polygons of 3 to 1000 corners [x, y]"));
        }
        if turns(&corners).sum::<f64>() < 0.0 {
            corners.reverse();
        }
        if !is_convex(&corners) {
            return Err(node.error(FormatProblem::NotConvex));
        }
        polygons.push(Obstacle::Polygon(corners));
    }
    Ok(polygons)
}

/// By which angle the outline turns at each corner, counter-clockwise positive.
fn turns(corners: &[Point2<f64>]) -> impl Iterator<Item = f64> {
    let edge = |i: usize| -> Vector2<f64> { corners[(i + 1) % corners.len()] - corners[i % corners.len()] };
    (0..corners.len()).map(move |i| se2::cross(&edge(i), &edge(i + 1)).atan2(edge(i).dot(&edge(i + 1))))
}

/// Whether corners stand counter-clockwise around a convex area. Corners on a straight line may be off by rounding; needles and
/// edges of no length are none.
fn is_convex(corners: &[Point2<f64>]) -> bool {
    let sound = |turn: f64| (-1e-9..std::f64::consts::PI - 1e-6).contains(&turn);
    let apart = (0..corners.len()).all(|i| (corners[(i + 1) % corners.len()] - corners[i]).norm() >= 1e-6);
    apart && turns(corners).all(sound) && (turns(corners).sum::<f64>() - std::f64::consts::TAU).abs() < 1e-6
}

#[cfg(test)]
mod tests;
