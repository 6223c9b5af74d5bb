//! A whole mission: run, recorded, and ready to be shown.

use std::io::Write;

use cohaul_core::control::{Decision, Observation};
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::record::marker::Marker;
use cohaul_core::record::{Header, LogWriter};
use cohaul_core::scenario::Instance;
use cohaul_core::scenario::document::{Scenario, WorldKind};
use cohaul_core::se2::Pose2;
use cohaul_core::time::Time;
use nalgebra::Vector2;

use crate::episode::{self, Recorder};
use crate::error::SimError;
use crate::outcome::Outcome;
use crate::page::{Frame, Replay, ReplayEvent, ReplayLoad, ReplayRobot, ReplayTeam};
use crate::recording::{robot_frame, team_frame, triple};
use crate::world::World;

/// Version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Revision of the source that it was built from.
pub const REVISION: &str = env!("COHAUL_REVISION");

/// A finished mission.
#[derive(Clone, Debug)]
pub struct Mission {
    /// The scenario with its seed, everything drawn.
    pub scenario: Scenario,
    /// How it ended.
    pub outcome: Outcome,
    /// The state of everything, 20 times per second and at the end.
    pub frames: Vec<Frame>,
    /// Records in the log, 0 without one.
    pub records: u64,
}

impl Mission {
    /// Runs a resolved scenario. The log goes to `log` if there is one; `stop` is asked once per simulated second with the
    /// time and the time limit, and ends the mission when it says so.
    ///
    /// # Errors
    /// A scenario that cannot be built, or a log that cannot be written.
    pub fn run(
        scenario: Scenario,
        log: Option<Box<dyn Write>>,
        stop: &mut dyn FnMut(Time, Time) -> bool,
    ) -> Result<Self, SimError> {
        let instance = scenario.instance()?;
        let mut frames = FrameRecorder { frames: Vec::new(), instance: &instance, scenario: &scenario };
        let mut log = log.map(|output| LogRecorder::new(output, &scenario, &instance)).transpose()?;
        let outcome = episode::run(&scenario, &mut Both(&mut frames, log.as_mut()), stop)?;
        let frames = frames.frames;
        let records = match log {
            Some(mut log) => {
                let end = Time::from_seconds(outcome.time_s);
                log.writer.outcome(end, &outcome.to_json())?;
                let records = log.writer.messages();
                log.writer.finish()?;
                records
            }
            None => 0,
        };
        Ok(Self { scenario, outcome, frames, records })
    }

    /// The mission as its page and picture show it.
    ///
    /// # Errors
    /// None for a mission that ran.
    pub fn replay(&self) -> Result<Replay, SimError> {
        let Scenario { name, description, terrain, loads, teams, seed, .. } = &self.scenario;
        let instance = self.scenario.instance()?;
        let corners = |points: &[Vector2<f64>]| points.iter().map(|v| [v.x, v.y]).collect::<Vec<_>>();
        let mut robots = Vec::new();
        let mut replay_teams = Vec::new();
        for (index, (team, built)) in teams.iter().zip(&instance.teams).enumerate() {
            let first = built.first_robot.index();
            replay_teams.push(ReplayTeam {
                id: team.id.clone(),
                load: built.load.index(),
                robots: (first..first + built.robots()).collect(),
                waypoints: team.mission.points().map(|p| [p.x, p.y]).collect(),
                tolerance: team.mission.tolerance,
                path: Vec::new(),
            });
            for place in 0..built.robots() {
                let slot = built.formation.load_from_robot(place);
                robots.push(ReplayRobot {
                    name: format!("{}", first + place + 1),
                    team: index,
                    radius: built.model.radius,
                    slot: Some(triple(&slot)),
                    ..ReplayRobot::default()
                });
            }
        }
        Ok(Replay {
            title: name.clone(),
            description: description.clone(),
            version: VERSION.to_owned(),
            seed: *seed,
            world: world_name(self.scenario.world).to_owned(),
            slope_deg: terrain.slope_deg,
            uphill_deg: terrain.uphill_deg,
            obstacles: instance.obstacles.iter().map(|o| corners(o.vertices())).collect(),
            walls: terrain.walls,
            workspace: terrain.workspace,
            loads: loads
                .iter()
                .zip(&instance.loads)
                .map(|(load, built)| ReplayLoad { id: load.id.clone(), polygon: corners(built.polygon.vertices()) })
                .collect(),
            robots,
            teams: replay_teams,
            frames: self.frames.clone(),
            events: self.events(),
            outcome: self.outcome.rows(),
            success: self.outcome.success,
            ..Replay::default()
        })
    }

