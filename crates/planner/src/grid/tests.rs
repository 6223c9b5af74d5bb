//! Plans on small grids against searches of all joint states.

use std::collections::BTreeMap;

use super::*;
use crate::instance::{Cell, GridAgent};

/// Small numbers from a seed.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % limit
    }
}

/// An agent: its start and its goals, as (x, y).
type Agent<'a> = ((i32, i32), &'a [(i32, i32)]);

/// Where all agents are, and who stays there for good.
type Joint = (Vec<Cell>, Vec<bool>);

/// A grid from rows of `.` and `#`, agents from (start, goals).
fn instance(rows: &[&str], agents: &[Agent<'_>], assignment: bool) -> GridInstance {
    let cell = |(x, y): (i32, i32)| Cell { x, y };
    GridInstance {
        width: rows[0].len() as i32,
        height: rows.len() as i32,
        blocked: rows.iter().flat_map(|row| row.chars().map(|cell| cell == '#')).collect(),
        agents: agents
            .iter()
            .enumerate()
            .map(|(index, (start, goals))| GridAgent {
                name: format!("agent{index}"),
                start: cell(*start),
                goals: goals.iter().copied().map(cell).collect(),
            })
            .collect(),
        assignment,
    }
}

fn random(numbers: &mut Numbers, assignment: bool) -> GridInstance {
    let (width, height) = (2 + numbers.below(2), 2 + numbers.below(2));
    let blocked: Vec<bool> = (0..width * height).map(|_| numbers.below(5) == 0).collect();
    let free: Vec<usize> = (0..width * height).filter(|&cell| !blocked[cell]).collect();
    let cell = |index: usize| Cell { x: (index % width) as i32, y: (index / width) as i32 };
    let mut draw = |count: usize| -> Vec<usize> {
        let mut rest = free.clone();
        (0..count.min(rest.len())).map(|_| rest.swap_remove(numbers.below(rest.len()))).collect()
    };
    let starts = draw(3);
    let goals = draw(if assignment { 2 + starts.len() % 2 } else { starts.len() });
    let agents = starts.iter().enumerate().map(|(agent, &start)| GridAgent {
        name: format!("agent{agent}"),
        start: cell(start),
        goals: if assignment {
            goals.iter().enumerate().filter(|(goal, _)| (goal + agent) % 3 != 1).map(|(_, &goal)| cell(goal)).collect()
        } else {
            vec![cell(goals[agent])]
        },
    });
    let agents = agents.collect();
    GridInstance { width: width as i32, height: height as i32, blocked, agents, assignment }
}

/// The least cost of any plan with given goals, from all joint states: Dijkstra over (cells, who has arrived for good).
fn least(instance: &GridInstance, goals: &[Option<usize>]) -> Option<usize> {
    let goal = |agent: usize| goals[agent].map(|goal| instance.agents[agent].goals[goal]);
    let start: Vec<Cell> = instance.agents.iter().map(|agent| agent.start).collect();
    let agents = start.len();
    let mut best: BTreeMap<Joint, usize> = BTreeMap::new();
    let mut open: BTreeMap<usize, Vec<Joint>> = BTreeMap::new();
    open.entry(0).or_default().push((start.clone(), vec![false; agents]));
    best.insert((start, vec![false; agents]), 0);
    while let Some(mut entry) = open.first_entry() {
        let cost = *entry.key();
        let Some((cells, done)) = entry.get_mut().pop() else {
            entry.remove();
            continue;
        };
        if best[&(cells.clone(), done.clone())] < cost {
            continue;
        }
        if (0..agents).all(|agent| done[agent] || goal(agent).is_none()) {
            return Some(cost);
        }
        let mut push = |state: Joint, cost: usize| {
            let old = best.entry(state.clone()).or_insert(usize::MAX);
            if cost < *old {
                *old = cost;
                open.entry(cost).or_default().push(state);
            }
        };
        // an agent at its goal may decide to stay for good
        for agent in 0..agents {
            if !done[agent] && goal(agent) == Some(cells[agent]) {
                let mut done = done.clone();
                done[agent] = true;
                push((cells.clone(), done), cost);
            }
        }
        // all joint moves
        let moves = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)];
        for code in 0..5_usize.pow(agents as u32) {
            let mut next = Vec::with_capacity(agents);
            let mut paid = 0;
            for agent in 0..agents {
                let choice = code / 5_usize.pow(agent as u32) % 5;
                let (dx, dy) = moves[choice];
                let to = Cell { x: cells[agent].x + dx, y: cells[agent].y + dy };
                if !instance.is_free(to) || (done[agent] && choice != 0) {
                    break;
                }
                let free = match goal(agent) {
                    None => choice == 0,
                    Some(goal) => done[agent] || (instance.assignment && choice == 0 && goal == to),
                };
                paid += usize::from(!free);
                next.push(to);
            }
            let met = |a: usize, b: usize| next[a] == next[b] || (next[a] == cells[b] && next[b] == cells[a]);
            if next.len() == agents && (0..agents).all(|a| (0..a).all(|b| !met(a, b))) {
                push((next, done.clone()), cost + paid);
            }
        }
    }
    None
}

