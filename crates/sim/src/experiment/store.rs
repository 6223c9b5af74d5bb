//! The edge: trials on disk, appended as they finish, and tables of them.
//!
//! A store is a folder EXPERIMENT-WORLD with `trials.jsonl`: a header, then a line a trial. Lines are appended whole, so
//! that a killed process loses nothing that was finished; what is there is not run again.
#![expect(clippy::disallowed_methods, reason = "this is where the files of an experiment are opened")]

use std::collections::BTreeMap;
use std::fs::{self, File, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::columns;
use super::lines;
use super::trials::{Key, Trial, TrialError};
use crate::files::{FileError, io_error};

pub use super::lines::Header;

/// Trials of a store, one line each.
pub const LINES: &str = "trials.jsonl";
/// Trials as a table.
pub const TABLE: &str = "trials.parquet";

/// An experiment's folder, open for more trials. It may be shared between threads.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    begun_by: Header,
    inside: Mutex<Inside>,
}

#[derive(Debug)]
struct Inside {
    file: File,
    trials: BTreeMap<(Key, u64), Trial>,
}

impl Store {
    /// Opens DIR/EXPERIMENT-WORLD, or makes it, and reads the trials that are there; a torn last line is cut off.
    ///
    /// # Errors
    /// Files that cannot be read or written, a damaged line, a folder of another experiment, world or set of scenarios,
    /// another process at work in it.
    pub fn open(dir: &Path, header: &Header) -> Result<Self, FileError> {
        let folder = dir.join(format!("{}-{}", header.experiment, header.world));
        fs::create_dir_all(&folder).map_err(io_error("create", &folder))?;
        let path = folder.join(LINES);
        let mut options = File::options();
        let mut file = options.read(true).append(true).create(true).open(&path).map_err(io_error("write", &path))?;
        // the lock ends with the file; where there are no locks, there is none
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(TrialError::Busy { folder: folder.display().to_string() }.into());
        }
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(io_error("read", &path))?;
        let whole = lines::whole(&text);
        file.set_len(whole.len() as u64).map_err(io_error("write", &path))?;
        file.seek(SeekFrom::End(0)).map_err(io_error("write", &path))?;
        let mut trials = BTreeMap::new();
        let begun_by = if whole.is_empty() {
            append(&mut file, &path, &header.line()?)?;
            header.clone()
        } else {
            let (there, found) = lines::read(whole)?;
            there.allows(header, &folder.display().to_string())?;
            for trial in found {
                trials.entry((trial.key.clone(), trial.seed)).or_insert(trial);
            }
            there
        };
        Ok(Self { folder, begun_by, inside: Mutex::new(Inside { file, trials }) })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The header that the store began with; the base seed may differ from that of today.
    pub const fn begun_by(&self) -> &Header {
        &self.begun_by
    }

    /// The trial of this cell and seed, if it is finished.
    pub fn trial(&self, key: &Key, seed: u64) -> Option<Trial> {
        self.with(|inside| inside.trials.get(&(key.clone(), seed)).cloned())
    }

    /// Every finished trial, by cell and seed.
    pub fn trials(&self) -> Vec<Trial> {
        self.with(|inside| inside.trials.values().cloned().collect())
    }

    /// Adds a finished trial; it is in the file when this returns. One that is there already stays as it is.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn append(&self, trial: Trial) -> Result<(), FileError> {
        let line = lines::line(&trial)?;
        self.with(|inside| {
            let name = (trial.key.clone(), trial.seed);
            if !inside.trials.contains_key(&name) {
                append(&mut inside.file, &self.folder.join(LINES), &line)?;
                inside.trials.insert(name, trial);
            }
            Ok(())
        })
    }

    fn with<T>(&self, work: impl FnOnce(&mut Inside) -> T) -> T {
        // a thread that panicked left a whole map: each change of it is one insertion
        work(&mut self.inside.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Writes a line in one piece.
fn append(file: &mut File, path: &Path, line: &str) -> Result<(), FileError> {
    file.write_all(format!("{line}\n").as_bytes()).and_then(|()| file.flush()).map_err(io_error("write", path))
}

/// Writes trials as a Parquet file: the same bytes for the same trials, whatever their order.
///
/// # Errors
/// A file that cannot be written, a factor with the name of a value.
pub fn write_parquet(path: &Path, trials: &[Trial]) -> Result<(), FileError> {
    let bytes = columns::encode(trials)?;
    // the table appears only when it is whole
    let unfinished = path.with_extension("parquet.part");
    fs::write(&unfinished, bytes).map_err(io_error("write", &unfinished))?;
    fs::rename(&unfinished, path).map_err(io_error("write", path))
}

/// Writes a text, such as a table for people.
///
/// # Errors
/// A file that cannot be written.
pub fn write_text(path: &Path, text: &str) -> Result<(), FileError> {
    fs::write(path, text).map_err(io_error("write", path))
}

/// Reads a Parquet file written by [`write_parquet`].
///
/// # Errors
/// A file that cannot be read, or that holds no trials.
pub fn read_parquet(path: &Path) -> Result<Vec<Trial>, FileError> {
    let file = File::open(path).map_err(io_error("read", path))?;
    Ok(columns::decode(file)?)
}

/// Reads trials from a folder of results, from its `trials.jsonl` or from a Parquet file.
///
/// In a folder the lines count where there are any: they hold what an interrupted run finished too.
///
/// # Errors
/// A file that cannot be read, or that holds no trials.
pub fn read_trials(path: &Path) -> Result<Vec<Trial>, FileError> {
    let mut file = path.to_owned();
    if path.is_dir() {
        file.push(LINES);
        if !file.exists() {
            file.set_file_name(TABLE);
        }
    }
    if file.extension().is_some_and(|extension| extension == "jsonl") {
        let text = fs::read(&file).map_err(io_error("read", &file))?;
        Ok(lines::read(lines::whole(&text))?.1)
    } else {
        read_parquet(&file)
    }
}
