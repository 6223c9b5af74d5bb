//! One mission from start to end: observe, decide, step, each at its own rate.
//!
//! Every robot has its own clock: its control rate with a random phase drawn from the seed. Stop flags reach the peers
//! before their next decision. The episode knows no file and no clock; a [`Recorder`] sees everything that happens.

use cohaul_core::contact::limit_surface::LimitSurface;
use cohaul_core::contact::slope::Slope;
use cohaul_core::control::guard::{Guard, GuardLimits};
use cohaul_core::control::guidance::Task;
use cohaul_core::control::r2p2::{Parameters, R2p2};
use cohaul_core::control::vlf::Vlf;
use cohaul_core::control::{Command, Decision, Observation, Phase, Step, Stepper, StopFlags};
use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::scenario::Instance;
use cohaul_core::scenario::document::{Controller, GroundModel, Scenario};
use cohaul_core::se2::{Pose2, pose};
use cohaul_core::time::Time;
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::error::SimError;
use crate::outcome::{End, Outcome};
use crate::score::Score;
use crate::sensor::SensorSystem;
use crate::world::{self, LoadBody, RobotBody, World, WorldSetup};

/// Sees everything that happens in an episode.
///
/// # Errors
/// Each method fails when it cannot record, which ends the episode.
#[expect(clippy::missing_errors_doc, reason = "said once for all three")]
pub trait Recorder {
    /// A robot starts with, or is reset to, this controller memory (JSON).
    fn memory(&mut self, time: Time, robot: RobotId, memory: &str) -> Result<(), SimError>;
    /// A robot has decided.
    fn decision(&mut self, observation: &Observation, decision: &Decision) -> Result<(), SimError>;
    /// The state of the world, 20 times per second and at the end; `decisions` holds the last one of each robot.
    fn state(&mut self, world: &dyn World, decisions: &[Decision]) -> Result<(), SimError>;
}

/// Records nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoRecorder;

impl Recorder for NoRecorder {
    fn memory(&mut self, _: Time, _: RobotId, _: &str) -> Result<(), SimError> {
        Ok(())
    }
    fn decision(&mut self, _: &Observation, _: &Decision) -> Result<(), SimError> {
        Ok(())
    }
    fn state(&mut self, _: &dyn World, _: &[Decision]) -> Result<(), SimError> {
        Ok(())
    }
}

/// Interval between two records of the world's state, ns.
const STATE_NANOS: i64 = 50_000_000;
/// Interval between two looks at who has lost what, ns.
const SCORE_NANOS: i64 = 50_000_000;

/// One robot's decision making.
struct Agent {
    robot: RobotId,
    /// Place in its team.
    place: usize,
    team: usize,
    guard: Guard<Box<dyn Step>>,
    load: LoadId,
    load_from_slot: Pose2,
    period_nanos: i64,
    next: Time,
}

/// A mission under way.
pub struct Episode {
    world: Box<dyn World>,
    sensors: SensorSystem,
    agents: Vec<Agent>,
    /// Stop flags as last sent, per team.
    flags: Vec<StopFlags>,
    commands: Vec<Command>,
    decisions: Vec<Decision>,
    score: Score,
    next_state: Time,
    next_score: Time,
    time_limit: Time,
    step_seconds: f64,
}

/// The guarded controller of the robot at `place` of team `team`: the same in the simulator and in a replay.
///
/// # Errors
/// Parameters that the controller refuses.
pub fn controller(
    scenario: &Scenario,
    instance: &Instance,
    team: usize,
    place: usize,
) -> Result<Guard<Box<dyn Step>>, SimError> {
    let spec = &scenario.teams[team];
    let built = &instance.teams[team];
    let (low, high) = instance.load_polygon(built.load.index()).bounds();
    let waypoints = spec.mission.points().map(|p| Vector2::new(p.x, p.y)).collect();
    let task = Task {
        formation: &built.formation,
        place,
        half_length: (high.y - low.y) / 2.0,
        waypoints,
        tolerance: spec.mission.tolerance,
        goal_yaw: spec.mission.goal_yaw(),
        limits: built.model.limits,
    };
    let inner: Box<dyn Step> = match &spec.controller {
        Controller::R2p2(keys) => Box::new(Stepper::new(R2p2::new(keys, task)?)),
        Controller::Vlf(keys) => Box::new(Stepper::new(Vlf::new(keys, task)?)),
    };
    let limits = GuardLimits { pose_timeout: scenario.sensors.timeout, robot: built.model.limits };
    Ok(Guard::new(inner, limits))
}

