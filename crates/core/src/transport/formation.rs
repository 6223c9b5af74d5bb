//! Slots around the load, and whether they cage it.
//!
//! # Source
//! [R2P2] §IV (placement at a distance from the corners, eq. 2; caging, eq. 1e) and Fig. 4 (six slots).
//!
//! # Deviations
//! - The load's heading is the normal of its long sides: with robots 3 and 6 outside "the length sides", no other reading
//!   gives the roles of Fig. 4.
//! - Distances in the caging condition are between bodies, not centres: measured between centres the paper's own formation
//!   violates it (0.40 m against a shortest side of 0.35 m).
//!
//! [R2P2]: crate::_documentation::references

use nalgebra::Vector2;

use crate::geometry::shape::ConvexPolygon;
use crate::scenario::document::{CustomSlot, Slots};
use crate::se2::Pose2;

/// The place of one robot at the load, in the load's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Edge of the footprint.
    pub edge: usize,
    /// Point of the edge in front of the robot, m.
    pub contact: Vector2<f64>,
    /// Unit vector into the load: where the robot faces.
    pub facing: Vector2<f64>,
}

impl Slot {
    /// Unit vector along the edge, a quarter turn clockwise from `facing`.
    pub fn tangent(&self) -> Vector2<f64> {
        Vector2::new(self.facing.y, -self.facing.x)
    }

    /// Pose of a robot of `radius` that stands in the slot with its body `gap` away from the edge, m.
    pub fn load_from_robot(&self, radius: f64, gap: f64) -> Pose2 {
        Pose2::new(self.center(radius, gap), self.facing.y.atan2(self.facing.x))
    }

    /// Centre of that robot, m.
    pub fn center(&self, radius: f64, gap: f64) -> Vector2<f64> {
        self.contact - (radius + gap) * self.facing
    }
}

/// Why a formation cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormationError {
    /// The number of robots is not the number of slots.
    #[error("{robots} robots for {slots} slots")]
    Count {
        /// Robots of the team.
        robots: usize,
        /// Slots of the formation.
        slots: usize,
    },
    /// The slots are still to be chosen.
    #[error("slots `auto` have not been chosen yet")]
    Unresolved,
    /// A named formation on a load that is not a rectangle along its frame.
    #[error("slots `{slots}` need a rectangular load; give `custom` slots for this one")]
    NotRectangle {
        /// Name of the formation.
        slots: &'static str,
    },
    /// The outer slots pass the middle of the edge.
    #[error("contact placement {placement} m lies outside [0, {limit:.3}] m: half of the edge less a robot's radius")]
    Placement {
        /// Given, m.
        placement: f64,
        /// Largest, m.
        limit: f64,
    },
    /// No such edge.
    #[error("slot {slot} is on edge {edge}, but the load has edges 0 to {last}")]
    Edge {
        /// Slot, counted from 0.
        slot: usize,
        /// Edge given.
        edge: usize,
        /// Last edge.
        last: usize,
    },
    /// Two robots in their slots overlap.
    #[error("robots {first} and {second} of the team overlap in their slots by {depth:.3} m")]
    Overlap {
        /// First slot, counted from 0.
        first: usize,
        /// Second slot, counted from 0.
        second: usize,
        /// Overlap, m.
        depth: f64,
    },
}

/// A way out of the formation for the load.
#[derive(Clone, Debug, PartialEq)]
pub enum CagingGap {
    /// Two neighbours stand too far apart.
    TooWide {
        /// Slot, counted from 0.
        first: usize,
        /// Next slot counter-clockwise.
        second: usize,
        /// Clear distance, m.
        distance: f64,
        /// It must stay below this, m.
        limit: f64,
    },
    /// No robot stands at this edge.
    OpenEdge {
        /// The edge.
        edge: usize,
    },
}

impl std::fmt::Display for CagingGap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::TooWide { first, second, distance, limit } => write!(
                f,
                "robots {first} and {second} leave {distance:.3} m between them, caging needs less than {limit:.3} m"
            ),
            Self::OpenEdge { edge } => write!(f, "no robot stands at edge {edge} of the load"),
        }
    }
}

/// Two neighbours around the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CagingPair {
    /// Slot, counted from 0.
    pub first: usize,
    /// Next slot counter-clockwise.
    pub second: usize,
    /// Clear distance below which the load cannot slip out between them, m.
    pub limit: f64,
}

/// The slots of one team, in team order.
#[derive(Clone, Debug, PartialEq)]
pub struct Formation {
    slots: Vec<Slot>,
    radius: f64,
    gap: f64,
}