    /// Waypoints reached and repositionings begun.
    fn events(&self) -> Vec<ReplayEvent> {
        let mut events = Vec::new();
        for pair in self.frames.windows(2) {
            let (before, after) = (&pair[0], &pair[1]);
            for (a, b) in before.teams.iter().zip(&after.teams) {
                if b.waypoint > a.waypoint {
                    events.push(ReplayEvent { time: after.time, text: format!("waypoint {} reached", b.waypoint) });
                }
            }
            let repositions = |frame: &Frame| frame.robots.iter().any(|r| r.stop);
            if repositions(after) && !repositions(before) {
                let who: Vec<String> =
                    (1..).zip(&after.robots).filter(|(_, r)| r.stop).map(|(i, _)| i.to_string()).collect();
                let text = format!("robot {} repositions", who.join(", "));
                events.push(ReplayEvent { time: after.time, text });
            }
        }
        let text = format!("{} after {:.1} s", self.outcome.outcome.name().replace('_', " "), self.outcome.time_s);
        events.push(ReplayEvent { time: self.outcome.time_s, text });
        events
    }
}

/// Name of a world, as in scenario files.
pub const fn world_name(world: WorldKind) -> &'static str {
    match world {
        WorldKind::Planar => "planar",
        WorldKind::Spatial => "spatial",
    }
}

/// Collects frames.
struct FrameRecorder<'a> {
    frames: Vec<Frame>,
    instance: &'a Instance,
    scenario: &'a Scenario,
}

impl Recorder for FrameRecorder<'_> {
    fn memory(&mut self, _: Time, _: RobotId, _: &str) -> Result<(), SimError> {
        Ok(())
    }

    fn decision(&mut self, _: &Observation, _: &Decision) -> Result<(), SimError> {
        Ok(())
    }

    fn state(&mut self, world: &dyn World, decisions: &[Decision]) -> Result<(), SimError> {
        let loads = (0..self.instance.loads.len()).map(|i| triple(&world.load_pose(LoadId(i as u16)))).collect();
        let robots = (0..).map(RobotId).zip(decisions);
        let robots = robots
            .map(|(id, decision)| robot_frame(&world.robot_pose(id), world.robot_speeds(id).linear, decision))
            .collect();
        let teams = self.scenario.teams.iter().zip(&self.instance.teams);
        let teams = teams
            .map(|(team, built)| {
                team_frame(&team.mission, &world.load_pose(built.load), &decisions[built.first_robot.index()])
            })
            .collect();
        self.frames.push(Frame { time: world.time().seconds(), loads, robots, teams });
        Ok(())
    }
}

/// Writes the log.
struct LogRecorder<'a> {
    writer: LogWriter<Box<dyn Write>>,
    instance: &'a Instance,
    waypoints: Vec<(Vector2<f64>, f64)>,
    states: u64,
}

/// States between two sets of markers: they are large and made for people.
const MARKERS_EVERY: u64 = 4;

