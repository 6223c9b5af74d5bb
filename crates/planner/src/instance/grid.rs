//! Agents on a 4-connected grid.

/// A cell of a grid; x to the right, y as the file has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    /// Column.
    pub x: i32,
    /// Row.
    pub y: i32,
}

/// Agents that move by one cell, or wait, in every step.
#[derive(Clone, Debug, PartialEq)]
pub struct GridInstance {
    /// Columns.
    pub width: i32,
    /// Rows.
    pub height: i32,
    /// Whether a cell is blocked, row by row: cell (x, y) is at y · width + x.
    pub blocked: Vec<bool>,
    /// The agents.
    pub agents: Vec<GridAgent>,
    /// Whether goals are to be assigned: every agent then takes at most one of its `goals`, and as many agents as possible
    /// take one. Otherwise every agent has exactly one goal, and it is its own.
    pub assignment: bool,
}

/// One agent on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct GridAgent {
    /// As the file calls it.
    pub name: String,
    /// Where it stands first.
    pub start: Cell,
    /// Where it may go; none, and it only must not be in the way.
    pub goals: Vec<Cell>,
}

impl GridInstance {
    /// Index of `cell` in `blocked`; nothing outside of the grid.
    pub fn index(&self, cell: Cell) -> Option<usize> {
        let inside = (0..self.width).contains(&cell.x) && (0..self.height).contains(&cell.y);
        let index = inside.then(|| cell.y as usize * self.width as usize + cell.x as usize);
        index.filter(|&index| index < self.blocked.len())
    }

    /// Whether an agent may stand in `cell`.
    pub fn is_free(&self, cell: Cell) -> bool {
        self.index(cell).is_some_and(|index| !self.blocked[index])
    }
}
