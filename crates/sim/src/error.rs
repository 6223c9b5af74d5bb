//! What can go wrong around an episode.

use cohaul_core::control::ControlError;

/// Why an episode could not be run or recorded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// The scenario does not describe a mission.
    #[error("scenario cannot be built: {0}")]
    Scenario(String),
    /// A controller refuses its parameters.
    #[error("controller cannot be built")]
    Control(#[from] ControlError),
}

impl From<String> for SimError {
    fn from(reason: String) -> Self {
        Self::Scenario(reason)
    }
}
