//! Friction between load, ground and robots.
