//! Identities. Ties are always broken by id.

use serde::{Deserialize, Serialize};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub u16);

        impl $name {
            /// Position in the list that the scenario gives.
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "{}", self.0)
            }
        }
    };
}

id!(
    /// A robot: its place in the list of all robots of a scenario, counted from 0.
    RobotId
);
id!(
    /// A load: its place in the scenario's `loads`, counted from 0.
    LoadId
);
id!(
    /// A team: its place in the scenario's `teams`, counted from 0.
    TeamId
);
