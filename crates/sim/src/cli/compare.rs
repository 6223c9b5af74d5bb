//! `cohaul compare`.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::{BAD_INPUT, DONE, FAILED, USAGE, complain, say};
use crate::compare::{CompareError, Compared};
use crate::error::chain;
use crate::experiment::store::write_text;
use crate::experiment::table::{latex_table, markdown_table};
use crate::files::{self, FileError};

#[derive(Args)]
pub(super) struct Compare {
    /// Results: a folder of trials, a .parquet file, or a log (.mcap).
    a: PathBuf,
    /// The others, of the same kind.
    b: PathBuf,
    /// Compare this number of the trials too, such as min_clearance_m; may be given several times.
    #[arg(long = "field", value_name = "NAME")]
    fields: Vec<String>,
    /// Folder for the picture of two logs, A-vs-B.svg and A-vs-B.png; `out` if not given.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the table as Markdown.
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
    /// Write the table as LaTeX, with the rules of booktabs.
    #[arg(long, value_name = "FILE")]
    latex: Option<PathBuf>,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    pub(super) json: bool,
}

pub(super) fn compare(arguments: &Compare) -> Result<i32, FileError> {
    let error = match tried(arguments) {
        Ok(()) => return Ok(DONE),
        Err(error) => error,
    };
    if arguments.json {
        let object = json!({"message": chain(&error), "file": null, "line": null, "column": null, "remedy": null});
        say(&json!({ "error": object }).to_string());
    } else {
        complain(&format!("error: {}", chain(&error)));
    }
    Ok(match error {
        CompareError::Usage(_) | CompareError::Field { .. } => USAGE,
        CompareError::File(FileError::Io { action: "read", .. } | FileError::Sim(_) | FileError::Trials(_)) => {
            BAD_INPUT
        }
        CompareError::Twice { .. } => BAD_INPUT,
        _ => FAILED,
    })
}

fn tried(arguments: &Compare) -> Result<(), CompareError> {
    let Compare { a, b, fields, out, .. } = arguments;
    let default = (files::is_log(a) && files::is_log(b)).then_some(Path::new("out"));
    let compared = files::compare(a, b, fields, out.as_deref().or(default))?;
    let (header, rows) = compared.table();
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    if let Some(path) = &arguments.markdown {
        let heading: String = compared.heading().iter().map(|line| format!("{line}  \n")).collect();
        write_text(path, &format!("{heading}\n{}", markdown_table(&header, &rows)))?;
    }
    if let Some(path) = &arguments.latex {
        let heading: String = compared.heading().iter().map(|line| format!("% {line}\n")).collect();
        write_text(path, &format!("{heading}{}", latex_table(&header, &rows)))?;
    }
    if arguments.json {
        say(&compared.to_json());
        return Ok(());
    }
    compared.heading().iter().for_each(|line| say(line));
    say("");
    say(&markdown_table(&header, &rows));
    if let Compared::Logs(paths) = &compared {
        for picture in paths.svg.iter().chain(&paths.png) {
            say(&format!("picture  {}", picture.display()));
        }
    }
    Ok(())
}
