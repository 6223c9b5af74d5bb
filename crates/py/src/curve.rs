//! Shortest curves, and assignments.

use cohaul_planner::assign::{self, Costs, NextBest};
use cohaul_planner::car::curve::{Curve, Place, Steer};
use cohaul_planner::car::{dubins, reeds_shepp};
use numpy::PyArray2;
use numpy::{AllowTypeChange, PyArrayLike2};
use pyo3::prelude::*;

use crate::{convert, error};

/// A shortest curve from one pose to another.
#[pyclass(frozen, module = "cohaul._cohaul")]
pub struct ShortestCurve {
    curve: Curve,
    start: [f64; 3],
    radius: f64,
}

fn shortest(
    start: [f64; 3],
    goal: [f64; 3],
    radius: f64,
    curves: fn(&Place, &Place, &mut Vec<Curve>),
) -> PyResult<ShortestCurve> {
    if !(radius.is_finite() && radius > 0.0) {
        return Err(error::plan(format!("radius is {radius}, must be positive and finite")));
    }
    let place = |what: &str, [x, y, yaw]: [f64; 3]| {
        let place = [x / radius, y / radius, yaw];
        if place.iter().all(|value| value.is_finite()) {
            Ok(Place::new(place[0], place[1], place[2]))
        } else {
            Err(error::plan(format!("{what} is ({x}, {y}, {yaw}), must be finite")))
        }
    };
    let (from, to) = (place("start", start)?, place("goal", goal)?);
    let mut found = Vec::new();
    curves(&from, &to, &mut found);
    let best = found.into_iter().min_by(|a, b| a.length().total_cmp(&b.length()));
    let curve = best.ok_or_else(|| error::plan("no curve leads there".to_owned()))?;
    Ok(ShortestCurve { curve, start, radius })
}

/// The shortest curve of a car that drives both ways.
#[pyfunction]
pub fn reeds_shepp_curve(start: [f64; 3], goal: [f64; 3], radius: f64) -> PyResult<ShortestCurve> {
    shortest(start, goal, radius, reeds_shepp::curves)
}

/// The shortest curve of a car that drives forwards.
#[pyfunction]
pub fn dubins_curve(start: [f64; 3], goal: [f64; 3], radius: f64) -> PyResult<ShortestCurve> {
    shortest(start, goal, radius, dubins::curves)
}

#[pymethods]
impl ShortestCurve {
    /// Its length, m.
    #[getter]
    fn length(&self) -> f64 {
        self.curve.length() * self.radius
    }

    /// Which way it steers and how far, m, negative backwards, piece by piece.
    #[getter]
    fn segments(&self) -> Vec<(&'static str, f64)> {
        let pieces = self.curve.segments().iter().map(|segment| {
            let steer = match segment.steer {
                Steer::Straight => "straight",
                Steer::Left => "left",
                Steer::Right => "right",
                Steer::Spin => "spin",
            };
            (steer, segment.length * self.radius)
        });
        pieces.collect()
    }

    /// Poses (n, 3) along it, at most `spacing` apart, with both ends of every piece.
    fn sample<'py>(&self, py: Python<'py>, spacing: f64) -> PyResult<Bound<'py, PyArray2<f64>>> {
        const MOST: f64 = 1e7;
        if !(spacing.is_finite() && spacing > 0.0 && self.length() / spacing < MOST) {
            return Err(error::plan(format!("spacing is {spacing}, must be positive and give fewer than 1e7 poses")));
        }
        let [x, y, yaw] = self.start;
        let mut at = Place::new(x / self.radius, y / self.radius, yaw);
        let mut numbers = vec![x, y, yaw];
        for segment in self.curve.segments() {
            let pieces = (segment.length.abs() * self.radius / spacing).ceil().max(1.0);
            for piece in 1..=pieces as u64 {
                let share = piece as f64 / pieces;
                let part = cohaul_planner::car::curve::Segment { length: segment.length * share, ..*segment };
                let place = at.after(part);
                numbers.extend([place.x * self.radius, place.y * self.radius, place.yaw]);
            }
            at = at.after(*segment);
        }
        convert::column(py, [numbers.len() / 3, 3], numbers.into_iter())
    }
}

fn costs(values: &Bound<'_, PyAny>) -> PyResult<Costs> {
    let array: PyArrayLike2<'_, f64, AllowTypeChange> =
        values.extract().map_err(|e| error::plan(format!("costs must have shape (agents, goals): {e}")))?;
    let array = array.as_array();
    Ok(Costs::new(array.nrows(), array.ncols(), array.iter().copied().collect()))
}

/// The goals of all agents, and the sum of the costs.
type Assigned = (Vec<Option<usize>>, f64);

/// The cheapest assignment.
#[pyfunction]
pub fn optimal_assignment(py: Python<'_>, values: &Bound<'_, PyAny>) -> PyResult<Assigned> {
    let costs = costs(values)?;
    let best = py.detach(|| assign::optimal(&costs));
    Ok((best.goals, best.cost))
}

/// The assignments in the order of their cost.
#[pyclass(module = "cohaul._cohaul")]
pub struct Assignments {
    rest: NextBest,
}

#[pymethods]
impl Assignments {
    /// Those under costs (agents, goals).
    #[staticmethod]
    fn under(values: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self { rest: NextBest::new(&costs(values)?) })
    }

    /// The goals of all agents and the sum of the costs; nothing after the last assignment.
    fn following(&mut self) -> Option<Assigned> {
        self.rest.next().map(|assignment| (assignment.goals, assignment.cost))
    }
}
