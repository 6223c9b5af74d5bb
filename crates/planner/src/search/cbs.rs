//! Conflict-based search over a forest: one tree per assignment of goals.
//!
//! # Source
//! Sharon et al., "Conflict-based search for optimal multi-agent pathfinding" (2015); Hönig et al., "Conflict-based search
//! with optimal task assignment" (2018) for the forest; Barer et al., "Suboptimal variants of the conflict-based search
//! algorithm" (2014) for the bounded-suboptimal one; Boyarski et al., "Don't split, try to work it out: bypassing conflicts in
//! multi-agent pathfinding" (2015).
//!
//! # Deviations
//! Best-first and focal search are one: with weight 1 only nodes of the least bound are taken. A root takes over the paths of
//! the root before it for all agents whose goal is the same. What a bounded search found is polished at the end: agents are
//! planned again, one by one, into what the others leave free. Roots are planned without slack: what agents need to make way
//! they get below, where they are in conflict, which makes plans cheaper.

use std::sync::Arc;

use super::focal::{Open, Standing};
use super::tree::{self, Goals, Node, Pair, Paths, Replan, Tree};
use super::{Assigned, Assignments, Bound, Budget, Domain, Found, Planned, Query, Spent};
use crate::outcome::Effort;

/// How often all agents are planned again after a bounded search.
const POLISHES: usize = 4;

/// Larger weights mean nothing, and infinite ones would spoil sums.
const HEAVIEST: f64 = 1e6;

/// How a conflict-based search goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// By which factor the cost may exceed the lower bound; 1 finds the optimum.
    pub weight: f64,
    /// Whether agents are planned again one by one once a plan is found, if the weight is more than 1.
    pub polish: bool,
}

impl Settings {
    /// Plans within `weight` (at least 1) of the optimum, polished.
    pub const fn within(weight: f64) -> Self {
        Self { weight: if weight > 1.0 { weight.min(HEAVIEST) } else { 1.0 }, polish: true }
    }
}

/// Finds paths of all agents that are free of conflicts, with goals from `assignments`, whose cost is at most
/// `settings.weight` times the lower bound that comes with them.
pub fn solve<D: Domain>(
    domain: &mut D,
    assignments: &mut dyn Assignments,
    settings: &Settings,
    budget: &Budget<'_>,
) -> (Found<D::Path>, Effort) {
    let before = domain.expanded();
    let mut forest = Forest {
        search: Search::new(domain, settings, budget),
        later: Later::Unknown { at_least: f64::NEG_INFINITY },
        root: None,
    };
    let found =
        forest.run(assignments).unwrap_or_else(|Spent| Found::Spent { best_bound: forest.search.bound.max(0.0) });
    let mut effort = forest.search.effort;
    effort.low_level_expanded = forest.search.domain.expanded() - before;
    (found, effort)
}

/// What is known of the assignments that are not roots yet.
enum Later {
    Unknown { at_least: f64 },
    Known(Assigned),
    None,
}

impl Later {
    const fn bound(&self) -> f64 {
        match self {
            Self::Unknown { at_least } => *at_least,
            Self::Known(assigned) => assigned.cost,
            Self::None => f64::INFINITY,
        }
    }
}

struct Forest<'a, D: Domain> {
    search: Search<'a, D>,
    later: Later,
    /// The youngest root.
    root: Option<u32>,
}

