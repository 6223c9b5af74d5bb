//! Plans on grids.

use std::collections::BTreeMap;

use super::agents::{Taker, check_assignment, matched};
use super::assignment::cheapest;
use super::claims::{self, Counted, Range};
use super::{Findings, Violation, ViolationKind, Work};
use crate::instance::{Cell, GridAgent, GridInstance};
use crate::plan::{GridPlan, Route};

/// Most cells that searches for the weak lower bound may visit, and most work of its assignment.
const WEAK_BOUND_MAX: u64 = 1_000_000_000;
/// Most entries of the table of that assignment.
const ENTRIES_MAX: u64 = 10_000_000;
/// Most meetings that are looked at; all of them are violations, so a plan with more is wrong anyway.
const MEETINGS_MAX: u64 = 10_000_000;

/// See [`super::grid`](fn@super::grid).
pub(super) fn check(instance: &GridInstance, plan: &GridPlan) -> Vec<Violation> {
    let mut findings = Findings::default();
    let Some(map) = Map::new(instance) else {
        let (width, height, blocked) = (instance.width, instance.height, instance.blocked.len());
        findings.add(ViolationKind::Instance, 0.0, &[], || {
            format!("the map is {width} × {height}, but has {blocked} cells")
        });
        return findings.finish();
    };
    let names: Vec<&str> = instance.agents.iter().map(|agent| agent.name.as_str()).collect();
    let routes = matched(&names, &plan.routes, &mut findings);
    for (agent, route) in routes.iter().enumerate() {
        if let Some(route) = route {
            check_route(&map, agent, &instance.agents[agent], route, &mut findings);
        }
    }
    check_conflicts(&routes, &mut findings);
    check_goals(&map, instance, &routes, &mut findings);
    let time = last_step(&routes);
    let counted = counted(instance, &routes, time);
    claims::check(&plan.claims, &counted, || weak_bound(&map, instance), &mut findings);
    findings.finish()
}

fn last_step(routes: &[Option<&Route<Cell>>]) -> f64 {
    routes.iter().flatten().map(|route| route.states.len().saturating_sub(1)).max().unwrap_or(0) as f64
}

/// The free cells.
struct Map<'a> {
    width: usize,
    height: usize,
    blocked: &'a [bool],
}

impl<'a> Map<'a> {
    fn new(instance: &'a GridInstance) -> Option<Self> {
        let (width, height) = (usize::try_from(instance.width).ok()?, usize::try_from(instance.height).ok()?);
        (width.checked_mul(height) == Some(instance.blocked.len())).then_some(Self {
            width,
            height,
            blocked: &instance.blocked,
        })
    }

    fn index(&self, cell: Cell) -> Option<usize> {
        let (x, y) = (usize::try_from(cell.x).ok()?, usize::try_from(cell.y).ok()?);
        (x < self.width && y < self.height).then_some(y * self.width + x)
    }

    /// The free cells beside the one with this index.
    fn beside(&self, index: usize) -> impl Iterator<Item = usize> {
        let (x, y) = (index % self.width, index / self.width);
        let (width, height) = (self.width, self.height);
        [
            (x > 0).then(|| index - 1),
            (x + 1 < width).then(|| index + 1),
            (y > 0).then(|| index - width),
            (y + 1 < height).then(|| index + width),
        ]
        .into_iter()
        .flatten()
        .filter(|next| !self.blocked[*next])
    }

    /// Which cells hang together: equal numbers, from 1; 0 for blocked ones.
    fn regions(&self) -> Vec<u32> {
        let mut region = vec![0; self.blocked.len()];
        let mut number = 0;
        let mut open = Vec::new();
        for cell in 0..region.len() {
            if self.blocked[cell] || region[cell] > 0 {
                continue;
            }
            number += 1;
            region[cell] = number;
            open.push(cell);
            while let Some(cell) = open.pop() {
                for next in self.beside(cell) {
                    if region[next] == 0 {
                        region[next] = number;
                        open.push(next);
                    }
                }
            }
        }
        region
    }

    /// Steps from every free cell to `goal`; `u32::MAX` where there is no way.
    fn distances(&self, goal: usize) -> Vec<u32> {
        let mut distance = vec![u32::MAX; self.blocked.len()];
        if self.blocked[goal] {
            return distance;
        }
        distance[goal] = 0;
        let mut open = vec![goal];
        let mut steps = 0;
        while !open.is_empty() {
            steps += 1;
            let mut further = Vec::new();
            for cell in open {
                for next in self.beside(cell) {
                    if distance[next] == u32::MAX {
                        distance[next] = steps;
                        further.push(next);
                    }
                }
            }
            open = further;
        }
        distance
    }
}

