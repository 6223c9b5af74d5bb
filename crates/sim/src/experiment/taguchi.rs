//! Sensitivity: four control factors against four noise factors on three terrains.
//!
//! # Source
//! [R2P2] §VI, Table III, Figs 8 and 9: crossed L9 arrays, 81 runs per terrain, repositioning by teleport with a fixed penalty;
//! the time y is the smaller the better. Means are over successful runs; in S/N = −10 log₁₀(mean y²) a failed run has y = 600 s.
//!
//! # Deviations
//! - The arrays are not printed: Taguchi's standard L9(3⁴), which has the two best rows that the paper quotes.
//! - The penalty is not stated: 5 s each, outside the time limit (the paper's means exceed its limit of 1500 s).
//! - The tolerance is not stated: 0.10 m.
//! - Everything runs a second time with robots that drive back to their slots.
//!
//! [R2P2]: cohaul_core::_documentation::references

use std::fmt::Write as _;
use std::path::Path;

use super::design::{Design, SINGLE, Terrain};
use super::figure::{self, Panels};
use super::table::markdown_table;
use super::trials::{Level, Trial};
use super::verdict::{self, Verdict};
use super::{Experiment, Results, Section};
use crate::files::FileError;
use crate::plot::{Lines, Series};
use crate::statistics::bootstrap;

/// Taguchi's L9(3⁴): levels of four factors in nine runs, every pair of levels once.
const L9: [[usize; 4]; 9] = [
    [1, 1, 1, 1],
    [1, 2, 2, 2],
    [1, 3, 3, 3],
    [2, 1, 2, 3],
    [2, 2, 3, 1],
    [2, 3, 1, 2],
    [3, 1, 3, 2],
    [3, 2, 1, 3],
    [3, 3, 2, 1],
];

/// A factor and its three levels (Table III).
type Factor = (&'static str, [f64; 3]);

/// The inner array: heuristics of the controller.
pub(super) const CONTROL: [Factor; 4] = [
    ("k_rot", [0.125, 0.25, 0.5]),
    ("k_trans", [0.2, 0.3, 0.4]),
    ("v_min", [0.1, 0.15, 0.2]),
    ("c", [0.05, 0.175, 0.3]),
];
/// The outer array: the surroundings.
pub(super) const NOISE: [Factor; 4] =
    [("mu", [0.4, 0.7, 0.9]), ("mass_kg", [0.1, 0.3, 0.5]), ("theta_deg", [5.0, 10.0, 15.0]), ("d_m", [0.2, 0.4, 0.6])];

/// Time of a failed run in the signal-to-noise ratio, s.
const CEILING: f64 = 600.0;

/// What the paper reports per terrain: successes of 81, mean time of these, ranges of the eight factors' level means in the
/// order of [`CONTROL`] and [`NOISE`], s. The ranges of friction and distance on flat ground are not given.
const PAPER: [(Terrain, u32, f64, [Option<f64>; 8]); 3] = [
    (Terrain::Flat, 78, 556.1, [Some(0.0), Some(0.0), Some(0.0), Some(1002.0), None, Some(1115.0), Some(913.0), None]),
    (
        Terrain::Downhill,
        81,
        57.7,
        [Some(0.0), Some(0.0), Some(0.0), Some(20.0), Some(59.0), Some(72.0), Some(39.0), Some(74.0)],
    ),
    (
        Terrain::Uphill,
        66,
        1256.4,
        [Some(98.0), Some(98.0), Some(465.0), Some(923.0), Some(1485.0), Some(1022.0), Some(4820.0), Some(1239.0)],
    ),
];

/// `r2p2-taguchi`.
pub struct Taguchi;

impl Experiment for Taguchi {
    fn name(&self) -> &'static str {
        "r2p2-taguchi"
    }

    fn about(&self) -> &'static str {
        "§VI: crossed L9 arrays of four control factors and four noise factors on three terrains, 81 missions each; \
         repositioning by teleport (5 s penalty each, outside the time limit) and, a second time, by driving."
    }

    fn trials(&self) -> usize {
        5
    }

    fn cells(&self) -> Vec<Design> {
        let mut cells = Vec::new();
        for reposition in ["teleport", "drive"] {
            for terrain in Terrain::ALL {
                for inner in L9 {
                    for outer in L9 {
                        cells.push(cell(reposition, terrain, inner, outer));
                    }
                }
            }
        }
        cells
    }

    fn measure(&self, trial: &mut Trial) {
        if let Some(time) = task_time(trial) {
            trial.push("task_time_s", time);
        }
    }

    fn figures(&self, results: &Results, folder: &Path) -> Result<(), FileError> {
        for reposition in ["teleport", "drive"] {
            let rows = [("heuristics", &CONTROL), ("surroundings", &NOISE)]
                .map(|(title, factors)| {
                    Terrain::ALL.map(|terrain| profiles(results, reposition, terrain, title, factors)).to_vec()
                })
                .to_vec();
            figure::save(folder, &format!("{}-{reposition}", self.name()), &Panels { rows })?;
        }
        Ok(())
    }

    fn sections(&self, results: &Results) -> Vec<Section> {
        let mut sections = Vec::new();
        for reposition in ["teleport", "drive"] {
            sections.push(overview(results, reposition));
            for factors in [&CONTROL, &NOISE] {
                sections.push(main_effects(results, reposition, factors));
            }
            sections.push(signal_to_noise(results, reposition));
        }
        sections.push(placements(results));
        sections.push(verdict::section(&self.verdicts(results)));
        sections
    }

    fn verdicts(&self, results: &Results) -> Vec<Verdict> {
        vec![placement_matters(results)]
    }
}