impl<D: Domain> Forest<'_, D> {
    fn run(&mut self, assignments: &mut dyn Assignments) -> Result<Found<D::Path>, Spent> {
        loop {
            let mut least = self.search.open.bound().unwrap_or(f64::INFINITY);
            while self.later.bound() < least {
                self.search.bound = self.search.bound.max(self.later.bound());
                match std::mem::replace(&mut self.later, Later::None) {
                    Later::Known(assigned) => {
                        self.later = Later::Unknown { at_least: assigned.cost };
                        self.add_root(&assigned)?;
                        least = self.search.open.bound().unwrap_or(f64::INFINITY);
                    }
                    Later::Unknown { at_least } => {
                        self.later = Later::Unknown { at_least };
                        self.later = assignments.next(self.search.budget)?.map_or(Later::None, Later::Known);
                    }
                    Later::None => {}
                }
            }
            let bound = least.min(self.later.bound());
            let Some(node) = self.search.open.pop(bound) else { return Ok(Found::Exhausted) };
            self.search.bound = self.search.bound.max(bound);
            if let Some(found) = self.search.expand(node)? {
                return Ok(found);
            }
        }
    }

    /// Adds the root of an assignment, unless some agent cannot reach its goal.
    fn add_root(&mut self, assigned: &Assigned) -> Result<(), Spent> {
        let agents = self.search.domain.agents();
        let goals: Goals = Arc::from(assigned.goals.as_slice());
        self.search.effort.assignments += 1;
        let (mut paths, old) = match self.root {
            None => ((0..agents).map(|_| None).collect(), &[] as &[_]),
            // roots keep their clashes for the next one
            Some(root) => (self.search.tree.paths(root, agents), self.search.roots_clashes.as_slice()),
        };
        let mut changed: Vec<u32> = Vec::new();
        for agent in 0..agents {
            let same = self.root.is_some_and(|root| self.search.tree.nodes[root as usize].goals[agent] == goals[agent]);
            if !same {
                paths[agent] = None;
                changed.push(agent as u32);
            }
        }
        for &agent in &changed {
            let agent = agent as usize;
            let query =
                Replan { agent, goal: goals.get(agent).copied().flatten(), rules: &[], weight: 1.0, floor: 0.0 };
            if tree::replan(self.search.domain, &query, &mut paths, self.search.budget)?.is_none() {
                return Ok(());
            }
        }
        let clashes = tree::clashes(self.search.domain, old, &paths, &changed);
        let (cost, bound) = tree::sums(&paths);
        let standing = Standing { lower_bound: bound.max(assigned.cost), cost, conflicts: tree::count(&clashes) };
        self.search.roots_clashes.clone_from(&clashes);
        let replaced = paths.into_iter().enumerate().filter_map(|(agent, path)| Some((agent as u32, path?))).collect();
        self.root = Some(self.search.tree.nodes.len() as u32);
        self.search.add(Node { parent: None, goals, rule: None, replaced, clashes, standing });
        Ok(())
    }
}

/// The tree below its roots.
pub(super) struct Search<'a, D: Domain> {
    pub domain: &'a mut D,
    pub settings: &'a Settings,
    pub budget: &'a Budget<'a>,
    pub tree: Tree<D>,
    pub open: Open,
    pub effort: Effort,
    /// No plan costs less.
    pub bound: f64,
    /// Clashes of the youngest root.
    roots_clashes: Vec<Pair<D::Conflict>>,
    rules: Vec<Bound<D::Rule>>,
}

impl<'a, D: Domain> Search<'a, D> {
    pub(super) fn new(domain: &'a mut D, settings: &'a Settings, budget: &'a Budget<'a>) -> Self {
        Self {
            domain,
            settings,
            budget,
            tree: Tree::new(),
            open: Open::new(settings.weight),
            effort: Effort::default(),
            bound: 0.0,
            roots_clashes: Vec::new(),
            rules: Vec::new(),
        }
    }

    /// Adds an open node.
    pub(super) fn add(&mut self, node: Node<D>) {
        self.open.push(node.standing);
        self.tree.nodes.push(node);
    }

    /// Splits the first conflict of a node, or returns what was found if it has none.
    fn expand(&mut self, index: u32) -> Result<Option<Found<D::Path>>, Spent> {
        self.budget.spend(1)?;
        self.effort.high_level_expanded += 1;
        let agents = self.domain.agents();
        let mut paths = self.tree.paths(index, agents);
        let node = &mut self.tree.nodes[index as usize];
        let goals = Arc::clone(&node.goals);
        let mut clashes = std::mem::take(&mut node.clashes);
        let mut standing = node.standing;
        loop {
            let Some(worst) = tree::worst(&clashes) else {
                return self.finish(&goals, paths).map(Some);
            };
            let branches = self.domain.split(worst.first as usize, worst.second as usize, &worst.clash.conflict);
            let mut children = Vec::with_capacity(2);
            let mut better = None;
            for branch in branches {
                let Some(child) = self.child(index, &goals, &mut paths, &clashes, standing, branch)? else { continue };
                if self.bypasses(&standing, &child, &paths) {
                    better = Some(child);
                    break;
                }
                children.push(child);
            }
            let Some(child) = better else {
                for child in children {
                    self.add(child);
                }
                return Ok(None);
            };
            standing = self.take_over(index, child, &mut paths, &mut clashes, standing);
        }
    }

    /// Gives a node the paths of a child: they obey its rules too, and so it need not be split here. Its own lower bounds stay,
    /// since the child's rule is not taken over.
    pub(super) fn take_over(
        &mut self,
        index: u32,
        child: Node<D>,
        paths: &mut Paths<D::Path>,
        clashes: &mut Vec<Pair<D::Conflict>>,
        standing: Standing,
    ) -> Standing {
        let node = &mut self.tree.nodes[index as usize];
        for (agent, mut planned) in child.replaced {
            let slot = &mut paths[agent as usize];
            planned.lower_bound = slot.as_ref().map_or(0.0, |old| old.lower_bound);
            *slot = Some(planned.clone());
            node.replaced.retain(|(other, _)| *other != agent);
            node.replaced.push((agent, planned));
        }
        *clashes = child.clashes;
        let (cost, _) = tree::sums(paths);
        node.standing = Standing { lower_bound: standing.lower_bound, cost, conflicts: child.standing.conflicts };
        node.standing
    }

