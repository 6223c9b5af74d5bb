//! What makes an instance unsolvable before anything is searched.

use super::Model;
use super::body::Body;
use super::curve::Place;
use super::field::{Blocked, Field};
use crate::instance::{CarInstance, Obstacle};
use crate::outcome::Reason;
use crate::search::{Budget, Spent};
use cohaul_core::se2::Pose2;

/// Places of starts and goals, and which goals can be taken at all.
pub(super) struct Checked {
    pub(super) starts: Vec<Place>,
    /// By agent and goal of the agent; `None` where nobody can stand.
    pub(super) goals: Vec<Vec<Option<Place>>>,
}

/// Goals that are looked at in the time of an expansion.
const LOOKS_PER_EXPANSION: usize = 64;
/// Largest number that is computed with, m and rad.
const NUMBER_MAX: f64 = 1e8;

/// What makes no sense in an instance.
pub(super) fn malformed(instance: &CarInstance) -> Option<String> {
    let is_sane = |value: &f64| value.abs() <= NUMBER_MAX;
    let vehicle = &instance.vehicle;
    if let Err(error) = vehicle.validate() {
        return Some(error.to_string());
    }
    let lengths = [vehicle.turning_radius, vehicle.front, vehicle.rear, vehicle.width];
    let penalties = [vehicle.turning_penalty, vehicle.reversing_penalty, vehicle.switching_penalty];
    if !lengths.iter().chain(&penalties).all(is_sane) {
        return Some("the vehicle has a number that is too large".to_owned());
    }
    if !is_sane(&instance.width) || !is_sane(&instance.height) {
        return Some(format!("the map is {} × {} m", instance.width, instance.height));
    }
    for (agent, given) in instance.agents.iter().enumerate() {
        let numbers = |pose: &Pose2| [pose.translation.x, pose.translation.y, pose.rotation.re, pose.rotation.im];
        if !std::iter::once(&given.start).chain(&given.goals).flat_map(numbers).all(|value| is_sane(&value)) {
            return Some(format!("the start or a goal of agent {agent} has a number that makes no sense"));
        }
    }
    let is_solid = |obstacle: &Obstacle| match obstacle {
        Obstacle::Point { at, radius } => is_sane(&at.x) && is_sane(&at.y) && is_sane(radius) && *radius >= 0.0,
        Obstacle::Polygon(corners) => corners.len() > 2 && corners.iter().all(|at| is_sane(&at.x) && is_sane(&at.y)),
    };
    let at = instance.obstacles.iter().position(|obstacle| !is_solid(obstacle))?;
    Some(format!("obstacle {at} has a number that makes no sense, or too few corners"))
}

/// Looks at starts and goals: all reasons why there cannot be a plan.
///
/// # Errors
/// [`Spent`] as soon as the budget is.
pub(super) fn check(
    field: &Field,
    instance: &CarInstance,
    budget: &Budget<'_>,
) -> Result<Result<Checked, Vec<Reason>>, Spent> {
    let mut reasons = Vec::new();
    let starts: Vec<Place> = instance.agents.iter().map(|agent| field.place(&agent.start)).collect();
    for (agent, start) in starts.iter().enumerate() {
        match field.blocked(start) {
            Some(Blocked::Outside) => reasons.push(Reason::StartOutside { agent }),
            Some(Blocked::By(at)) if !instance.free_starts => {
                reasons.push(Reason::StartBlocked { agent, obstacle: Some(at) });
            }
            _ => {}
        }
    }
    let mut goals = Vec::with_capacity(starts.len());
    for (agent, task) in instance.agents.iter().enumerate() {
        let mut own = Vec::with_capacity(task.goals.len());
        let mut blocked = Vec::new();
        for (goal, pose) in task.goals.iter().enumerate() {
            if goal % LOOKS_PER_EXPANSION == 0 {
                budget.spend(1)?;
            }
            let place = field.place(pose);
            own.push(match field.blocked(&place) {
                None => Some(place),
                Some(Blocked::Outside) => {
                    blocked.push(Reason::GoalOutside { agent, goal });
                    None
                }
                Some(Blocked::By(at)) => {
                    blocked.push(Reason::GoalBlocked { agent, goal, obstacle: Some(at) });
                    None
                }
            });
        }
        if !instance.assignment {
            // its goal is its own: there is no other
            own.truncate(1);
            reasons.extend(blocked.into_iter().take(1));
            if task.goals.is_empty() {
                reasons.push(Reason::NoGoal { agent });
            }
        }
        goals.push(own);
    }
    for (first, second) in close_pairs(field, &starts) {
        reasons.push(Reason::StartsCollide { first, second });
    }
    if !instance.assignment {
        let taken: Vec<(usize, Place)> = goals
            .iter()
            .enumerate()
            .filter_map(|(agent, own)| Some((agent, own.first().copied().flatten()?)))
            .collect();
        let places: Vec<Place> = taken.iter().map(|(_, place)| *place).collect();
        for (first, second) in close_pairs(field, &places) {
            reasons.push(Reason::GoalsCollide { first: taken[first].0, second: taken[second].0 });
        }
    }
    Ok(if reasons.is_empty() { Ok(Checked { starts, goals }) } else { Err(reasons) })
}

/// Whether two bodies cannot both rest at these places.
pub(super) fn collide(field: &Field, a: &Place, b: &Place) -> bool {
    match field.model {
        Model::Clcbs => (a.x - b.x).powi(2) + (a.y - b.y).powi(2) < field.separation_squared,
        Model::Exact => Body::gap(&field.body, a, b) <= 0.0,
    }
}

/// Pairs of places that are too close to each other, found along x.
fn close_pairs(field: &Field, places: &[Place]) -> Vec<(usize, usize)> {
    let far = field.separation_squared.sqrt().max(2.0 * (field.body.radius + field.body.offset.abs()));
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|a, b| places[*a].x.total_cmp(&places[*b].x).then(a.cmp(b)));
    let mut pairs = Vec::new();
    for (i, a) in order.iter().enumerate() {
        for b in &order[i + 1..] {
            if places[*b].x - places[*a].x > far {
                break;
            }
            if collide(field, &places[*a], &places[*b]) {
                pairs.push((*a.min(b), *a.max(b)));
            }
        }
    }
    pairs.sort_unstable();
    pairs
}
