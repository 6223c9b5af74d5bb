//! Whether the planar and the spatial world agree on Table I.
//!
//! # Source
//! Not in [R2P2], which has one simulator. Trials of the two worlds share their seeds, and so every jitter of the start.
//!
//! [R2P2]: cohaul_core::_documentation::references

use super::Section;
use super::design::Terrain;
use super::table::markdown_table;
use super::trials::{Key, Level, Trial, cells, numbers};
use crate::statistics::{median, ratio_of_medians_interval, wilson};

/// Ratios of medians outside of this are named.
const ALIKE: (f64, f64) = (0.75, 1.33);

/// Success and times of both worlds, cell by cell and terrain by terrain. `None` without common cells.
pub fn section(planar: &[Trial], spatial: &[Trial], seed: u64) -> Option<Section> {
    let others = cells(spatial);
    let both: Vec<(&Key, Vec<&Trial>, &Vec<&Trial>)> = cells(planar)
        .into_iter()
        .filter_map(|(key, of_planar)| Some((key, of_planar, &others.iter().find(|(other, _)| *other == key)?.1)))
        .collect();
    if both.is_empty() {
        return None;
    }
    let mut apart = Vec::new();
    let mut unlike = Vec::new();
    for (key, a, b) in &both {
        let interval = |trials: &[&Trial]| wilson(trials.iter().filter(|t| t.success()).count(), trials.len());
        let (first, second) = (interval(a), interval(b));
        if first.0 > second.1 || second.0 > first.1 {
            apart.push(key.to_string());
        }
        let (low, high) = ratio_of_medians_interval(&times(b), &times(a), seed);
        if !(low >= ALIKE.0 && high <= ALIKE.1) {
            unlike.push(format!("{key} ({low:.2} to {high:.2})"));
        }
    }
    let rows: Vec<Vec<String>> = Terrain::ALL
        .iter()
        .filter_map(|terrain| {
            let level = Level::from(terrain.name());
            let of = |spatial: bool| {
                let cells = both.iter().filter(|(key, ..)| key.level("terrain") == Some(&level));
                cells.flat_map(|(_, a, b)| times(if spatial { b } else { a })).collect::<Vec<f64>>()
            };
            let (a, b) = (of(false), of(true));
            if a.is_empty() || b.is_empty() {
                return None;
            }
            let (low, high) = ratio_of_medians_interval(&b, &a, seed);
            Some(vec![
                terrain.name().to_owned(),
                format!("{:.1} (n {})", median(&a), a.len()),
                format!("{:.1} (n {})", median(&b), b.len()),
                format!("{:.3}", median(&b) / median(&a)),
                format!("{low:.3} to {high:.3}"),
            ])
        })
        .collect();
    let named = |list: &[String], none: &str| if list.is_empty() { none.to_owned() } else { list.join("; ") };
    let text = format!(
        "{} cells of Table I. Cells whose 95 % intervals of success do not overlap: {}. Cells whose 95 % interval of the ratio \
         of medians (spatial ÷ planar) leaves {} to {}: {}.\n\n{}",
        both.len(),
        named(&apart, "none"),
        ALIKE.0,
        ALIKE.1,
        named(&unlike, "none"),
        markdown_table(&["terrain", "planar: median s", "spatial: median s", "ratio", "95 %"], &rows),
    );
    Some(Section::text("The planar and the spatial world", text))
}

fn times(trials: &[&Trial]) -> Vec<f64> {
    numbers(trials.iter().copied().filter(|t| t.success()), "time_s")
}
