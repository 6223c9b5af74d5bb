//! The grid as flat tables: neighbours and exact distances.

use crate::instance::{Cell, GridInstance};
use crate::search::{Budget, Spent};

/// No cell, or no way.
pub(super) const NONE: u32 = u32::MAX;

/// Moves to the four neighbours in the order of [`Space::neighbours`].
pub(super) const MOVES: usize = 4;

/// Staying, in the place of a move.
pub(super) const WAIT: usize = 4;

/// The move that undoes `direction`.
pub(super) const fn opposite(direction: usize) -> usize {
    direction ^ 1
}

/// Cells by number, y · width + x.
pub(super) struct Space {
    pub width: u32,
    /// The neighbours of each cell, [`NONE`] where blocked or outside: x + 1, x − 1, y + 1, y − 1.
    pub neighbours: Vec<[u32; MOVES]>,
}

impl Space {
    pub(super) fn new(instance: &GridInstance) -> Self {
        let cells = instance.blocked.len();
        let mut neighbours = vec![[NONE; MOVES]; cells];
        for y in 0..instance.height {
            for x in 0..instance.width {
                let Some(from) = instance.index(Cell { x, y }) else { continue };
                for (slot, (dx, dy)) in [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().enumerate() {
                    let to = Cell { x: x + dx, y: y + dy };
                    if let Some(index) = instance.index(to)
                        && instance.is_free(to)
                    {
                        neighbours[from][slot] = index as u32;
                    }
                }
            }
        }
        Self { width: instance.width as u32, neighbours }
    }

    pub(super) const fn cells(&self) -> usize {
        self.neighbours.len()
    }

    pub(super) const fn cell(&self, index: u32) -> Cell {
        Cell { x: (index % self.width) as i32, y: (index / self.width) as i32 }
    }

    /// A bound from below on the steps between two cells.
    pub(super) const fn at_least(&self, a: u32, b: u32) -> u32 {
        (a % self.width).abs_diff(b % self.width) + (a / self.width).abs_diff(b / self.width)
    }

    /// Steps from every cell to `goal`, [`NONE`] where no way leads there.
    ///
    /// # Errors
    /// [`Spent`] as soon as the budget is.
    pub(super) fn distances(&self, goal: u32, budget: &Budget<'_>) -> Result<Vec<u32>, Spent> {
        let mut distances = vec![NONE; self.cells()];
        let mut queue = Vec::with_capacity(self.cells());
        distances[goal as usize] = 0;
        queue.push(goal);
        let mut at = 0;
        while at < queue.len() {
            // a cell here is far less work than an expansion in a search
            if at.is_multiple_of(64) {
                budget.spend(1)?;
            }
            let from = queue[at];
            at += 1;
            let next = distances[from as usize] + 1;
            for to in self.neighbours[from as usize] {
                if to != NONE && distances[to as usize] == NONE {
                    distances[to as usize] = next;
                    queue.push(to);
                }
            }
        }
        Ok(distances)
    }
}
