//! Which bodies come so near to each other that it has to be looked at.

use nalgebra::Vector2;

use super::Work;
use super::motion::Motion;

/// A disc that holds something for the whole of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disc {
    pub centre: Vector2<f64>,
    pub radius: f64,
}

impl Disc {
    /// Around everything within `reach` of the reference point of a body that moves.
    pub(super) fn around(motion: &Motion, reach: f64) -> Self {
        // no point of the way is further from its start than the way is long
        Self { centre: motion.at(0.0).0, radius: motion.length() + reach }
    }

    fn meets(&self, other: &Self) -> bool {
        (self.centre - other.centre).norm() <= self.radius + other.radius
    }
}

/// Calls `look` with every pair of discs that meet, the smaller number first; false where that takes too much work or `look`
/// says that it is enough.
pub(super) fn near_pairs(
    discs: &[(usize, Disc)],
    order: &mut Vec<usize>,
    work: &mut Work,
    mut look: impl FnMut(usize, usize, &mut Work) -> bool,
) -> bool {
    let low = |index: usize| discs[index].1.centre.x - discs[index].1.radius;
    // from the step before it is nearly sorted
    if order.len() != discs.len() {
        *order = (0..discs.len()).collect();
    }
    order.sort_by(|a, b| low(*a).total_cmp(&low(*b)).then(a.cmp(b)));
    for (place, first) in order.iter().enumerate() {
        let high = discs[*first].1.centre.x + discs[*first].1.radius;
        for second in order[place + 1..].iter().take_while(|second| low(**second) <= high) {
            if !work.spend(1) {
                return false;
            }
            let (one, other) = (*first.min(second), *first.max(second));
            if discs[one].1.meets(&discs[other].1) && !look(one, other, work) {
                return false;
            }
        }
        if !work.spend(1) {
            return false;
        }
    }
    true
}
