//! Table I: three terrains, three masses, three coefficients of friction.
//!
//! # Source
//! [R2P2] §V-C, Table I: goal at 45° and 1 m, times of one run per cell.
//!
//! # Deviations
//! - The tolerance is not stated: 0.10 m, as in Table II (b).
//! - The static friction of 0.9 is read as that between wheels and ground; `r2p2-breakaway` runs the other reading, in which a
//!   load at rest breaks away at 0.9 of its weight.
//! - Slopes lie along the load's heading at the start; the paper does not say.
//!
//! [R2P2]: cohaul_core::_documentation::references

use super::design::{Design, SINGLE, Terrain};
use super::table::markdown_table;
use super::trials::{Level, Trial};
use super::verdict::{self, Verdict};
use super::{Experiment, Results, Section, summary_of};
use crate::statistics::{Regression, ascending, median, median_interval};

/// Masses of Table I, kg.
pub(super) const MASSES: [f64; 3] = [0.5, 2.0, 6.0];
/// Its coefficients of friction.
pub(super) const FRICTIONS: [f64; 3] = [0.001, 0.01, 0.1];

/// Mission times of Table I, s: terrain, mass, friction as in [`MASSES`] and [`FRICTIONS`].
const TIMES: [(Terrain, [[f64; 3]; 3]); 3] = [
    (Terrain::Flat, [[77.7, 76.02, 69.91], [85.34, 82.89, 93.64], [116.49, 125.58, 179.2]]),
    (Terrain::Downhill, [[78.49, 62.35, 72.13], [72.34, 77.94, 71.53], [79.97, 79.53, 74.33]]),
    (Terrain::Uphill, [[244.38, 232.81, 267.83], [266.44, 233.26, 268.18], [292.96, 299.59, 323.27]]),
];

/// The 27 missions of Table I.
pub(super) fn table_1() -> Vec<Design> {
    let mut cells = Vec::new();
    for (terrain, by_mass) in TIMES {
        for (mass, by_friction) in MASSES.iter().zip(by_mass) {
            for (friction, time_s) in FRICTIONS.iter().zip(by_friction) {
                let cell = Design::new(SINGLE)
                    .terrain(terrain)
                    .level("mass_kg", *mass)
                    .level("mu", *friction)
                    .set("loads.0.mass", mass)
                    .set("terrain.friction.dynamic", friction)
                    .goal(45.0, 1.0)
                    .paper("time_s", time_s);
                cells.push(cell);
            }
        }
    }
    cells
}

/// `r2p2-generalize`.
pub struct Generalize;

impl Experiment for Generalize {
    fn name(&self) -> &'static str {
        "r2p2-generalize"
    }

    fn about(&self) -> &'static str {
        "Table I: mission time over terrain, mass and friction; goal at 45° and 1 m, tolerance 0.10 m."
    }

    fn cells(&self) -> Vec<Design> {
        table_1()
    }

    fn sections(&self, results: &Results) -> Vec<Section> {
        vec![against_the_paper(results), verdict::section(&self.verdicts(results))]
    }

    fn verdicts(&self, results: &Results) -> Vec<Verdict> {
        let mut verdicts = vec![uphill_slowest(results)];
        verdicts.extend(Terrain::ALL.map(|terrain| time_over_mass(results, terrain)));
        verdicts.extend(Terrain::ALL.map(|terrain| time_over_friction(results, terrain)));
        verdicts
    }
}

/// Which medians lie below the paper's time, and which do not.
fn against_the_paper(results: &Results) -> Section {
    let mut rows = Vec::new();
    let mut slower = Vec::new();
    for cell in &results.cells {
        let Some(paper) = cell.paper.as_ref().and_then(|p| p.get("time_s")).and_then(serde_json::Value::as_f64) else {
            continue;
        };
        let times: Vec<f64> = results.reached(&cell.key).map(|t| t.number("time_s").unwrap_or(f64::NAN)).collect();
        let interval = median_interval(&ascending(&times));
        let median = median(&times);
        if median.is_nan() || median >= paper {
            slower.push(cell.key.to_string());
        }
        let share = cell.reposition_share.unwrap_or(0.0);
        let mut row: Vec<String> = cell.key.iter().map(|(_, level)| level.to_string()).collect();
        row.push(format!("{median:.1}"));
        row.push(interval.map_or_else(|| "–".to_owned(), |(low, high)| format!("{low:.1} to {high:.1}")));
        row.push(format!("{:.0} %", 100.0 * share));
        row.push(format!("{paper:.1}"));
        row.push(format!("{:.2}", median / paper));
        rows.push(row);
    }
    let header =
        ["terrain", "mass kg", "µ", "median s", "95 % of the median", "repositioning", "paper s", "median ÷ paper"];
    let summary = if slower.is_empty() {
        "The median lies below the paper's time in every cell.".to_owned()
    } else {
        format!("Not below the paper's time: {}.", slower.join("; "))
    };
    Section::text("Times against Table I", format!("{summary}\n\n{}", markdown_table(&header, &rows)))
}

