//! The flow of control as told by `core::control::flow`, against what controllers do.

use std::collections::BTreeMap;

use cohaul_core::control::flow::{TRANSITIONS, permits};
use cohaul_core::control::{Decision, Observation, Phase, Step as _, StopFlags};
use cohaul_core::id::RobotId;
use cohaul_core::scenario::document::Scenario;
use cohaul_core::scenario::{Override, parse};
use cohaul_core::se2::{Pose2, Twist2, pose};
use cohaul_core::time::Time;
use cohaul_sim::episode::{Recorder, controller, run};
use cohaul_sim::error::SimError;
use cohaul_sim::world::World;

/// What happened from one tick of a robot to its next.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tick {
    before: Phase,
    after: Phase,
    /// Whether a peer's stop flag was up.
    flagged: bool,
    /// Whether the last waypoint was behind it.
    arrived: bool,
}

/// Counts what happens in an episode.
#[derive(Default)]
struct Ticks {
    last: BTreeMap<RobotId, Phase>,
    seen: Vec<Tick>,
    waypoints: u16,
}

impl Recorder for Ticks {
    fn memory(&mut self, _: Time, _: RobotId, _: &str) -> Result<(), SimError> {
        Ok(())
    }

    fn decision(&mut self, observation: &Observation, decision: &Decision) -> Result<(), SimError> {
        let before = self.last.insert(observation.robot, decision.phase).unwrap_or_default();
        let tick = Tick {
            before,
            after: decision.phase,
            flagged: observation.stop_flags.any_but(observation.robot.index()),
            arrived: decision.waypoint == self.waypoints,
        };
        if !self.seen.contains(&tick) {
            self.seen.push(tick);
        }
        Ok(())
    }

    fn state(&mut self, _: &dyn World, _: &[Decision]) -> Result<(), SimError> {
        Ok(())
    }
}

fn scenario(name: &str, changes: &[&str]) -> Scenario {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name);
    let overrides: Vec<Override> = changes.iter().map(|c| Override::parse(c).unwrap()).collect();
    parse(name, &std::fs::read(path).unwrap(), &overrides).unwrap().resolve(None, &mut || 0.5).unwrap()
}

/// What happens in missions that go well, and in some that make robots reposition themselves.
fn seen_in_missions() -> Vec<Tick> {
    let missions: &[(&str, &[&str])] = &[
        ("r2p2/flat.yaml", &[]),
        ("r2p2/uphill.yaml", &[]),
        ("r2p2/downhill.yaml", &["seed=1"]),
        ("r2p2/downhill.yaml", &["seed=2", "world=spatial"]),
        ("r2p2/flat.yaml", &["teams.0.controller.r2p2.stance=square"]),
        ("r2p2/flat.yaml", &["teams.0.controller.r2p2={variant: literal}", "teams.0.mission.time_limit=300"]),
        ("r2p2/downhill.yaml", &["teams.0.controller.r2p2={variant: literal}", "teams.0.mission.time_limit=300"]),
    ];
    let mut seen = Vec::new();
    for (name, changes) in missions {
        let scenario = scenario(name, changes);
        let waypoints = scenario.teams[0].mission.points().count() as u16;
        let mut ticks = Ticks { waypoints, ..Ticks::default() };
        run(&scenario, &mut ticks, &mut |_, _| false).unwrap();
        seen.extend(ticks.seen);
    }
    seen
}

/// Phase after `phase` of the robot at `place` of the flat mission, which has repositioned itself for `seconds`, with the
/// load at (`x`, 0) and the robot `offset` (m, m, rad) away from its slot.
fn next_phase(place: usize, phase: Phase, seconds: f64, x: f64, offset: [f64; 3], flags: StopFlags) -> Phase {
    phase_of(&["teams.0.mission={goal: {x: 3, y: 0}}"], place, phase, seconds, x, offset, flags)
}

