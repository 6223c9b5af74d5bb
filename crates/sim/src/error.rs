//! What can go wrong around an episode.

use cohaul_core::control::ControlError;
use cohaul_core::record::RecordError;
use cohaul_core::scenario::Problem;

/// Why an episode could not be run, recorded or replayed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// The scenario does not describe a mission.
    #[error("scenario cannot be built")]
    Scenario(#[from] Problem),
    /// A controller refuses its parameters.
    #[error("controller cannot be built")]
    Control(#[from] ControlError),
    /// The log cannot be written or read.
    #[error("log failed")]
    Record(#[from] RecordError),
}