fn cell(reposition: &str, terrain: Terrain, inner: [usize; 4], outer: [usize; 4]) -> Design {
    let level = |factors: &[Factor; 4], levels: [usize; 4], place: usize| factors[place].1[levels[place] - 1];
    let mut design = Design::new(SINGLE).level("reposition", reposition).terrain(terrain);
    for (place, (name, _)) in CONTROL.iter().enumerate() {
        design = design.level(name, level(&CONTROL, inner, place));
    }
    for (place, (name, _)) in NOISE.iter().enumerate() {
        design = design.level(name, level(&NOISE, outer, place));
    }
    design
        .set("teams.0.controller.r2p2.rotation_gain", level(&CONTROL, inner, 0))
        .set("teams.0.controller.r2p2.translation_gain", level(&CONTROL, inner, 1))
        .set("teams.0.controller.r2p2.speed_min", level(&CONTROL, inner, 2))
        .set("teams.0.formation.contact_placement", level(&CONTROL, inner, 3))
        .set("teams.0.controller.r2p2.reposition", reposition)
        .set("terrain.friction.dynamic", level(&NOISE, outer, 0))
        .set("loads.0.mass", level(&NOISE, outer, 1))
        .goal(level(&NOISE, outer, 2), level(&NOISE, outer, 3))
}

/// Simulated time and penalties, s.
fn task_time(trial: &Trial) -> Option<f64> {
    Some(trial.number("time_s")? + trial.number("penalty_s")?)
}

fn has(trial: &Trial, factor: &str, level: &Level) -> bool {
    trial.key.level(factor) == Some(level)
}

/// Trials of one kind of repositioning on one terrain.
fn selected<'a>(results: &'a Results, reposition: &str, terrain: Terrain) -> Vec<&'a Trial> {
    let (reposition, terrain) = (Level::from(reposition), Level::from(terrain.name()));
    results.trials.iter().filter(|t| has(t, "reposition", &reposition) && has(t, "terrain", &terrain)).collect()
}

fn times<'a>(trials: impl IntoIterator<Item = &'a &'a Trial>) -> Vec<f64> {
    trials.into_iter().filter(|t| t.success()).filter_map(|t| task_time(t)).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Means of the task time at the three levels of a factor, over successful runs, s.
fn level_means(trials: &[&Trial], (name, levels): &Factor) -> [f64; 3] {
    levels.map(|level| {
        let level = Level::from(level);
        mean(&times(trials.iter().filter(|t| has(t, name, &level))))
    })
}

