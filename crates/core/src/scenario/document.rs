//! The scenario file as data. The JSON Schema in `scenarios/` is made from these structs.

mod mission;
mod r2p2;
mod settings;
mod vlf;

use std::collections::BTreeMap;

use garde::Validate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use mission::{Controller, Mission, Plan, Point};
pub use r2p2::{Drive, Prevent, R2p2, Reposition, Stance, Support, Variant};
pub use settings::{Physics, Sensors, Start};
pub use vlf::Vlf;

const NAME_PATTERN: &str = "^[A-Za-z0-9_-]{1,64}$";

/// A mission's name becomes part of file names.
fn is_name(text: &str, _: &()) -> garde::Result {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if (1..=64).contains(&text.len()) && text.chars().all(allowed) {
        Ok(())
    } else {
        Err(garde::Error::new("not a name of 1 to 64 letters, digits, `_` and `-`"))
    }
}

const ID_PATTERN: &str = "^[A-Za-z_][A-Za-z0-9_]{0,63}$";

/// An id becomes part of topics.
fn is_id(text: &str, _: &()) -> garde::Result {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let starts = text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    if starts && text.len() <= 64 && text.chars().all(allowed) {
        Ok(())
    } else {
        Err(garde::Error::new("not an id of 1 to 64 letters, digits and `_` that starts with a letter or `_`"))
    }
}

/// A whole scenario file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
#[garde(allow_unvalidated)]
#[schemars(title = "cohaul scenario")]
pub struct Scenario {
    /// Version of the format.
    pub format: Format,
    /// Name of the mission; the files written are named after it.
    #[garde(custom(is_name))]
    #[schemars(regex(pattern = NAME_PATTERN))]
    pub name: String,
    /// What the mission shows.
    #[serde(default)]
    #[garde(length(max = 10_000))]
    pub description: String,
    /// Which simulator runs it.
    pub world: WorldKind,
    /// Ground and fixed surroundings.
    #[serde(default)]
    #[garde(dive)]
    pub terrain: Terrain,
    /// What is moved.
    #[garde(length(min = 1, max = 64), dive)]
    pub loads: Vec<Load>,
    /// Who moves it.
    #[garde(length(min = 1, max = 64), dive)]
    pub teams: Vec<Team>,
    /// How poses are measured.
    #[serde(default)]
    #[garde(dive)]
    pub sensors: Sensors,
    /// Integration of the simulated world.
    #[serde(default)]
    #[garde(dive)]
    pub physics: Physics,
    /// Random displacement of every body at the start.
    #[serde(default)]
    #[garde(dive)]
    pub start: Start,
    /// Numeric keys drawn anew for every seed, uniformly from [low, high]: path as for `--set`, such as `loads.0.mass`.
    #[serde(default)]
    #[garde(length(max = 64))]
    #[schemars(extend("maxProperties" = 64))]
    pub randomize: BTreeMap<String, [f64; 2]>,
    /// Seed of everything random.
    #[serde(default = "Scenario::default_seed")]
    pub seed: u64,
}

impl Scenario {
    const fn default_seed() -> u64 {
        1
    }
}

/// Version of the file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Format {
    /// The first one.
    #[serde(rename = "cohaul/1")]
    V1,
}

/// Which simulator runs the scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WorldKind {
    /// Rigid bodies in the plane.
    Planar,
    /// Rigid bodies in space.
    Spatial,
}

/// Ground and fixed surroundings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
#[garde(allow_unvalidated)]
pub struct Terrain {
    /// Inclination of the ground, degrees; negative means that the direction `uphill_deg` leads downhill.
    #[garde(range(min = -80.0, max = 80.0))]
    pub slope_deg: f64,
    /// Direction of steepest ascent in the ground plane, degrees from the x axis.
    #[garde(range(min = -360.0, max = 360.0))]
    pub uphill_deg: f64,
    /// Coefficients of friction.
    #[garde(dive)]
    pub friction: Friction,
    /// Model of the friction between load and ground.
    pub ground: GroundModel,
    /// Fixed convex obstacles, each a list of corners [x, y] in the world, m.
    #[garde(length(max = 1000), inner(length(min = 3, max = 64), inner(inner(range(min = -1e4, max = 1e4)))))]
    pub obstacles: Vec<Vec<[f64; 2]>>,
    /// Solid walls around the rectangle [x_min, y_min, x_max, y_max], m.
    #[garde(inner(inner(range(min = -1e4, max = 1e4))))]
    #[schemars(inner(range(min = -1e4, max = 1e4)))]
    pub walls: Option<[f64; 4]>,
    /// Rectangle [x_min, y_min, x_max, y_max] that the centre of every load must stay in, m; leaving it loses the load.
    #[garde(inner(inner(range(min = -1e4, max = 1e4))))]
    #[schemars(inner(range(min = -1e4, max = 1e4)))]
    pub workspace: Option<[f64; 4]>,
}

