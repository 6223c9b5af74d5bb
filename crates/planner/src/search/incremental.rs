//! Conflict-based search in one tree, in which the assignment follows the constraints.
//!
//! # Source
//! Tang et al., "Solving multi-agent target assignment and path finding with a single constraint tree" (2023, ITA-CBS) and
//! "ITA-ECBS: a bounded-suboptimal algorithm for the combined target-assignment and path-finding problem" (2024).
//!
//! # Deviations
//! Costs are looked at only where the assignment takes them: an entry of the matrix is a lower bound from fewer rules until its
//! agent and goal are assigned to each other; then it is planned, raised, and the assignment mended by one augmenting
//! path. The papers plan a whole row for every constraint.

use std::sync::Arc;

use super::cbs::{Search, Settings};
use super::focal::Standing;
use super::tree::{self, Goals, Node, Pair, Paths};
use super::{Bound, Budget, Domain, Found, Planned, Query, Spent};
use crate::assign::{Costs, Matching, Scratch};
use crate::outcome::Effort;

/// Which of its goals each agent has at each column of the costs.
pub type Columns = [Vec<Option<usize>>];

/// Finds paths of all agents that are free of conflicts, with the assignment that is cheapest for them; as many agents as
/// possible take a goal. `costs` are lower bounds by agent and column, `columns` says which goals the columns are.
///
/// The domain's rules must not depend on which goal an agent has, since that changes within the tree.
pub fn solve_incremental<D: Domain>(
    domain: &mut D,
    costs: &Costs,
    columns: &Columns,
    settings: &Settings,
    budget: &Budget<'_>,
) -> (Found<D::Path>, Effort) {
    let before = domain.expanded();
    let mut incremental = Incremental {
        search: Search::new(domain, settings, budget),
        base: costs,
        columns,
        taken: 0,
        extras: Vec::new(),
        scratch: Scratch::default(),
        rules: Vec::new(),
    };
    let found =
        incremental.run().unwrap_or_else(|Spent| Found::Spent { best_bound: incremental.search.bound.max(0.0) });
    let mut effort = incremental.search.effort;
    effort.low_level_expanded = incremental.search.domain.expanded() - before;
    (found, effort)
}

/// What a node knows of the assignment.
struct Extra {
    matching: Arc<Matching>,
    /// The entries that it raised: agent, column (past the goals: idling), cost.
    raised: Vec<(u32, u32, f64)>,
}

struct Incremental<'a, D: Domain> {
    search: Search<'a, D>,
    base: &'a Costs,
    columns: &'a Columns,
    /// How many agents take a goal.
    taken: usize,
    /// By node.
    extras: Vec<Extra>,
    scratch: Scratch,
    rules: Vec<Bound<D::Rule>>,
}

/// A node that is being made.
struct Draft<'t, D: Domain> {
    parent: Option<u32>,
    branch: Option<Bound<D::Rule>>,
    costs: Costs,
    matching: Matching,
    raised: Vec<(u32, u32, f64)>,
    /// The present paths, the parent's at first, with the goals that they lead to.
    paths: &'t mut Paths<D::Path>,
    goals: Vec<Option<usize>>,
    /// Whose path has to be found anew, whatever its goal.
    stale: Vec<bool>,
    changed: Vec<u32>,
}

