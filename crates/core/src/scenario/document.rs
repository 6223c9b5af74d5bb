//! The scenario file as data. The JSON Schema in `scenarios/` is made from these structs.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A whole scenario file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Version of the format.
    pub format: Format,
    /// Name of the mission; the files written are named after it.
    pub name: String,
    /// What the mission shows.
    #[serde(default)]
    pub description: String,
    /// Which simulator runs it.
    pub world: WorldKind,
    /// Ground and fixed surroundings.
    #[serde(default)]
    pub terrain: Terrain,
    /// What is moved.
    pub loads: Vec<Load>,
    /// Who moves it.
    pub teams: Vec<Team>,
    /// How poses are measured.
    #[serde(default)]
    pub sensors: Sensors,
    /// Integration of the simulated world.
    #[serde(default)]
    pub physics: Physics,
    /// Random displacement of every body at the start.
    #[serde(default)]
    pub start: Start,
    /// Numeric keys drawn anew for every seed, uniformly from [low, high]: path as for `--set`, such as `loads.0.mass`.
    #[serde(default)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Terrain {
    /// Inclination of the ground, degrees; negative means that the direction `uphill_deg` leads downhill.
    pub slope_deg: f64,
    /// Direction of steepest ascent in the ground plane, degrees from the x axis.
    pub uphill_deg: f64,
    /// Coefficients of friction.
    pub friction: Friction,
    /// Model of the friction between load and ground.
    pub ground: GroundModel,
    /// Fixed convex obstacles, each a list of corners [x, y] in the world, m.
    pub obstacles: Vec<Vec<[f64; 2]>>,
    /// Solid walls around the rectangle [x_min, y_min, x_max, y_max], m.
    pub walls: Option<[f64; 4]>,
    /// Rectangle [x_min, y_min, x_max, y_max] that the centre of every load must stay in, m; leaving it loses the load.
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Friction {
    /// Between a sliding load and the ground.
    pub dynamic: f64,
    /// Between a resting load and the ground; the dynamic one where it is not given.
    #[serde(rename = "static")]
    pub breakaway: Option<f64>,
    /// Between wheels and ground: limits the traction of every robot.
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Name by which teams refer to it.
    pub id: String,
    /// Footprint.
    pub shape: Shape,
    /// Height, m.
    #[serde(default = "Load::default_height")]
    pub height: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Coefficient of friction between robot and load.
    #[serde(default = "Load::default_contact_friction")]
    pub contact_friction: f64,
    /// Where its centre starts; its heading is the x axis of its frame.
    #[serde(default)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// A rectangle.
    Rectangle {
        /// Extent across the heading (the long side of the paper's load), m.
        length: f64,
        /// Extent along the heading, m.
        width: f64,
    },
    /// Any convex polygon.
    Polygon {
        /// Corners [x, y] in the load's frame, m; the frame is moved to the centroid.
        vertices: Vec<[f64; 2]>,
    },
}

/// A planar pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Pose {
    /// m.
    pub x: f64,
    /// m.
    pub y: f64,
    /// Degrees, counter-clockwise.
    pub yaw_deg: f64,
}

/// A team: robots that move one load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Team {
    /// Name.
    pub id: String,
    /// The load's `id`.
    pub load: String,
    /// The robots, all alike.
    pub robots: Robots,
    /// Where they stand around the load.
    pub formation: Formation,
    /// What they shall reach.
    pub mission: Mission,
    /// How each of them decides.
    pub controller: Controller,
}

/// Robots of a team, all alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Robots {
    /// Kind of robot.
    #[serde(default)]
    pub model: RobotKind,
    /// How many.
    pub count: usize,
    /// Extra mass that each carries.
    #[serde(default)]
    pub ballast: Option<Ballast>,
    /// Control rate of each robot, Hz, where it differs from the controller's `rate_hz`; one number per robot.
    #[serde(default)]
    pub rates_hz: Option<Vec<f64>>,
    /// Linear acceleration limit, m/s².
    #[serde(default = "Robots::default_acceleration")]
    pub acceleration: f64,
    /// Angular acceleration limit, rad/s².
    #[serde(default = "Robots::default_angular_acceleration")]
    pub angular_acceleration: f64,
    /// Step to which the base truncates commands toward zero, m/s and rad/s; 0 for none.
    #[serde(default = "Robots::default_command_step")]
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
}

/// Extra mass on a robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ballast {
    /// kg.
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Formation {
    /// Which slots.
    #[serde(default)]
    pub slots: Slots,
    /// Distance of the outer slots from the corner along the edge, m ([R2P2] Table III, c).
    #[serde(default = "Formation::default_contact_placement")]
    pub contact_placement: f64,
    /// Distance between the robots' bodies and the load in their slots, m.
    #[serde(default = "Formation::default_gap")]
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Slots {
    /// Two on each long side, one at each short end ([R2P2] Fig. 4).
    #[default]
    Six,
    /// Two on each long side ([R2P2] §VII).
    Four,
    /// Any places on the load's edges, one per robot.
    Custom(Vec<CustomSlot>),
}

/// A slot on an edge of the load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CustomSlot {
    /// Edge of the footprint, counter-clockwise from 0; a rectangle's edge 0 is its right side, edge 1 its front.
    pub edge: usize,
    /// Place along the edge, 0 at its start, 1 at its end.
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

/// What a team shall reach.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mission {
    /// Points that the load's centre passes in this order, before the goal.
    #[serde(default)]
    pub waypoints: Vec<Point>,
    /// Where the load's centre shall end.
    pub goal: Point,
    /// Distance at which a waypoint and the goal count as reached, m.
    #[serde(default = "Mission::default_tolerance")]
    pub tolerance: f64,
    /// Time allowed, s.
    #[serde(default = "Mission::default_time_limit")]
    pub time_limit: f64,
}

