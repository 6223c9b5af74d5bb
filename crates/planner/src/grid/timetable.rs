//! Who is where in which step, and what a rule bars: one flat table over steps and cells.

use super::space::{MOVES, NONE, Space, WAIT, opposite};
use crate::search::Spent;

/// One cell in one step.
#[derive(Clone, Copy, Default)]
pub(super) struct Slot {
    /// Bit 4: nobody may be here; bits 0–3: nobody may leave by that move.
    pub barred: u8,
    /// How many other agents are here. Wraps around at 256, which spoils preferences only.
    pub here: u8,
    /// How many of them leave by each move.
    pub leaving: [u8; MOVES],
}

/// Slots that there are at most: with the states of the low level about 600 MB.
const MOST_SLOTS: usize = 1 << 25;

/// The bit of a barred cell.
pub(super) const CELL: u8 = 1 << WAIT;

/// The table. Its last layer stands for all later steps: everybody has arrived, and no rule holds any more.
pub(super) struct Timetable {
    cells: usize,
    layers: usize,
    slots: Vec<Slot>,
    /// Slots whose `barred` is set.
    barred: Vec<usize>,
}

impl Timetable {
    pub(super) fn new(cells: usize) -> Self {
        Self { cells, layers: 1, slots: vec![Slot::default(); cells], barred: Vec::new() }
    }

    pub(super) const fn cells(&self) -> usize {
        self.cells
    }

    pub(super) const fn layers(&self) -> usize {
        self.layers
    }

    /// Slot of a cell in a layer.
    pub(super) fn slot(&self, layer: usize, cell: u32) -> &Slot {
        &self.slots[layer * self.cells + cell as usize]
    }

    /// Makes sure that there are as many layers; new ones are as the last.
    ///
    /// # Errors
    /// [`Spent`] if that takes more memory than a search may use.
    pub(super) fn extend(&mut self, layers: usize) -> Result<(), Spent> {
        if layers <= self.layers {
            return Ok(());
        }
        let size = layers.saturating_mul(self.cells);
        if size > MOST_SLOTS {
            return Err(Spent);
        }
        // a quarter more at most: tables are large
        let wanted = (size + size / 4).min(MOST_SLOTS);
        if self.slots.capacity() < size {
            self.slots.reserve_exact(wanted - self.slots.len());
        }
        let last = (self.layers - 1) * self.cells;
        self.slots.resize(layers * self.cells, Slot::default());
        for layer in self.layers..layers {
            self.slots.copy_within(last..last + self.cells, layer * self.cells);
        }
        self.layers = layers;
        Ok(())
    }

    /// Adds (`by` = 1) or takes away (`by` = 255) a path, given as cells by step.
    ///
    /// # Errors
    /// As [`Timetable::extend`].
    pub(super) fn count(&mut self, space: &Space, path: &[u32], by: u8) -> Result<(), Spent> {
        self.extend(path.len())?;
        let Some(&last) = path.last() else { return Ok(()) };
        for (step, pair) in path.windows(2).enumerate() {
            let slot = &mut self.slots[step * self.cells + pair[0] as usize];
            slot.here = slot.here.wrapping_add(by);
            if let Some(direction) = direction(space, pair[0], pair[1]) {
                slot.leaving[direction] = slot.leaving[direction].wrapping_add(by);
            }
        }
        for layer in path.len() - 1..self.layers {
            let slot = &mut self.slots[layer * self.cells + last as usize];
            slot.here = slot.here.wrapping_add(by);
        }
        Ok(())
    }

    /// Bars a cell in a step.
    ///
    /// # Errors
    /// As [`Timetable::extend`].
    pub(super) fn bar_cell(&mut self, step: usize, cell: u32) -> Result<(), Spent> {
        self.bar(step, cell, CELL)
    }

    /// Bars a move that begins in a step.
    ///
    /// # Errors
    /// As [`Timetable::extend`].
    pub(super) fn bar_move(&mut self, step: usize, cell: u32, direction: usize) -> Result<(), Spent> {
        self.bar(step, cell, 1 << direction)
    }

    fn bar(&mut self, step: usize, cell: u32, bits: u8) -> Result<(), Spent> {
        self.extend(step + 2)?;
        let index = step * self.cells + cell as usize;
        if self.slots[index].barred == 0 {
            self.barred.push(index);
        }
        self.slots[index].barred |= bits;
        Ok(())
    }

    /// Lifts all bars.
    pub(super) fn lift(&mut self) {
        for index in self.barred.drain(..) {
            self.slots[index].barred = 0;
        }
    }

    /// Conflicts with others of one move from `cell` in `layer` to `next` in the layer after it.
    pub(super) fn conflicts(&self, layer: usize, next_layer: usize, next: u32, direction: usize) -> u32 {
        let mut conflicts = u32::from(self.slot(next_layer, next).here);
        if direction < MOVES {
            conflicts += u32::from(self.slot(layer, next).leaving[opposite(direction)]);
        }
        conflicts
    }
}

/// The move from one cell to the next, `None` for staying.
pub(super) fn direction(space: &Space, from: u32, to: u32) -> Option<usize> {
    if from == to {
        return None;
    }
    space.neighbours[from as usize].iter().position(|&next| next == to && next != NONE)
}
