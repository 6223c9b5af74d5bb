//! The conflict tree: nodes that say only in what they differ from their parents.

use std::sync::Arc;

use super::focal::Standing;
use super::{Bound, Budget, Clash, Domain, Planned, Query, Spent};

/// Goals of all agents, shared between nodes.
pub(super) type Goals = Arc<[Option<usize>]>;

/// The paths of a node, by agent.
pub(super) type Paths<P> = Vec<Option<Planned<P>>>;

/// Two agents with what their paths have against each other.
pub(super) struct Pair<C> {
    pub first: u32,
    pub second: u32,
    pub clash: Clash<C>,
}

impl<C: Clone> Clone for Pair<C> {
    fn clone(&self) -> Self {
        let Clash { ref conflict, count, priority } = self.clash;
        let clash = Clash { conflict: conflict.clone(), count, priority };
        Self { first: self.first, second: self.second, clash }
    }
}

/// A node of the tree.
pub(super) struct Node<D: Domain> {
    pub parent: Option<u32>,
    pub goals: Goals,
    /// What it adds to the rules of its parent.
    pub rule: Option<Bound<D::Rule>>,
    /// The paths in which it differs from its parent; all in a root.
    pub replaced: Vec<(u32, Planned<D::Path>)>,
    pub clashes: Vec<Pair<D::Conflict>>,
    pub standing: Standing,
}

/// All nodes so far.
pub(super) struct Tree<D: Domain> {
    pub nodes: Vec<Node<D>>,
}

impl<D: Domain> Tree<D> {
    pub(super) const fn new() -> Self {
        Self { nodes: Vec::new() }
    }

    /// The paths of all agents in a node.
    pub(super) fn paths(&self, node: u32, agents: usize) -> Paths<D::Path> {
        let mut paths: Paths<D::Path> = (0..agents).map(|_| None).collect();
        let mut missing = agents;
        let mut at = Some(node);
        while let Some(index) = at {
            let node = &self.nodes[index as usize];
            for (agent, planned) in &node.replaced {
                let slot = &mut paths[*agent as usize];
                if slot.is_none() {
                    *slot = Some(planned.clone());
                    missing -= 1;
                }
            }
            if missing == 0 {
                break;
            }
            at = node.parent;
        }
        paths
    }

    /// Replaces `rules` by all rules that bind `agent` in a node, youngest first, after `added`.
    pub(super) fn rules(
        &self,
        node: Option<u32>,
        agent: usize,
        added: Option<&Bound<D::Rule>>,
        rules: &mut Vec<Bound<D::Rule>>,
    ) {
        rules.clear();
        rules.extend(added.filter(|bound| bound.binds(agent)).cloned());
        let mut at = node;
        while let Some(index) = at {
            let node = &self.nodes[index as usize];
            rules.extend(node.rule.as_ref().filter(|bound| bound.binds(agent)).cloned());
            at = node.parent;
        }
    }
}

/// Replans one agent among `paths` and puts the result there. False if there is no path.
pub(super) fn replan<D: Domain>(
    domain: &mut D,
    query: &Replan<'_, D>,
    paths: &mut Paths<D::Path>,
    budget: &Budget<'_>,
) -> Result<Option<Planned<D::Path>>, Spent> {
    let Replan { agent, goal, rules, weight, floor } = *query;
    let found = domain.plan(&Query { agent, goal, rules, paths, weight, floor, ceiling: 0.0 }, budget)?;
    Ok(found.map(|mut planned| {
        planned.lower_bound = planned.lower_bound.max(floor);
        paths[agent] = Some(planned.clone());
        planned
    }))
}

/// A [`Query`] but for the paths.
pub(super) struct Replan<'a, D: Domain> {
    pub agent: usize,
    pub goal: Option<usize>,
    pub rules: &'a [Bound<D::Rule>],
    pub weight: f64,
    pub floor: f64,
}

/// Sums over all paths: cost and lower bound.
pub(super) fn sums<P>(paths: &Paths<P>) -> (f64, f64) {
    paths.iter().flatten().fold((0.0, 0.0), |(cost, bound), path| (cost + path.cost, bound + path.lower_bound))
}

/// The clashes of a node that differs from one with `clashes` in the paths of the agents for whom `changed` is true.
pub(super) fn clashes<D: Domain>(
    domain: &mut D,
    old: &[Pair<D::Conflict>],
    paths: &Paths<D::Path>,
    changed: &[u32],
) -> Vec<Pair<D::Conflict>> {
    let is_changed = |agent: u32| changed.contains(&agent);
    let mut new: Vec<_> =
        old.iter().filter(|pair| !is_changed(pair.first) && !is_changed(pair.second)).cloned().collect();
    for (at, &agent) in changed.iter().enumerate() {
        let Some(own) = &paths[agent as usize] else { continue };
        for (other, planned) in paths.iter().enumerate() {
            let Some(planned) = planned else { continue };
            let other = other as u32;
            // a pair of changed agents is met twice: it counts the first time
            if other == agent || changed[..at].contains(&other) {
                continue;
            }
            let (first, second) = (agent.min(other), agent.max(other));
            let (a, b) = if agent < other { (&own.path, &planned.path) } else { (&planned.path, &own.path) };
            if let Some(clash) = domain.clash(first as usize, a, second as usize, b) {
                new.push(Pair { first, second, clash });
            }
        }
    }
    new
}

/// The pair that is to be split first.
pub(super) fn worst<C>(clashes: &[Pair<C>]) -> Option<&Pair<C>> {
    clashes.iter().min_by_key(|pair| (pair.clash.priority, pair.first, pair.second))
}

/// How many conflicts all pairs have.
pub(super) fn count<C>(clashes: &[Pair<C>]) -> u32 {
    clashes.iter().fold(0, |sum, pair| sum.saturating_add(pair.clash.count))
}
