//! The flow of control as data: what a robot asks itself in a tick, and which phase follows which.
//!
//! # Source
//! [R2P2] Fig. 3 (flowchart) and §IV, in the words of [`r2p2`](super::r2p2). Drawn by `cohaul.plot.flowchart` in Python; the
//! tests compare it with what controllers do in whole missions.
//!
//! # Deviations
//! - Repositioning has its four phases of [`reposition`](crate::transport::reposition), the paper a single state.
//! - A manoeuvre ends after a time limit.
//!
//! [R2P2]: crate::_documentation::references

use super::Phase;

/// Name of a phase, as in logs and replay pages.
pub const fn name(phase: Phase) -> &'static str {
    match phase {
        Phase::Work => "work",
        Phase::Hold => "hold",
        Phase::TurnParallel => "turn_parallel",
        Phase::Slide => "slide",
        Phase::TurnFacing => "turn_facing",
        Phase::Approach => "approach",
        Phase::Done => "done",
        Phase::Teleport => "teleport",
    }
}

/// One phase follows another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transition {
    /// The phase of a tick.
    pub from: Phase,
    /// The phase after it.
    pub to: Phase,
    /// What makes it follow.
    pub why: &'static str,
}

const fn follows(from: Phase, to: Phase, why: &'static str) -> Transition {
    Transition { from, to, why }
}

const FLAG_UP: &str = "a peer's stop flag is up";
const FLAGS_DOWN: &str = "all stop flags are down";
const OFF_ALONG: &str = "off its slot along the edge";
const OFF_ELSE: &str = "off its slot otherwise";
const TIMEOUT: &str = "manoeuvre takes too long";
const ARRIVED: &str = "at the goal";
const MOVED_OFF: &str = "the load has left the goal";
const TELEPORTS: &str = "off its slot, in a simulation with teleports";

/// Every transition. Within a tick, phases of the manoeuvre that nothing calls for are passed through: see [`permits`].
pub const TRANSITIONS: &[Transition] = &[
    follows(Phase::Work, Phase::Hold, FLAG_UP),
    follows(Phase::Hold, Phase::Work, FLAGS_DOWN),
    follows(Phase::Work, Phase::TurnParallel, OFF_ALONG),
    follows(Phase::Work, Phase::TurnFacing, OFF_ELSE),
    follows(Phase::Hold, Phase::TurnParallel, OFF_ALONG),
    follows(Phase::Hold, Phase::TurnFacing, OFF_ELSE),
    follows(Phase::TurnParallel, Phase::Slide, "parallel to the edge"),
    follows(Phase::Slide, Phase::TurnFacing, "in front of its slot"),
    follows(Phase::Slide, Phase::Work, "there, and works parallel to the edge"),
    follows(Phase::TurnFacing, Phase::Approach, "faces the edge"),
    follows(Phase::Approach, Phase::Work, "at the edge"),
    follows(Phase::TurnParallel, Phase::Work, TIMEOUT),
    follows(Phase::Slide, Phase::Work, TIMEOUT),
    follows(Phase::TurnFacing, Phase::Work, TIMEOUT),
    follows(Phase::Approach, Phase::Work, TIMEOUT),
    follows(Phase::Work, Phase::Teleport, TELEPORTS),
    follows(Phase::Hold, Phase::Teleport, TELEPORTS),
    follows(Phase::Teleport, Phase::Work, "in its slot"),
    follows(Phase::Teleport, Phase::Hold, FLAG_UP),
    follows(Phase::Teleport, Phase::Done, ARRIVED),
    follows(Phase::Work, Phase::Done, ARRIVED),
    follows(Phase::Hold, Phase::Done, ARRIVED),
    follows(Phase::TurnParallel, Phase::Done, ARRIVED),
    follows(Phase::Slide, Phase::Done, ARRIVED),
    follows(Phase::TurnFacing, Phase::Done, ARRIVED),
    follows(Phase::Approach, Phase::Done, ARRIVED),
    follows(Phase::Done, Phase::Work, MOVED_OFF),
    follows(Phase::Done, Phase::Hold, FLAG_UP),
];

