//! Which places: candidates along the edges, a greedy start, exchanges until none is better.
//!
//! # Source
//! The exchange method of optimal design; what makes a formation good is [`grip`](super::grip) and the caging condition of
//! [R2P2] §IV, eq. 1e.
//!
//! # Deviations
//! A local optimum of the places tried. They are few (half a robot apart along the edges, then once finer), every robot is tried
//! in each of them, and the search starts from several formations, always in the same order.
//!
//! [R2P2]: cohaul_core::_documentation::references

use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::transport::formation::{Formation, Slot};

use super::grip::{Demand, Grip};

/// Clear distance that robots keep in their slots, m.
pub(crate) const CLEAR: f64 = 0.02;
/// Share of the margin that one way out of the formation costs where caging is not required.
const OPEN: f64 = 0.5;
/// Relative differences of the margin below this are none.
const EQUAL: f64 = 0.005;
/// Widest angle between neighbours seen from the load's centre, rad: a half-plane less 10°.
const WIDEST: f64 = std::f64::consts::PI * 17.0 / 18.0;
/// Rounds of exchanges.
const ROUNDS: usize = 8;

/// A place on an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub edge: usize,
    /// Along the edge, 0 to 1.
    pub at: f64,
}

/// The load with the rules that places obey.
#[derive(Clone, Debug)]
pub(crate) struct Board<'a> {
    pub load: &'a ConvexPolygon,
    /// Distance of a contact from the corners, m; the middle where the edge is too short for that.
    pub placement: f64,
    pub gap: f64,
    pub radius: f64,
    /// Whether an open cage is worse than any margin.
    pub caged: bool,
}

/// A formation under consideration.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub places: Vec<Place>,
    pub margin: f64,
    pub limited_by: Demand,
    met: f64,
    gaps: usize,
    spread: f64,
}

/// Places along one edge less one: enough for twelve robots and the gaps between them.
const MOST_STEPS: usize = 24;

