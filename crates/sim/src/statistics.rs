//! Statistics of trials: proportions, quantiles, intervals, paired tests, straight lines.
//!
//! # Source
//! Score interval of a proportion [Wilson1927]; quantiles of type 7 [Hyndman1996]; exact interval of the median from order
//! statistics, exact paired test of proportions [McNemar1947] in its binomial form, percentile bootstrap [Efron1993].
//!
//! # Deviations
//! Intervals are of 95 %, always. An interval of order statistics or of a bootstrap covers at least, or about, that much.
//! What cannot be computed is NaN or `None`, never an error: a cell without successes is no mistake.
//!
//! [Wilson1927]: cohaul_core::_documentation::references
//! [Hyndman1996]: cohaul_core::_documentation::references
//! [McNemar1947]: cohaul_core::_documentation::references
//! [Efron1993]: cohaul_core::_documentation::references

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

mod regression;
#[cfg(test)]
mod tests;

pub use regression::{Estimate, Regression};

/// Samples that the bootstraps of this crate draw.
pub const RESAMPLES: usize = 2000;

/// Probability left out on either side of an interval.
const TAIL: f64 = 0.025;
/// Quantile 1 − [`TAIL`] of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// 95 % interval (low, high) of a proportion of which `successes` of `n` were seen ([Wilson1927]); (0, 1) for `n` = 0.
///
/// ```
/// # use cohaul_sim::statistics::wilson;
/// let (low, high) = wilson(10, 10);
/// assert!((low - 0.7225).abs() < 1e-4 && high == 1.0);
/// ```
///
/// [Wilson1927]: cohaul_core::_documentation::references
pub fn wilson(successes: usize, n: usize) -> (f64, f64) {
    if n == 0 {
        return (0.0, 1.0);
    }
    let (k, n) = (successes.min(n) as f64, n as f64);
    let (p, z2) = (k / n, Z * Z);
    let middle = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
    let half = Z / (1.0 + z2 / n) * (p * (1.0 - p) / n + z2 / (4.0 * n * n)).sqrt();
    // the ends are 0 and 1 exactly, but for rounding
    let low = if k == 0.0 { 0.0 } else { (middle - half).max(0.0) };
    let high = if k == n { 1.0 } else { (middle + half).min(1.0) };
    (low, high)
}

/// Quantile `q` ∈ [0, 1] of ascending values, linear between them (type 7 of [Hyndman1996], the usual one); NaN of none.
///
/// [Hyndman1996]: cohaul_core::_documentation::references
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = last as f64 * q.clamp(0.0, 1.0);
    let below = place.floor() as usize;
    let (low, high) = (sorted[below.min(last)], sorted[(below + 1).min(last)]);
    // equal neighbours give themselves, infinite ones too
    if low == high { low } else { low + (place - below as f64) * (high - low) }
}

/// Median of values in any order; NaN of none.
pub fn median(values: &[f64]) -> f64 {
    quantile(&ascending(values), 0.5)
}

