//! Moving one load together: primitives, roles, formation, repositioning.

pub mod formation;
pub mod primitive;
pub mod reposition;
pub mod role;
