//! What can be wrong with a scenario, and what to do about it.

use super::decode::quoted;
use super::schema;
use crate::geometry::shape::ShapeError;
use crate::transport::formation::{CagingGap, FormationError};

/// What is wrong with a scenario. Paths are those of `--set`, such as `loads.0.mass`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file is too large to be a scenario.
    #[error("the file has {bytes} bytes, a scenario at most {limit}")]
    TooLarge {
        /// Size of the file.
        bytes: usize,
        /// Largest size.
        limit: usize,
    },
    /// The file is not text.
    #[error("the file is not UTF-8 text: byte {offset} cannot be read")]
    NotText {
        /// First bad byte, counted from 0.
        offset: usize,
    },
    /// The text is not YAML.
    #[error("not readable as YAML: {message}")]
    Syntax {
        /// What the YAML reader says.
        message: String,
    },
    /// Too deep, too many values or too many aliases.
    #[error("more nesting, values or aliases than a scenario may have: {message}")]
    Budget {
        /// What the YAML reader says.
        message: String,
    },
    /// A key is given twice.
    #[error("key `{key}` is given twice")]
    DuplicateKey {
        /// The key.
        key: String,
    },
    /// NaN, infinity or a number too large.
    #[error("{value} is not a finite number")]
    NotFinite {
        /// As written.
        value: String,
    },
    /// A value of another type.
    #[error("{}: expected {expected}, found {found}", place_name(path))]
    WrongType {
        /// Path of the value.
        path: String,
        /// What belongs there.
        expected: String,
        /// What is there.
        found: String,
    },
    /// A key that does not exist.
    #[error("unknown key `{key}` in {}", place_name(path))]
    UnknownKey {
        /// Path of the map.
        path: String,
        /// The key.
        key: String,
        /// Keys that exist there.
        allowed: Vec<String>,
    },
    /// A key that must be given.
    #[error("key `{key}` is missing in {}", place_name(path))]
    MissingKey {
        /// Path of the map.
        path: String,
        /// The key.
        key: String,
    },
    /// Not one of the words allowed.
    #[error("`{path}`: unknown value `{found}`")]
    UnknownValue {
        /// Path of the value.
        path: String,
        /// What is there.
        found: String,
        /// What may be there.
        allowed: Vec<String>,
    },
    /// A value outside its range.
    #[error("`{path}` is {value}: {reason}")]
    OutOfRange {
        /// Path of the value.
        path: String,
        /// As given.
        value: String,
        /// The bound that is passed.
        reason: String,
    },
    /// An index past the end of a list.
    #[error("`{path}` does not exist: `{list}` has {entries} entries, counted from 0")]
    NoSuchEntry {
        /// Path asked for.
        path: String,
        /// Path of the list.
        list: String,
        /// Its length.
        entries: usize,
    },
    /// An override that is not `path=value`.
    #[error("`{text}` is not an override: {reason}")]
    OverrideSyntax {
        /// As given.
        text: String,
        /// What is missing.
        reason: String,
    },
    /// A list of waypoints without any.
    #[error("`{path}` is an empty list")]
    EmptyWaypoints {
        /// Path of the list.
        path: String,
    },
    /// Not a convex polygon.
    #[error("`{path}`: {error}")]
    Shape {
        /// Path of the polygon.
        path: String,
        /// Why.
        error: ShapeError,
    },
    /// Robots cannot stand as the formation has it.
    #[error("team `{team}`: {error}")]
    Formation {
        /// Name of the team.
        team: String,
        /// Why.
        error: FormationError,
    },
    /// Waypoints that are still to be planned.
    #[error("team `{team}`: plan `auto` has not been resolved yet")]
    Unplanned {
        /// Name of the team.
        team: String,
    },
    /// The load could slip out of its formation.
    #[error("team `{team}` does not cage its load: {gap}")]
    Caging {
        /// Name of the team.
        team: String,
        /// The first way out.
        gap: CagingGap,
    },
    /// Two robots do not fit beside each other along the longest edge ([R2P2] §I, assumption ii).
    ///
    /// [R2P2]: crate::_documentation::references
    #[error(
        "load `{load}`: its longest edge, {length:.3} m, is not longer than two robots side by side, {needed:.3} m"
    )]
    ShortEdge {
        /// Name of the load.
        load: String,
        /// Longest edge, m.
        length: f64,
        /// Twice the diameter of a robot, m.
        needed: f64,
    },
    /// Two things have the same name.
    #[error("two {kind} are called `{id}`")]
    DuplicateId {
        /// Loads or teams.
        kind: &'static str,
        /// The name.
        id: String,
    },
    /// A team without its load.
    #[error("team `{team}` moves load `{load}`, which does not exist")]
    UnknownLoad {
        /// Name of the team.
        team: String,
        /// Name of the load.
        load: String,
        /// Loads of the scenario.
        loads: Vec<String>,
    },
    /// Two teams move one load.
    #[error("teams `{first}` and `{second}` both move load `{load}`")]
    SharedLoad {
        /// Name of the first team.
        first: String,
        /// Name of the second team.
        second: String,
        /// Name of the load.
        load: String,
    },
    /// Two bodies overlap at the start.
    #[error("{first} and {second} overlap at the start{}", depth_text(*depth))]
    Overlap {
        /// First body.
        first: String,
        /// Second body.
        second: String,
        /// How far the first, a robot, reaches into the second, m; `None` between two polygons.
        depth: Option<f64>,
    },
    /// Something lies outside the walls or the workspace.
    #[error("{what} ({x:.3}, {y:.3}) lies outside the {region}")]
    Outside {
        /// What.
        what: String,
        /// m.
        x: f64,
        /// m.
        y: f64,
        /// `walls` or `workspace`.
        region: &'static str,
    },
    /// A point to reach lies in an obstacle.
    #[error("{what} ({x:.3}, {y:.3}) lies in obstacle {obstacle}")]
    InObstacle {
        /// What.
        what: String,
        /// m.
        x: f64,
        /// m.
        y: f64,
        /// Obstacle, counted from 0.
        obstacle: usize,
    },
    /// Two values that contradict each other.
    #[error("`{path}`: {reason}")]
    Contradiction {
        /// Path of one of them.
        path: String,
        /// What contradicts what.
        reason: String,
        /// What to do about it.
        remedy: String,
    },
    /// A key that cannot be drawn.
    #[error("randomize: `{path}` cannot be drawn: {reason}")]
    Randomize {
        /// Path of the key.
        path: String,
        /// Why.
        reason: String,
    },
    /// Values that are allowed one by one, but not together.
    #[error("the values drawn ({drawn}) do not go together: {reason}")]
    Drawn {
        /// Keys and values.
        drawn: String,
        /// Why.
        reason: String,
    },
}

