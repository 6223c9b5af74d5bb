//! The body and the costs of its motion: CL-CBS's `config.yaml`, and `vehicle:` in an instance.

use super::error::{FormatError, FormatProblem};
use super::yaml::{Node, Tree};
use crate::instance::{Drive, Vehicle};

/// What a `config.yaml` says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// The body.
    pub vehicle: Vehicle,
    /// Distance that bodies keep from points, metres.
    pub obstacle_radius: f64,
}

impl Default for Config {
    /// The car of the CL-CBS benchmark.
    fn default() -> Self {
        Self { vehicle: Vehicle::default(), obstacle_radius: 0.8 }
    }
}

/// Reads a `config.yaml`; keys that are missing are those of CL-CBS.
///
/// # Errors
/// A file that is no configuration, unknown keys, values out of range.
pub fn read_config(text: &str, name: &str) -> Result<Config, FormatError> {
    let tree = Tree::read(name, text)?;
    if tree.root().is_null() {
        return Ok(Config::default());
    }
    decode(tree.root(), "the configuration")
}

pub(super) fn decode(node: Node<'_>, place: &'static str) -> Result<Config, FormatError> {
    let mut config = Config::default();
    let known = [
        "r",
        "deltat",
        "penaltyTurning",
        "penaltyReversing",
        "penaltyCOD",
        "mapResolution",
        "carWidth",
        "LF",
        "LB",
        "obsRadius",
        "constraintWaitTime",
        "drive",
        "stepTime",
    ];
    let [r, deltat, turning, reversing, switching, resolution, width, front, rear, radius, wait, drive, step_time] =
        node.fields(place, known)?;
    let vehicle = &mut config.vehicle;
    let numbers = [
        (r, "r", &mut vehicle.turning_radius),
        (deltat, "deltat", &mut vehicle.step_angle),
        (turning, "penaltyTurning", &mut vehicle.turning_penalty),
        (reversing, "penaltyReversing", &mut vehicle.reversing_penalty),
        (switching, "penaltyCOD", &mut vehicle.switching_penalty),
        (width, "carWidth", &mut vehicle.width),
        (front, "LF", &mut vehicle.front),
        (rear, "LB", &mut vehicle.rear),
        (step_time, "stepTime", &mut vehicle.step_time),
    ];
    for (node, key, value) in numbers {
        if let Some(node) = node {
            *value = node.number(key)?;
            // beyond, squares and quotients of lengths lose their meaning
            if !(1e-4..=1e4).contains(value) {
                let range = "between 0.0001 and 10000";
                return Err(node.error(FormatProblem::OutOfRange { what: key.to_owned(), value: *value, range }));
            }
        }
    }
    // these two are of CL-CBS's search: read, so that its files are, and not needed
    for (node, key) in [(resolution, "mapResolution"), (wait, "constraintWaitTime")] {
        if let Some(node) = node {
            node.number(key)?;
        }
    }
    if let Some(node) = radius {
        let value = node.number("obsRadius")?;
        if !(0.0..=1e4).contains(&value) {
            let range = "between 0 and 10000";
            return Err(node.error(FormatProblem::OutOfRange { what: "obsRadius".to_owned(), value, range }));
        }
        config.obstacle_radius = value;
    }
    if let Some(node) = drive {
        let expected = "`car`, `forward_car` or `differential`";
        config.vehicle.drive = match node.text("drive").map_err(|_| node.wrong("drive", expected))? {
            "car" => Drive::Car,
            "forward_car" => Drive::ForwardCar,
            "differential" => Drive::Differential,
            _ => return Err(node.wrong("drive", expected)),
        };
    }
    config.vehicle.validate().map_err(|error| node.error(FormatProblem::Vehicle(error)))?;
    Ok(config)
}

/// As files call it.
pub(super) const fn drive_name(drive: Drive) -> &'static str {
    match drive {
        Drive::Car => "car",
        Drive::ForwardCar => "forward_car",
        Drive::Differential => "differential",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_as_in_the_benchmark() {
        let config = read_config("r: 4\nLF: 2.5 # longer\ndrive: forward_car\n", "config.yaml").unwrap();
        assert_eq!(config.vehicle.turning_radius, 4.0);
        assert_eq!(config.vehicle.front, 2.5);
        assert_eq!(config.vehicle.drive, Drive::ForwardCar);
        assert_eq!(config.vehicle.rear, 1.0);
        assert_eq!(config.obstacle_radius, 0.8);
        assert_eq!(read_config("", "config.yaml").unwrap(), Config::default());
    }

    #[test]
    fn errors_name_the_place() {
        let message = |text: &str| read_config(text, "config.yaml").unwrap_err().to_string();
        assert_eq!(message("r: 3\nLF: -1"), "config.yaml:2:5: `LF` is -1; it must be between 0.0001 and 10000");
        assert_eq!(
            message("drive: tank"),
            "config.yaml:1:8: `drive` must be `car`, `forward_car` or `differential`, not `tank`"
        );
        assert_eq!(message("R: 3"), "config.yaml:1:1: unknown key `R` in the configuration");
        assert_eq!(
            message("penaltyCOD: 0.5"),
            "config.yaml:1:1: the vehicle's switching penalty is 0.5; it must be at least 1 and finite"
        );
    }
}