impl<D: Domain> Incremental<'_, D> {
    fn run(&mut self) -> Result<Found<D::Path>, Spent> {
        let agents = self.search.domain.agents();
        let budget = self.search.budget;
        let work = self.base.work();
        let matching = Matching::new(self.base, &mut self.scratch, || budget.spend(work))?;
        self.taken = matching.goals().iter().flatten().count();
        let mut paths: Paths<D::Path> = (0..agents).map(|_| None).collect();
        let draft = Draft {
            parent: None,
            branch: None,
            costs: self.base.clone(),
            matching,
            raised: Vec::new(),
            paths: &mut paths,
            goals: vec![None; agents],
            stale: vec![true; agents],
            changed: Vec::new(),
        };
        if let Some((node, extra)) = self.complete(draft, &[], 0.0)? {
            self.add(node, extra);
        }
        while let Some(bound) = self.search.open.bound() {
            self.search.bound = self.search.bound.max(bound);
            let Some(node) = self.search.open.pop(bound) else { break };
            if let Some(found) = self.expand(node)? {
                return Ok(found);
            }
        }
        Ok(Found::Exhausted)
    }

    fn add(&mut self, node: Node<D>, extra: Extra) {
        self.search.add(node);
        self.extras.push(extra);
    }

    /// The cost matrix of a node.
    fn costs(&self, node: u32) -> Costs {
        let mut costs = self.base.clone();
        let mut at = Some(node);
        while let Some(index) = at {
            for &(agent, column, cost) in &self.extras[index as usize].raised {
                // costs only rise on the way down
                costs.raise_to(agent as usize, column as usize, cost);
            }
            at = self.search.tree.nodes[index as usize].parent;
        }
        costs
    }

    fn expand(&mut self, index: u32) -> Result<Option<Found<D::Path>>, Spent> {
        self.search.budget.spend(1)?;
        self.search.effort.high_level_expanded += 1;
        let agents = self.search.domain.agents();
        let mut paths = self.search.tree.paths(index, agents);
        let node = &mut self.search.tree.nodes[index as usize];
        let goals = Arc::clone(&node.goals);
        let mut clashes = std::mem::take(&mut node.clashes);
        let mut standing = node.standing;
        if clashes.is_empty() {
            return self.search.finish(&goals, paths).map(Some);
        }
        let costs = self.costs(index);
        let matching = Arc::clone(&self.extras[index as usize].matching);
        while let Some(worst) = tree::worst(&clashes) {
            let branches = self.search.domain.split(worst.first as usize, worst.second as usize, &worst.clash.conflict);
            let mut children = Vec::with_capacity(2);
            let mut better = None;
            for branch in branches {
                let before = paths.clone();
                let stale = (0..agents).map(|agent| self.is_stale(agent, &paths, &branch)).collect();
                let draft = Draft {
                    parent: Some(index),
                    branch: Some(branch),
                    costs: costs.clone(),
                    matching: (*matching).clone(),
                    raised: Vec::new(),
                    paths: &mut paths,
                    goals: goals.to_vec(),
                    stale,
                    changed: Vec::new(),
                };
                let made = self.complete(draft, &clashes, standing.lower_bound);
                paths = before;
                let Some((node, extra)) = made? else { continue };
                if node.goals == goals && self.search.bypasses(&standing, &node, &paths) {
                    better = Some(node);
                    break;
                }
                children.push((node, extra));
            }
            let Some(child) = better else {
                for (node, extra) in children {
                    self.add(node, extra);
                }
                return Ok(None);
            };
            standing = self.search.take_over(index, child, &mut paths, &mut clashes, standing);
        }
        self.search.finish(&goals, paths).map(Some)
    }

    /// Whether a rule makes an agent's path void.
    fn is_stale(&self, agent: usize, paths: &Paths<D::Path>, branch: &Bound<D::Rule>) -> bool {
        let Some(planned) = &paths[agent] else { return true };
        if branch.everyone { !self.search.domain.obeys(agent, &planned.path, branch) } else { branch.agent == agent }
    }

    /// Plans and assigns until all agents have a path to the goal that the assignment gives them; `None` if they cannot.
    fn complete(
        &mut self,
        mut draft: Draft<'_, D>,
        clashes: &[Pair<D::Conflict>],
        bound: f64,
    ) -> Result<Option<(Node<D>, Extra)>, Spent> {
        let agents = self.search.domain.agents();
        let assigned = |matching: &Matching, columns: &Columns, agent: usize| {
            matching.goal(agent).and_then(|column| columns[agent][column])
        };
        self.search.effort.assignments += 1;
        let root = draft.parent.is_none();
        loop {
            let next = (0..agents).find(|&agent| {
                draft.stale[agent] || draft.goals[agent] != assigned(&draft.matching, self.columns, agent)
            });
            let Some(agent) = next else { break };
            let goal = assigned(&draft.matching, self.columns, agent);
            let column = draft.matching.goal(agent).unwrap_or_else(|| self.base.goals());
            let entry = draft.costs.at(agent, column);
            let planned = self.plan(&draft, agent, goal, entry, root)?;
            let least = planned.as_ref().map_or(f64::INFINITY, |planned| planned.lower_bound);
            if let Some(planned) = planned {
                draft.paths[agent] = Some(planned);
                draft.goals[agent] = goal;
                draft.stale[agent] = false;
                if !draft.changed.contains(&(agent as u32)) {
                    draft.changed.push(agent as u32);
                }
            }
            if least > entry {
                draft.costs.raise_to(agent, column, least);
                draft.raised.push((agent as u32, column as u32, least));
                self.search.budget.spend(self.base.work())?;
                let possible = draft.matching.raise(&draft.costs, agent, &mut self.scratch);
                if !possible || draft.matching.goals().iter().flatten().count() < self.taken {
                    return Ok(None);
                }
            }
        }
        let Draft { parent, branch, costs, matching, raised, paths, goals, changed, .. } = draft;
        let clashes = tree::clashes(self.search.domain, clashes, paths, &changed);
        let (cost, _) = tree::sums(paths);
        let least =
            (0..agents).map(|agent| costs.at(agent, matching.goal(agent).unwrap_or_else(|| self.base.goals()))).sum();
        let standing = Standing { lower_bound: bound.max(least), cost, conflicts: tree::count(&clashes) };
        let replaced = changed.iter().filter_map(|&agent| Some((agent, paths[agent as usize].clone()?))).collect();
        let node = Node { parent, goals: Goals::from(goals), rule: branch, replaced, clashes, standing };
        Ok(Some((node, Extra { matching: Arc::new(matching), raised })))
    }

    /// A path of one agent to a goal under the rules of the draft.
    fn plan(
        &mut self,
        draft: &Draft<'_, D>,
        agent: usize,
        goal: Option<usize>,
        floor: f64,
        root: bool,
    ) -> Result<Option<Planned<D::Path>>, Spent> {
        self.search.tree.rules(draft.parent, agent, draft.branch.as_ref(), &mut self.rules);
        let weight = if root { 1.0 } else { self.search.settings.weight };
        let query = Query { agent, goal, rules: &self.rules, paths: draft.paths, weight, floor, ceiling: 0.0 };
        let found = self.search.domain.plan(&query, self.search.budget)?;
        Ok(found.map(|mut planned| {
            planned.lower_bound = planned.lower_bound.max(floor);
            planned
        }))
    }
}