impl Formation {
    /// Slots for `robots` robots of `radius` m around `load`, their bodies `gap` m away from it.
    ///
    /// `placement` is the distance of the outer slots from the corner along the edge, m ([R2P2] Table III, c).
    ///
    /// # Errors
    /// See [`FormationError`].
    ///
    /// [R2P2]: crate::_documentation::references
    pub fn new(
        load: &ConvexPolygon,
        slots: &Slots,
        robots: usize,
        placement: f64,
        gap: f64,
        radius: f64,
    ) -> Result<Self, FormationError> {
        let slots = match slots {
            Slots::Six => {
                let [fl, fr, bl, br] = corners(load, "six", placement, radius)?;
                let (low, high) = load.bounds();
                let right = Slot { edge: 0, contact: Vector2::new(0.0, low.y), facing: Vector2::y() };
                let left = Slot { edge: 2, contact: Vector2::new(0.0, high.y), facing: -Vector2::y() };
                // clockwise from front left, as in Fig. 4
                vec![fl, fr, right, br, bl, left]
            }
            Slots::Four => {
                let [fl, fr, bl, br] = corners(load, "four", placement, radius)?;
                vec![fl, fr, br, bl]
            }
            Slots::Auto => return Err(FormationError::Unresolved),
            Slots::Custom(places) => custom(load, places)?,
        };
        if slots.len() != robots {
            return Err(FormationError::Count { robots, slots: slots.len() });
        }
        let formation = Self { slots, radius, gap };
        for first in 0..robots {
            for second in first + 1..robots {
                let depth = -formation.clear_distance(first, second);
                if depth > 0.0 {
                    return Err(FormationError::Overlap { first, second, depth });
                }
            }
        }
        Ok(formation)
    }

    /// The formation of these slots, which are not checked.
    pub const fn around(slots: Vec<Slot>, gap: f64, radius: f64) -> Self {
        Self { slots, radius, gap }
    }

    /// Without slots: stands for a formation whose slots are still to be chosen.
    pub(crate) const fn unresolved(gap: f64, radius: f64) -> Self {
        Self { slots: Vec::new(), radius, gap }
    }

    /// The slots, in team order.
    pub fn slots(&self) -> &[Slot] {
        &self.slots
    }

    /// Distance between the robots' bodies and the load, m.
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// Radius of the robots, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Greatest distance of a robot's centre from the load's centre, m.
    pub fn outermost(&self) -> f64 {
        self.slots.iter().map(|slot| slot.center(self.radius, self.gap).norm()).fold(0.0, f64::max)
    }

    /// Pose of the robot at `place` in its slot.
    pub fn load_from_robot(&self, place: usize) -> Pose2 {
        self.slots[place].load_from_robot(self.radius, self.gap)
    }

    /// Distance between the bodies of two robots in their slots, m.
    fn clear_distance(&self, first: usize, second: usize) -> f64 {
        let a = self.slots[first].center(self.radius, self.gap);
        let b = self.slots[second].center(self.radius, self.gap);
        (a - b).norm() - 2.0 * self.radius
    }