/// Whether a robot in phase `from` at one tick may be in phase `to` at the next: through one transition, or through
/// several whose phases in between belong to the manoeuvre and have nothing to do.
///
/// ```
/// use cohaul_core::control::{Phase, flow::permits};
///
/// assert!(permits(Phase::Work, Phase::Slide)); // it stands parallel to the edge already
/// assert!(!permits(Phase::Approach, Phase::Slide)); // the manoeuvre only goes forward
/// ```
pub fn permits(from: Phase, to: Phase) -> bool {
    // the manoeuvre only goes forward, so a path has no more transitions than there are phases
    fn reaches(from: Phase, to: Phase, transitions: usize) -> bool {
        TRANSITIONS.iter().filter(|t| t.from == from).any(|t| {
            let passed_through = t.to.is_repositioning() && t.to != Phase::Teleport;
            t.to == to || (transitions > 1 && passed_through && reaches(t.to, to, transitions - 1))
        })
    }
    from == to || reaches(from, to, Phase::ALL.len())
}

/// A question that a robot asks itself in a tick, or something that it works out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Its name.
    pub name: &'static str,
    /// The question, or what is worked out.
    pub text: &'static str,
    /// Where it leads: one way for what is worked out, one for each answer of a question.
    pub next: &'static [Way],
}

/// Where a step leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Way {
    /// The answer; empty for what is worked out.
    pub answer: &'static str,
    /// What comes next.
    pub to: Next,
}

/// What comes after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Another step, by its name.
    Step(&'static str),
    /// The tick ends in this phase.
    Phase(Phase),
    /// The tick ends in the manoeuvre: it goes on, or begins.
    Repositioning,
}

const fn then(to: &'static str) -> Way {
    Way { answer: "", to: Next::Step(to) }
}

const fn answer(answer: &'static str, to: Next) -> Way {
    Way { answer, to }
}

/// The steps of one tick, the first one first.
pub const TICK: &[Step] = &[
    Step { name: "observe", text: "own pose, pose of the load, stop flags", next: &[then("arrived")] },
    Step {
        name: "arrived",
        text: "load at the goal?",
        next: &[answer("yes", Next::Phase(Phase::Done)), answer("no", Next::Step("primitive"))],
    },
    Step { name: "primitive", text: "turn or translate, from the heading error", next: &[then("role")] },
    Step { name: "role", text: "push, prevent or support, from the slot", next: &[then("busy")] },
    Step {
        name: "busy",
        text: "repositioning?",
        next: &[answer("yes", Next::Repositioning), answer("no", Next::Step("off"))],
    },
    Step {
        name: "off",
        text: "check due, and off its slot?",
        next: &[answer("yes", Next::Repositioning), answer("no", Next::Step("flag"))],
    },
    Step {
        name: "flag",
        text: "a peer's stop flag up?",
        next: &[answer("yes", Next::Phase(Phase::Hold)), answer("no", Next::Phase(Phase::Work))],
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tick_reaches_every_step_and_ends_in_every_way() {
        let mut ends = Vec::new();
        let mut reached = vec!["observe"];
        for step in TICK {
            assert!(reached.contains(&step.name), "{} comes before what leads to it", step.name);
            assert_eq!(step.next.len(), if step.text.ends_with('?') { 2 } else { 1 }, "{}", step.name);
            for way in step.next {
                match way.to {
                    Next::Step(name) => reached.push(name),
                    Next::Phase(phase) => ends.push(Some(phase)),
                    Next::Repositioning => ends.push(None),
                }
            }
        }
        assert_eq!(reached, TICK.iter().map(|step| step.name).collect::<Vec<_>>());
        assert_eq!(ends, [Some(Phase::Done), None, None, Some(Phase::Hold), Some(Phase::Work)]);
    }

    #[test]
    fn names_are_those_of_logs() {
        for phase in Phase::ALL {
            assert_eq!(serde_json::to_value(phase).unwrap(), name(phase));
        }
    }

    #[test]
    fn every_phase_is_left_and_none_is_out_of_reach_of_the_goal() {
        for phase in Phase::ALL {
            assert!(Phase::ALL.iter().any(|&other| other != phase && permits(phase, other)), "{phase:?}");
            assert!(permits(phase, Phase::Done), "{phase:?}");
        }
        assert!(!permits(Phase::Done, Phase::TurnParallel), "a robot resumes its work before it repositions itself");
    }

    #[test]
    fn the_manoeuvre_only_goes_forward() {
        assert!(permits(Phase::Work, Phase::Approach) && permits(Phase::TurnParallel, Phase::Approach));
        assert!(!permits(Phase::Approach, Phase::TurnFacing) && !permits(Phase::Slide, Phase::TurnParallel));
        assert!(!permits(Phase::Slide, Phase::Hold), "a repositioning robot heeds no stop flag");
    }
}
