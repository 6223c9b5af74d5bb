//! What is asked of a planner: where agents stand, where they may go, what is in their way.
//!
//! Plain data, shared by the readers of files, the searches and the certifier. Nothing here is checked: whether an instance
//! can be solved at all is the searches' first question, and their answer names what is wrong ([`Reason`](crate::outcome::Reason)).

mod car;
mod grid;

pub use car::{CarAgent, CarInstance, Drive, Obstacle, Vehicle, VehicleError};
pub use grid::{Cell, GridAgent, GridInstance};

/// A planning problem of one of the kinds that are understood.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Instance {
    /// Agents on a 4-connected grid.
    Grid(GridInstance),
    /// Bodies that drive in the plane.
    Car(CarInstance),
}

impl Instance {
    /// How many agents there are.
    pub const fn agents(&self) -> usize {
        match self {
            Self::Grid(grid) => grid.agents.len(),
            Self::Car(car) => car.agents.len(),
        }
    }
}
