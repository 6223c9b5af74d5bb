//! Questions that are answered by running many missions.

pub mod bisect;