/// Greatest minus least of the means, s.
fn range(means: [f64; 3]) -> f64 {
    means.iter().copied().fold(f64::NEG_INFINITY, f64::max) - means.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Figs 8 and 9: level means of four factors, the mean of all dashed in the paper, a series here.
fn profiles(results: &Results, reposition: &str, terrain: Terrain, title: &str, factors: &[Factor; 4]) -> Lines {
    let trials = selected(results, reposition, terrain);
    let mut series: Vec<Series> = factors
        .iter()
        .map(|factor| {
            let means = level_means(&trials, factor);
            Series {
                name: format!("{} (Δ {:.1} s)", factor.0, range(means)),
                points: (0..).zip(means).map(|(level, mean)| (f64::from(level), mean)).collect(),
                joined: true,
                marked: true,
                ..Series::default()
            }
        })
        .collect();
    let all = mean(&times(&trials));
    series.push(Series {
        name: format!("mean {all:.1} s"),
        points: vec![(0.0, all), (2.0, all)],
        joined: true,
        ..Series::default()
    });
    Lines {
        title: format!("{}: {title}", terrain.name()),
        x: "level".to_owned(),
        y: "mean task time, s".to_owned(),
        names: ["1", "2", "3"].map(String::from).to_vec(),
        y_shows: None,
        series,
    }
}

fn overview(results: &Results, reposition: &str) -> Section {
    let mut rows = Vec::new();
    for (terrain, successes, time, _) in PAPER {
        let trials = selected(results, reposition, terrain);
        let reached = times(&trials);
        let teleports = trials.iter().filter_map(|t| t.number("repositions")).sum::<f64>() / trials.len() as f64;
        rows.push(vec![
            terrain.name().to_owned(),
            format!("{} of {}", reached.len(), trials.len()),
            format!("{:.1}", mean(&reached)),
            format!("{teleports:.2}"),
            format!("{successes} of 81"),
            format!("{time:.1}"),
        ]);
    }
    let header =
        ["terrain", "reached", "mean time s", "repositionings per run", "paper: reached", "paper: mean time s"];
    Section::text(&format!("Repositioning by {reposition}"), markdown_table(&header, &rows))
}

fn main_effects(results: &Results, reposition: &str, factors: &[Factor; 4]) -> Section {
    let offset = if factors[0].0 == CONTROL[0].0 { 0 } else { 4 };
    let mut rows = Vec::new();
    for (terrain, _, _, ranges) in PAPER {
        let trials = selected(results, reposition, terrain);
        for (place, factor) in factors.iter().enumerate() {
            let means = level_means(&trials, factor);
            let mut row = vec![terrain.name().to_owned(), factor.0.to_owned()];
            row.extend(factor.1.iter().zip(means).map(|(level, mean)| format!("{mean:.1} ({level})")));
            row.push(format!("{:.1}", range(means)));
            row.push(ranges[offset + place].map_or_else(|| "not given".to_owned(), |r| format!("{r:.0}")));
            rows.push(row);
        }
    }
    let header = ["terrain", "factor", "mean s, level 1", "level 2", "level 3", "range s", "paper: range s"];
    let title = if offset == 0 { "Main effects of the control factors" } else { "Main effects of the noise factors" };
    Section::text(&format!("{title}, repositioning by {reposition}"), markdown_table(&header, &rows))
}

/// Signal-to-noise ratio of every row of the inner array.
fn signal_to_noise(results: &Results, reposition: &str) -> Section {
    let mut rows = Vec::new();
    let mut best = String::new();
    for terrain in Terrain::ALL {
        let trials = selected(results, reposition, terrain);
        let mut highest: Option<(f64, String)> = None;
        for inner in L9 {
            let levels: Vec<(&str, Level)> = CONTROL
                .iter()
                .zip(inner)
                .map(|((name, levels), level)| (*name, Level::from(levels[level - 1])))
                .collect();
            let of_row: Vec<&Trial> =
                trials.iter().copied().filter(|t| levels.iter().all(|(name, level)| has(t, name, level))).collect();
            let squares = of_row.iter().map(|t| {
                let y = if t.success() { task_time(t).unwrap_or(CEILING) } else { CEILING };
                y * y
            });
            let ratio = -10.0 * (squares.sum::<f64>() / of_row.len() as f64).log10();
            let names: Vec<String> = levels.iter().map(|(_, level)| level.to_string()).collect();
            if highest.as_ref().is_none_or(|(value, _)| ratio > *value) {
                highest = Some((ratio, names.join(", ")));
            }
            let mut row = vec![terrain.name().to_owned()];
            row.extend(names);
            row.push(format!("{:.1}", mean(&times(&of_row))));
            row.push(format!("{ratio:.2}"));
            rows.push(row);
        }
        if let Some((ratio, names)) = highest {
            let _ = write!(best, "Best on {}: {names} (S/N {ratio:.2}). ", terrain.name());
        }
    }
    let header = ["terrain", "k_rot", "k_trans", "v_min", "c", "mean s", "S/N dB"];
    let text = format!("{}\n\n{}", best.trim(), markdown_table(&header, &rows));
    Section::text(&format!("Signal-to-noise ratios, repositioning by {reposition}"), text)
}

/// Success per level of contact placement with robots that drive back to their slots.
fn placements(results: &Results) -> Section {
    let mut rows = Vec::new();
    for terrain in Terrain::ALL {
        let trials = selected(results, "drive", terrain);
        let mut row = vec![terrain.name().to_owned()];
        for level in CONTROL[3].1 {
            let level = Level::from(level);
            let of_level: Vec<&&Trial> = trials.iter().filter(|t| has(t, "c", &level)).collect();
            let reached = of_level.iter().filter(|t| t.success()).count();
            row.push(format!("{reached} of {}", of_level.len()));
        }
        rows.push(row);
    }
    let header = ["terrain", "c = 0.05 m", "c = 0.175 m", "c = 0.3 m"];
    Section::text("Reached with real repositioning, by contact placement", markdown_table(&header, &rows))
}

/// "Contact placement c is the only heuristic parameter that produces a meaningful main effect on all three terrains."
fn placement_matters(results: &Results) -> Verdict {
    let statement = "contact placement is the one heuristic that matters on every terrain";
    let mut parts = Vec::new();
    let mut largest_everywhere = true;
    for terrain in Terrain::ALL {
        let trials: Vec<&Trial> = selected(results, "teleport", terrain);
        if trials.is_empty() {
            return Verdict::unknown(statement);
        }
        let by_cell = super::trials::cells(&results.trials);
        let mates: Vec<&[&Trial]> = trials
            .iter()
            .filter_map(|trial| by_cell.iter().find(|(key, _)| **key == trial.key).map(|(_, mates)| mates.as_slice()))
            .collect();
        let mut ranges: Vec<(f64, f64, f64, String)> = CONTROL
            .iter()
            .map(|factor| {
                let value = range(level_means(&trials, factor));
                let (low, high) = bootstrap(crate::statistics::RESAMPLES, results.seed, trials.len(), |chosen| {
                    // within the cell of each trial, so that the design stays crossed
                    let resampled: Vec<&Trial> =
                        mates.iter().zip(chosen).map(|(mates, index)| mates[index % mates.len()]).collect();
                    range(level_means(&resampled, factor))
                });
                (value, low, high, format!("{} {value:.2} s ({low:.2} to {high:.2})", factor.0))
            })
            .collect();
        ranges.sort_by(|a, b| b.0.total_cmp(&a.0));
        largest_everywhere &= ranges.first().is_some_and(|(_, low, _, text)| {
            text.starts_with("c ") && ranges.iter().skip(1).all(|(_, _, high, _)| low > high)
        });
        let texts: Vec<&str> = ranges.iter().map(|(.., text)| text.as_str()).collect();
        parts.push(format!("{}: {}", terrain.name(), texts.join(", ")));
    }
    let evidence =
        format!("ranges of the level means with 95 % bootstrap intervals, largest first; {}", parts.join("; "));
    Verdict { statement: statement.to_owned(), agrees: Some(largest_everywhere), evidence }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Orthogonality: every pair of columns has every pair of levels exactly once.
    #[test]
    fn the_array_is_orthogonal() {
        for a in 0..4 {
            for b in a + 1..4 {
                let mut pairs: Vec<_> = L9.iter().map(|row| (row[a], row[b])).collect();
                pairs.sort_unstable();
                pairs.dedup();
                assert_eq!(pairs.len(), 9);
            }
        }
    }

    /// The two best rows that the paper quotes are rows of this array (flat: row 2, uphill: row 8).
    #[test]
    fn the_papers_best_rows_are_in_the_array() {
        let row = |levels: [usize; 4]| [0, 1, 2, 3].map(|place| CONTROL[place].1[levels[place] - 1]);
        assert_eq!(row(L9[1]), [0.125, 0.3, 0.15, 0.175]);
        assert_eq!(row(L9[7]), [0.5, 0.3, 0.1, 0.3]);
        assert_eq!(Taguchi.cells().len(), 2 * 3 * 81);
    }
}
