//! Whether a goal is walled in: a flood over positions that is never too strict.
//!
//! A body of any heading covers the disc about its reference point that its nearest side touches. Positions where that
//! disc meets an obstacle are certainly blocked; if the others do not connect start and goal, no way does.

use super::Model;
use super::curve::Place;
use super::field::Field;
use crate::search::{Budget, Spent};

/// Cells per unit of length, unless the map is too large for that.
const FINENESS: f64 = 4.0;
/// Most cells of the flood.
const MOST_CELLS: f64 = 2e6;

/// Whether positions may connect `start` with `goal`; if not, no way does.
pub(super) fn may_connect(field: &Field, start: &Place, goal: &Place, budget: &Budget<'_>) -> Result<bool, Spent> {
    let fineness = FINENESS.min((MOST_CELLS / (field.width * field.height).max(1e-9)).sqrt());
    let size = |length: f64| ((length * fineness) as usize + 1).min(MOST_CELLS as usize);
    let (columns, rows) = (size(field.width), size(field.height));
    if columns * rows > 2 * MOST_CELLS as usize {
        return Ok(true);
    }
    let at = |place: &Place| {
        let column = ((place.x * fineness) as usize).min(columns - 1);
        let row = ((place.y * fineness) as usize).min(rows - 1);
        (column, row)
    };
    let half_diagonal = std::f64::consts::FRAC_1_SQRT_2 / fineness;
    // positions that one step can reach: where only the ends of steps count, what is thin can be jumped
    let jump = match field.model {
        Model::Clcbs => field.step,
        Model::Exact => 0.0,
    };
    let reach = (jump * fineness).ceil() as isize + 1;
    let (from, to) = (at(start), at(goal));
    // 0 not seen, 1 seen, 2 blocked
    let mut state = vec![0_u8; columns * rows];
    let mut open = vec![to];
    state[to.1 * columns + to.0] = 1;
    while let Some((column, row)) = open.pop() {
        budget.spend(1)?;
        if (column, row) == from {
            return Ok(true);
        }
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let (Some(x), Some(y)) = (column.checked_add_signed(dx), row.checked_add_signed(dy)) else { continue };
                if x >= columns || y >= rows || state[y * columns + x] != 0 {
                    continue;
                }
                let middle = ((x as f64 + 0.5) / fineness, (y as f64 + 0.5) / fineness);
                if (x, y) != from && field.surely_blocked(middle, half_diagonal) {
                    state[y * columns + x] = 2;
                } else {
                    state[y * columns + x] = 1;
                    open.push((x, y));
                }
            }
        }
    }
    Ok(false)
}
