//! What a plan says about itself, against what was counted.

use super::{Findings, ViolationKind};
use crate::plan::Claims;

/// What a number may be, both ends included.
pub(super) type Range = (f64, f64);

/// What was counted. Several ranges where there are several ways of counting.
pub(super) struct Counted {
    pub cost: Vec<Range>,
    pub makespan: Vec<Range>,
    pub flowtime: Vec<Range>,
    /// By how much claims may be off.
    pub tolerance: f64,
    /// By which share of themselves claims may be off.
    pub relative: f64,
    /// Last step of the plan, at which violations are reported.
    pub time: f64,
}

/// Reports the claims that are wrong. `weak_bound` is asked only where a bound comes without a lower bound.
pub(super) fn check(
    claims: &Claims,
    counted: &Counted,
    weak_bound: impl FnOnce() -> Option<f64>,
    findings: &mut Findings,
) {
    let slack = |value: f64| counted.tolerance + counted.relative * value.abs();
    let numbers = [
        (ViolationKind::Cost, claims.cost, &counted.cost),
        (ViolationKind::Makespan, claims.makespan, &counted.makespan),
        (ViolationKind::Flowtime, claims.flowtime, &counted.flowtime),
    ];
    for (kind, claim, ranges) in numbers {
        let Some(claim) = claim else { continue };
        let fits = |(low, high): &Range| claim >= low - slack(*low) && claim <= high + slack(*high);
        if !ranges.iter().any(fits) {
            findings.add(kind, counted.time, &[], || {
                let is: Vec<String> = ranges.iter().map(|range| said(*range)).collect();
                format!("the plan claims {claim}, but its {kind} is {}", is.join(" or "))
            });
        }
    }
    let highest = counted.cost.iter().map(|range| range.1).fold(f64::NEG_INFINITY, f64::max);
    let cost = claims.cost.unwrap_or(highest);
    if let Some(lower) = claims.lower_bound
        && !(lower.is_finite() && lower <= cost + slack(cost) && lower <= highest + slack(highest))
    {
        findings.add(ViolationKind::LowerBound, counted.time, &[], || {
            format!("the plan claims that none costs less than {lower}, but it costs {} itself", cost.min(highest))
        });
    }
    let Some(bound) = claims.bound else { return };
    if !(bound.is_finite() && bound >= 1.0) {
        findings.add(ViolationKind::Bound, counted.time, &[], || format!("a bound of {bound} makes no sense"));
        return;
    }
    let (lower, whose) = match claims.lower_bound {
        Some(lower) => (lower, "the claimed lower bound"),
        None => {
            match weak_bound() {
                Some(lower) => (lower, "the shortest ways"),
                None => {
                    findings.add(ViolationKind::Unchecked, counted.time, &[], || {
                    format!("a bound of {bound} is claimed without a lower bound, and the instance is too large for another")
                });
                    return;
                }
            }
        }
    };
    let most = bound * lower;
    // a lower bound that is no number must not pass
    if most.is_nan() || cost > most + slack(most) {
        findings.add(ViolationKind::Bound, counted.time, &[], || {
            format!("the cost {cost} is more than the claimed bound {bound} times {whose} {lower}")
        });
    }
}

fn said((low, high): Range) -> String {
    if low == high { format!("{low}") } else { format!("between {low} and {high}") }
}
