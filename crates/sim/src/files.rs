//! The edge: scenario files read, logs, pages and pictures written.
#![expect(clippy::disallowed_methods, reason = "this is where files are opened for the rest of the crate")]

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use cohaul_core::record::{self, Recovered};
use cohaul_core::scenario::{self, Override, Parsed, ScenarioError};
use cohaul_core::time::Time;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::error::SimError;
use crate::mission::Mission;
use crate::page;
use crate::recording::Recording;
use crate::replay::{self, Replayed};

/// A file that could not be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// It cannot be opened, read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// What was attempted: `read`, `write`, `create`.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The scenario in it is not valid.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The mission or the log in it failed.
    #[error(transparent)]
    Sim(#[from] SimError),
}

fn io_error(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> FileError {
    move |source| FileError::Io { action, path: path.to_owned(), source }
}

/// Reads and checks the scenario file at `path`.
///
/// # Errors
/// A file that cannot be read, or a scenario that is not valid.
pub fn read_scenario(path: &Path, overrides: &[Override]) -> Result<Parsed, FileError> {
    let file = File::open(path).map_err(io_error("read", path))?;
    let mut text = Vec::new();
    // one byte more than allowed is enough to refuse the file
    file.take(scenario::MAX_BYTES as u64 + 1).read_to_end(&mut text).map_err(io_error("read", path))?;
    Ok(scenario::parse(&path.display().to_string(), &text, overrides)?)
}

/// The scenario of one seed, everything in `randomize` drawn from it.
///
/// # Errors
/// Values drawn together that make no valid scenario.
pub fn draw(parsed: &Parsed, seed: Option<u64>) -> Result<scenario::document::Scenario, ScenarioError> {
    let mut random = ChaCha8Rng::seed_from_u64(seed.unwrap_or(parsed.scenario.seed));
    parsed.resolve(seed, &mut || random.random::<f64>())
}

/// Where a mission left its files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The log.
    pub log: PathBuf,
    /// The replay page.
    pub page: PathBuf,
    /// The picture, where one was asked for.
    pub picture: Option<PathBuf>,
}

/// Runs a resolved scenario and writes its log and its page, NAME.mcap and NAME.html, into `folder`; with `picture` also
/// NAME.svg. `stop` is as in [`Mission::run`].
///
/// # Errors
/// Files that cannot be written, or a mission that cannot run.
pub fn run_into(
    scenario: scenario::document::Scenario,
    folder: &Path,
    picture: bool,
    stop: &mut dyn FnMut(Time, Time) -> bool,
) -> Result<(Mission, Written), FileError> {
    fs::create_dir_all(folder).map_err(io_error("create", folder))?;
    let file = |ending: &str| folder.join(format!("{}.{ending}", scenario.name));
    let mut written = Written { log: file("mcap"), page: file("html"), picture: picture.then(|| file("svg")) };
    let log = File::create(&written.log).map_err(io_error("write", &written.log))?;
    let mission = Mission::run(scenario, Some(Box::new(log)), stop)?;
    let replay = mission.replay()?;
    write(&written.page, &page::render(&replay))?;
    if let Some(path) = &mut written.picture {
        write(path, &page::picture(&replay))?;
    }
    Ok((mission, written))
}

fn write(path: &Path, text: &str) -> Result<(), FileError> {
    File::create(path).and_then(|mut file| file.write_all(text.as_bytes())).map_err(io_error("write", path))
}

/// Re-decides the log at `path`.
///
/// # Errors
/// A file that cannot be read, or a damaged log.
pub fn replay_log(path: &Path) -> Result<Replayed, FileError> {
    let file = File::open(path).map_err(io_error("read", path))?;
    Ok(replay::replay(io::BufReader::new(file))?)
}

/// Reads the log at `path` as the mission that it recorded.
///
/// # Errors
/// A file that cannot be read, or a damaged log.
pub fn read_log(path: &Path) -> Result<Recording, FileError> {
    let file = File::open(path).map_err(io_error("read", path))?;
    Ok(Recording::read(io::BufReader::new(file))?)
}

/// Makes a valid log of what is left of the one at `path`; the other file is `output`, or NAME.recovered.mcap beside it.
///
/// # Errors
/// Files that cannot be read or written, or one that was never a log.
pub fn recover_log(path: &Path, output: Option<&Path>) -> Result<(Recovered, PathBuf), FileError> {
    let output = output.map_or_else(|| path.with_extension("recovered.mcap"), Path::to_owned);
    let input = File::open(path).map_err(io_error("read", path))?;
    let same = fs::canonicalize(&output).is_ok_and(|a| fs::canonicalize(path).is_ok_and(|b| a == b));
    if same {
        let source = io::Error::new(io::ErrorKind::InvalidInput, "it is the log to recover; choose another --out");
        return Err(FileError::Io { action: "write", path: output, source });
    }
    // the other file appears only when it is whole
    let unfinished = output.with_extension("mcap.part");
    let file = File::create(&unfinished).map_err(io_error("write", &unfinished))?;
    let recovered = record::recover(io::BufReader::new(input), file).map_err(SimError::from);
    if recovered.is_err() {
        let _ = fs::remove_file(&unfinished);
    }
    let recovered = recovered?;
    fs::rename(&unfinished, &output).map_err(io_error("write", &output))?;
    Ok((recovered, output))
}
