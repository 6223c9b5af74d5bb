//! The best cost at which states were reached: a table that is emptied without being touched.

/// One entry; of no meaning unless its stamp is the table's.
#[derive(Clone, Copy, Default)]
struct Slot {
    key: u64,
    cost: f32,
    stamp: u32,
}

/// Open addressing with linear probing; a new stamp empties it.
pub(super) struct Table {
    slots: Vec<Slot>,
    stamp: u32,
    filled: usize,
}

impl Table {
    pub(super) fn new() -> Self {
        Self { slots: vec![Slot::default(); 1 << 10], stamp: 1, filled: 0 }
    }

    pub(super) fn clear(&mut self) {
        self.filled = 0;
        self.stamp = self.stamp.wrapping_add(1);
        if self.stamp == 0 {
            self.slots.fill(Slot::default());
            self.stamp = 1;
        }
    }

    /// Puts `cost` in unless what is there is not worse; whether it did.
    #[inline]
    pub(super) fn improves(&mut self, key: u64, cost: f32) -> bool {
        if 2 * self.filled >= self.slots.len() {
            self.grow();
        }
        let mask = self.slots.len() - 1;
        let mut at = hash(key) as usize & mask;
        loop {
            let slot = &mut self.slots[at];
            if slot.stamp != self.stamp {
                *slot = Slot { key, cost, stamp: self.stamp };
                self.filled += 1;
                return true;
            }
            if slot.key == key {
                if cost < slot.cost {
                    slot.cost = cost;
                    return true;
                }
                return false;
            }
            at = (at + 1) & mask;
        }
    }

    fn grow(&mut self) {
        let slots = std::mem::take(&mut self.slots);
        self.slots = vec![Slot::default(); 2 * slots.len()];
        let mask = self.slots.len() - 1;
        for slot in slots.into_iter().filter(|slot| slot.stamp == self.stamp) {
            let mut at = hash(slot.key) as usize & mask;
            while self.slots[at].stamp == self.stamp {
                at = (at + 1) & mask;
            }
            self.slots[at] = slot;
        }
    }
}

/// Mixes the bits of a key, as splitmix64 finishes.
#[inline]
const fn hash(key: u64) -> u64 {
    let mixed = (key ^ (key >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ (mixed >> 31)
}
