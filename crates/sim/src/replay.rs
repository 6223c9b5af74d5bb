//! Re-decides a log: feeds every recorded observation to a fresh controller and compares the decisions bit for bit.
//!
//! Only what the log holds is used: the scenario in its metadata, the controllers' memories, the observations.

use std::collections::BTreeMap;
use std::io::Read;

use cohaul_core::control::guard::Guard;
use cohaul_core::control::{Decision, Step};
use cohaul_core::id::RobotId;
use cohaul_core::record::{LogReader, Record};
use cohaul_core::scenario;

use crate::episode::controller;
use crate::error::SimError;

/// What a replay found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replayed {
    /// Name of the mission.
    pub name: String,
    /// Version of the program that wrote the log.
    pub version: String,
    /// Decisions compared.
    pub decisions: u64,
    /// Decisions that came out differently.
    pub different: u64,
    /// The first of them.
    pub first: Option<Difference>,
}

/// A decision that came out differently.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Who decided.
    pub robot: RobotId,
    /// When, s.
    pub time_s: f64,
    /// What the log says.
    pub recorded: Decision,
    /// What came out now.
    pub decided: Decision,
}

/// Replays the log in `input`.
///
/// # Errors
/// A damaged log, or one whose scenario this version does not read.
pub fn replay(input: impl Read) -> Result<Replayed, SimError> {
    let mut found = Replayed::default();
    let mut guards: BTreeMap<RobotId, Guard<Box<dyn Step>>> = BTreeMap::new();
    let mut pending: BTreeMap<RobotId, Decision> = BTreeMap::new();
    for record in LogReader::new(input) {
        match record? {
            Record::Metadata(header) => {
                found.name = header.scenario_name;
                found.version = header.version;
                let parsed = scenario::parse("scenario of the log", header.scenario_text.as_bytes(), &[])?;
                let instance = parsed.scenario.instance()?;
                for (team, built) in instance.teams.iter().enumerate() {
                    for place in 0..built.robots() {
                        let robot = RobotId(built.first_robot.0 + place as u16);
                        guards.insert(robot, controller(&parsed.scenario, &instance, team, place)?);
                    }
                }
            }
            Record::Memory { robot, json, .. } => guard(&mut guards, robot)?.inner_mut().restore(&json)?,
            Record::Observation(observation) => {
                let decision = guard(&mut guards, observation.robot)?.step(&observation);
                pending.insert(observation.robot, decision);
            }
            Record::Decision(recorded) => {
                let Some(decided) = pending.remove(&recorded.robot) else {
                    let reason = format!("robot {} decides without an observation", recorded.robot);
                    return Err(SimError::Replay(reason));
                };
                found.decisions += 1;
                if !is_same(&recorded.decision, &decided) {
                    found.different += 1;
                    let time_s = recorded.time.seconds();
                    let (robot, recorded) = (recorded.robot, recorded.decision);
                    found.first.get_or_insert(Difference { robot, time_s, recorded, decided });
                }
            }
            _ => {}
        }
    }
    Ok(found)
}

fn guard(
    guards: &mut BTreeMap<RobotId, Guard<Box<dyn Step>>>,
    robot: RobotId,
) -> Result<&mut Guard<Box<dyn Step>>, SimError> {
    let known = guards.len();
    guards
        .get_mut(&robot)
        .ok_or_else(|| SimError::Replay(format!("robot {robot} is not among the {known} robots of the log's scenario")))
}

/// Equality of every bit, so that −0 differs from 0 and a NaN equals itself.
fn is_same(a: &Decision, b: &Decision) -> bool {
    let numbers = |d: &Decision| {
        [
            d.command.linear,
            d.command.lateral,
            d.command.angular,
            d.heading_error,
            d.distance,
            d.slot_tangential,
            d.slot_gap,
            d.slot_heading,
        ]
        .map(f64::to_bits)
    };
    let rest = |d: &Decision| (d.stop, d.primitive, d.role, d.phase, d.fault, d.waypoint);
    numbers(a) == numbers(b) && rest(a) == rest(b)
}
