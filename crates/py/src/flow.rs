//! The flow of control as data.

use cohaul_core::control::Phase;
use cohaul_core::control::flow::{Next, Step, TICK, TRANSITIONS, name};
use pyo3::prelude::*;

/// A step of a tick, or a phase.
#[derive(IntoPyObject)]
pub struct Node {
    kind: &'static str,
    name: &'static str,
    text: String,
    repositioning: bool,
    next: Vec<Way>,
}

/// Where a node leads, and why.
#[derive(IntoPyObject)]
struct Way {
    to: &'static str,
    why: &'static str,
}

/// The flow of control of one robot as a list of nodes: the steps of a tick in their order, then the phases.
#[pyfunction]
pub fn flow() -> Vec<Node> {
    TICK.iter().map(of_step).chain(Phase::ALL.into_iter().map(of_phase)).collect()
}

fn of_step(step: &Step) -> Node {
    let next = step.next.iter().map(|way| {
        let to = match way.to {
            Next::Step(name) => name,
            Next::Phase(phase) => name(phase),
            Next::Repositioning => "repositioning",
        };
        Way { to, why: way.answer }
    });
    Node { kind: "step", name: step.name, text: step.text.to_owned(), repositioning: false, next: next.collect() }
}

fn of_phase(phase: Phase) -> Node {
    let next = TRANSITIONS.iter().filter(|t| t.from == phase).map(|t| Way { to: name(t.to), why: t.why });
    let repositioning = phase.is_repositioning();
    Node { kind: "phase", name: name(phase), text: name(phase).replace('_', " "), repositioning, next: next.collect() }
}
