//! NumPy on one side, nalgebra and the frames of a mission on the other: the only place where they meet.

use cohaul_core::control::Phase;
use cohaul_core::control::r2p2::Parameters;
use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::scenario::TeamInstance;
use cohaul_core::scenario::document::{self, Controller, Scenario};
use cohaul_core::se2::{Twist2, Wrench2};
use cohaul_core::transport::primitive::Primitive;
use cohaul_core::transport::role::Role;
use cohaul_sim::page::{Frame, RobotFrame, TeamFrame};
use nalgebra::Vector2;
use numpy::ndarray::{Array, Dim, Dimension, IntoDimension, Ix};
use numpy::{
    AllowTypeChange, Element, IntoPyArray, Ix1, Ix2, Ix3, PyArray, PyArray1, PyArrayLike1, PyArrayLike2, PyArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error;

/// The state of everything at every recorded instant, one read-only array a column, the instants first.
#[derive(IntoPyObject)]
pub struct Traces<'py> {
    time: Bound<'py, PyArray<f64, Ix1>>,
    load_pose: Bound<'py, PyArray<f64, Ix3>>,
    robot_pose: Bound<'py, PyArray<f64, Ix3>>,
    command: Bound<'py, PyArray<f64, Ix3>>,
    speed: Bound<'py, PyArray<f64, Ix2>>,
    role: Bound<'py, PyArray<i8, Ix2>>,
    phase: Bound<'py, PyArray<i8, Ix2>>,
    stop: Bound<'py, PyArray<bool, Ix2>>,
    primitive: Bound<'py, PyArray<i8, Ix2>>,
    heading_error: Bound<'py, PyArray<f64, Ix2>>,
    distance: Bound<'py, PyArray<f64, Ix2>>,
    waypoint: Bound<'py, PyArray<i64, Ix2>>,
}

/// The columns of `frames`.
pub fn traces<'py>(py: Python<'py>, frames: &[Frame]) -> PyResult<Traces<'py>> {
    let count = |items: fn(&Frame) -> usize| frames.first().map_or(0, items);
    let (instants, loads) = (frames.len(), count(|f| f.loads.len()));
    let of_robots = [instants, count(|f| f.robots.len())];
    let of_teams = [instants, count(|f| f.teams.len())];
    let robots = || frames.iter().flat_map(|frame| &frame.robots);
    let teams = || frames.iter().flat_map(|frame| &frame.teams);
    Ok(Traces {
        time: column(py, [instants], frames.iter().map(|f| f.time))?,
        load_pose: column(py, [instants, loads, 3], frames.iter().flat_map(|f| &f.loads).flatten().copied())?,
        robot_pose: column(py, [of_robots[0], of_robots[1], 3], robots().flat_map(|r| r.pose))?,
        command: column(py, [of_robots[0], of_robots[1], 2], robots().flat_map(|r| r.command))?,
        speed: column(py, of_robots, robots().map(|r| r.speed))?,
        role: column(py, of_robots, robots().map(role))?,
        phase: column(py, of_robots, robots().map(phase))?,
        stop: column(py, of_robots, robots().map(|r| r.stop))?,
        primitive: column(py, of_teams, teams().map(primitive))?,
        heading_error: column(py, of_teams, teams().map(|t| t.heading_error))?,
        distance: column(py, of_teams, teams().map(|t| t.distance))?,
        waypoint: column(py, of_teams, teams().map(|t| t.waypoint as i64))?,
    })
}

/// The bodies of a scenario and what its teams shall reach; coordinates (n, 2) in metres, loads in their own frame.
#[derive(IntoPyObject)]
pub struct Layout<'py> {
    name: String,
    outlines: Vec<Bound<'py, PyArray<f64, Ix2>>>,
    obstacles: Vec<Bound<'py, PyArray<f64, Ix2>>>,
    teams: Vec<Team<'py>>,
}

/// A team of a [`Layout`].
#[derive(IntoPyObject)]
struct Team<'py> {
    load: usize,
    robots: Vec<usize>,
    radius: f64,
    waypoints: Bound<'py, PyArray<f64, Ix2>>,
    tolerance: f64,
    /// Heading error that starts a rotation, rad.
    heading_threshold: Option<f64>,
}

