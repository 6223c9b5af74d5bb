//! What can go wrong around an episode.

use cohaul_core::control::ControlError;
use cohaul_core::record::RecordError;
use cohaul_core::scenario::{Problem, ScenarioError};

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
    /// A scenario taken from a log is not valid.
    #[error(transparent)]
    Parse(#[from] ScenarioError),
    /// The scenario cannot be written out.
    #[error("scenario cannot be written out: {0}")]
    Text(#[from] cohaul_core::scenario::TextError),
    /// The log cannot be written or read.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The log makes no sense as a whole.
    #[error("log cannot be replayed: {0}")]
    Replay(String),
}

/// An error with its causes, each said once.
pub fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let next = error.to_string();
        if !text.contains(&next) {
            text = format!("{text}: {next}");
        }
        cause = error.source();
    }
    text
}
