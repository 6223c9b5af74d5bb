//! Friction between load, ground and wheels in the plane.

pub mod friction;
pub mod limit_surface;
pub mod slope;