fn place_name(path: &str) -> String {
    if path.is_empty() { "the scenario".to_owned() } else { format!("`{path}`") }
}

fn depth_text(depth: Option<f64>) -> String {
    depth.map(|depth| format!(" by {depth:.3} m")).unwrap_or_default()
}

impl Problem {
    /// What to do about it.
    pub fn remedy(&self) -> String {
        match self {
            Self::TooLarge { .. } => "check that this is the scenario file; a usual one has a few kilobytes".to_owned(),
            Self::NotText { .. } => "save the file as UTF-8 text".to_owned(),
            Self::Syntax { .. } => {
                "check the indentation, the colons, brackets and quotes at this place; quote text with special characters"
                    .to_owned()
            }
            Self::Budget { .. } => "write the values out instead of nesting them or repeating them by aliases".to_owned(),
            Self::DuplicateKey { key } => format!("keep one of the two `{key}`"),
            Self::NotFinite { .. } => "give a finite number; leave an optional key out to get its default".to_owned(),
            Self::WrongType { path, expected, .. } => match schema::describe(path) {
                Some(key) if expected == "text" => format!("put the value in quotes. {}", key.description()),
                Some(key) => format!("give {expected}. {}", key.description()),
                None => format!("give {expected}"),
            },
            Self::UnknownKey { path, allowed, .. } => {
                format!("the keys of {} are {}", place_name(path), quoted(allowed))
            }
            Self::MissingKey { path, key } => {
                let described = schema::describe(&super::tree::join(path, key)).map(|key| key.description());
                format!("add `{key}: …`. {}", described.unwrap_or_default())
            }
            Self::UnknownValue { allowed, .. } => format!("write one of {}", quoted(allowed)),
            Self::OutOfRange { path, .. } => match schema::describe(path) {
                Some(key) => format!("give {}. {}", key.range(), key.description()),
                None => "give a value in range".to_owned(),
            },
            Self::NoSuchEntry { entries: 0, .. } => "set the whole list".to_owned(),
            Self::NoSuchEntry { list, entries, .. } => {
                format!("use `{list}.0` to `{list}.{}`, or `{list}.{entries}` to append", entries - 1)
            }
            Self::OverrideSyntax { .. } => "write path=value, such as `loads.0.mass=3.3`".to_owned(),
            Self::EmptyWaypoints { .. } => {
                "leave the key `waypoints` out for a mission with only a goal, or list points such as {x: 1.0, y: 0.4}"
                    .to_owned()
            }
            Self::Shape { .. } => {
                "list the corners [x, y] of a convex polygon in order, once around; split a non-convex one".to_owned()
            }
            Self::Formation { error, .. } => formation_remedy(error),
            Self::Unplanned { .. } => "resolve the scenario with the planner first, or list `waypoints`".to_owned(),
            Self::Caging { gap, .. } => match gap {
                CagingGap::TooWide { .. } => {
                    "bring the slots closer together (`contact_placement`, more `custom` slots) or write `caging: partial`"
                        .to_owned()
                }
                CagingGap::OpenEdge { .. } => {
                    "put a robot at every edge (slots `six` or `custom`) or write `caging: partial`".to_owned()
                }
            },
            Self::ShortEdge { .. } => "use a longer load or smaller robots; two robots cannot push one edge".to_owned(),
            Self::DuplicateId { .. } => "give each its own `id`".to_owned(),
            Self::UnknownLoad { loads, .. } => format!("the loads are {}", quoted(loads)),
            Self::SharedLoad { .. } => "give each team its own load, or make one team of the two".to_owned(),
            Self::Overlap { .. } => "move one of them: a load's `pose` moves its team with it".to_owned(),
            Self::Outside { region, .. } => format!("move it inside, or enlarge `terrain.{region}` or write null there"),
            Self::InObstacle { .. } => "move the point or the obstacle".to_owned(),
            Self::Contradiction { remedy, .. } => remedy.clone(),
            Self::Randomize { .. } => {
                "name a numeric key as for `--set`, with a range [low, high] whose ends are allowed values".to_owned()
            }
            Self::Drawn { .. } => "narrow the ranges in `randomize`".to_owned(),
        }
    }
}

fn formation_remedy(error: &FormationError) -> String {
    match error {
        FormationError::Count { slots, .. } => format!("set `robots.count` to {slots} or change the slots"),
        FormationError::Unresolved => {
            "resolve the scenario with the planner first, or list `custom` slots, one per robot".to_owned()
        }
        FormationError::NotRectangle { .. } => {
            "use `shape: {rectangle: …}`, slots `auto`, or list `custom` slots, one per robot".to_owned()
        }
        FormationError::Placement { limit, .. } if *limit < 0.0 => "use a longer load or `custom` slots".to_owned(),
        FormationError::Placement { limit, .. } => format!("set `contact_placement` between 0 and {limit:.3}"),
        FormationError::Edge { last, .. } => format!("use an edge from 0 to {last}"),
        FormationError::Overlap { .. } => "move the slots apart or use fewer robots".to_owned(),
    }
}
