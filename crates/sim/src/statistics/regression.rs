//! Straight lines through points, and whether they are bent.
//!
//! # Source
//! Least squares; intervals by the bootstrap of points ([Efron1993]), which asks nothing of the errors.
//!
//! # Deviations
//! The quadratic term is found as the coefficient of a polynomial orthogonal to the line on the given points: the same
//! number as by a fit of three coefficients, without its ill-conditioned equations.
//!
//! [Efron1993]: cohaul_core::_documentation::references

use serde::Serialize;

use super::{RESAMPLES, bootstrap};

/// A number with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Estimate {
    /// Whether the interval leaves out `value`: the difference from it is significant at 5 %.
    pub fn excludes(&self, value: f64) -> bool {
        value < self.low || value > self.high
    }
}

/// Least squares of y on x: y = intercept + slope · x, with a test of whether a parabola would fit better.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Regression {
    /// Points.
    pub n: usize,
    /// Slope, units of y per unit of x.
    pub slope: Estimate,
    /// y at x = 0.
    pub intercept: f64,
    /// Share of the variance of y that the line explains; NaN if all y are equal.
    pub r2: f64,
    /// Coefficient of x² in the parabola of least squares; its sign is that of the bend, and the relation is not straight
    /// where its interval excludes 0. `None` for fewer than three different x.
    pub curvature: Option<Estimate>,
}

impl Regression {
    /// Through the points (x, y), pair by pair; the seed is that of the bootstraps. `None` for fewer than two different x, or a
    /// value that is not finite. What one list has more than the other is left out.
    pub fn fit(x: &[f64], y: &[f64], seed: u64) -> Option<Self> {
        let points: Vec<[f64; 2]> = x.iter().zip(y).map(|(x, y)| [*x, *y]).collect();
        if points.iter().flatten().any(|value| !value.is_finite()) {
            return None;
        }
        let all: Vec<usize> = (0..points.len()).collect();
        let moments = Moments::of(&points, &all);
        let slope = moments.slope()?;
        let residuals: f64 = points.iter().map(|[x, y]| (y - moments.y - slope * (x - moments.x)).powi(2)).sum();
        let total: f64 = points.iter().map(|[_, y]| (y - moments.y).powi(2)).sum();
        let estimate = |value: f64, statistic: fn(&Moments) -> Option<f64>| {
            let again = |drawn: &[usize]| statistic(&Moments::of(&points, drawn)).unwrap_or(f64::NAN);
            let (low, high) = bootstrap(RESAMPLES, seed, points.len(), again);
            Estimate { value, low, high }
        };
        Some(Self {
            n: points.len(),
            slope: estimate(slope, Moments::slope),
            intercept: moments.y - slope * moments.x,
            r2: if total > 0.0 { 1.0 - residuals / total } else { f64::NAN },
            curvature: moments.curvature().map(|value| estimate(value, Moments::curvature)),
        })
    }

    /// y on the line at `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.intercept + self.slope.value * x
    }
}

/// Means, and sums over u = (x − mean) / spread and v = y − mean.
struct Moments {
    n: f64,
    x: f64,
    y: f64,
    spread: f64,
    u2: f64,
    u3: f64,
    u4: f64,
    uv: f64,
    u2v: f64,
    different: usize,
}

impl Moments {
    fn of(points: &[[f64; 2]], chosen: &[usize]) -> Self {
        let n = chosen.len() as f64;
        let taken = || chosen.iter().map(|&index| points[index]);
        let x = taken().map(|[x, _]| x).sum::<f64>() / n;
        let y = taken().map(|[_, y]| y).sum::<f64>() / n;
        let spread = taken().map(|[px, _]| (px - x).abs()).fold(0.0, f64::max);
        let mut moments = Self { n, x, y, spread, u2: 0.0, u3: 0.0, u4: 0.0, uv: 0.0, u2v: 0.0, different: 0 };
        for [px, py] in taken() {
            let (u, v) = ((px - x) / spread, py - y);
            moments.u2 += u * u;
            moments.u3 += u * u * u;
            moments.u4 += u * u * u * u;
            moments.uv += u * v;
            moments.u2v += u * u * v;
        }
        // three different x are as good as many
        let mut seen: Vec<f64> = Vec::with_capacity(3);
        for [px, _] in taken() {
            if seen.len() < 3 && !seen.contains(&px) {
                seen.push(px);
            }
        }
        moments.different = seen.len();
        moments
    }

    fn slope(&self) -> Option<f64> {
        (self.different >= 2).then(|| self.uv / self.u2 / self.spread)
    }

    /// With p(u) = u² − a u − b orthogonal to 1 and u: Σ p v / Σ p².
    fn curvature(&self) -> Option<f64> {
        if self.different < 3 {
            return None;
        }
        let a = self.u3 / self.u2;
        let squares = self.u4 - a * self.u3 - self.u2 * self.u2 / self.n;
        let products = self.u2v - a * self.uv; // Σ v = 0
        Some(products / squares / (self.spread * self.spread))
    }
}