    /// Neighbours around the load and the clear distance below which nothing slips out between them ([R2P2] §IV, eq. 1e):
    /// on one edge that edge's length, on adjacent edges the shortest edge. Neighbours with an open edge between them have
    /// no such distance and are left out.
    ///
    /// [R2P2]: crate::_documentation::references
    pub fn caging_pairs(&self, load: &ConvexPolygon) -> Vec<CagingPair> {
        let edges = load.vertices().len();
        let shortest = (0..edges).map(|i| load.edge(i).length()).fold(f64::INFINITY, f64::min);
        let along = |i: usize| {
            let slot = &self.slots[i];
            let edge = load.edge(slot.edge);
            (slot.edge, edge.tangent().dot(&(slot.contact - edge.start)))
        };
        let mut around: Vec<usize> = (0..self.slots.len()).collect();
        around.sort_by(|a, b| {
            let (a, b) = (along(*a), along(*b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        let count = around.len();
        (0..count)
            .filter_map(|i| {
                let (first, second) = (around[i], around[(i + 1) % count]);
                let (a, b) = (self.slots[first].edge, self.slots[second].edge);
                let limit = if a == b && i + 1 < count {
                    load.edge(a).length()
                } else if (a + 1) % edges == b {
                    shortest
                } else {
                    return None;
                };
                Some(CagingPair { first, second, limit })
            })
            .collect()
    }

    /// Every way out for the load; empty if the formation cages it: no edge is without a robot and no
    /// [pair](Self::caging_pairs) stands too far apart.
    pub fn caging_gaps(&self, load: &ConvexPolygon) -> Vec<CagingGap> {
        let open = (0..load.vertices().len())
            .filter(|edge| !self.slots.iter().any(|slot| slot.edge == *edge))
            .map(|edge| CagingGap::OpenEdge { edge });
        let wide = self.caging_pairs(load).into_iter().filter_map(|CagingPair { first, second, limit }| {
            let distance = self.clear_distance(first, second);
            (distance >= limit).then_some(CagingGap::TooWide { first, second, distance, limit })
        });
        open.chain(wide).collect()
    }
}

/// Slots near the corners of the long sides: front left, front right, back left, back right. Front is +x.
fn corners(load: &ConvexPolygon, name: &'static str, placement: f64, radius: f64) -> Result<[Slot; 4], FormationError> {
    let (low, high) = load.bounds();
    let is_corner = |v: &Vector2<f64>| {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        (near(v.x, low.x) || near(v.x, high.x)) && (near(v.y, low.y) || near(v.y, high.y))
    };
    if load.vertices().len() != 4 || !load.vertices().iter().all(is_corner) {
        return Err(FormationError::NotRectangle { slots: name });
    }
    let limit = (high.y - low.y) / 2.0 - radius;
    if !(0.0..=limit).contains(&placement) {
        return Err(FormationError::Placement { placement, limit });
    }
    let (left, right) = (high.y - placement, low.y + placement);
    let front = |y| Slot { edge: 1, contact: Vector2::new(high.x, y), facing: -Vector2::x() };
    let back = |y| Slot { edge: 3, contact: Vector2::new(low.x, y), facing: Vector2::x() };
    Ok([front(left), front(right), back(left), back(right)])
}

fn custom(load: &ConvexPolygon, places: &[CustomSlot]) -> Result<Vec<Slot>, FormationError> {
    let edges = load.vertices().len();
    places
        .iter()
        .enumerate()
        .map(|(slot, place)| {
            if place.edge >= edges {
                return Err(FormationError::Edge { slot, edge: place.edge, last: edges - 1 });
            }
            let edge = load.edge(place.edge);
            let contact = edge.start + place.at * (edge.end - edge.start);
            Ok(Slot { edge: place.edge, contact, facing: edge.inward() })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> (ConvexPolygon, Formation) {
        let load = ConvexPolygon::rectangle(0.35, 1.35).unwrap();
        let formation = Formation::new(&load, &Slots::Six, 6, 0.175, 0.01, 0.105).unwrap();
        (load, formation)
    }

    /// Slot table of the six-robot formation; the numbering reproduces the roles of Fig. 4.
    #[test]
    fn six_slots_stand_where_figure_4_has_them() {
        let (_, formation) = paper();
        let expected = [
            (0.29, 0.5, -1.0, 0.0),
            (0.29, -0.5, -1.0, 0.0),
            (0.0, -0.79, 0.0, 1.0),
            (-0.29, -0.5, 1.0, 0.0),
            (-0.29, 0.5, 1.0, 0.0),
            (0.0, 0.79, 0.0, -1.0),
        ];
        for (slot, (x, y, fx, fy)) in formation.slots().iter().zip(expected) {
            let center = slot.center(0.105, 0.01);
            assert!((center - Vector2::new(x, y)).norm() < 1e-12, "{slot:?}");
            assert_eq!(slot.facing, Vector2::new(fx, fy));
        }
    }

    #[test]
    fn six_robots_cage_the_load_and_four_do_not() {
        let (load, formation) = paper();
        assert_eq!(formation.caging_gaps(&load), []);
        let four = Formation::new(&load, &Slots::Four, 4, 0.175, 0.01, 0.105).unwrap();
        assert_eq!(four.caging_gaps(&load), [CagingGap::OpenEdge { edge: 0 }, CagingGap::OpenEdge { edge: 2 }]);
    }

    #[test]
    fn slots_too_far_from_the_corner_open_the_cage() {
        let load = ConvexPolygon::rectangle(0.35, 1.35).unwrap();
        let formation = Formation::new(&load, &Slots::Six, 6, 0.45, 0.01, 0.105).unwrap();
        assert!(matches!(formation.caging_gaps(&load)[0], CagingGap::TooWide { .. }));
    }
}