impl Default for Terrain {
    fn default() -> Self {
        Self {
            slope_deg: 0.0,
            uphill_deg: 0.0,
            friction: Friction::default(),
            ground: GroundModel::Exact,
            obstacles: Vec::new(),
            walls: None,
            workspace: None,
        }
    }
}

/// Coefficients of friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
#[garde(allow_unvalidated)]
pub struct Friction {
    /// Between a sliding load and the ground.
    #[garde(range(min = 0.0, max = 2.0))]
    pub dynamic: f64,
    /// Between a resting load and the ground; the dynamic one where it is not given.
    #[serde(rename = "static")]
    #[garde(range(min = 0.0, max = 2.0))]
    pub breakaway: Option<f64>,
    /// Between wheels and ground: limits the traction of every robot.
    #[garde(range(min = 0.0, max = 2.0))]
    pub wheel: f64,
}

impl Default for Friction {
    fn default() -> Self {
        Self { dynamic: 0.1, breakaway: None, wheel: 0.9 }
    }
}

/// Model of the friction between load and ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GroundModel {
    /// Uniform pressure over the whole footprint.
    #[default]
    Exact,
    /// The ellipsoid with the same force and torque limits.
    Ellipsoid,
}

/// What is moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
#[garde(allow_unvalidated)]
pub struct Load {
    /// Name by which teams refer to it.
    #[garde(custom(is_id))]
    #[schemars(regex(pattern = ID_PATTERN))]
    pub id: String,
    /// Footprint.
    #[garde(dive)]
    pub shape: Shape,
    /// Height, m.
    #[serde(default = "Load::default_height")]
    #[garde(range(min = 0.001, max = 10.0))]
    pub height: f64,
    /// Mass, kg.
    #[garde(range(min = 0.001, max = 1e4))]
    pub mass: f64,
    /// Coefficient of friction between robot and load.
    #[serde(default = "Load::default_contact_friction")]
    #[garde(range(min = 0.0, max = 2.0))]
    pub contact_friction: f64,
    /// Where its centre starts; its heading is the x axis of its frame.
    #[serde(default)]
    #[garde(dive)]
    pub pose: Pose,
}

impl Load {
    const fn default_height() -> f64 {
        0.1
    }

    const fn default_contact_friction() -> f64 {
        0.3
    }
}

/// A convex footprint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[garde(allow_unvalidated)]
pub enum Shape {
    /// A rectangle.
    Rectangle {
        /// Extent across the heading (the long side of the paper's load), m.
        #[garde(range(min = 0.01, max = 100.0))]
        length: f64,
        /// Extent along the heading, m.
        #[garde(range(min = 0.01, max = 100.0))]
        width: f64,
    },
    /// Any convex polygon.
    Polygon {
        /// Corners [x, y] in the load's frame, m; the frame is moved to the centroid.
        #[garde(length(min = 3, max = 64), inner(inner(range(min = -100.0, max = 100.0))))]
        vertices: Vec<[f64; 2]>,
    },
}

/// A planar pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
#[garde(allow_unvalidated)]
pub struct Pose {
    /// m.
    #[garde(range(min = -1e4, max = 1e4))]
    pub x: f64,
    /// m.
    #[garde(range(min = -1e4, max = 1e4))]
    pub y: f64,
    /// Degrees, counter-clockwise.
    #[garde(range(min = -360.0, max = 360.0))]
    pub yaw_deg: f64,
}

/// A team: robots that move one load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
#[garde(allow_unvalidated)]
pub struct Team {
    /// Name.
    #[garde(custom(is_id))]
    #[schemars(regex(pattern = ID_PATTERN))]
    pub id: String,
    /// The load's `id`.
    pub load: String,
    /// The robots, all alike.
    #[garde(dive)]
    pub robots: Robots,
    /// Where they stand around the load.
    #[garde(dive)]
    pub formation: Formation,
    /// What they shall reach.
    #[garde(dive)]
    pub mission: Mission,
    /// How each of them decides.
    #[garde(dive)]
    pub controller: Controller,
}

