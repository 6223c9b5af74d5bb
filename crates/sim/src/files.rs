//! The edge: scenario files read, logs, pages and pictures written.
#![expect(clippy::disallowed_methods, reason = "this is where files are opened for the rest of the crate")]

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use cohaul_core::record::{self, Recovered};
use cohaul_core::scenario::{self, Override, Parsed, ScenarioError};
use cohaul_core::time::Time;
use cohaul_planner::capacity::{self, Capacity, CapacityError};
use cohaul_planner::formation::{self, FormationPlanError, ReformError};
use cohaul_planner::generate::GenerateError;
use cohaul_planner::io::FormatError;
use cohaul_planner::load_path::{self, LoadPathError};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::compare::{self, CompareError, Compared, Pairs, Paths, Track};
use crate::error::SimError;
use crate::experiment::store;
use crate::experiment::trials::TrialError;
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
    /// The slots that it leaves open cannot be chosen.
    #[error(transparent)]
    Formation(#[from] FormationPlanError),
    /// The waypoints that it leaves open cannot be planned.
    #[error(transparent)]
    LoadPath(LoadPathError),
    /// What the team can do cannot be said.
    #[error(transparent)]
    Capacity(#[from] CapacityError),
    /// The team cannot form anew.
    #[error(transparent)]
    Reform(#[from] ReformError),
    /// The mission or the log in it failed.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// The trials in it are damaged, or others.
    #[error(transparent)]
    Trials(#[from] TrialError),
    /// A planning instance or a plan that cannot be used.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// A planning instance that cannot be made.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// A figure that cannot be drawn.
    #[error("figure: {0}")]
    Figure(String),
    /// The threads of an experiment could not be started.
    #[error("cannot start the threads: {0}")]
    Threads(String),
}

impl From<LoadPathError> for FileError {
    fn from(error: LoadPathError) -> Self {
        match error {
            LoadPathError::Formation(error) => Self::Formation(error),
            error => Self::LoadPath(error),
        }
    }
}

pub(crate) fn io_error(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> FileError {
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

/// The text of an instance or a plan.
///
/// # Errors
/// A file that cannot be read, is not UTF-8, or is longer than is read.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    let file = File::open(path).map_err(io_error("read", path))?;
    let most = cohaul_planner::io::MAX_BYTES as u64;
    let length = file.metadata().map_or(0, |metadata| metadata.len()).min(most);
    let mut text = Vec::with_capacity(length as usize + 1);
    // one byte more than allowed is enough to refuse the file
    file.take(most + 1).read_to_end(&mut text).map_err(io_error("read", path))?;
    String::from_utf8(text).map_err(|error| {
        let source = io::Error::new(io::ErrorKind::InvalidData, error.utf8_error());
        FileError::Io { action: "read", path: path.to_owned(), source }
    })
}

/// Whether there is something at `path`.
pub fn exists(path: &Path) -> bool {
    path.exists()
}

/// Writes a file; makes its folder where there is none.
///
/// # Errors
/// One that cannot be written.
pub fn write_text(path: &Path, text: &str) -> Result<(), FileError> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        create_folder(folder)?;
    }
    write(path, text)
}

/// Makes a folder where there is none, with those that it lies in.
///
/// # Errors
/// One that cannot be made.
pub fn create_folder(path: &Path) -> Result<(), FileError> {
    fs::create_dir_all(path).map_err(io_error("create", path))
}

/// The scenario of one seed, everything in `randomize` drawn from it, slots and waypoints left open (`slots: auto`,
/// `plan: auto`) chosen.
///
/// # Errors
/// Values drawn together that make no valid scenario, slots that cannot be chosen, or loads without a way.
pub fn draw(parsed: &Parsed, seed: Option<u64>) -> Result<scenario::document::Scenario, FileError> {
    Ok(load_path::resolve(&draw_open(parsed, seed)?)?)
}

/// The same with what it leaves open still open.
pub(crate) fn draw_open(parsed: &Parsed, seed: Option<u64>) -> Result<scenario::document::Scenario, ScenarioError> {
    let mut random = ChaCha8Rng::seed_from_u64(seed.unwrap_or(parsed.scenario.seed));
    parsed.resolve(seed, &mut || random.random::<f64>())
}

/// What every team of the scenario can move once the robots `without` (counted from 1 over all teams) are gone and the others
/// of their teams have formed anew.
///
/// # Errors
/// A scenario that cannot be drawn or built, or robots that it does not have. Too few robots left, or none that find places,
/// are errors too.
pub fn capacity(parsed: &Parsed, without: &[usize]) -> Result<Vec<Capacity>, FileError> {
    let mut scenario = draw(parsed, None)?;
    let robots: usize = scenario.teams.iter().map(|team| team.robots.count).sum();
    if let Some(robot) = without.iter().find(|robot| !(1..=robots).contains(*robot)) {
        let team = scenario.teams.iter().map(|team| team.id.as_str()).collect::<Vec<_>>().join("`, `");
        return Err(ReformError::NoSuchRobot { team, robot: *robot, robots }.into());
    }
    let mut first = 1;
    for team in 0..scenario.teams.len() {
        let count = scenario.teams[team].robots.count;
        let lost: Vec<usize> =
            without.iter().filter(|robot| (first..first + count).contains(*robot)).map(|robot| robot - first).collect();
        first += count;
        if lost.is_empty() {
            continue;
        }
        match formation::reform(&scenario, team, &lost) {
            Ok(reformed) => scenario = reformed,
            Err(ReformError::Incapable(verdict)) => return Ok(vec![*verdict]),
            Err(error) => return Err(error.into()),
        }
    }
    Ok(capacity::assess(&scenario)?)
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

/// Reads the ways of the loads from the log at `path`.
///
/// # Errors
/// A file that cannot be read, or a damaged log.
pub fn read_track(path: &Path) -> Result<Track, FileError> {
    let file = File::open(path).map_err(io_error("read", path))?;
    Ok(Track::read(io::BufReader::new(file))?)
}

/// Whether a file's name is that of a log.
pub fn is_log(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "mcap")
}

/// Compares two results: two logs (`.mcap`), or two sets of trials (folders, `.jsonl`, `.parquet`).
///
/// For logs, `out` is the folder into which their picture goes, A-vs-B.svg and A-vs-B.png after the names of the files; for
/// sets of trials, `fields` are compared besides the time.
///
/// # Errors
/// Files that cannot be read, results that do not fit together, and what is only for the other kind.
pub fn compare(a: &Path, b: &Path, fields: &[String], out: Option<&Path>) -> Result<Compared, CompareError> {
    let usage = |text: &str| Err(CompareError::Usage(text.to_owned()));
    match (is_log(a), is_log(b)) {
        (true, true) if !fields.is_empty() => usage("fields are those of trials; logs have none"),
        (true, true) => {
            let (track_a, track_b) = (read_track(a)?, read_track(b)?);
            let mut paths = Paths::of((a.to_owned(), &track_a), (b.to_owned(), &track_b))?;
            if let Some(folder) = out {
                fs::create_dir_all(folder).map_err(io_error("create", folder))?;
                let stem = |path: &Path| path.file_stem().unwrap_or_default().display().to_string();
                let path = folder.join(format!("{}-vs-{}", stem(a), stem(b)));
                compare::draw(&mut paths, &track_a, &track_b, &path)?;
            }
            Ok(Compared::Logs(paths))
        }
        (false, false) if out.is_some() => usage("a picture is drawn of two logs, not of trials"),
        (false, false) => Ok(Compared::Trials(Pairs::of(&store::read_trials(a)?, &store::read_trials(b)?, fields)?)),
        _ => usage("one is a log and the other is not: give two logs, or two sets of trials"),
    }
}