/// The least cost over all assignments that leave as few agents without a goal as possible.
fn least_assigned(instance: &GridInstance) -> Option<usize> {
    fn all(instance: &GridInstance, goals: &mut Vec<Option<usize>>, found: &mut Vec<Vec<Option<usize>>>) {
        let agent = goals.len();
        let Some(wishes) = instance.agents.get(agent) else {
            found.push(goals.clone());
            return;
        };
        for goal in (0..wishes.goals.len()).map(Some).chain([None]) {
            let taken = |goal: usize| {
                let earlier = goals.iter().zip(&instance.agents);
                earlier.filter_map(|(goal, agent)| Some(agent.goals[(*goal)?])).any(|cell| cell == wishes.goals[goal])
            };
            let reachable = |goal: usize| {
                let alone = GridInstance { agents: vec![wishes.clone()], ..instance.clone() };
                least(&alone, &[Some(goal)]).is_some()
            };
            if goal.is_none_or(|goal| !taken(goal) && reachable(goal)) {
                goals.push(goal);
                all(instance, goals, found);
                goals.pop();
            }
        }
    }
    let mut found = Vec::new();
    all(instance, &mut Vec::new(), &mut found);
    let most = found.iter().map(|goals| goals.iter().flatten().count()).max()?;
    found.iter().filter(|goals| goals.iter().flatten().count() == most).filter_map(|goals| least(instance, goals)).min()
}

/// What is wrong with a plan: moves, conflicts, ends, cost and bound.
fn fault(instance: &GridInstance, plan: &GridPlan) -> Option<String> {
    let steps = plan.routes.iter().map(|route| route.states.len()).max().unwrap_or(0);
    let at = |agent: usize, step: usize| {
        let states = &plan.routes[agent].states;
        states[step.min(states.len() - 1)]
    };
    for (agent, (route, wishes)) in plan.routes.iter().zip(&instance.agents).enumerate() {
        if at(agent, 0) != wishes.start || route.goal.is_some_and(|goal| wishes.goals[goal] != at(agent, steps)) {
            return Some(format!("agent {agent} is wrong at an end"));
        }
        for step in 0..steps {
            let (now, next) = (at(agent, step), at(agent, step + 1));
            if (now.x - next.x).abs() + (now.y - next.y).abs() > 1 || !instance.is_free(next) {
                return Some(format!("agent {agent} jumps at {step}"));
            }
            if (0..agent)
                .any(|other| at(other, step + 1) == next || (at(other, step + 1) == now && at(other, step) == next))
            {
                return Some(format!("agent {agent} collides at {step}"));
            }
        }
    }
    let Claims { cost: Some(cost), lower_bound: Some(least), bound: Some(bound), .. } = plan.claims else {
        return Some("claims are missing".to_owned());
    };
    (cost > bound * least + 1e-9 || least > cost).then(|| format!("cost {cost}, lower bound {least}, bound {bound}"))
}

