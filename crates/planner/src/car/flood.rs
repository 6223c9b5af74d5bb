//! Whether a goal is walled in: a flood over positions that is never too strict.
//!
//! A body of any heading covers the disc about its reference point that its nearest side touches. Positions where that
//! disc meets an obstacle are certainly blocked; if the others do not connect start and goal, no way does.

use super::Model;
use super::curve::Place;
use super::field::Field;
use crate::search::{Budget, Spent};

/// Cells per unit of length, unless the map is too large for that.
const FINENESS: f64 = 8.0;
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
    // between the middles of cells
    let far = jump * fineness + std::f64::consts::SQRT_2 + 1e-9;
    let reach = far as isize;
    let ends = [at(start), at(goal)];
    // which ends have seen a cell, as bits, and whether it is blocked
    const BLOCKED: u8 = 4;
    let mut state = vec![0_u8; columns * rows];
    let mut open = ends.map(|end| vec![end]);
    for (end, (column, row)) in ends.iter().enumerate() {
        state[row * columns + column] |= 1 << end;
    }
    if ends[0] == ends[1] {
        return Ok(true);
    }
    // in turn, so that the end that is walled in is done soon
    loop {
        for end in [0, 1] {
            let Some((column, row)) = open[end].pop() else { return Ok(false) };
            budget.spend(1)?;
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    let (Some(x), Some(y)) = (column.checked_add_signed(dx), row.checked_add_signed(dy)) else {
                        continue;
                    };
                    if x >= columns || y >= rows || (dx * dx + dy * dy) as f64 > far * far {
                        continue;
                    }
                    let seen = state[y * columns + x];
                    if seen & (BLOCKED | 1 << end) != 0 {
                        continue;
                    }
                    if seen != 0 {
                        // the other end has been here
                        return Ok(true);
                    }
                    let middle = ((x as f64 + 0.5) / fineness, (y as f64 + 0.5) / fineness);
                    if field.surely_blocked(middle, half_diagonal) {
                        state[y * columns + x] = BLOCKED;
                    } else {
                        state[y * columns + x] = 1 << end;
                        open[end].push((x, y));
                    }
                }
            }
        }
    }
}