/// Start, cells and moves of one agent.
fn check_route(map: &Map<'_>, agent: usize, given: &GridAgent, route: &Route<Cell>, findings: &mut Findings) {
    match route.states.first() {
        None => findings.add(ViolationKind::Start, 0.0, &[agent], || format!("the route of agent {agent} is empty")),
        Some(first) if *first != given.start => findings.add(ViolationKind::Start, 0.0, &[agent], || {
            format!("agent {agent} starts in {} instead of {}", at(*first), at(given.start))
        }),
        Some(_) => {}
    }
    for (step, cell) in route.states.iter().enumerate() {
        match map.index(*cell) {
            None => findings.add(ViolationKind::Outside, step as f64, &[agent], || {
                format!("agent {agent} is in {}, outside of the map", at(*cell))
            }),
            Some(index) if map.blocked[index] => findings.add(ViolationKind::Obstacle, step as f64, &[agent], || {
                format!("agent {agent} is in {}, which is blocked", at(*cell))
            }),
            Some(_) => {}
        }
    }
    for (step, pair) in route.states.windows(2).enumerate() {
        let far = pair[0].x.abs_diff(pair[1].x).saturating_add(pair[0].y.abs_diff(pair[1].y));
        if far > 1 {
            findings.add(ViolationKind::Step, step as f64, &[agent], || {
                format!("agent {agent} jumps by {far} cells from {} to {}", at(pair[0]), at(pair[1]))
            });
        }
    }
}

fn at(cell: Cell) -> String {
    format!("({}, {})", cell.x, cell.y)
}

/// Two in one cell, two that change places.
fn check_conflicts(routes: &[Option<&Route<Cell>>], findings: &mut Findings) {
    let mut states: Vec<(usize, Cell, usize)> = Vec::new();
    let mut parked: BTreeMap<Cell, Vec<(usize, usize)>> = BTreeMap::new();
    for (agent, route) in routes.iter().enumerate() {
        let Some(route) = route else { continue };
        states.extend(route.states.iter().enumerate().map(|(step, cell)| (step, *cell, agent)));
        if let Some(last) = route.states.last() {
            parked.entry(*last).or_default().push((route.states.len() - 1, agent));
        }
    }
    states.sort_unstable();
    let mut meetings = Work { left: MEETINGS_MAX };
    for group in states.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        for (number, (step, cell, first)) in group.iter().enumerate() {
            for (_, _, second) in &group[number + 1..] {
                if findings.is_full() || !meetings.spend(1) {
                    return;
                }
                findings.add(ViolationKind::Collision, *step as f64, &[*first, *second], || {
                    format!("agents {first} and {second} are both in {}", at(*cell))
                });
            }
        }
    }
    for waiting in parked.values_mut() {
        waiting.sort_unstable();
    }
    for (step, cell, agent) in &states {
        let Some(waiting) = parked.get(cell) else { continue };
        // in the same step they were seen above
        for (since, other) in waiting.iter().take_while(|(since, _)| since < step).filter(|(_, other)| other != agent) {
            if findings.is_full() || !meetings.spend(1) {
                return;
            }
            findings.add(ViolationKind::Collision, *step as f64, &[*agent, *other], || {
                format!("agent {agent} is in {}, where agent {other} stays since step {since}", at(*cell))
            });
        }
    }
    let mut moves: Vec<(usize, Cell, Cell, usize)> = Vec::new();
    for (agent, route) in routes.iter().enumerate() {
        let Some(route) = route else { continue };
        let pairs = route.states.windows(2).enumerate().filter(|(_, pair)| pair[0] != pair[1]);
        moves.extend(pairs.map(|(step, pair)| (step, pair[0], pair[1], agent)));
    }
    moves.sort_unstable();
    for (step, from, to, agent) in &moves {
        let first = moves.partition_point(|other| (other.0, other.1, other.2) < (*step, *to, *from));
        for other in moves[first..].iter().take_while(|other| (other.0, other.1, other.2) == (*step, *to, *from)) {
            if findings.is_full() || !meetings.spend(1) {
                return;
            }
            findings.add(ViolationKind::Swap, *step as f64 + 0.5, &[*agent, other.3], || {
                format!("agents {agent} and {} change places between {} and {}", other.3, at(*from), at(*to))
            });
        }
    }
}