/// The same with other `changes` of the mission.
fn phase_of(
    changes: &[&str],
    place: usize,
    phase: Phase,
    seconds: f64,
    x: f64,
    offset: [f64; 3],
    flags: StopFlags,
) -> Phase {
    let scenario = scenario("r2p2/flat.yaml", changes);
    let instance = scenario.instance().unwrap();
    let time = Time::from_seconds(100.0);
    let mut guard = controller(&scenario, &instance, 0, place).unwrap();
    let memory = serde_json::json!({
        "progress": {"waypoint": 0, "primitive": "translate", "backwards": false, "aligning": false},
        "phase": phase, "since_check": 1000, "began": Time::from_seconds(100.0 - seconds),
    });
    guard.inner_mut().restore(&memory.to_string()).unwrap();
    let world_from_load = pose(x, 0.0, 0.0);
    let slot = instance.teams[0].formation.load_from_robot(place);
    let [along, across, turn] = offset;
    let moved =
        Pose2::new(slot.translation.vector + nalgebra::Vector2::new(along, across), slot.rotation.angle() + turn);
    let decision = guard.step(&Observation {
        time,
        sampled: time,
        robot: RobotId(place as u16),
        world_from_robot: world_from_load * moved,
        world_from_load,
        load_twist_in_world: Twist2::ZERO,
        stop_flags: flags,
    });
    assert_eq!(decision.fault, cohaul_core::control::Fault::None);
    decision.phase
}

#[test]
fn phases_change_only_as_the_table_says() {
    for Tick { before, after, .. } in seen_in_missions() {
        assert!(permits(before, after), "{before:?} to {after:?} is not in the table");
    }
}

#[test]
fn every_tick_ends_as_its_questions_say() {
    for tick in seen_in_missions() {
        let Tick { before, after, flagged, arrived } = tick;
        let allowed = if arrived {
            after == Phase::Done
        } else if before.is_repositioning() {
            after.is_repositioning() || after == Phase::Work
        } else if before == Phase::Done {
            after == if flagged { Phase::Hold } else { Phase::Work }
        } else if after.is_repositioning() {
            true
        } else if flagged {
            // a manoeuvre that has nothing to do ends at once
            after == Phase::Hold || after == Phase::Work
        } else {
            after == Phase::Work
        };
        assert!(allowed, "{tick:?}");
    }
}

#[test]
fn every_transition_of_the_table_occurs() {
    let raised = StopFlags(0b10);
    let mut seen: Vec<(Phase, Phase)> = seen_in_missions().iter().map(|t| (t.before, t.after)).collect();
    // one that ends is at its goal; one that takes too long is off its slot in every way for more than 20 s
    for phase in Phase::ALL {
        seen.push((phase, next_phase(0, phase, 1.0, 3.0, [0.0; 3], StopFlags::default())));
        if phase.is_repositioning() {
            seen.push((phase, next_phase(0, phase, 20.1, 0.0, [0.05, 0.2, 0.7], StopFlags::default())));
        }
    }
    for (along, offset) in [(Phase::TurnParallel, [0.0, 0.2, 0.0]), (Phase::TurnFacing, [0.1, 0.0, 0.5])] {
        for before in [Phase::Work, Phase::Hold] {
            let after = next_phase(0, before, 0.0, 0.0, offset, raised);
            assert_eq!(after, along);
            seen.push((before, after));
        }
    }
    // teleports: from work and hold, then on with the work
    for before in [Phase::Work, Phase::Hold] {
        let goal = "teams.0.mission={goal: {x: 3, y: 0}}";
        let teleports = [goal, "teams.0.controller.r2p2.reposition=teleport"];
        let flags = if before == Phase::Hold { raised } else { StopFlags::default() };
        let after = phase_of(&teleports, 0, before, 0.0, 0.0, [0.1, 0.0, 0.5], flags);
        assert_eq!(after, Phase::Teleport);
        seen.push((before, after));
    }
    for (before, flags) in [(Phase::Teleport, raised), (Phase::Done, raised)] {
        seen.push((before, next_phase(0, before, 0.0, 0.0, [0.0; 3], flags)));
        seen.push((before, next_phase(0, before, 0.0, 0.0, [0.0; 3], StopFlags::default())));
    }
    // two ends of a manoeuvre besides its time limit: at the edge, and beside the short end of the load, parallel to it
    for (place, phase, turn) in [(0, Phase::Approach, 0.0), (2, Phase::Slide, std::f64::consts::FRAC_PI_2)] {
        assert_eq!(next_phase(place, phase, 1.0, 0.0, [0.0, 0.0, turn], StopFlags::default()), Phase::Work);
    }
    for transition in TRANSITIONS {
        assert!(seen.contains(&(transition.from, transition.to)), "{transition:?} never occurs");
    }
}
