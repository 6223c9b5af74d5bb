//! The contact model.

use cohaul_core::contact::limit_surface;
use cohaul_core::geometry::shape::ConvexPolygon;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::{convert, error};

/// Which friction wrench a load feels while it slides over the ground.
///
/// Uniform pressure over the footprint. `model="exact"` is dry friction at every point of it, `"ellipsoid"` the ellipsoid
/// with the same friction radius. Sources: [Goyal1991], [Howe1996].
#[pyclass(frozen, module = "cohaul")]
pub struct LimitSurface {
    inner: limit_surface::LimitSurface,
    model: String,
}

impl LimitSurface {
    fn new(footprint: &ConvexPolygon, model: String) -> PyResult<Self> {
        let inner = match model.as_str() {
            "exact" => limit_surface::LimitSurface::exact(footprint),
            "ellipsoid" => limit_surface::LimitSurface::ellipsoid(footprint),
            _ => return Err(error::contact(format!("model is {model:?}, must be 'exact' or 'ellipsoid'"))),
        };
        Ok(Self { inner, model })
    }
}

#[pymethods]
impl LimitSurface {
    /// Of a rectangle `along_x` by `along_y` [m] centred on the origin.
    #[staticmethod]
    #[pyo3(signature = (*, along_x, along_y, model = "exact".to_owned()))]
    fn rectangle(along_x: f64, along_y: f64, model: String) -> PyResult<Self> {
        Self::new(&ConvexPolygon::rectangle(along_x, along_y).map_err(|e| error::shape(&e))?, model)
    }

    /// Of a convex polygon with `vertices` (n, 2) [m], moved so that its centroid is the origin.
    #[staticmethod]
    #[pyo3(signature = (vertices, *, model = "exact".to_owned()))]
    fn polygon(vertices: &Bound<'_, PyAny>, model: String) -> PyResult<Self> {
        let polygon = ConvexPolygon::new(&convert::points(vertices)?).map_err(|e| error::shape(&e))?;
        Self::new(&polygon.centred(), model)
    }

    /// Friction wrench (3,) [N, N, N·m] on a load that slides with `twist` (3,) [m/s, m/s, rad/s], both in the load's frame;
    /// `limit` [N] is the friction coefficient times the normal force. Zero at rest.
    #[pyo3(signature = (*, twist, limit))]
    fn wrench<'py>(
        &self,
        py: Python<'py>,
        twist: &Bound<'py, PyAny>,
        limit: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(convert::wrench(py, &self.inner.wrench(&convert::twist(twist)?, limit)))
    }

    /// Friction power per unit of limit force [m/s] at `twist` (3,) [m/s, m/s, rad/s].
    #[pyo3(signature = (*, twist))]
    fn dissipation(&self, twist: &Bound<'_, PyAny>) -> PyResult<f64> {
        Ok(self.inner.dissipation(&convert::twist(twist)?))
    }

    /// Largest torque over largest force [m].
    fn friction_radius(&self) -> f64 {
        self.inner.friction_radius()
    }

    fn __repr__(&self) -> String {
        format!("<LimitSurface {}, friction radius {:.4} m>", self.model, self.inner.friction_radius())
    }
}