/// Every route ends in the goal it claims; goals are taken once, and as many as can be.
fn check_goals(map: &Map<'_>, instance: &GridInstance, routes: &[Option<&Route<Cell>>], findings: &mut Findings) {
    for (agent, (given, route)) in instance.agents.iter().zip(routes).enumerate() {
        let Some((route, end)) = route.and_then(|route| Some((route, *route.states.last()?))) else { continue };
        let time = (route.states.len() - 1) as f64;
        match (goal_of(instance, given, route), route.goal) {
            (Some(goal), _) if goal != end => findings.add(ViolationKind::Goal, time, &[agent], || {
                format!("agent {agent} ends in {} instead of its goal {}", at(end), at(goal))
            }),
            (None, Some(index)) => findings.add(ViolationKind::Goal, time, &[agent], || {
                format!("agent {agent} claims its goal {index}, but has {}", given.goals.len())
            }),
            _ => {}
        }
    }
    if !instance.assignment {
        return;
    }
    let region = map.regions();
    let mut numbers: BTreeMap<Cell, usize> = BTreeMap::new();
    for goal in instance.agents.iter().flat_map(|agent| &agent.goals) {
        let next = numbers.len();
        numbers.entry(*goal).or_insert(next);
    }
    let takers: Vec<Taker> = instance
        .agents
        .iter()
        .zip(routes)
        .map(|(given, route)| {
            let home = map.index(given.start).map_or(0, |index| region[index]);
            let reached = |goal: &&Cell| home > 0 && map.index(**goal).is_some_and(|index| region[index] == home);
            Taker {
                options: given.goals.iter().filter(reached).map(|goal| numbers[goal]).collect(),
                taken: route.and_then(|route| goal_of(instance, given, route)).map(|goal| numbers[&goal]),
            }
        })
        .collect();
    check_assignment(&takers, numbers.len(), last_step(routes), findings);
}

/// The goal that a route takes. Without assignment that is the agent's own, whether or not the route says so.
fn goal_of(instance: &GridInstance, given: &GridAgent, route: &Route<Cell>) -> Option<Cell> {
    match route.goal {
        Some(index) => given.goals.get(index).copied(),
        None if !instance.assignment => given.goals.first().copied(),
        None => None,
    }
}

/// Cost, makespan and flowtime, by the last arrivals and, where goals are assigned, as libMultiRobotPlanning counts too.
fn counted(instance: &GridInstance, routes: &[Option<&Route<Cell>>], time: f64) -> Counted {
    let (mut sums, mut most) = ([0.0; 2], [0.0_f64; 2]);
    let mut last = 0.0_f64;
    for (given, route) in instance.agents.iter().zip(routes) {
        let Some(route) = route else { continue };
        let Some(end) = route.states.last() else { continue };
        let arrival = route.states.iter().rposition(|cell| cell != end).map_or(0, |before| before + 1);
        let goal = goal_of(instance, given, route);
        let is_free = |pair: &[Cell]| pair[0] == pair[1] && goal.is_none_or(|goal| goal == pair[0]);
        let charged = route.states.windows(2).filter(|pair| !is_free(pair)).count();
        last = last.max(arrival as f64);
        let arrived = if goal.is_some() { arrival } else { charged };
        for (way, steps) in [arrived, charged].into_iter().enumerate() {
            sums[way] += steps as f64;
            most[way] = most[way].max(steps as f64);
        }
    }
    let exactly = |value: f64| (value, value);
    let ways = if instance.assignment { 2 } else { 1 };
    let sums: Vec<Range> = sums.into_iter().take(ways).map(exactly).collect();
    let mut makespan = vec![exactly(last)];
    makespan.extend(most.into_iter().filter(|most| instance.assignment && *most != last).map(exactly));
    // steps are whole numbers; what is left is how files write them
    Counted { cost: sums.clone(), makespan, flowtime: sums, tolerance: 1e-6, relative: 1e-9, time }
}

/// Sum of the shortest ways, under the cheapest assignment; nothing where that takes too much work.
fn weak_bound(map: &Map<'_>, instance: &GridInstance) -> Option<f64> {
    let mut takers: BTreeMap<Cell, Vec<usize>> = BTreeMap::new();
    for (agent, given) in instance.agents.iter().enumerate() {
        for goal in &given.goals {
            takers.entry(*goal).or_default().push(agent);
        }
    }
    let (rows, goals, cells) = (instance.agents.len() as u64, takers.len() as u64, map.blocked.len() as u64);
    let assigning = if instance.assignment { rows.checked_mul(rows)?.checked_mul(rows + goals)? } else { 0 };
    let entries = if instance.assignment { rows.checked_mul(goals)? } else { 0 };
    if goals.checked_mul(cells)? > WEAK_BOUND_MAX || assigning > WEAK_BOUND_MAX || entries > ENTRIES_MAX {
        return None;
    }
    let mut costs: Vec<Vec<Option<f64>>> =
        vec![vec![None; entries as usize / instance.agents.len().max(1)]; instance.agents.len()];
    let mut shortest = vec![f64::INFINITY; instance.agents.len()];
    for (column, (goal, agents)) in takers.iter().enumerate() {
        let Some(index) = map.index(*goal) else { continue };
        let distance = map.distances(index);
        for agent in agents {
            let steps = map.index(instance.agents[*agent].start).map_or(u32::MAX, |start| distance[start]);
            if steps == u32::MAX {
                continue;
            }
            let steps = f64::from(steps);
            shortest[*agent] = shortest[*agent].min(steps);
            if instance.assignment {
                costs[*agent][column] = Some(steps);
            }
        }
    }
    if instance.assignment {
        return Some(cheapest(&costs));
    }
    Some(shortest.into_iter().filter(|steps| steps.is_finite()).sum())
}
