//! What the trials of a cell say together.

use std::collections::BTreeMap;

use serde::Serialize;

use super::trials::{Key, Trial, cells, numbers};
use crate::statistics::{ascending, mean_sd, median_interval, quantile, wilson};

/// Mean and standard deviation; `None` where there are too few values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeanSd {
    /// Mean.
    pub mean: Option<f64>,
    /// Standard deviation of a sample.
    pub sd: Option<f64>,
}

impl MeanSd {
    /// Of these values.
    pub fn of(values: &[f64]) -> Self {
        let (mean, sd) = mean_sd(values);
        Self { mean: finite(mean), sd: finite(sd) }
    }
}

/// Summary of a cell; the names are those of `--json`. Times, shares and distances are over the trials that reached the goal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellSummary {
    /// The cell.
    pub key: Key,
    /// Trials.
    pub n: usize,
    /// Those that reached the goal.
    pub reached: usize,
    /// 95 % interval of the probability to reach it.
    pub wilson: [f64; 2],
    /// How many trials ended how.
    pub outcomes: BTreeMap<String, usize>,
    /// Median time, s.
    pub median_time_s: Option<f64>,
    /// Lower quartile of the time, s.
    pub q25_time_s: Option<f64>,
    /// Upper quartile of the time, s.
    pub q75_time_s: Option<f64>,
    /// Mean time, s.
    pub mean_time_s: Option<f64>,
    /// Standard deviation of the time, s.
    pub sd_time_s: Option<f64>,
    /// 95 % interval of the median time, s; `None` for fewer than six.
    pub median_interval_s: Option<[f64; 2]>,
    /// Mean share of the time in which robots reposition themselves.
    pub reposition_share: Option<f64>,
    /// Least distance between the centres of two robots, m.
    pub min_distance_m: MeanSd,
    /// What the paper says of this cell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paper: Option<serde_json::Map<String, serde_json::Value>>,
}

/// One summary a cell, in order of first appearance.
pub fn summarise(trials: &[Trial]) -> Vec<CellSummary> {
    cells(trials).into_iter().map(|(key, members)| cell(key, &members)).collect()
}

fn cell(key: &Key, trials: &[&Trial]) -> CellSummary {
    let mut outcomes = BTreeMap::new();
    for name in trials.iter().filter_map(|trial| trial.outcome()) {
        *outcomes.entry(name.to_owned()).or_insert(0) += 1;
    }
    let reached: Vec<&Trial> = trials.iter().copied().filter(|trial| trial.success()).collect();
    let of = |name: &str| numbers(reached.iter().copied(), name);
    let times = ascending(&of("time_s"));
    let share = |trial: &&Trial| Some(trial.number("reposition_time_s")? / trial.number("time_s")?);
    let shares: Vec<f64> = reached.iter().filter_map(share).filter(|share| share.is_finite()).collect();
    let (low, high) = wilson(reached.len(), trials.len());
    let time = MeanSd::of(&times);
    CellSummary {
        key: key.clone(),
        n: trials.len(),
        reached: reached.len(),
        wilson: [low, high],
        outcomes,
        median_time_s: finite(quantile(&times, 0.5)),
        q25_time_s: finite(quantile(&times, 0.25)),
        q75_time_s: finite(quantile(&times, 0.75)),
        mean_time_s: time.mean,
        sd_time_s: time.sd,
        median_interval_s: median_interval(&times).map(|(low, high)| [low, high]),
        reposition_share: finite(mean_sd(&shares).0),
        min_distance_m: MeanSd::of(&of("min_robot_distance_m")),
        paper: None,
    }
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
