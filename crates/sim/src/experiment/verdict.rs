//! Verdicts on the paper's statements.

use serde::Serialize;

use super::Section;
use super::table::markdown_table;

/// What the trials say about one statement of the paper.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// The statement.
    pub statement: String,
    /// Whether the trials agree; `None` if there are too few.
    pub agrees: Option<bool>,
    /// Numbers with their intervals.
    pub evidence: String,
}

impl Verdict {
    /// For a statement without trials.
    pub fn unknown(statement: &str) -> Self {
        Self {
            statement: statement.to_owned(),
            agrees: None,
            evidence: "too few trials that reached the goal".to_owned(),
        }
    }
}

/// The verdicts as a table.
pub fn section(verdicts: &[Verdict]) -> Section {
    let rows: Vec<Vec<String>> = verdicts
        .iter()
        .map(|verdict| {
            let ours = match verdict.agrees {
                Some(true) => "ours agree",
                Some(false) => "ours differ",
                None => "unknown",
            };
            vec![verdict.statement.clone(), ours.to_owned(), verdict.evidence.clone()]
        })
        .collect();
    Section::text("Verdicts on the paper's statements", markdown_table(&["statement", "verdict", "evidence"], &rows))
}