fn run(instance: &GridInstance, planner: Planner, bound: f64, expansions: u64) -> Ended<GridPlan> {
    solve(instance, &Options { planner, bound }, &Budget::new(expansions, &|| false))
}

fn reasons(instance: &GridInstance) -> Vec<Reason> {
    match run(instance, Planner::Cbs, 1.0, 10_000).outcome {
        Outcome::Infeasible(reasons) => reasons,
        other => panic!("{other:?}"),
    }
}

/// Instances of up to three agents with own goals; 300 from seed 3.
#[test]
fn plans_cost_what_joint_states_cost() {
    let mut numbers = Numbers(3);
    let mut solved = 0;
    for case in 0..300 {
        let instance = random(&mut numbers, false);
        let goals = vec![Some(0); instance.agents.len()];
        let expected = least(&instance, &goals);
        match (run(&instance, Planner::Cbs, 1.0, 30_000).outcome, expected) {
            (Outcome::Solved(plan), Some(expected)) => {
                assert_eq!(fault(&instance, &plan), None, "case {case}: {instance:?}");
                assert_eq!(plan.claims.cost, Some(expected as f64), "case {case}: {instance:?}");
                solved += 1;
            }
            (Outcome::Infeasible(_) | Outcome::BudgetSpent { .. }, None) => continue,
            (outcome, expected) => panic!("case {case}: {outcome:?}, expected {expected:?}, {instance:?}"),
        }
        let Outcome::Solved(plan) = run(&instance, Planner::Ecbs, 1.3, 1_000_000).outcome else {
            panic!("case {case} is not solved: {instance:?}")
        };
        assert_eq!(fault(&instance, &plan), None, "case {case}: {instance:?}");
        assert!(plan.claims.cost <= expected.map(|cost| 1.3 * cost as f64 + 1e-9));
        assert!(plan.claims.lower_bound <= expected.map(|cost| cost as f64));
    }
    assert!(solved > 100, "only {solved} instances could be solved");
}

/// Up to three agents, two or three goals, some of them forbidden: more agents than goals and fewer.
#[test]
fn assigned_plans_cost_what_joint_states_cost() {
    let mut numbers = Numbers(11);
    let mut solved = 0;
    for case in 0..200 {
        let instance = random(&mut numbers, true);
        let expected = least_assigned(&instance);
        for (planner, bound) in
            [(Planner::CbsTa, 1.0), (Planner::ItaCbs, 1.0), (Planner::EcbsTa, 1.3), (Planner::ItaEcbs, 1.3)]
        {
            match (run(&instance, planner, bound, 60_000).outcome, expected) {
                (Outcome::Solved(plan), Some(expected)) => {
                    assert_eq!(fault(&instance, &plan), None, "case {case} {planner:?}: {instance:?}");
                    let cost = plan.claims.cost.unwrap();
                    assert!(
                        cost >= expected as f64 && cost <= bound * expected as f64 + 1e-9,
                        "case {case} {planner:?}: {cost}, expected {expected}: {instance:?}"
                    );
                    solved += 1;
                }
                (Outcome::Infeasible(_) | Outcome::BudgetSpent { .. }, None) => {}
                (outcome, expected) => {
                    panic!("case {case} {planner:?}: {outcome:?}, expected {expected:?}: {instance:?}")
                }
            }
        }
    }
    assert!(solved > 400, "only {solved} runs could be solved");
}

#[test]
fn every_plain_fault_is_reported_at_once() {
    let walled = instance(
        &["..#.", "..##"],
        &[
            ((0, 0), &[(3, 0)]),
            ((0, 0), &[(2, 0)]),
            ((2, 0), &[(9, 0)]),
            ((-1, 0), &[(1, 1)]),
            ((1, 0), &[(1, 1)]),
            ((0, 1), &[]),
        ],
        false,
    );
    let reasons = reasons(&walled);
    for reason in [
        Reason::Unreachable { agent: 0, goal: 0 },
        Reason::StartsCollide { first: 0, second: 1 },
        Reason::GoalBlocked { agent: 1, goal: 0, obstacle: None },
        Reason::StartBlocked { agent: 2, obstacle: None },
        Reason::GoalOutside { agent: 2, goal: 0 },
        Reason::StartOutside { agent: 3 },
        Reason::GoalsCollide { first: 3, second: 4 },
        Reason::NoGoal { agent: 5 },
    ] {
        assert!(reasons.contains(&reason), "{reason} is missing in {reasons:?}");
    }
    assert_eq!(reasons.len(), 8);
}