fn of_terrain(results: &Results, terrain: Terrain) -> Vec<&Trial> {
    let wanted = Level::from(terrain.name());
    results.trials.iter().filter(|t| t.success() && t.key.level("terrain") == Some(&wanted)).collect()
}

/// "… it is observed that the mission time increases with mass" on flat ground and uphill, not downhill.
fn time_over_mass(results: &Results, terrain: Terrain) -> Verdict {
    let statement = match terrain {
        Terrain::Downhill => "downhill the mission time shows no trend with mass",
        Terrain::Flat => "on flat ground the mission time grows with mass",
        Terrain::Uphill => "uphill the mission time grows with mass",
    };
    let trials = of_terrain(results, terrain);
    let (x, y): (Vec<f64>, Vec<f64>) = trials
        .iter()
        .filter_map(|t| match t.key.level("mass_kg") {
            Some(Level::Number(mass)) => Some((*mass, t.number("time_s")?)),
            _ => None,
        })
        .unzip();
    let Some(fit) = Regression::fit(&x, &y, results.seed) else { return Verdict::unknown(statement) };
    let grows = fit.slope.low > 0.0;
    let agrees = if terrain == Terrain::Downhill { !fit.slope.excludes(0.0) } else { grows };
    let curved = fit.curvature.as_ref().is_some_and(|c| c.excludes(0.0));
    let evidence = format!(
        "slope {:+.3} s/kg, 95 % {:+.3} to {:+.3}, R² {:.2}, n {}; {}",
        fit.slope.value,
        fit.slope.low,
        fit.slope.high,
        fit.r2,
        fit.n,
        if curved { "the quadratic term differs from 0: not linear" } else { "no curvature seen" }
    );
    Verdict { statement: statement.to_owned(), agrees: Some(agrees), evidence }
}

/// "No monotone effect": the regression on the logarithm of the friction has no slope.
fn time_over_friction(results: &Results, terrain: Terrain) -> Verdict {
    let statement = format!("{}: friction has no monotone effect on the mission time", terrain.name());
    let (x, y): (Vec<f64>, Vec<f64>) = of_terrain(results, terrain)
        .iter()
        .filter_map(|t| match t.key.level("mu") {
            Some(Level::Number(friction)) => Some((friction.log10(), t.number("time_s")?)),
            _ => None,
        })
        .unzip();
    let Some(fit) = Regression::fit(&x, &y, results.seed) else { return Verdict::unknown(&statement) };
    let medians: Vec<String> = FRICTIONS
        .iter()
        .map(|friction| {
            let of_level = x.iter().zip(&y).filter(|(x, _)| **x == friction.log10()).map(|(_, y)| *y);
            format!("µ {friction}: {:.1} s", median(&of_level.collect::<Vec<_>>()))
        })
        .collect();
    let evidence = format!(
        "slope {:+.2} s per decade of µ, 95 % {:+.2} to {:+.2}, n {}; medians {}",
        fit.slope.value,
        fit.slope.low,
        fit.slope.high,
        fit.n,
        medians.join(", ")
    );
    Verdict { statement, agrees: Some(!fit.slope.excludes(0.0)), evidence }
}

fn uphill_slowest(results: &Results) -> Verdict {
    let statement = "uphill takes longest, in every cell of mass and friction";
    let median = |terrain: Terrain, mass: f64, mu: f64| {
        let key = [("terrain", terrain.name().into()), ("mass_kg", mass.into()), ("mu", mu.into())];
        summary_of(results, &key).and_then(|cell| cell.median_time_s)
    };
    let mut slowest = 0;
    let mut counted = 0;
    for mass in MASSES {
        for mu in FRICTIONS {
            let times = Terrain::ALL.map(|terrain| median(terrain, mass, mu));
            if let [Some(flat), Some(down), Some(up)] = times {
                counted += 1;
                slowest += usize::from(up > flat && up > down);
            }
        }
    }
    if counted < MASSES.len() * FRICTIONS.len() {
        return Verdict::unknown(statement);
    }
    let medians: Vec<String> = Terrain::ALL
        .iter()
        .map(|terrain| {
            let times: Vec<f64> = of_terrain(results, *terrain).iter().filter_map(|t| t.number("time_s")).collect();
            format!("{} {:.1} s", terrain.name(), crate::statistics::median(&times))
        })
        .collect();
    let evidence = format!("slowest in {slowest} of {counted} cells; medians over all: {}", medians.join(", "));
    Verdict { statement: statement.to_owned(), agrees: Some(slowest == counted), evidence }
}
