//! What it costs a car to fetch a load and push it to its goal, for assigning loads to cars.
//!
//! # Source
//! [PuSHR] §IV assigns by ways on a grid. Here the way to the load is the shortest curve that the car can drive, and the push
//! the shortest one forwards that turns no tighter than a load stays on the bumper.
//!
//! [PuSHR]: cohaul_core::_documentation::references

use cohaul_core::se2::Pose2;

use super::curve::Place;
use super::{dubins, steering};
use crate::assign::Costs;
use crate::instance::Vehicle;

/// One load that is to be pushed. Poses of the car's reference point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Where the car touches the load.
    pub contact: Pose2,
    /// Where it lets go of it.
    pub release: Pose2,
    /// Least radius of the car's path while it pushes, m.
    pub turning_radius: f64,
}

/// Metres by car and push: from where the car is to the contact, as the car drives, then forwards to the release.
///
/// ```
/// use cohaul_core::se2::Pose2;
/// use cohaul_planner::assign::optimal;
/// use cohaul_planner::car::{Push, push_costs};
/// use cohaul_planner::instance::Vehicle;
/// use nalgebra::Vector2;
///
/// let at = |x: f64, y: f64| Pose2::new(Vector2::new(x, y), 0.0);
/// let push = |y: f64| Push { contact: at(10.0, y), release: at(20.0, y), turning_radius: 6.0 };
/// let costs = push_costs(&Vehicle::default(), &[at(0.0, 0.0), at(0.0, 9.0)], &[push(9.0), push(0.0)]);
/// assert_eq!(costs.of(0)[1], 20.0);
/// assert_eq!(optimal(&costs).goals, [Some(1), Some(0)]);
/// ```
pub fn push_costs(vehicle: &Vehicle, cars: &[Pose2], pushes: &[Push]) -> Costs {
    let place = |pose: &Pose2, radius: f64| {
        let at = pose.translation.vector / radius;
        Place { x: at.x, y: at.y, yaw: pose.rotation.angle(), cos: pose.rotation.re, sin: pose.rotation.im }
    };
    let radius = vehicle.turning_radius;
    let pushed: Vec<f64> = pushes
        .iter()
        .map(|push| {
            let wide = push.turning_radius;
            wide * dubins::distance(&place(&push.contact, wide), &place(&push.release, wide))
        })
        .collect();
    let values = cars.iter().flat_map(|car| {
        let start = place(car, radius);
        let fetch =
            move |push: &Push| radius * steering::distance(vehicle.drive, &start, &place(&push.contact, radius));
        pushes.iter().zip(&pushed).map(move |(push, pushed)| fetch(push) + pushed)
    });
    Costs::new(cars.len(), pushes.len(), values.collect())
}