impl Board<'_> {
    pub fn slot(&self, place: Place) -> Slot {
        let edge = self.load.edge(place.edge);
        Slot { edge: place.edge, contact: edge.start + place.at * (edge.end - edge.start), facing: edge.inward() }
    }

    /// Places along every edge, half a robot's pitch apart, farther on edges with room for more robots than a team has.
    pub fn candidates(&self) -> Vec<Place> {
        let pitch = 2.0 * self.radius + CLEAR;
        let mut places = Vec::new();
        for edge in 0..self.load.vertices().len() {
            let length = self.load.edge(edge).length();
            let inset = self.placement.min(length / 2.0);
            let span = length - 2.0 * inset;
            let abreast = (span / pitch + 1e-9).floor();
            let steps = if span < 0.25 * pitch { 0 } else { (2 * (abreast as usize).max(1)).min(MOST_STEPS) };
            for i in 0..=steps {
                let along = if steps == 0 { length / 2.0 } else { inset + span * i as f64 / steps as f64 };
                places.push(Place { edge, at: along / length });
            }
        }
        places
    }

    /// Distance between the bodies of robots in two places, m.
    pub fn clear(&self, a: Place, b: Place) -> f64 {
        let center = |place| self.slot(place).center(self.radius, self.gap);
        (center(a) - center(b)).norm() - 2.0 * self.radius
    }

    fn fits(&self, places: &[Place], except: usize, new: Place) -> bool {
        places.iter().enumerate().all(|(i, p)| i == except || self.clear(*p, new) >= CLEAR - 1e-9)
    }

    /// How many robots fit at once: as many as go round one after the other, from the best of all starts.
    pub fn room(&self) -> usize {
        let candidates = self.candidates();
        let from = |start: usize| {
            let mut taken: Vec<Place> = Vec::new();
            for i in 0..candidates.len() {
                let place = candidates[(start + i) % candidates.len()];
                if self.fits(&taken, usize::MAX, place) {
                    taken.push(place);
                }
            }
            taken
        };
        (0..candidates.len()).map(|start| from(start).len()).max().unwrap_or_default()
    }

    /// `robots` places that fit, spread over the places of the fullest tour.
    fn tour(&self, robots: usize) -> Option<Vec<Place>> {
        let candidates = self.candidates();
        (0..candidates.len()).find_map(|start| {
            let mut taken: Vec<Place> = Vec::new();
            for i in 0..candidates.len() {
                let place = candidates[(start + i) % candidates.len()];
                if self.fits(&taken, usize::MAX, place) {
                    taken.push(place);
                }
            }
            (taken.len() >= robots).then(|| (0..robots).map(|i| taken[i * taken.len() / robots]).collect())
        })
    }

    fn rate(&self, grip: &Grip, places: Vec<Place>) -> Found {
        let slots: Vec<Slot> = places.iter().map(|p| self.slot(*p)).collect();
        // a load that is not between its robots is nobody's
        let mut rating = grip.rate(&slots);
        if !self.surround(&slots) {
            (rating.margin, rating.limited_by) = (0.0, Demand::Hold);
        }
        let gaps = Formation::around(slots, self.gap, self.radius).caging_gaps(self.load).len();
        let mut spread = f64::INFINITY;
        for (i, a) in places.iter().enumerate() {
            for b in &places[..i] {
                spread = spread.min(self.clear(*a, *b));
            }
        }
        Found { places, margin: rating.margin, limited_by: rating.limited_by, met: rating.met, gaps, spread }
    }

    /// Whether no half-plane through the load's centre is free of robots, with some degrees to spare; two robots or fewer
    /// never surround it and are let through on their way to more.
    fn surround(&self, slots: &[Slot]) -> bool {
        let centers = slots.iter().map(|slot| slot.center(self.radius, self.gap));
        let mut bearings: Vec<f64> = centers.map(|c| c.y.atan2(c.x)).collect();
        bearings.sort_by(f64::total_cmp);
        let Some(first) = bearings.first().copied() else { return false };
        let next = bearings.iter().skip(1).copied().chain([first + std::f64::consts::TAU]);
        bearings.len() < 3 || bearings.iter().zip(next).all(|(a, b)| b - a < WIDEST)
    }

    fn better(&self, a: &Found, b: &Found) -> bool {
        let able = |f: &Found| f.margin > 0.0;
        if able(a) != able(b) {
            return able(a);
        }
        if !able(a) && a.met != b.met {
            return a.met > b.met;
        }
        if self.caged && a.gaps != b.gaps {
            return a.gaps < b.gaps;
        }
        let worth = |f: &Found| f.margin * (1.0 - OPEN).powi(f.gaps as i32);
        let (x, y) = (worth(a), worth(b));
        if (x - y).abs() > EQUAL * x.max(y) {
            return x > y;
        }
        (a.gaps, -a.spread) < (b.gaps, -b.spread - 1e-6)
    }

    /// The best formation found, `None` if the robots do not fit.
    pub fn search(&self, grip: &Grip, robots: usize) -> Option<Found> {
        let candidates = self.candidates();
        let mut best: Option<Found> = None;
        for start in [self.greedy(grip, robots, true), self.greedy(grip, robots, false), self.tour(robots)] {
            let Some(places) = start else { continue };
            let found = self.exchange(grip, self.rate(grip, places), &candidates);
            if best.as_ref().is_none_or(|best| self.better(&found, best)) {
                best = Some(found);
            }
        }
        let mut best = best?;
        // then finer, around each robot
        for shrink in [0.25, 0.125] {
            for robot in 0..robots {
                let here = best.places[robot];
                let length = self.load.edge(here.edge).length();
                let inset = self.placement.min(length / 2.0) / length;
                let step = shrink * 2.0 * self.radius / length;
                for at in [here.at - step, here.at + step] {
                    let place = Place { at, ..here };
                    if (inset..=1.0 - inset).contains(&at) && self.fits(&best.places, robot, place) {
                        let mut places = best.places.clone();
                        places[robot] = place;
                        let found = self.rate(grip, places);
                        if self.better(&found, &best) {
                            best = found;
                        }
                    }
                }
            }
        }
        best.places.sort_by(|a, b| a.edge.cmp(&b.edge).then(a.at.total_cmp(&b.at)));
        Some(best)
    }

    /// One robot after the other where it does most good; `around` puts one in the middle of every edge first.
    fn greedy(&self, grip: &Grip, robots: usize, around: bool) -> Option<Vec<Place>> {
        let candidates = self.candidates();
        let mut places: Vec<Place> = Vec::new();
        let edges = self.load.vertices().len();
        if around && robots >= edges {
            for edge in 0..edges {
                let place = Place { edge, at: 0.5 };
                if self.fits(&places, usize::MAX, place) {
                    places.push(place);
                }
            }
        }
        while places.len() < robots {
            let mut best: Option<Found> = None;
            for place in candidates.iter().filter(|p| self.fits(&places, usize::MAX, **p)) {
                let found = self.rate(grip, [&places[..], &[*place]].concat());
                if best.as_ref().is_none_or(|best| self.better(&found, best)) {
                    best = Some(found);
                }
            }
            places = best?.places;
        }
        Some(places)
    }

    fn exchange(&self, grip: &Grip, mut best: Found, candidates: &[Place]) -> Found {
        for _ in 0..ROUNDS {
            let mut improved = false;
            for robot in 0..best.places.len() {
                for place in candidates {
                    if !self.fits(&best.places, robot, *place) {
                        continue;
                    }
                    let mut places = best.places.clone();
                    places[robot] = *place;
                    let found = self.rate(grip, places);
                    if self.better(&found, &best) {
                        best = found;
                        improved = true;
                    }
                }
            }
            if !improved {
                break;
            }
        }
        best
    }
}