impl<'a> LogRecorder<'a> {
    fn new(output: Box<dyn Write>, scenario: &Scenario, instance: &'a Instance) -> Result<Self, SimError> {
        let robots = instance.teams.iter().map(cohaul_core::scenario::TeamInstance::robots).sum::<usize>();
        let header = Header {
            scenario_name: scenario.name.clone(),
            scenario_text: scenario.to_yaml()?,
            seed: scenario.seed,
            world: world_name(scenario.world).to_owned(),
            version: VERSION.to_owned(),
            revision: REVISION.to_owned(),
            robots: (1..=robots).map(|i| format!("r{i}")).collect(),
            loads: scenario.loads.iter().map(|load| load.id.clone()).collect(),
        };
        let waypoints = scenario
            .teams
            .iter()
            .flat_map(|team| team.mission.points().map(|p| (Vector2::new(p.x, p.y), team.mission.tolerance)))
            .collect();
        Ok(Self { writer: LogWriter::new(output, &header)?, instance, waypoints, states: 0 })
    }

    fn markers(&mut self, world: &dyn World, decisions: &[Decision]) -> Result<(), SimError> {
        let mut markers = Vec::with_capacity(decisions.len() + self.waypoints.len() + 1);
        for (load, built) in (0..).map(LoadId).zip(&self.instance.loads) {
            let outline_in_load = built.polygon.vertices();
            markers.push(Marker::Load { load, world_from_load: world.load_pose(load), outline_in_load });
        }
        let radii = self.instance.teams.iter().flat_map(|t| std::iter::repeat_n(t.model.radius, t.robots()));
        for ((robot, decision), radius) in (0..).map(RobotId).zip(decisions).zip(radii) {
            let world_from_robot = world.robot_pose(robot);
            markers.push(Marker::Robot { robot, world_from_robot, radius, role: decision.role });
        }
        for (index, (position, radius)) in (0..).zip(&self.waypoints) {
            markers.push(Marker::Waypoint { index, position: *position, radius: *radius });
        }
        Ok(self.writer.markers(world.time(), &markers)?)
    }
}

impl Recorder for LogRecorder<'_> {
    fn memory(&mut self, time: Time, robot: RobotId, memory: &str) -> Result<(), SimError> {
        Ok(self.writer.memory(time, robot, memory)?)
    }

    fn decision(&mut self, observation: &Observation, decision: &Decision) -> Result<(), SimError> {
        Ok(self.writer.decision(observation, decision)?)
    }

    fn state(&mut self, world: &dyn World, decisions: &[Decision]) -> Result<(), SimError> {
        let time = world.time();
        let robots: Vec<(RobotId, Pose2)> =
            (0..decisions.len() as u16).map(|i| (RobotId(i), world.robot_pose(RobotId(i)))).collect();
        let loads: Vec<(LoadId, Pose2)> =
            (0..self.instance.loads.len() as u16).map(|i| (LoadId(i), world.load_pose(LoadId(i)))).collect();
        for (load, pose) in &loads {
            self.writer.load_state(time, *load, pose, &world.load_twist(*load))?;
        }
        for (robot, pose) in &robots {
            self.writer.robot_state(time, *robot, pose, world.robot_speeds(*robot), world.traction(*robot))?;
        }
        self.writer.transforms(time, &robots, &loads)?;
        if self.states.is_multiple_of(MARKERS_EVERY) {
            self.markers(world, decisions)?;
        }
        self.states += 1;
        Ok(())
    }
}

/// Two recorders, the second one optional.
struct Both<'a, A, B>(&'a mut A, Option<&'a mut B>);

impl<A: Recorder, B: Recorder> Recorder for Both<'_, A, B> {
    fn memory(&mut self, time: Time, robot: RobotId, memory: &str) -> Result<(), SimError> {
        self.0.memory(time, robot, memory)?;
        self.1.as_mut().map_or(Ok(()), |b| b.memory(time, robot, memory))
    }

    fn decision(&mut self, observation: &Observation, decision: &Decision) -> Result<(), SimError> {
        self.0.decision(observation, decision)?;
        self.1.as_mut().map_or(Ok(()), |b| b.decision(observation, decision))
    }

    fn state(&mut self, world: &dyn World, decisions: &[Decision]) -> Result<(), SimError> {
        self.0.state(world, decisions)?;
        self.1.as_mut().map_or(Ok(()), |b| b.state(world, decisions))
    }
}
