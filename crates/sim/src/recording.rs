//! A log as the mission that it recorded: its scenario, and the state of everything at every instant.

use std::collections::BTreeMap;
use std::io::Read;

use cohaul_core::control::Decision;
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::record::{LogReader, Record};
use cohaul_core::scenario::document::{self, Scenario};
use cohaul_core::scenario::{self, Instance};
use cohaul_core::se2::{Pose2, position, wrap_angle, yaw};
use cohaul_core::time::Time;
use nalgebra::Vector2;

use crate::error::SimError;
use crate::page::{Frame, RobotFrame, TeamFrame};

/// What a log holds of a mission.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The scenario, everything drawn.
    pub scenario: Scenario,
    /// The state of everything, 20 times per second and at the end.
    pub frames: Vec<Frame>,
}

/// True states of one instant, as far as they have come in.
#[derive(Default)]
struct Instant {
    time: Time,
    loads: BTreeMap<LoadId, Pose2>,
    robots: BTreeMap<RobotId, (Pose2, f64)>,
}

impl Recording {
    /// Reads the log in `input`.
    ///
    /// # Errors
    /// A damaged log, or one whose scenario this version does not read.
    pub fn read(input: impl Read) -> Result<Self, SimError> {
        let mut records = LogReader::new(input);
        let Some(Record::Metadata(header)) = records.next().transpose()? else {
            return Err(SimError::Replay("it does not begin with its scenario".to_owned()));
        };
        let scenario = scenario::parse("scenario of the log", header.scenario_text.as_bytes(), &[])?.scenario;
        let instance = scenario.instance()?;
        let robots = instance.teams.iter().map(scenario::TeamInstance::robots).sum::<usize>();
        let mut decisions = vec![Decision::default(); robots];
        let mut now = Instant::default();
        let mut frames = Vec::new();
        for record in records {
            match record? {
                Record::Decision(decided) => {
                    if let Some(last) = decisions.get_mut(decided.robot.index()) {
                        *last = decided.decision;
                    }
                }
                Record::LoadState(state) => {
                    now.at(state.time).loads.insert(state.load, state.world_from_load);
                }
                Record::RobotState(state) => {
                    now.at(state.time).robots.insert(state.robot, (state.world_from_robot, state.speeds.linear));
                    if now.robots.len() == robots && now.loads.len() == instance.loads.len() {
                        frames.push(now.frame(&scenario, &instance, &decisions));
                        now = Instant::default();
                    }
                }
                _ => {}
            }
        }
        Ok(Self { scenario, frames })
    }
}

impl Instant {
    /// The states of `time`; those of another instant are dropped.
    fn at(&mut self, time: Time) -> &mut Self {
        if self.time != time {
            *self = Self { time, ..Self::default() };
        }
        self
    }

    fn frame(&self, scenario: &Scenario, instance: &Instance, decisions: &[Decision]) -> Frame {
        let robots = self.robots.values().zip(decisions);
        let load = |id: &LoadId| self.loads.get(id).copied().unwrap_or_default();
        Frame {
            time: self.time.seconds(),
            loads: self.loads.values().map(triple).collect(),
            robots: robots.map(|((pose, speed), decision)| robot_frame(pose, *speed, decision)).collect(),
            teams: (scenario.teams.iter().zip(&instance.teams))
                .map(|(team, built)| {
                    let first = decisions.get(built.first_robot.index()).copied().unwrap_or_default();
                    team_frame(&team.mission, &load(&built.load), &first)
                })
                .collect(),
        }
    }
}

/// x, y and yaw, m and rad.
pub(crate) fn triple(pose: &Pose2) -> [f64; 3] {
    let at = position(pose);
    [at.x, at.y, yaw(pose)]
}

/// One robot with its last decision; `speed` is its forward speed, m/s.
pub(crate) fn robot_frame(world_from_robot: &Pose2, speed: f64, decision: &Decision) -> RobotFrame {
    RobotFrame {
        pose: triple(world_from_robot),
        command: [decision.command.linear, decision.command.angular],
        speed,
        role: decision.role,
        phase: decision.phase,
        stop: decision.stop,
    }
}

/// One team, by the last decision of its first robot.
pub(crate) fn team_frame(mission: &document::Mission, world_from_load: &Pose2, first: &Decision) -> TeamFrame {
    // at the end the goal stays the target
    let passed = usize::from(first.waypoint);
    let target = mission.points().nth(passed).unwrap_or(&mission.goal);
    let way = Vector2::new(target.x, target.y) - position(world_from_load);
    TeamFrame {
        primitive: first.primitive,
        heading_error: wrap_angle(way.y.atan2(way.x) - yaw(world_from_load)),
        distance: way.norm(),
        waypoint: passed,
    }
}
