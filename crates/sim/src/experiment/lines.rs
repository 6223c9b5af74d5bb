//! Trials as lines of JSON: a header, then one trial a line.

use serde::{Deserialize, Serialize};

use super::named::Named;
use super::trials::{Key, Trial, TrialError, Value, fingerprint};
use crate::mission::{REVISION, VERSION};

/// First line of a store: which trials it holds and what began it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Name of the experiment.
    pub experiment: String,
    /// Simulator.
    pub world: String,
    /// Base seed of the run that began the store.
    pub seed: u64,
    /// Version of the program that began it.
    pub version: String,
    /// Its source revision.
    pub revision: String,
    /// Hash of the cells' scenarios, hexadecimal ([`fingerprint`]).
    pub fingerprint: String,
}

impl Header {
    /// Of this version of the program; `scenarios` are the texts of all cells, in order.
    pub fn new<T: AsRef<str>>(
        experiment: &str,
        world: &str,
        seed: u64,
        scenarios: impl IntoIterator<Item = T>,
    ) -> Self {
        Self {
            experiment: experiment.to_owned(),
            world: world.to_owned(),
            seed,
            version: VERSION.to_owned(),
            revision: REVISION.to_owned(),
            fingerprint: format!("{:016x}", fingerprint(scenarios)),
        }
    }

    /// As a line, its end left out.
    pub(super) fn line(&self) -> Result<String, TrialError> {
        serde_json::to_string(self).map_err(TrialError::Fields)
    }

    /// Whether trials under the header `other` may join those under this one, which stand in `folder`.
    pub(super) fn allows(&self, other: &Self, folder: &str) -> Result<(), TrialError> {
        let compared = [
            ("experiment", &self.experiment, &other.experiment),
            ("world", &self.world, &other.world),
            // the report names one program; trials of another would pass for its own
            ("version", &self.version, &other.version),
            ("revision", &self.revision, &other.revision),
            ("set of scenarios, with the fingerprint", &self.fingerprint, &other.fingerprint),
        ];
        match compared.into_iter().find(|(_, there, here)| there != here) {
            None => Ok(()),
            Some((what, there, here)) => {
                Err(TrialError::Other { folder: folder.to_owned(), what, there: there.clone(), here: here.clone() })
            }
        }
    }
}

/// A trial as it stands in a line.
#[derive(Serialize, Deserialize)]
struct Line {
    key: Key,
    seed: u64,
    values: Named<Value>,
}

/// A trial as a line, its end left out.
pub(super) fn line(trial: &Trial) -> Result<String, TrialError> {
    let line = Line { key: trial.key.clone(), seed: trial.seed, values: trial.values.clone() };
    serde_json::to_string(&line).map_err(TrialError::Fields)
}

/// The lines that were written whole: everything up to the last end of a line.
pub(super) fn whole(text: &[u8]) -> &[u8] {
    let end = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |place| place + 1);
    text.get(..end).unwrap_or_default()
}

/// Header and trials of whole lines.
pub(super) fn read(text: &[u8]) -> Result<(Header, Vec<Trial>), TrialError> {
    let damaged = |place: usize| move |source| TrialError::Line { line: place + 1, source };
    let mut lines = text.split(|byte| *byte == b'\n').enumerate().filter(|(_, line)| !line.is_empty());
    let (place, first) = lines.next().ok_or(TrialError::NoHeader)?;
    let header: Header = serde_json::from_slice(first).map_err(damaged(place))?;
    let mut trials = Vec::new();
    for (place, line) in lines {
        let Line { key, seed, values } = serde_json::from_slice(line).map_err(damaged(place))?;
        let mut trial = Trial::new(&header.experiment, &header.world, key, seed);
        trial.values = values;
        trials.push(trial);
    }
    Ok((header, trials))
}