impl Episode {
    /// Prepares the mission of a resolved scenario; everything random comes from its seed.
    ///
    /// # Errors
    /// A scenario that [`cohaul_core::scenario::parse`] would refuse.
    pub fn new(scenario: &Scenario) -> Result<Self, SimError> {
        let instance = scenario.instance()?;
        let random = |stream: u64| {
            let mut random = ChaCha8Rng::seed_from_u64(scenario.seed);
            random.set_stream(stream);
            random
        };
        let setup = world_setup(scenario, &instance, &mut random(1));
        let world = world::build(scenario.world, &setup);
        let mut agents = Vec::new();
        let mut loads_of = Vec::new();
        let mut phases = random(2);
        for (team, built) in instance.teams.iter().enumerate() {
            let rate_hz = match &scenario.teams[team].controller {
                Controller::R2p2(keys) => Parameters::new(keys).rate_hz,
                Controller::Vlf(keys) => keys.rate_hz,
            };
            for place in 0..built.robots() {
                let own = scenario.teams[team].robots.rates_hz.as_ref().and_then(|rates| rates.get(place).copied());
                let period = 1.0 / own.unwrap_or(rate_hz);
                agents.push(Agent {
                    robot: RobotId(built.first_robot.0 + place as u16),
                    place,
                    team,
                    guard: controller(scenario, &instance, team, place)?,
                    load: built.load,
                    load_from_slot: built.formation.load_from_robot(place),
                    period_nanos: (period * 1e9).round() as i64,
                    next: Time::from_seconds(period * phases.random::<f64>()),
                });
                loads_of.push(built.load);
            }
        }
        let sensors = SensorSystem::new(scenario.sensors, &*world, setup.loads.len(), &loads_of, random(3));
        let robots = agents.len();
        let limit = scenario.teams.iter().map(|t| t.mission.time_limit).fold(0.0, f64::max);
        Ok(Self {
            score: Score::new(scenario, &instance, &*world),
            world,
            sensors,
            agents,
            flags: vec![StopFlags::default(); scenario.teams.len()],
            commands: vec![Command::STOP; robots],
            decisions: vec![Decision::default(); robots],
            next_state: Time::ZERO,
            next_score: Time::ZERO,
            time_limit: Time::from_seconds(limit),
            step_seconds: setup.step_nanos as f64 * 1e-9,
        })
    }

    /// Now.
    pub fn time(&self) -> Time {
        self.world.time()
    }

    /// The world.
    pub fn world(&self) -> &dyn World {
        &*self.world
    }

    /// The time at which the mission ends at the latest.
    pub const fn time_limit(&self) -> Time {
        self.time_limit
    }

    /// Advances one step; tells how the mission ended if it did.
    ///
    /// # Errors
    /// Those of the recorder.
    pub fn advance(&mut self, recorder: &mut dyn Recorder) -> Result<Option<End>, SimError> {
        let now = self.world.time();
        if now == Time::ZERO {
            for agent in &self.agents {
                recorder.memory(now, agent.robot, &agent.guard.inner().memory())?;
            }
        }
        self.sensors.advance(&*self.world);
        for agent in &mut self.agents {
            if now < agent.next {
                continue;
            }
            agent.next = agent.next.plus_nanos(agent.period_nanos);
            let received = self.sensors.received(agent.robot);
            let observation = Observation {
                time: now,
                sampled: received.sampled,
                robot: agent.robot,
                world_from_robot: received.world_from_robot,
                world_from_load: received.world_from_load,
                load_twist_in_world: received.load_twist_in_world,
                stop_flags: self.flags[agent.team],
            };
            let decision = agent.guard.step(&observation);
            self.flags[agent.team].set(agent.place, decision.stop);
            self.commands[agent.robot.index()] = decision.command;
            self.decisions[agent.robot.index()] = decision;
            recorder.decision(&observation, &decision)?;
            if decision.phase == Phase::Teleport {
                let slot = self.world.load_pose(agent.load) * agent.load_from_slot;
                self.world.place(agent.robot, &slot);
                self.score.teleported();
            }
        }
        if now >= self.next_state {
            self.next_state = self.next_state.plus_nanos(STATE_NANOS);
            recorder.state(&*self.world, &self.decisions)?;
        }
        self.world.step(&self.commands);
        let stopped = self.flags.iter().any(|flags| flags.0 != 0);
        self.score.step(&*self.world, self.step_seconds, stopped);
        let mut end = None;
        if self.world.time() >= self.next_score {
            self.next_score = self.next_score.plus_nanos(SCORE_NANOS);
            end = self.score.look(&*self.world, SCORE_NANOS as f64 * 1e-9);
        }
        if end.is_none() && self.world.time() >= self.time_limit {
            end = Some(End::TimedOut);
        }
        if end.is_some() {
            recorder.state(&*self.world, &self.decisions)?;
        }
        Ok(end)
    }