/// Robots of a team, all alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
#[garde(allow_unvalidated)]
pub struct Robots {
    /// Kind of robot.
    #[serde(default)]
    pub model: RobotKind,
    /// How many.
    #[garde(range(min = 1, max = 64))]
    pub count: usize,
    /// Extra mass that each carries.
    #[serde(default)]
    #[garde(dive)]
    pub ballast: Option<Ballast>,
    /// Control rate of each robot, Hz, where it differs from the controller's `rate_hz`; one number per robot.
    #[serde(default)]
    #[garde(inner(inner(range(min = 0.1, max = 1000.0))))]
    #[schemars(inner(range(min = 0.1, max = 1000.0)))]
    pub rates_hz: Option<Vec<f64>>,
    /// Linear acceleration limit, m/s².
    #[serde(default = "Robots::default_acceleration")]
    #[garde(range(min = 0.01, max = 100.0))]
    pub acceleration: f64,
    /// Angular acceleration limit, rad/s².
    #[serde(default = "Robots::default_angular_acceleration")]
    #[garde(range(min = 0.01, max = 1000.0))]
    pub angular_acceleration: f64,
    /// Step to which the base truncates commands toward zero, m/s and rad/s; 0 for none.
    #[serde(default = "Robots::default_command_step")]
    #[garde(range(min = 0.0, max = 0.1))]
    pub command_step: f64,
}

impl Robots {
    const fn default_acceleration() -> f64 {
        1.0
    }

    const fn default_angular_acceleration() -> f64 {
        6.0
    }

    const fn default_command_step() -> f64 {
        0.01
    }
}

/// Kind of robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RobotKind {
    /// TurtleBot3 Burger: round, radius 0.105 m, 1.0 kg, 0.22 m/s, 2.84 rad/s.
    #[default]
    Turtlebot3Burger,
    /// The same body on a base that drives in any direction.
    Omnidirectional,
}

/// Extra mass on a robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
#[garde(allow_unvalidated)]
pub struct Ballast {
    /// kg.
    #[garde(range(min = 0.0, max = 100.0))]
    pub mass: f64,
    /// Where it sits.
    #[serde(default)]
    pub at: BallastPlace,
}

/// Where ballast sits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BallastPlace {
    /// Over the driven wheels: adds to the traction.
    #[default]
    Front,
    /// Over the caster: adds mass but no traction.
    Rear,
}

/// Where the robots of a team stand around their load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
#[garde(allow_unvalidated)]
pub struct Formation {
    /// Which slots.
    #[serde(default)]
    #[garde(dive)]
    pub slots: Slots,
    /// Distance of the outer slots from the corner along the edge, m (R2P2, Table III, c).
    #[serde(default = "Formation::default_contact_placement")]
    #[garde(range(min = 0.0, max = 50.0))]
    pub contact_placement: f64,
    /// Distance between the robots' bodies and the load in their slots, m.
    #[serde(default = "Formation::default_gap")]
    #[garde(range(min = 0.0, max = 1.0))]
    pub gap: f64,
    /// What it means if the load could slip out between two robots.
    #[serde(default)]
    pub caging: Option<Caging>,
}

impl Formation {
    const fn default_contact_placement() -> f64 {
        0.175
    }

    const fn default_gap() -> f64 {
        0.01
    }
}

/// Which slots a formation has.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(rename_all = "snake_case")]
#[garde(allow_unvalidated)]
pub enum Slots {
    /// Two on each long side, one at each short end (R2P2, Fig. 4).
    #[default]
    Six,
    /// Two on each long side (R2P2, §VII).
    Four,
    /// The best places for 3 to 12 robots around any load, chosen before the mission starts (see `cohaul check`).
    Auto,
    /// Any places on the load's edges, one per robot.
    Custom(#[garde(length(min = 1, max = 64), dive)] Vec<CustomSlot>),
}

/// A slot on an edge of the load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
#[garde(allow_unvalidated)]
pub struct CustomSlot {
    /// Edge of the footprint, counter-clockwise from 0; a rectangle's edge 0 is its right side, edge 1 its front.
    #[garde(range(min = 0, max = 63))]
    pub edge: usize,
    /// Place along the edge, 0 at its start, 1 at its end.
    #[garde(range(min = 0.0, max = 1.0))]
    pub at: f64,
}

/// What it means if the load could slip out between two robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Caging {
    /// The scenario is refused.
    Required,
    /// A warning.
    Partial,
    /// Nothing.
    None,
}