    /// Whether a node with these paths may take over those of a child without splitting: only paths that it could have had
    /// itself.
    pub(super) fn bypasses(&self, standing: &Standing, child: &Node<D>, paths: &Paths<D::Path>) -> bool {
        let weight = self.settings.weight;
        let limit = if weight > 1.0 { self.open.limit(self.bound) } else { standing.cost };
        let own = child.replaced.iter().all(|(agent, planned)| {
            let old = paths[*agent as usize].as_ref();
            old.is_some_and(|old| planned.cost <= (weight * old.lower_bound).max(old.cost))
        });
        own && child.standing.conflicts < standing.conflicts && child.standing.cost <= limit
    }

    /// The child of a node for a branch, `None` if there is no path for some agent. `paths` are those of the node.
    fn child(
        &mut self,
        parent: u32,
        goals: &Goals,
        paths: &mut Paths<D::Path>,
        clashes: &[Pair<D::Conflict>],
        standing: Standing,
        branch: Bound<D::Rule>,
    ) -> Result<Option<Node<D>>, Spent> {
        let mut old = Vec::new();
        let result = self.replan_bound(parent, goals, paths, &branch, &mut old);
        let child = match result {
            Ok(true) => {
                let changed: Vec<u32> = old.iter().map(|(agent, _)| *agent).collect();
                let clashes = tree::clashes(self.domain, clashes, paths, &changed);
                let (cost, bound) = tree::sums(paths);
                let standing =
                    Standing { lower_bound: standing.lower_bound.max(bound), cost, conflicts: tree::count(&clashes) };
                let replaced =
                    changed.iter().filter_map(|&agent| Some((agent, paths[agent as usize].clone()?))).collect();
                let (goals, rule) = (Arc::clone(goals), Some(branch));
                Some(Node { parent: Some(parent), goals, rule, replaced, clashes, standing })
            }
            _ => None,
        };
        for (agent, planned) in old {
            paths[agent as usize] = planned;
        }
        result.map(|_| child)
    }

    /// Replans all agents that a new rule binds and puts their former paths into `old`; false if one has no path.
    fn replan_bound(
        &mut self,
        parent: u32,
        goals: &Goals,
        paths: &mut Paths<D::Path>,
        branch: &Bound<D::Rule>,
        old: &mut Vec<(u32, Option<Planned<D::Path>>)>,
    ) -> Result<bool, Spent> {
        let affected: Vec<usize> = if branch.everyone {
            let disobeys = |agent: &usize| {
                paths[*agent].as_ref().is_some_and(|planned| !self.domain.obeys(*agent, &planned.path, branch))
            };
            (0..paths.len()).filter(disobeys).collect()
        } else {
            vec![branch.agent]
        };
        for agent in affected {
            self.tree.rules(Some(parent), agent, Some(branch), &mut self.rules);
            let floor = paths[agent].as_ref().map_or(0.0, |old| old.lower_bound);
            let weight = self.settings.weight;
            old.push((agent as u32, paths[agent].clone()));
            let query = Replan { agent, goal: goals[agent], rules: &self.rules, weight, floor };
            if tree::replan(self.domain, &query, paths, self.budget)?.is_none() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The answer, polished if that was asked for.
    pub(super) fn finish(&mut self, goals: &Goals, mut paths: Paths<D::Path>) -> Result<Found<D::Path>, Spent> {
        if self.settings.polish && self.settings.weight > 1.0 {
            // a plan is a plan: if the budget ends here, it is returned as it is
            let _ = self.polish(goals, &mut paths);
        }
        let (cost, _) = tree::sums(&paths);
        let goals = goals.to_vec();
        Ok(Found::Solved {
            goals,
            paths: paths.into_iter().flatten().collect(),
            cost,
            lower_bound: self.bound.min(cost),
        })
    }

    /// Plans each agent again, as cheap as the others let it.
    fn polish(&mut self, goals: &Goals, paths: &mut Paths<D::Path>) -> Result<(), Spent> {
        for _ in 0..POLISHES {
            let mut improved = false;
            for agent in 0..paths.len() {
                let Some(old) = paths[agent].clone() else { continue };
                let query =
                    Query { agent, goal: goals[agent], rules: &[], paths, weight: 1.0, floor: 0.0, ceiling: old.cost };
                let Some(new) = self.domain.plan(&query, self.budget)? else { continue };
                if new.cost >= old.cost {
                    continue;
                }
                paths[agent] = Some(new);
                if tree::clashes(self.domain, &[], paths, &[agent as u32]).is_empty() {
                    improved = true;
                } else {
                    paths[agent] = Some(old);
                }
            }
            if !improved {
                break;
            }
        }
        Ok(())
    }
}