/// The values in ascending order.
pub fn ascending(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// 95 % interval (low, high) of the median of what ascending values are drawn from, whatever the distribution.
///
/// The k-th smallest and the k-th largest value, k the largest with P(Bin(n, ½) < k) ≤ 2.5 %. `None` for fewer than six
/// values, which no such interval covers with 95 %.
pub fn median_interval(sorted: &[f64]) -> Option<(f64, f64)> {
    let n = sorted.len();
    let mut cumulative = 0.0;
    let mut rank = 0; // the interval's ends are the values at `rank` from below and from above, counted from 1
    for below in binomial_half(n) {
        cumulative += below;
        if cumulative > TAIL {
            break;
        }
        rank += 1;
    }
    let first = usize::checked_sub(rank, 1)?;
    Some((*sorted.get(first)?, *sorted.get(n.checked_sub(rank)?)?))
}

/// Mean and standard deviation (of a sample, over n − 1); NaN where there are too few values.
pub fn mean_sd(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = if values.is_empty() { f64::NAN } else { values.iter().sum::<f64>() / n };
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let sd = if values.len() < 2 { f64::NAN } else { (squares / (n - 1.0)).sqrt() };
    (mean, sd)
}

/// 95 % interval (low, high) of a statistic by the percentile bootstrap ([Efron1993]).
///
/// Draws `samples` times `n` indices below `n`, with replacement and from a generator of its own, and gives the 2.5 % and
/// 97.5 % quantiles of what `statistic` makes of them. Samples without a finite statistic are left out; NaN if none is left.
///
/// ```
/// # use cohaul_sim::statistics::{RESAMPLES, bootstrap};
/// let times = [60.0, 62.0, 61.0, 65.0, 59.0];
/// let mean = |drawn: &[usize]| drawn.iter().map(|&i| times[i]).sum::<f64>() / drawn.len() as f64;
/// let (low, high) = bootstrap(RESAMPLES, 0, times.len(), mean);
/// assert!(59.0 < low && low < 61.4 && 61.4 < high && high < 65.0);
/// ```
///
/// [Efron1993]: cohaul_core::_documentation::references
pub fn bootstrap(samples: usize, seed: u64, n: usize, statistic: impl Fn(&[usize]) -> f64) -> (f64, f64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut drawn = vec![0; n];
    let found = (0..samples).map(|_| {
        resample(&mut random, n, &mut drawn);
        statistic(&drawn)
    });
    percentiles(found)
}

/// 95 % bootstrap interval (low, high) of median(a) / median(b), the two drawn independently of each other.
///
/// NaN if one of them is empty.
pub fn ratio_of_medians_interval(a: &[f64], b: &[f64], seed: u64) -> (f64, f64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut drawn_a, mut drawn_b) = (vec![0; a.len()], vec![0; b.len()]);
    let found = (0..RESAMPLES).map(|_| {
        resample(&mut random, a.len(), &mut drawn_a);
        resample(&mut random, b.len(), &mut drawn_b);
        median(&chosen(a, &drawn_a)) / median(&chosen(b, &drawn_b))
    });
    percentiles(found)
}

/// The values at these indices.
pub fn chosen(values: &[f64], indices: &[usize]) -> Vec<f64> {
    indices.iter().filter_map(|&index| values.get(index).copied()).collect()
}

/// Two-sided exact p value of the paired test of two proportions ([McNemar1947]).
///
/// `b` pairs succeeded in the first member only, `c` in the second only; under the hypothesis of no difference each of them
/// falls on either side with probability ½. 1 if there are none.
///
/// ```
/// # use cohaul_sim::statistics::mcnemar_exact;
/// assert_eq!(mcnemar_exact(0, 5), 2.0 / 32.0);
/// ```
///
/// [McNemar1947]: cohaul_core::_documentation::references
pub fn mcnemar_exact(b: usize, c: usize) -> f64 {
    let tail: f64 = binomial_half(b + c).take(b.min(c) + 1).sum();
    (2.0 * tail).min(1.0)
}

/// P(Bin(n, ½) = k) for k = 0, 1, … n.
fn binomial_half(n: usize) -> impl Iterator<Item = f64> {
    // in logarithms, which do not underflow; exact where powers of two are
    let exact = n <= 50;
    let mut choose = 1.0;
    let mut log = -(n as f64) * std::f64::consts::LN_2;
    (0..=n).map(move |k| {
        let value = if exact { choose * 0.5_f64.powi(n as i32) } else { log.exp() };
        let step = (n - k) as f64 / (k + 1) as f64;
        choose = (choose * step).round();
        log += step.ln();
        value
    })
}

fn resample(random: &mut ChaCha8Rng, n: usize, drawn: &mut [usize]) {
    for index in drawn {
        *index = random.random_range(0..n);
    }
}

/// The ends of a percentile interval.
fn percentiles(found: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite: Vec<f64> = found.filter(|value| value.is_finite()).collect();
    let sorted = ascending(&finite);
    (quantile(&sorted, TAIL), quantile(&sorted, 1.0 - TAIL))
}
