//! What is said about an answer: names for programs, rows for people.

use cohaul_planner::certify::Violation;
use cohaul_planner::instance::Instance;
use cohaul_planner::outcome::Outcome;
use cohaul_planner::plan::Claims;
use serde_json::{Value, json};

use super::{Answer, AnyPlan, explain, kind, name};

/// Why there is no plan: the kind of reason, the names of the agents, and the same in words.
pub fn reasons(answer: &Answer, instance: &Instance) -> Vec<Value> {
    let Outcome::Infeasible(reasons) = &answer.outcome else { return Vec::new() };
    let listed = reasons.iter().map(|reason| {
        let agents: Vec<String> = reason.agents().iter().map(|agent| name(instance, *agent)).collect();
        json!({"kind": kind(reason), "agents": agents, "detail": explain(reason, instance)})
    });
    listed.collect()
}

/// What is wrong with a plan, by the names of the agents.
pub fn violations(violations: &[Violation], instance: &Instance) -> Value {
    let listed = violations.iter().map(|violation| {
        let agents: Vec<String> = violation.agents.iter().map(|agent| name(instance, *agent)).collect();
        json!({"kind": violation.kind.name(), "time": violation.time, "agents": agents, "detail": violation.detail})
    });
    listed.collect()
}

/// How a search ended, for programs.
pub const fn status(outcome: &Outcome<AnyPlan>) -> &'static str {
    match outcome {
        Outcome::Solved(_) => "solved",
        Outcome::Infeasible(_) => "infeasible",
        Outcome::BudgetSpent { .. } => "budget_spent",
    }
}

/// Why there is no plan, in a line.
fn reason(answer: &Answer, reasons: &[Value], timeout: f64) -> Option<String> {
    match &answer.outcome {
        Outcome::Solved(_) => None,
        Outcome::Infeasible(_) => {
            let details: Vec<&str> = reasons.iter().filter_map(|reason| reason["detail"].as_str()).collect();
            Some(details.join("; "))
        }
        Outcome::BudgetSpent { .. } => {
            Some(format!("stopped before an answer was found (limit {timeout} s of CPU time or 4 GiB of memory)"))
        }
    }
}

/// The outcome with its numbers, by the names of `cohaul plan --json`.
pub fn summary(answer: &Answer, reasons: &[Value], timeout: f64) -> Value {
    let claims = match &answer.outcome {
        Outcome::Solved(plan) => *plan.claims(),
        Outcome::BudgetSpent { best_bound } => Claims { lower_bound: Some(*best_bound), ..Claims::default() },
        Outcome::Infeasible(_) => Claims::default(),
    };
    json!({
        "status": status(&answer.outcome),
        "reason": reason(answer, reasons, timeout),
        "reasons": reasons,
        "cost": claims.cost,
        "lower_bound": claims.lower_bound,
        "bound": claims.bound,
        "makespan": claims.makespan,
        "flowtime": claims.flowtime,
        "runtime_s": answer.runtime,
        "high_level_expanded": answer.effort.high_level_expanded,
        "low_level_expanded": answer.effort.low_level_expanded,
        "assignments": answer.effort.assignments,
    })
}

/// Label and value of every row of the table of results.
pub fn rows(answer: &Answer, reasons: &[Value], timeout: f64) -> Vec<(&'static str, String)> {
    let mut rows = vec![("status", status(&answer.outcome).replace('_', " "))];
    if reasons.is_empty() {
        rows.extend(reason(answer, reasons, timeout).map(|reason| ("because", reason)));
    }
    let details = reasons.iter().filter_map(|reason| reason["detail"].as_str());
    rows.extend(details.map(|detail| ("because", detail.to_owned())));
    if let Outcome::BudgetSpent { best_bound } = &answer.outcome {
        rows.push(("lower bound", three_digits(*best_bound)));
    }
    if let Outcome::Solved(plan) = &answer.outcome {
        let claims = plan.claims();
        let numbers = [
            ("cost", claims.cost),
            ("lower bound", claims.lower_bound),
            ("makespan", claims.makespan),
            ("flowtime", claims.flowtime),
        ];
        // three digits are enough for people; files have all of them
        rows.extend(numbers.into_iter().filter_map(|(label, value)| Some((label, three_digits(value?)))));
    }
    let effort = answer.effort;
    rows.push((
        "expanded",
        format!("{} high level, {} low level", effort.high_level_expanded, effort.low_level_expanded),
    ));
    rows.push(("CPU time", format!("{:.4} s", answer.runtime)));
    rows
}

fn three_digits(value: f64) -> String {
    if value.fract() == 0.0 { value.to_string() } else { format!("{value:.3}") }
}