    /// The result, given how the episode ended.
    pub fn outcome(&self, end: End) -> Outcome {
        self.score.outcome(&*self.world, end)
    }
}

/// Runs a resolved scenario to its end, or until `stop` says so (asked once per simulated second).
///
/// # Errors
/// Those of [`Episode::new`] and of the recorder.
pub fn run(
    scenario: &Scenario,
    recorder: &mut dyn Recorder,
    stop: &mut dyn FnMut(Time, Time) -> bool,
) -> Result<Outcome, SimError> {
    let mut episode = Episode::new(scenario)?;
    let mut next_question = Time::ZERO;
    loop {
        if episode.time() >= next_question {
            next_question = next_question.plus_nanos(1_000_000_000);
            if stop(episode.time(), episode.time_limit()) {
                return Ok(episode.outcome(End::Interrupted));
            }
        }
        if let Some(end) = episode.advance(recorder)? {
            return Ok(episode.outcome(end));
        }
    }
}

/// The bodies of the scenario, each displaced by the jitter of the start.
fn world_setup(scenario: &Scenario, instance: &Instance, random: &mut ChaCha8Rng) -> WorldSetup {
    let mut displaced = |at: Pose2| {
        let mut draw = |half_width: f64| half_width * (2.0 * random.random::<f64>() - 1.0);
        let (x, y) = (draw(scenario.start.position_jitter), draw(scenario.start.position_jitter));
        let turn = draw(scenario.start.yaw_jitter_deg).to_radians();
        Pose2::from_parts(
            nalgebra::Translation2::new(at.translation.x + x, at.translation.y + y),
            at.rotation * pose(0.0, 0.0, turn).rotation,
        )
    };
    let terrain = &scenario.terrain;
    let loads = scenario
        .loads
        .iter()
        .zip(&instance.loads)
        .map(|(load, built)| {
            let footprint = built.polygon.clone();
            let surface = match terrain.ground {
                GroundModel::Exact => LimitSurface::exact(&footprint),
                GroundModel::Ellipsoid => LimitSurface::ellipsoid(&footprint),
            };
            LoadBody {
                footprint,
                height: load.height,
                mass: load.mass,
                contact_friction: load.contact_friction,
                surface,
                world_from_load: displaced(built.world_from_load),
                twist: cohaul_core::se2::Twist2::ZERO,
            }
        })
        .collect();
    let robots = instance
        .teams
        .iter()
        .enumerate()
        .flat_map(|(team, built)| (0..built.robots()).map(move |place| (team, place, built.model)))
        .map(|(team, place, model)| RobotBody {
            model,
            world_from_robot: displaced(instance.start_pose_of_robot(team, place)),
        })
        .collect();
    let mut obstacles = instance.obstacles.clone();
    obstacles.extend(terrain.walls.iter().flat_map(walls));
    WorldSetup {
        slope: Slope::new(terrain.slope_deg.to_radians(), terrain.uphill_deg.to_radians()),
        friction_dynamic: terrain.friction.dynamic,
        friction_static: terrain.friction.breakaway.unwrap_or(terrain.friction.dynamic),
        friction_wheel: terrain.friction.wheel,
        loads,
        robots,
        obstacles,
        step_nanos: (scenario.physics.step * 1e9).round() as i64,
        iterations: scenario.physics.iterations,
    }
}

/// Thickness of walls, m.
const WALL: f64 = 0.2;

/// Four solid walls around the rectangle [x_min, y_min, x_max, y_max].
fn walls(inside: &[f64; 4]) -> Vec<ConvexPolygon> {
    let [x0, y0, x1, y1] = *inside;
    let (u0, v0, u1, v1) = (x0 - WALL, y0 - WALL, x1 + WALL, y1 + WALL);
    [[u0, v0, x0, v1], [x1, v0, u1, v1], [u0, v0, u1, y0], [u0, y1, u1, v1]]
        .iter()
        .filter_map(|[a, b, c, d]| {
            let v = Vector2::new;
            ConvexPolygon::new(&[v(*a, *b), v(*c, *b), v(*c, *d), v(*a, *d)]).ok()
        })
        .collect()
}
