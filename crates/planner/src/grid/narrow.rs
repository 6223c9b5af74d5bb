//! Which steps of a cheapest path are without alternative.
//!
//! # Source
//! The multi-valued decision diagrams of Sharon et al., "The increasing cost tree search for optimal multi-agent pathfinding"
//! (2013), of which only the width of each layer is kept.

use super::low_level::{Request, reaches};
use super::space::{MOVES, NONE, Space, WAIT};
use super::timetable::{CELL, Timetable};
use crate::search::{Budget, Spent};

/// Scratch memory.
#[derive(Default)]
pub(super) struct Narrow {
    stamp: u32,
    /// By cell: the stamp of the layer in which it was met last.
    met: Vec<u32>,
    /// Cells of all layers, one layer after the other.
    cells: Vec<u32>,
    /// Where each layer begins.
    layers: Vec<usize>,
}

impl Narrow {
    /// By step, whether all paths of cost `cost` that obey the table are in the same cell. Agents with a goal only.
    pub(super) fn find(
        &mut self,
        space: &Space,
        table: &Timetable,
        request: &Request<'_>,
        cost: usize,
        budget: &Budget<'_>,
    ) -> Result<Vec<bool>, Spent> {
        let Some((_, distances)) = request.goal else { return Ok(Vec::new()) };
        let last = table.layers() - 1;
        self.cells.clear();
        self.layers.clear();
        self.met.resize(space.cells(), 0);
        self.layers.push(0);
        self.cells.push(request.start);
        for step in 0..cost {
            let begin = self.layers[step];
            let end = self.cells.len();
            self.layers.push(end);
            self.next_stamp();
            budget.spend((end - begin) as u64 / 4)?;
            for at in begin..end {
                let cell = self.cells[at];
                let barred = table.slot(step.min(last), cell).barred;
                for direction in 0..=WAIT {
                    let next = if direction < MOVES { space.neighbours[cell as usize][direction] } else { cell };
                    if next == NONE || self.met[next as usize] == self.stamp || barred & 1 << direction & !CELL != 0 {
                        continue;
                    }
                    let layer = (step + 1).min(last);
                    let rest = distances[next as usize];
                    if rest == NONE
                        || step + 1 + rest as usize > cost
                        || table.slot(layer, next).barred & CELL != 0
                        || request.closed.get(next as usize).is_some_and(|&from| layer as u32 >= from)
                        || !reaches(space, request.waypoints, layer as u32, next)
                    {
                        continue;
                    }
                    self.met[next as usize] = self.stamp;
                    self.cells.push(next);
                }
            }
        }
        self.layers.push(self.cells.len());
        Ok(self.widths(space, table, cost, last))
    }

    /// Goes back from the goal, which is alone in the last layer, and marks the layers of one cell.
    fn widths(&mut self, space: &Space, table: &Timetable, cost: usize, last: usize) -> Vec<bool> {
        let mut narrow = vec![true; cost + 1];
        // `met` holds what of the layer above is on a path
        self.next_stamp();
        for at in self.layers[cost]..self.layers[cost + 1] {
            self.met[self.cells[at] as usize] = self.stamp;
        }
        for step in (0..cost).rev() {
            let above = self.stamp;
            let (begin, end) = (self.layers[step], self.layers[step + 1]);
            let mut kept = begin;
            for at in begin..end {
                let cell = self.cells[at];
                let barred = table.slot(step.min(last), cell).barred;
                let leads = (0..=WAIT).any(|direction| {
                    let next = if direction < MOVES { space.neighbours[cell as usize][direction] } else { cell };
                    let open = direction == WAIT || barred & 1 << direction == 0;
                    next != NONE && open && self.met[next as usize] == above
                });
                if leads {
                    self.cells[kept] = cell;
                    kept += 1;
                }
            }
            narrow[step] = kept - begin == 1;
            self.next_stamp();
            for at in begin..kept {
                self.met[self.cells[at] as usize] = self.stamp;
            }
        }
        narrow
    }

    fn next_stamp(&mut self) {
        self.stamp = self.stamp.wrapping_add(1);
        if self.stamp == 0 {
            self.met.fill(0);
            self.stamp = 1;
        }
    }
}