impl Mission {
    const fn default_tolerance() -> f64 {
        0.10
    }

    const fn default_time_limit() -> f64 {
        1500.0
    }
}

/// A point of the ground plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// m.
    pub x: f64,
    /// m.
    pub y: f64,
}

/// How each robot of a team decides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Controller {
    /// Roles with rules and proportional-control primitives.
    R2p2(R2p2),
}

/// Parameters of R2P2. Whatever is not given comes from `variant`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct R2p2 {
    /// Which reading of the paper the other keys default to.
    pub variant: Variant,
    /// Pushing speed per heading error, m/s per rad (the reciprocal of the paper's k_p).
    pub rotation_gain: Option<f64>,
    /// Pushing speed per distance, 1/s (the reciprocal of the paper's k_p).
    pub translation_gain: Option<f64>,
    /// Lowest pushing speed, m/s.
    pub speed_min: Option<f64>,
    /// Highest speed, m/s.
    pub speed_max: Option<f64>,
    /// Highest speed at which a preventing robot gives way, m/s (v_max of eq. 4).
    pub load_speed_max: Option<f64>,
    /// Control rate, Hz.
    pub rate_hz: Option<f64>,
    /// Heading error that starts a rotation, rad (ε of §IV-A).
    pub heading_threshold: Option<f64>,
    /// Heading error that ends a rotation, rad.
    pub heading_release: Option<f64>,
    /// Shortest signed angles instead of the unwrapped comparison of §IV-A.
    pub wrap: Option<bool>,
    /// What a supporting robot does.
    pub support: Option<Support>,
    /// How robots stand to the edge while they work.
    pub stance: Option<Stance>,
    /// At which speed preventing robots give way.
    pub prevent: Option<Prevent>,
    /// Whether a pushing robot turns with the load; the paper has ω = 0 (eq. 3).
    pub push_turns: Option<bool>,
    /// Whether ω of eqs. 4 and 5 has the load's sense; the paper prints the opposite one.
    pub turn_with_load: Option<bool>,
    /// Speed per clearance at which a preventing robot returns to the edge, 1/s; eq. 4 has none.
    pub gap_gain: Option<f64>,
    /// Whether robots reposition themselves.
    pub reposition: Option<bool>,
    /// Control steps between two checks of the own slot.
    pub check_interval: Option<u32>,
    /// Deviation along the edge that starts a repositioning, m.
    pub reposition_tangential: Option<f64>,
    /// Deviation of the heading that starts a repositioning, rad.
    pub reposition_heading: Option<f64>,
    /// Clearance that starts a repositioning, m.
    pub reposition_gap: Option<f64>,
}

/// Which reading of the paper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Variant {
    /// The equations as they work.
    #[default]
    Recommended,
    /// The equations as printed.
    Literal,
}

/// What a supporting robot does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Support {
    /// Follows its slot.
    Track,
    /// Eq. 5 as printed.
    Literal,
    /// Stands still until it has to reposition itself.
    Park,
}

/// How robots stand to the edge while they work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stance {
    /// Along the path of their slot: tangential to its arc while the load turns.
    Arc,
    /// Square to the edge, as in the paper.
    Square,
}

/// At which speed preventing robots give way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Prevent {
    /// At the speed that the pushing robots aim at (eq. 3).
    Paced,
    /// At the speed that the load has (eq. 4).
    Literal,
}

/// How poses are measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sensors {
    /// Rate, Hz.
    pub rate_hz: f64,
    /// Standard deviation of each coordinate, m.
    pub position_sd: f64,
    /// Standard deviation of the yaw, degrees.
    pub yaw_sd_deg: f64,
    /// Age of a pose when it arrives, s.
    pub latency: f64,
    /// Share of the poses that get lost, 0 to 1.
    pub dropout: f64,
    /// Age of the last pose at which a robot stops, s.
    pub timeout: f64,
}

impl Default for Sensors {
    fn default() -> Self {
        Self { rate_hz: 40.0, position_sd: 0.0, yaw_sd_deg: 0.0, latency: 0.0, dropout: 0.0, timeout: 0.15 }
    }
}

/// Integration of the simulated world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Physics {
    /// Time step, s.
    pub step: f64,
    /// Solver iterations per step.
    pub iterations: u32,
}

impl Default for Physics {
    fn default() -> Self {
        Self { step: 0.01, iterations: 4 }
    }
}

/// Random displacement of every body at the start, uniform and independent, drawn from the seed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Start {
    /// Half-width for each coordinate, m.
    pub position_jitter: f64,
    /// Half-width for the yaw, degrees.
    pub yaw_jitter_deg: f64,
}