/// Two agents that would have to pass each other in a corridor: no check sees it, and the budget ends the search.
#[test]
fn what_cannot_be_solved_ends_with_the_budget() {
    let corridor = instance(&["...."], &[((0, 0), &[(3, 0)]), ((3, 0), &[(0, 0)])], false);
    for (planner, bound) in [(Planner::Cbs, 1.0), (Planner::Ecbs, 1.5)] {
        match run(&corridor, planner, bound, 20_000).outcome {
            Outcome::BudgetSpent { best_bound } => assert!(best_bound >= 6.0),
            Outcome::Infeasible(reasons) => assert_eq!(reasons, [Reason::Exhausted]),
            Outcome::Solved(plan) => panic!("{plan:?}"),
        }
    }
}

#[test]
fn stop_ends_the_search_and_its_set_up() {
    let open = instance(&["....", "...."], &[((0, 0), &[(3, 0)]), ((3, 0), &[(0, 0)])], false);
    let ended = solve(&open, &Options { planner: Planner::Cbs, bound: 1.0 }, &Budget::new(u64::MAX, &|| true));
    assert_eq!(ended.outcome, Outcome::BudgetSpent { best_bound: 0.0 });
    assert_eq!(ended.effort.low_level_expanded, 0);
}

#[test]
fn the_same_instance_gives_the_same_plan() {
    let mut numbers = Numbers(23);
    for planner in [Planner::Ecbs, Planner::EcbsTa, Planner::ItaEcbs] {
        let instance = random(&mut numbers, planner != Planner::Ecbs);
        assert_eq!(run(&instance, planner, 1.3, 50_000), run(&instance, planner, 1.3, 50_000));
    }
}

/// An agent without a goal steps aside for one that has to pass, and pays for its moves; waiting is free.
#[test]
fn idle_agents_make_way() {
    let aside = instance(&["...", "#.#"], &[((0, 0), &[(2, 0)]), ((1, 0), &[])], true);
    for planner in [Planner::CbsTa, Planner::ItaCbs] {
        let Outcome::Solved(plan) = run(&aside, planner, 1.0, 50_000).outcome else { panic!("{planner:?}") };
        assert_eq!(plan.claims.cost, Some(3.0), "two steps and one aside: {planner:?}");
        assert_eq!(plan.routes[1].goal, None);
    }
}

#[test]
fn nobody_has_an_empty_plan() {
    let Outcome::Solved(plan) = run(&instance(&[".."], &[], false), Planner::Cbs, 1.0, 10).outcome else { panic!() };
    assert_eq!(plan.claims.cost, Some(0.0));
    assert!(plan.routes.is_empty());
}

/// Nothing checks an instance's sizes before the search does: cells that `blocked` does not have are outside.
#[test]
fn tables_of_the_wrong_size_are_no_trouble() {
    for (width, height, cells) in [(3, 3, 4), (-2, 5, 9), (0, 0, 0), (2, 2, 40)] {
        let mut odd = instance(&["..", ".."], &[((0, 0), &[(1, 1)]), ((1, 0), &[(2, 2)])], false);
        (odd.width, odd.height, odd.blocked) = (width, height, vec![false; cells]);
        assert!(matches!(run(&odd, Planner::Cbs, 1.0, 1_000).outcome, Outcome::Infeasible(_)));
        odd.assignment = true;
        for planner in [Planner::EcbsTa, Planner::ItaEcbs] {
            for bound in [f64::NAN, f64::INFINITY, -3.0] {
                let _ = run(&odd, planner, bound, 1_000);
            }
        }
    }
}
