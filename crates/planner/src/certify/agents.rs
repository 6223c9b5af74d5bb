//! Which route is whose, and which goals they take.

use std::collections::BTreeMap;

use super::assignment::could_take_more;
use super::{Findings, ViolationKind};
use crate::plan::Route;

/// The route of every agent of the instance, by its name; reports agents without a route, routes without an agent, and
/// routes in another order than their agents.
pub(super) fn matched<'a, S>(
    names: &[&str],
    routes: &'a [Route<S>],
    findings: &mut Findings,
) -> Vec<Option<&'a Route<S>>> {
    // files may call two agents the same, so names are looked up only where the order does not tell already
    if names.len() == routes.len() && names.iter().zip(routes).all(|(name, route)| *name == route.name) {
        return routes.iter().map(Some).collect();
    }
    let mut unused: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, route) in routes.iter().enumerate().rev() {
        unused.entry(&route.name).or_default().push(index);
    }
    let mut found = Vec::with_capacity(names.len());
    for (agent, name) in names.iter().enumerate() {
        let index = unused.get_mut(name).and_then(Vec::pop);
        match index {
            None => {
                findings.add(ViolationKind::Agents, 0.0, &[agent], || format!("agent {agent} ({name:?}) has no route"));
            }
            Some(index) if index != agent => findings.add(ViolationKind::Agents, 0.0, &[agent], || {
                format!("the route of agent {agent} ({name:?}) stands in place {index}")
            }),
            Some(_) => {}
        }
        found.push(index.map(|index| &routes[index]));
    }
    let strays: usize = unused.values().map(Vec::len).sum();
    if strays > 0 {
        findings
            .add(ViolationKind::Agents, 0.0, &[], || format!("{strays} routes belong to no agent that has none yet"));
    }
    found
}

/// What an agent may take and what it takes.
pub(super) struct Taker {
    /// Numbers of the goals that it could reach, as far as that is known; equal goals have equal numbers.
    pub options: Vec<usize>,
    /// Number of the goal that it takes.
    pub taken: Option<usize>,
}

/// Reports goals that are taken twice, and goals that could be taken in addition. `goals` is how many numbers there are.
pub(super) fn check_assignment(takers: &[Taker], goals: usize, time: f64, findings: &mut Findings) {
    let mut owner: Vec<Option<usize>> = vec![None; goals];
    let mut is_matching = true;
    for (agent, taker) in takers.iter().enumerate() {
        let Some(goal) = taker.taken else { continue };
        match owner[goal] {
            None => owner[goal] = Some(agent),
            Some(other) => {
                is_matching = false;
                findings.add(ViolationKind::Assignment, time, &[other, agent], || {
                    format!("agents {other} and {agent} take the same goal")
                });
            }
        }
    }
    if !is_matching {
        return;
    }
    if let Some(agent) = could_take_more(takers, &owner) {
        let taken = owner.iter().flatten().count();
        findings.add(ViolationKind::Assignment, time, &[agent], || {
            format!("{taken} goals are taken, but another assignment takes {} and gives agent {agent} one", taken + 1)
        });
    }
}
