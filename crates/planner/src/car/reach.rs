//! A way for a body with nobody else there; or the certainty, as far as it goes, that there is none.
//!
//! # Source
//! Quick search first, then searches from both ends in turn, with limits that grow: the one that is walled in comes to its
//! end first.
//!
//! # Deviations
//! Steps are whole, and states in one cell are taken for the same, so a search that comes to its end proves nothing by
//! itself. It is repeated with shorter steps and smaller cells; only where the shortest ones do not lead out either, the goal
//! counts as out of reach. How fine the steps have to be is told, since other searches for the body need it, too.

use super::curve::{Place, wrap};
use super::field::Field;
use super::flood;
use super::hybrid_astar::{Ask, Care, HybridAstar};
use super::traffic::Traffic;
use super::way::Way;
use crate::instance::Drive;
use crate::search::{Budget, Spent};

/// States that the first search from either end may expand, and by how much that grows.
const LIMIT: u64 = 4_000;
const GROWTH: u64 = 4;
/// How much shorter steps become.
const FINENESS: [u32; 3] = [1, 2, 4];

/// A way, and into how many a whole step has to be divided for it.
type Fine = (Way, u32);

/// A good way from `start` to `goal`, nothing if there is none; adds to `expanded`.
pub(super) fn way(
    field: &Field,
    start: Place,
    goal: Place,
    search: &mut HybridAstar,
    expanded: &mut u64,
    budget: &Budget<'_>,
) -> Result<Option<Fine>, Spent> {
    let empty = Traffic::new(0);
    let quick = Ask {
        field,
        traffic: &empty,
        weights: &[],
        prices: &field.prices,
        start,
        goal: Some(goal),
        rules: &[],
        ratio: 1.0,
        below: f64::INFINITY,
        limit: LIMIT,
        care: Care::Quick,
        fineness: 1,
    };
    let found = search.find(&quick, budget)?;
    *expanded += found.expanded;
    if let Some(way) = found.way {
        return Ok(Some((way, 1)));
    }
    // a body that starts in an obstacle may leave it, but not drive into it
    let is_clear = field.blocked(&start).is_none();
    if is_clear && !flood::may_connect(field, &start, &goal, budget)? {
        return Ok(None);
    }
    // who only drives forwards is searched backwards as a body turned round
    let turned;
    let (back, [from, to]) = if field.drive == Drive::ForwardCar {
        turned = field.turned_round();
        (&turned, [goal, start].map(|place| Place::new(place.x, place.y, wrap(place.yaw + std::f64::consts::PI))))
    } else {
        (field, [goal, start])
    };
    let ask = |field, start, goal, limit, fineness| Ask {
        field,
        start,
        goal: Some(goal),
        ratio: 2.0,
        limit,
        care: Care::Thorough,
        fineness,
        ..quick
    };
    let mut limit = LIMIT;
    for fineness in FINENESS {
        loop {
            let found = search.find(&ask(field, start, goal, limit, fineness), budget)?;
            *expanded += found.expanded;
            if let Some(way) = found.way {
                return Ok(Some((way, fineness)));
            }
            if found.exhausted {
                break;
            }
            if is_clear {
                let found = search.find(&ask(back, from, to, limit, fineness), budget)?;
                *expanded += found.expanded;
                if found.exhausted && found.way.is_none() {
                    break;
                }
            }
            limit = limit.saturating_mul(GROWTH);
        }
    }
    Ok(None)
}
