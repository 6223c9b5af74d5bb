//! Bodies that drive in the plane.

use cohaul_core::se2::Pose2;
use nalgebra::Point2;

/// How a body can move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// Forwards and backwards on arcs no tighter than the turning radius.
    Car,
    /// The same, forwards only.
    ForwardCar,
    /// Straight both ways, and turns in place.
    Differential,
}

/// What limits a body's motion, and what the motion costs. Metres and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vehicle {
    /// How it drives.
    pub drive: Drive,
    /// Least radius of its reference point's path (middle of the rear axle); of no meaning for [`Drive::Differential`].
    pub turning_radius: f64,
    /// Largest change of heading in one step.
    pub step_angle: f64,
    /// From the reference point to the front end.
    pub front: f64,
    /// From the reference point to the rear end.
    pub rear: f64,
    /// Width of the body.
    pub width: f64,
    /// Factor on the cost of a step that turns.
    pub turning_penalty: f64,
    /// Factor on the cost of a step backwards.
    pub reversing_penalty: f64,
    /// Factor on the cost of a step that changes between forwards and backwards.
    pub switching_penalty: f64,
    /// Duration of a step in seconds; 1 where files speak of steps only.
    pub step_time: f64,
}

impl Default for Vehicle {
    /// The car of the CL-CBS benchmark.
    fn default() -> Self {
        Self {
            drive: Drive::Car,
            turning_radius: 3.0,
            step_angle: 0.706,
            front: 2.0,
            rear: 1.0,
            width: 2.0,
            turning_penalty: 1.5,
            reversing_penalty: 2.0,
            switching_penalty: 2.0,
            step_time: 1.0,
        }
    }
}

impl Vehicle {
    /// Longest way of the reference point in one step.
    pub fn step_length(&self) -> f64 {
        self.turning_radius * self.step_angle
    }

    /// Least distance of two reference points that CL-CBS allows: √((2 front)² + width²).
    pub fn separation(&self) -> f64 {
        (2.0 * self.front).hypot(self.width)
    }

    /// Whether all lengths are positive and finite and no penalty is below 1.
    ///
    /// # Errors
    /// [`VehicleError`] with the first value that is not.
    pub fn validate(&self) -> Result<(), VehicleError> {
        let lengths = [
            ("turning radius", self.turning_radius),
            ("step angle", self.step_angle),
            ("front", self.front),
            ("rear", self.rear),
            ("width", self.width),
            ("step time", self.step_time),
        ];
        let penalties = [
            ("turning penalty", self.turning_penalty),
            ("reversing penalty", self.reversing_penalty),
            ("switching penalty", self.switching_penalty),
        ];
        for (name, value) in lengths {
            if !(value.is_finite() && value > 0.0) {
                return Err(VehicleError { name, value, least: "more than 0" });
            }
        }
        for (name, value) in penalties {
            if !(value.is_finite() && value >= 1.0) {
                return Err(VehicleError { name, value, least: "at least 1" });
            }
        }
        if self.step_angle > std::f64::consts::FRAC_PI_2 {
            return Err(VehicleError { name: "step angle", value: self.step_angle, least: "at most π/2" });
        }
        Ok(())
    }
}

/// A vehicle that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the vehicle's {name} is {value}; it must be {least} and finite")]
pub struct VehicleError {
    /// Which value.
    pub name: &'static str,
    /// What it is.
    pub value: f64,
    /// What it must be.
    pub least: &'static str,
}

/// What no body may touch. Metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Obstacle {
    /// A point from which bodies keep a distance, measured as CL-CBS does: it must not lie in the body's rectangle grown
    /// by `radius` on every side, corners included.
    Point {
        /// Where it is.
        at: Point2<f64>,
        /// By how much rectangles are grown.
        radius: f64,
    },
    /// A convex polygon, counter-clockwise.
    Polygon(Vec<Point2<f64>>),
}

/// Bodies of one kind in a rectangle, each with a start and goals.
#[derive(Clone, Debug, PartialEq)]
pub struct CarInstance {
    /// Extent in x: reference points stay within 0 and this.
    pub width: f64,
    /// Extent in y.
    pub height: f64,
    /// What is in the way.
    pub obstacles: Vec<Obstacle>,
    /// The bodies.
    pub vehicle: Vehicle,
    /// Who drives.
    pub agents: Vec<CarAgent>,
    /// Whether goals are to be assigned, as in [`GridInstance::assignment`](super::GridInstance::assignment).
    pub assignment: bool,
    /// Whether bodies may start inside an obstacle, as CL-CBS lets them, and stay there until they first move.
    pub free_starts: bool,
}

/// One body with its start and its goals. Poses of the reference point, yaw counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct CarAgent {
    /// As the file calls it.
    pub name: String,
    /// Where it stands first.
    pub start: Pose2,
    /// Where it may go; none, and it only must not be in the way.
    pub goals: Vec<Pose2>,
}
