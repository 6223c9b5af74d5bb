//! Whether anything round could get through at all, and what would have to go for it: a flood over cells.

use std::collections::VecDeque;

use nalgebra::Vector2;

use super::Obstruction;
use super::body::distance_to_polygon;
use super::roadmap::extent;
use super::task::Task;
use crate::search::{Budget, Spent};

/// Size of a cell where the map is not too large for it, m.
const CELL: f64 = 0.1;
/// Cells are made coarser rather than more than this.
const CELLS: f64 = 60_000.0;

struct Cells {
    columns: usize,
    rows: usize,
    start: usize,
    goal: usize,
    /// How many obstacles are too near for the disc, and one of them.
    near: Vec<(u16, u16)>,
}

/// Whether a disc of `radius` m around the load's centre might get from the start to the goal: `false` is a proof that it
/// cannot, for it is asked of cells as a whole.
///
/// # Errors
/// A spent budget.
pub(super) fn connects(task: &Task, radius: f64, budget: &Budget<'_>) -> Result<bool, Spent> {
    Ok(Cells::new(task, radius, true, budget)?.connects(None))
}

/// Everything whose removal alone would let a disc of `radius` m through, as far as the middles of cells tell.
///
/// # Errors
/// A spent budget.
pub(super) fn in_the_way(task: &Task, radius: f64, budget: &Budget<'_>) -> Result<Vec<Obstruction>, Spent> {
    let cells = Cells::new(task, radius, false, budget)?;
    let mut found = Vec::new();
    if cells.connects(None) {
        return Ok(found);
    }
    for (index, obstacle) in task.obstacles.iter().enumerate() {
        budget.spend(1 + cells.near.len() as u64 / 64)?;
        if obstacle.what != Obstruction::Wall && cells.connects(u16::try_from(index).ok()) {
            found.push(obstacle.what);
        }
    }
    Ok(found)
}

impl Cells {
    /// Cells that the disc cannot be in with its centre in the middle, or, if `anywhere`, at any point of the cell.
    fn new(task: &Task, radius: f64, anywhere: bool, budget: &Budget<'_>) -> Result<Self, Spent> {
        let (low, high) = extent(task);
        let size = (high - low).sup(&Vector2::zeros());
        let step = CELL.max((size.x * size.y / CELLS).sqrt()).max(size.x.max(size.y) / CELLS);
        let (columns, rows) = ((size.x / step) as usize + 1, (size.y / step) as usize + 1);
        let cell = |at: &Vector2<f64>| {
            let place = (at - low) / step;
            (place.y as usize).min(rows - 1) * columns + (place.x as usize).min(columns - 1)
        };
        // nothing in the cell is farther from an obstacle than its centre and half its diagonal
        let needed = if anywhere { radius - step * std::f64::consts::FRAC_1_SQRT_2 } else { radius };
        let mut near = vec![(0, 0); columns * rows];
        for (index, obstacle) in task.obstacles.iter().enumerate() {
            let mut bounds = (obstacle.corners[0], obstacle.corners[0]);
            for corner in &obstacle.corners {
                bounds = (bounds.0.inf(corner), bounds.1.sup(corner));
            }
            let first = (bounds.0.add_scalar(-radius) - low) / step;
            let last = (bounds.1.add_scalar(radius) - low) / step;
            for row in first.y.max(0.0) as usize..=(last.y.max(-1.0) + 1.0).min(rows as f64 - 1.0) as usize {
                for column in first.x.max(0.0) as usize..=(last.x.max(-1.0) + 1.0).min(columns as f64 - 1.0) as usize {
                    let middle = low + step * Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
                    if distance_to_polygon(&middle, &obstacle.corners) < needed {
                        let (count, _) = near[row * columns + column];
                        near[row * columns + column] = (count + 1, index as u16);
                    }
                }
                budget.spend(1 + columns as u64 / 16)?;
            }
        }
        Ok(Self { columns, rows, start: cell(&task.start), goal: cell(&task.goal), near })
    }

    /// Whether the goal's cell is reached, without one of the obstacles.
    fn connects(&self, without: Option<u16>) -> bool {
        let free = |cell: usize| match self.near[cell] {
            (0, _) => true,
            (1, index) => Some(index) == without,
            _ => false,
        };
        let mut seen = vec![false; self.near.len()];
        let mut queue = VecDeque::from([self.start]);
        seen[self.start] = true;
        while let Some(cell) = queue.pop_front() {
            if cell == self.goal {
                return true;
            }
            let (row, column) = (cell / self.columns, cell % self.columns);
            for row in row.saturating_sub(1)..=(row + 1).min(self.rows - 1) {
                for column in column.saturating_sub(1)..=(column + 1).min(self.columns - 1) {
                    let next = row * self.columns + column;
                    if !seen[next] && free(next) {
                        seen[next] = true;
                        queue.push_back(next);
                    }
                }
            }
        }
        false
    }
}
