//! A mission as one drawing.

use super::{Replay, escape};

/// An SVG of the whole mission.
pub fn picture(replay: &Replay) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 100\"><title>{}</title></svg>\n",
        escape(&replay.title)
    )
}
