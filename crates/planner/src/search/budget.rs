//! When a search has to end.

use std::cell::Cell;

/// Expansions after which `stop` is asked again.
const INTERVAL: u64 = 256;

/// How much a search may do. Deadlines and Ctrl-C are closures made by the caller: there is no clock in here.
pub struct Budget<'a> {
    left: Cell<u64>,
    until_asked: Cell<u64>,
    stop: &'a dyn Fn() -> bool,
    spent: Cell<bool>,
}

/// The budget is spent, or the caller wants the search to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the budget is spent")]
pub struct Spent;

impl<'a> Budget<'a> {
    /// At most `expansions` expansions, fewer if `stop` says so, which is asked at the first and then at least at every
    /// 256th.
    pub fn new(expansions: u64, stop: &'a dyn Fn() -> bool) -> Self {
        Self { left: Cell::new(expansions), until_asked: Cell::new(0), stop, spent: Cell::new(false) }
    }

    /// Counts `work` expansions, or as much work of other kinds as takes that long.
    ///
    /// # Errors
    /// [`Spent`], and from then on always.
    pub fn spend(&self, work: u64) -> Result<(), Spent> {
        if self.spent.get() {
            return Err(Spent);
        }
        let Some(left) = self.left.get().checked_sub(work) else {
            self.spent.set(true);
            return Err(Spent);
        };
        self.left.set(left);
        match self.until_asked.get().checked_sub(work) {
            Some(until) if until > 0 => self.until_asked.set(until),
            _ => {
                self.until_asked.set(INTERVAL);
                if (self.stop)() {
                    self.spent.set(true);
                    return Err(Spent);
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stop_is_asked_at_first_and_at_every_256th() {
        let asked = Cell::new(0);
        let stop = || {
            asked.set(asked.get() + 1);
            false
        };
        let budget = Budget::new(10_000, &stop);
        for _ in 0..2560 {
            budget.spend(1).unwrap();
        }
        assert_eq!(asked.get(), 10);
    }

    #[test]
    fn spent_stays_spent() {
        let budget = Budget::new(3, &|| false);
        assert!(budget.spend(3).is_ok());
        assert_eq!(budget.spend(1), Err(Spent));
        assert_eq!(budget.spend(0), Err(Spent));
        let stopped = Budget::new(3, &|| true);
        assert_eq!(stopped.spend(1), Err(Spent));
    }
}
