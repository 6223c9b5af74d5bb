//! `cohaul generate`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::{DONE, say};
use crate::files::{self, FileError};
use crate::planning::generate::{self, Kind, Wanted};

#[derive(Args)]
pub(super) struct Generate {
    /// What kind of instances.
    #[arg(value_enum)]
    kind: Kind,
    /// How many agents each.
    #[arg(long, value_name = "N", default_value = "10")]
    agents: usize,
    /// Side of the square map: cells for grids (32 if not given), metres for bodies (100).
    #[arg(long, value_name = "S")]
    size: Option<u16>,
    /// How many obstacles: a fifth of the cells if not given; 25, 50 or 100 for bodies on maps of 50, 100, 300 m.
    #[arg(long, value_name = "N")]
    obstacles: Option<usize>,
    /// How many goals an agent may take, for the kinds with windows.
    #[arg(long, value_name = "K", default_value = "3")]
    window: usize,
    /// Seed of the first instance; the others have the following ones.
    #[arg(long, value_name = "N", default_value = "1")]
    seed: u64,
    /// How many instances.
    #[arg(long, value_name = "K", default_value = "1")]
    count: u64,
    /// Folder for the files.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    pub(super) json: bool,
}

pub(super) fn generate(arguments: &Generate) -> Result<i32, FileError> {
    files::create_folder(&arguments.out)?;
    let &Generate { kind, agents, size, obstacles, window, .. } = arguments;
    let wanted = Wanted { kind, agents, size, obstacles, window };
    let mut written = Vec::new();
    for number in 0..arguments.count {
        let seed = arguments.seed.wrapping_add(number);
        for (name, text) in generate::made(&wanted, seed)? {
            let path = arguments.out.join(name);
            files::write_text(&path, &text)?;
            if !arguments.json {
                say(&path.display().to_string());
            }
            written.push(path);
        }
    }
    if arguments.json {
        say(&json!({ "files": written, "seed": arguments.seed, "count": arguments.count }).to_string());
    }
    Ok(DONE)
}