/// The layout of `scenario`.
pub fn layout<'py>(py: Python<'py>, scenario: &Scenario) -> PyResult<Layout<'py>> {
    let instance = scenario.instance().map_err(|e| error::sim(&e.into()))?;
    let corners = |polygon: &ConvexPolygon| {
        let vertices = polygon.vertices();
        column(py, [vertices.len(), 2], vertices.iter().flat_map(|v| [v.x, v.y]))
    };
    let team = |(team, built): (&document::Team, &TeamInstance)| {
        let (first, mission) = (built.first_robot.index(), &team.mission);
        let heading_threshold = match &team.controller {
            Controller::R2p2(keys) => Some(Parameters::new(keys).heading_threshold),
            Controller::Vlf(keys) => Some(keys.heading_threshold),
        };
        Ok(Team {
            load: built.load.index(),
            robots: (first..first + built.robots()).collect(),
            radius: built.model.radius,
            waypoints: column(py, [mission.points().count(), 2], mission.points().flat_map(|p| [p.x, p.y]))?,
            tolerance: mission.tolerance,
            heading_threshold,
        })
    };
    Ok(Layout {
        name: scenario.name.clone(),
        outlines: instance.loads.iter().map(|load| corners(&load.polygon)).collect::<PyResult<_>>()?,
        obstacles: instance.obstacles.iter().map(corners).collect::<PyResult<_>>()?,
        teams: scenario.teams.iter().zip(&instance.teams).map(team).collect::<PyResult<_>>()?,
    })
}

/// Values in the order of rows as a read-only array that owns them.
pub fn column<'py, T, S, const N: usize>(
    py: Python<'py>,
    shape: S,
    values: impl Iterator<Item = T>,
) -> PyResult<Bound<'py, PyArray<T, Dim<[Ix; N]>>>>
where
    T: Element,
    S: IntoDimension<Dim = Dim<[Ix; N]>>,
    Dim<[Ix; N]>: Dimension,
{
    let array = Array::from_shape_vec(shape.into_dimension(), values.collect());
    let array = array.map_err(|error| PyValueError::new_err(error.to_string()))?.into_pyarray(py);
    array.try_readwrite()?.make_nonwriteable();
    Ok(array)
}

/// Place in the list of all, −1 for none.
fn code<T: PartialEq>(all: &[T], value: Option<T>) -> i8 {
    let place = value.and_then(|value| all.iter().position(|other| *other == value));
    place.and_then(|place| i8::try_from(place).ok()).unwrap_or(-1)
}

fn role(robot: &RobotFrame) -> i8 {
    code(&Role::ALL, robot.role)
}

fn phase(robot: &RobotFrame) -> i8 {
    code(&Phase::ALL, Some(robot.phase))
}

fn primitive(team: &TeamFrame) -> i8 {
    code(&Primitive::ALL, team.primitive)
}

/// A twist from anything that NumPy makes three numbers of.
pub fn twist(values: &Bound<'_, PyAny>) -> PyResult<Twist2> {
    let array: PyArrayLike1<'_, f64, AllowTypeChange> =
        values.extract().map_err(|e| error::contact(format!("twist must have shape (3,): {e}")))?;
    let array = array.as_array();
    if array.len() != 3 {
        return Err(error::contact(format!("twist has shape ({},), must be (3,)", array.len())));
    }
    Ok(Twist2::new(array[0], array[1], array[2]))
}

/// Points in the plane from anything that NumPy makes an array (n, 2) of.
pub fn points(values: &Bound<'_, PyAny>) -> PyResult<Vec<Vector2<f64>>> {
    let array: PyArrayLike2<'_, f64, AllowTypeChange> =
        values.extract().map_err(|e| error::contact(format!("vertices must have shape (n, 2): {e}")))?;
    let array = array.as_array();
    if array.ncols() != 2 {
        return Err(error::contact(format!("vertices have shape {:?}, must be (n, 2)", array.shape())));
    }
    Ok(array.rows().into_iter().map(|row| Vector2::new(row[0], row[1])).collect())
}

/// A wrench as an array (3,).
pub fn wrench<'py>(py: Python<'py>, wrench: &Wrench2) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, wrench.vector().as_slice())
}
