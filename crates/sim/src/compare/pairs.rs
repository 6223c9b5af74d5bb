//! Two sets of trials, paired by cell and seed.
//!
//! # Source
//! Exact test of paired proportions [McNemar1947]; percentile bootstrap over pairs [Efron1993].
//!
//! # Deviations
//! Differences are B − A and ratios B / A, over the pairs of which both reached the goal: how long a failure took says
//! nothing. A trial without a field `success` counts as one that reached it.
//!
//! [McNemar1947]: cohaul_core::_documentation::references
//! [Efron1993]: cohaul_core::_documentation::references

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::{CompareError, Table, number, with_interval};
use crate::experiment::trials::{Key, Trial, Value};
use crate::statistics::{RESAMPLES, bootstrap, chosen, mcnemar_exact, mean_sd, median};

/// The field that is compared without being asked for.
const TIME: &str = "time_s";
/// Seed of the bootstraps: the same trials give the same intervals.
const SEED: u64 = 0;

/// One side.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Side {
    /// Experiments and worlds of its trials, such as `r2p2-mass, planar`.
    pub experiments: Vec<String>,
    /// Trials.
    pub trials: usize,
    /// Those without a partner.
    pub unpaired: usize,
}

/// A field over the pairs of which both members reached the goal and have it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Field {
    /// Pairs.
    pub n: usize,
    /// Mean of B − A.
    pub mean_difference: f64,
    /// Its 95 % interval.
    pub mean_difference_interval: (f64, f64),
    /// Median of A.
    pub median_a: f64,
    /// Median of B.
    pub median_b: f64,
    /// Median of B over median of A.
    pub ratio_of_medians: f64,
    /// Its 95 % interval.
    pub ratio_of_medians_interval: (f64, f64),
}

/// The pairs of a cell, or of all.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// The cell; `None` for all.
    pub key: Option<Key>,
    /// Pairs.
    pub n: usize,
    /// A reached the goal.
    pub reached_a: usize,
    /// B reached the goal.
    pub reached_b: usize,
    /// Only A reached the goal.
    pub only_a: usize,
    /// Only B reached the goal.
    pub only_b: usize,
    /// Exact two-sided p value for the same probability to reach it.
    pub mcnemar_p: f64,
    /// Fields by name.
    pub fields: BTreeMap<String, Field>,
}

/// What two sets of trials say about each other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pairs {
    /// The one side.
    pub a: Side,
    /// The other.
    pub b: Side,
    /// Cells that both have.
    pub cells: Vec<Cell>,
    /// All pairs together.
    pub total: Cell,
}

type Pair<'a> = (&'a Trial, &'a Trial);

