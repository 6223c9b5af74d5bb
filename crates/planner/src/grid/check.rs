//! What can be said about an instance before any search.

use std::sync::Arc;

use super::domain::Target;
use super::space::{NONE, Space};
use crate::instance::GridInstance;
use crate::outcome::Reason;
use crate::search::{Budget, Spent};

/// An instance as numbers.
pub(super) struct Checked {
    pub space: Space,
    pub starts: Vec<u32>,
    /// By agent and index into its goals; none where no way leads.
    pub targets: Vec<Vec<Option<Target>>>,
}

/// Numbers the cells and finds all distances, or says why there is no plan: all reasons that are plain to see.
pub(super) fn check(instance: &GridInstance, budget: &Budget<'_>) -> Result<Result<Checked, Vec<Reason>>, Spent> {
    let mut reasons = Vec::new();
    let mut starts = Vec::with_capacity(instance.agents.len());
    // by cell: who starts there, whose goal it is
    let mut starting = vec![NONE; instance.blocked.len()];
    let mut ending = vec![NONE; instance.blocked.len()];
    for (agent, wishes) in instance.agents.iter().enumerate() {
        match instance.index(wishes.start) {
            None => reasons.push(Reason::StartOutside { agent }),
            Some(_) if !instance.is_free(wishes.start) => reasons.push(Reason::StartBlocked { agent, obstacle: None }),
            Some(cell) => {
                if starting[cell] == NONE {
                    starting[cell] = agent as u32;
                } else {
                    reasons.push(Reason::StartsCollide { first: starting[cell] as usize, second: agent });
                }
            }
        }
        starts.push(instance.index(wishes.start).unwrap_or(0) as u32);
        if instance.assignment {
            continue;
        }
        let Some(&cell) = wishes.goals.first() else {
            reasons.push(Reason::NoGoal { agent });
            continue;
        };
        match instance.index(cell) {
            None => reasons.push(Reason::GoalOutside { agent, goal: 0 }),
            Some(_) if !instance.is_free(cell) => reasons.push(Reason::GoalBlocked { agent, goal: 0, obstacle: None }),
            Some(cell) if ending[cell] == NONE => ending[cell] = agent as u32,
            Some(cell) => reasons.push(Reason::GoalsCollide { first: ending[cell] as usize, second: agent }),
        }
    }
    let space = Space::new(instance);
    let mut known: Vec<Option<Arc<[u32]>>> = vec![None; space.cells()];
    let mut targets = Vec::with_capacity(instance.agents.len());
    for (agent, wishes) in instance.agents.iter().enumerate() {
        let mut own = Vec::with_capacity(wishes.goals.len());
        for (goal, &cell) in wishes.goals.iter().enumerate() {
            let Some(index) = instance.index(cell).filter(|_| instance.is_free(cell)) else {
                own.push(None);
                continue;
            };
            let distances = match &known[index] {
                Some(distances) => Arc::clone(distances),
                None => {
                    let found: Arc<[u32]> = space.distances(index as u32, budget)?.into();
                    known[index] = Some(Arc::clone(&found));
                    found
                }
            };
            let reachable = distances[starts[agent] as usize] != NONE;
            if !reachable && !instance.assignment && goal == 0 && instance.is_free(wishes.start) {
                reasons.push(Reason::Unreachable { agent, goal });
            }
            own.push(reachable.then_some(Target { cell: index as u32, distances }));
        }
        targets.push(own);
    }
    Ok(if reasons.is_empty() { Ok(Checked { space, starts, targets }) } else { Err(reasons) })
}