impl Pairs {
    /// Pairs the trials by cell and seed and compares success, `time_s` and the other `fields`.
    ///
    /// # Errors
    /// No common cell and seed, a cell and seed that stands twice on one side, a field that nobody has.
    pub fn of(a: &[Trial], b: &[Trial], fields: &[String]) -> Result<Self, CompareError> {
        let (by_name_a, by_name_b) = (by_name(a, 'A')?, by_name(b, 'B')?);
        let mut cells: Vec<(&Key, Vec<Pair<'_>>)> = Vec::new();
        for (&(key, seed), &first) in &by_name_a {
            let Some(&second) = by_name_b.get(&(key, seed)) else { continue };
            match cells.last_mut() {
                Some((last, pairs)) if *last == key => pairs.push((first, second)),
                _ => cells.push((key, vec![(first, second)])),
            }
        }
        let all: Vec<Pair<'_>> = cells.iter().flat_map(|(_, pairs)| pairs.iter().copied()).collect();
        if all.is_empty() {
            let reason = format!("no cell and seed is in both; A has {}, B has {}", contents(a), contents(b));
            return Err(CompareError::Nothing(reason));
        }
        let known = numeric(&all);
        let mut names: Vec<&str> = known.contains(TIME).then_some(TIME).into_iter().collect();
        for field in fields {
            if !known.contains(field.as_str()) {
                let known = known.into_iter().map(str::to_owned).collect();
                return Err(CompareError::Field { field: field.clone(), known });
            }
            if !names.contains(&field.as_str()) {
                names.push(field);
            }
        }
        let side = |trials: &[Trial]| Side {
            experiments: trials
                .iter()
                .map(|trial| format!("{}, {}", trial.experiment, trial.world))
                .collect::<BTreeSet<_>>()
                .into_iter()
                .collect(),
            trials: trials.len(),
            unpaired: trials.len() - all.len(),
        };
        Ok(Self {
            a: side(a),
            b: side(b),
            cells: cells.iter().map(|(key, pairs)| cell(Some((*key).clone()), pairs, &names)).collect(),
            total: cell(None, &all, &names),
        })
    }

    pub(super) fn heading(&self) -> Vec<String> {
        let side = |name: char, side: &Side| {
            let unpaired =
                if side.unpaired > 0 { format!(", {} of them unpaired", side.unpaired) } else { String::new() };
            format!("{name}: {}; {} trials{unpaired}", side.experiments.join("; "), side.trials)
        };
        let mut lines = vec![side('A', &self.a), side('B', &self.b)];
        if self.a.experiments != self.b.experiments {
            lines.push("the two are of different experiments or worlds, with the same cells".to_owned());
        }
        lines.push(format!(
            "{} pairs of cell and seed; differences are B − A, ratios B / A, with 95 % intervals, where both reached the goal",
            self.total.n
        ));
        lines
    }

    pub(super) fn table(&self) -> Table {
        let mut header: Vec<String> = ["cell", "pairs", "reached A", "reached B", "p"].map(String::from).to_vec();
        for name in self.total.fields.keys() {
            header.push(format!("Δ {name}"));
            header.push(format!("ratio of medians, {name}"));
        }
        let row = |cell: &Cell| {
            let name = cell.key.as_ref().map_or_else(|| "all".to_owned(), Key::to_string);
            let count = |count: usize| count.to_string();
            let p = if cell.mcnemar_p < 1e-3 { "< 0.001".to_owned() } else { format!("{:.3}", cell.mcnemar_p) };
            let mut row = vec![name, count(cell.n), count(cell.reached_a), count(cell.reached_b), p];
            for name in self.total.fields.keys() {
                match cell.fields.get(name) {
                    Some(field) => {
                        row.push(with_interval(field.mean_difference, field.mean_difference_interval));
                        row.push(with_interval(field.ratio_of_medians, field.ratio_of_medians_interval));
                    }
                    None => row.extend([number(f64::NAN), number(f64::NAN)]),
                }
            }
            row
        };
        // a single cell is all there is
        let cells = if self.cells.len() > 1 { self.cells.as_slice() } else { &[] };
        (header, cells.iter().chain([&self.total]).map(row).collect())
    }
}

fn by_name(trials: &[Trial], side: char) -> Result<BTreeMap<(&Key, u64), &Trial>, CompareError> {
    let mut named = BTreeMap::new();
    for trial in trials {
        if named.insert((&trial.key, trial.seed), trial).is_some() {
            return Err(CompareError::Twice { side, cell: trial.key.to_string(), seed: trial.seed });
        }
    }
    Ok(named)
}

/// A few words on what a set holds, for those who wonder why nothing fits.
fn contents(trials: &[Trial]) -> String {
    let keys: BTreeSet<&Key> = trials.iter().map(|trial| &trial.key).collect();
    let seeds: BTreeSet<u64> = trials.iter().map(|trial| trial.seed).collect();
    match (keys.first(), seeds.first(), seeds.last()) {
        (Some(key), Some(first), Some(last)) => {
            format!("{} cells such as [{key}] with seeds from {first} to {last}", keys.len())
        }
        _ => "no trials".to_owned(),
    }
}

fn reached(trial: &Trial) -> bool {
    trial.value("success").is_none_or(|value| *value == Value::Boolean(true))
}

/// Names under which both members of some pair have a number.
fn numeric<'a>(pairs: &[Pair<'a>]) -> BTreeSet<&'a str> {
    let mut known = BTreeSet::new();
    for (a, b) in pairs {
        known.extend(
            a.values()
                .filter(|(_, value)| value.number().is_some())
                .map(|(name, _)| name)
                .filter(|name| b.number(name).is_some()),
        );
    }
    known
}

fn cell(key: Option<Key>, pairs: &[Pair<'_>], fields: &[&str]) -> Cell {
    let count = |fits: fn(bool, bool) -> bool| pairs.iter().filter(|(a, b)| fits(reached(a), reached(b))).count();
    let (only_a, only_b) = (count(|a, b| a && !b), count(|a, b| b && !a));
    let both: Vec<&Pair<'_>> = pairs.iter().filter(|(a, b)| reached(a) && reached(b)).collect();
    let fields = fields.iter().filter_map(|name| {
        let values = both.iter().filter_map(|(a, b)| Some((a.number(name)?, b.number(name)?)));
        let (a, b): (Vec<f64>, Vec<f64>) = values.unzip();
        (!a.is_empty()).then(|| ((*name).to_owned(), field(&a, &b)))
    });
    Cell {
        key,
        n: pairs.len(),
        reached_a: count(|a, _| a),
        reached_b: count(|_, b| b),
        only_a,
        only_b,
        mcnemar_p: mcnemar_exact(only_a, only_b),
        fields: fields.collect(),
    }
}

fn field(a: &[f64], b: &[f64]) -> Field {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| b - a).collect();
    let (median_a, median_b) = (median(a), median(b));
    let mean = |drawn: &[usize]| mean_sd(&chosen(&differences, drawn)).0;
    let ratio = |drawn: &[usize]| median(&chosen(b, drawn)) / median(&chosen(a, drawn));
    Field {
        n: a.len(),
        mean_difference: mean_sd(&differences).0,
        mean_difference_interval: bootstrap(RESAMPLES, SEED, a.len(), mean),
        median_a,
        median_b,
        ratio_of_medians: median_b / median_a,
        ratio_of_medians_interval: bootstrap(RESAMPLES, SEED, a.len(), ratio),
    }
}
