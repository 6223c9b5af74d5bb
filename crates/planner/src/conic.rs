//! Convex programs: linear, quadratic, with second-order cones.
//!
//! The only door to the solver. A program is built from variables and affine expressions, solved once, and gives the optimal
//! point or says why there is none. Solving is silent, single-threaded and the same from run to run.
//!
//! ```
//! use cohaul_planner::conic::{Affine, Program};
//!
//! // the point of the unit disc that lies farthest along (3, 4)
//! let mut program = Program::new();
//! let (x, y) = (program.variable(), program.variable());
//! program.within(Affine::constant(1.0), &[x.into(), y.into()]);
//! program.minimize(-3.0 * x - 4.0 * y);
//! let solution = program.solve()?;
//! assert!((solution.value + 5.0).abs() < 1e-6);
//! assert!((solution[x] - 0.6).abs() < 1e-6);
//! # Ok::<(), cohaul_planner::conic::ConicError>(())
//! ```
//!
//! # Source
//! [Clarabel]: an interior-point method with a homogeneous embedding, which tells infeasible and unbounded programs apart.
//!
//! # Deviations
//! None. What the solver calls a solution of reduced accuracy counts as one: its residuals are still below 1e-4.
//!
//! [Clarabel]: cohaul_core::_documentation::references

use std::ops::{Add, Index, Mul, Neg, Sub};

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT, SolverStatus, SupportedConeT,
    ZeroConeT,
};

/// A variable of one program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variable(usize);

/// An inequality of one program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inequality(usize);

/// Σ aᵢ xᵢ + c.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Affine {
    terms: Vec<(usize, f64)>,
    constant: f64,
}

impl Affine {
    /// The number `value`.
    pub const fn constant(value: f64) -> Self {
        Self { terms: Vec::new(), constant: value }
    }

    /// Adds `factor` times `variable`.
    pub fn push(&mut self, factor: f64, variable: Variable) {
        self.terms.push((variable.0, factor));
    }

    /// Its value at `point`.
    fn at(&self, point: &[f64]) -> f64 {
        self.constant + self.terms.iter().map(|(i, a)| a * point.get(*i).copied().unwrap_or_default()).sum::<f64>()
    }
}

impl From<Variable> for Affine {
    fn from(variable: Variable) -> Self {
        Self { terms: vec![(variable.0, 1.0)], constant: 0.0 }
    }
}

impl Mul<Variable> for f64 {
    type Output = Affine;
    fn mul(self, variable: Variable) -> Affine {
        Affine { terms: vec![(variable.0, self)], constant: 0.0 }
    }
}

impl Mul<Affine> for f64 {
    type Output = Affine;
    fn mul(self, mut right: Affine) -> Affine {
        right.constant *= self;
        for (_, factor) in &mut right.terms {
            *factor *= self;
        }
        right
    }
}

impl<T: Into<Affine>> Add<T> for Affine {
    type Output = Affine;
    fn add(mut self, right: T) -> Affine {
        let right = right.into();
        self.terms.extend(right.terms);
        self.constant += right.constant;
        self
    }
}

impl<T: Into<Affine>> Sub<T> for Affine {
    type Output = Affine;
    fn sub(self, right: T) -> Affine {
        self + -1.0 * right.into()
    }
}

impl Neg for Affine {
    type Output = Affine;
    fn neg(self) -> Affine {
        -1.0 * self
    }
}

impl From<f64> for Affine {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

/// Why a program has no optimal point.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ConicError {
    /// No point satisfies all constraints.
    #[error("no point satisfies the constraints ({status})")]
    Infeasible {
        /// What the solver says.
        status: String,
    },
    /// The objective falls without end.
    #[error("the objective is unbounded ({status})")]
    Unbounded {
        /// What the solver says.
        status: String,
    },
    /// The solver gave up.
    #[error("the solver gave up ({status})")]
    Failed {
        /// What the solver says.
        status: String,
    },
}

/// The optimal point of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    point: Vec<f64>,
    multipliers: Vec<f64>,
    /// The objective there.
    pub value: f64,
}

impl Solution {
    /// Value of `expression` at the optimal point.
    pub fn at(&self, expression: &Affine) -> f64 {
        expression.at(&self.point)
    }

    /// By how much the optimal value falls per unit by which `inequality` is relaxed: ≥ 0, and 0 where it does not bind.
    pub fn multiplier(&self, inequality: Inequality) -> f64 {
        self.multipliers.get(inequality.0).copied().unwrap_or_default()
    }
}

impl Index<Variable> for Solution {
    type Output = f64;
    fn index(&self, variable: Variable) -> &f64 {
        &self.point[variable.0]
    }
}

/// A convex program under construction.
#[derive(Clone, Debug, Default)]
pub struct Program {
    variables: usize,
    objective: Affine,
    /// Weight and expression of every square in the objective.
    squares: Vec<(f64, Affine)>,
    zeros: Vec<Affine>,
    nonnegatives: Vec<Affine>,
    cones: Vec<Vec<Affine>>,
}

impl Program {
    /// Without variables and constraints.
    pub fn new() -> Self {
        Self::default()
    }

    /// A new free variable.
    pub fn variable(&mut self) -> Variable {
        self.variables += 1;
        Variable(self.variables - 1)
    }

    /// Requires `expression` = 0.
    pub fn zero(&mut self, expression: Affine) {
        self.zeros.push(expression);
    }

    /// Requires `expression` ≥ 0.
    pub fn nonnegative(&mut self, expression: Affine) -> Inequality {
        self.nonnegatives.push(expression);
        Inequality(self.nonnegatives.len() - 1)
    }

    /// Requires that the Euclidean norm of `parts` is at most `bound`.
    pub fn within(&mut self, bound: Affine, parts: &[Affine]) {
        self.cones.push([&[bound], parts].concat());
    }

    /// Adds `expression` to what is minimised.
    pub fn minimize(&mut self, expression: impl Into<Affine>) {
        let sum = std::mem::take(&mut self.objective);
        self.objective = sum + expression.into();
    }

    /// Adds `weight` · `expression`² to what is minimised; a negative weight counts as 0, for it would not be convex.
    pub fn minimize_square(&mut self, weight: f64, expression: Affine) {
        self.squares.push((weight.max(0.0), expression));
    }

    /// The optimal point.
    ///
    /// # Errors
    /// A program that is infeasible or unbounded, or numbers that the solver cannot cope with.
    pub fn solve(&self) -> Result<Solution, ConicError> {
        let n = self.variables;
        let mut linear = vec![0.0; n];
        for (i, factor) in &self.objective.terms {
            linear[*i] += factor;
        }
        let mut offset = self.objective.constant;
        // the solver's objective is ½ xᵀPx + qᵀx, P given by its upper triangle
        let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for (weight, expression) in &self.squares {
            for (i, a) in &expression.terms {
                linear[*i] += 2.0 * weight * expression.constant * a;
                for (j, b) in &expression.terms {
                    if i <= j {
                        rows.push(*i);
                        columns.push(*j);
                        values.push(2.0 * weight * a * b);
                    }
                }
            }
            offset += weight * expression.constant * expression.constant;
        }
        let quadratic = CscMatrix::new_from_triplets(n, n, rows, columns, values);

        // a·x + c in a cone is written b − A x with A = −a, b = c
        let mut cones: Vec<SupportedConeT<f64>> = Vec::new();
        let (mut rows, mut columns, mut values, mut right) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut add = |expressions: &[Affine]| {
            for expression in expressions {
                for (i, factor) in &expression.terms {
                    rows.push(right.len());
                    columns.push(*i);
                    values.push(-factor);
                }
                right.push(expression.constant);
            }
        };
        add(&self.zeros);
        cones.extend((!self.zeros.is_empty()).then_some(ZeroConeT(self.zeros.len())));
        add(&self.nonnegatives);
        cones.extend((!self.nonnegatives.is_empty()).then_some(NonnegativeConeT(self.nonnegatives.len())));
        for cone in &self.cones {
            add(cone);
            cones.push(SecondOrderConeT(cone.len()));
        }
        let constraints = CscMatrix::new_from_triplets(right.len(), n, rows, columns, values);

        let settings = DefaultSettings {
            verbose: false,
            max_threads: 1,
            direct_solve_method: "qdldl".to_owned(),
            ..DefaultSettings::default()
        };
        let failed = |status: String| ConicError::Failed { status };
        let mut solver = DefaultSolver::new(&quadratic, &linear, &constraints, &right, &cones, settings)
            .map_err(|error| failed(error.to_string()))?;
        solver.solve();
        let status = format!("{:?}", solver.solution.status);
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {
                let point = std::mem::take(&mut solver.solution.x);
                let first = self.zeros.len();
                let multipliers = solver.solution.z[first..first + self.nonnegatives.len()].to_vec();
                Ok(Solution { point, multipliers, value: solver.solution.obj_val + offset })
            }
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                Err(ConicError::Infeasible { status })
            }
            SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => Err(ConicError::Unbounded { status }),
            _ => Err(failed(status)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_program_ends_in_its_corner() {
        // max x + y with x + 2y ≤ 4, 3x + y ≤ 6: the corner (1.6, 1.2)
        let mut program = Program::new();
        let (x, y) = (program.variable(), program.variable());
        let first = program.nonnegative(Affine::constant(4.0) - x - 2.0 * y);
        program.nonnegative(Affine::constant(6.0) - 3.0 * x - y);
        program.minimize(-1.0 * x - y);
        let solution = program.solve().unwrap();
        assert!((solution.value + 2.8).abs() < 1e-6);
        assert!((solution[x] - 1.6).abs() < 1e-6 && (solution[y] - 1.2).abs() < 1e-6);
        // one unit more on the right of the first moves the corner by (-0.2, 0.6)
        assert!((solution.multiplier(first) - 0.4).abs() < 1e-6);
    }

    #[test]
    fn a_quadratic_program_projects_a_point_on_a_line() {
        // nearest point to (3, 1) on x = y: (2, 2), at the squared distance 2
        let mut program = Program::new();
        let (x, y) = (program.variable(), program.variable());
        program.zero(1.0 * x - y);
        program.minimize_square(1.0, Affine::from(x) - 3.0);
        program.minimize_square(1.0, Affine::from(y) - 1.0);
        let solution = program.solve().unwrap();
        assert!((solution.value - 2.0).abs() < 1e-6, "{}", solution.value);
        assert!((solution[x] - 2.0).abs() < 1e-6 && (solution[y] - 2.0).abs() < 1e-6);
    }

    #[test]
    fn impossible_and_endless_programs_are_told_apart() {
        let mut program = Program::new();
        let x = program.variable();
        program.minimize(x);
        program.nonnegative(Affine::constant(1.0) - x);
        assert!(matches!(program.solve(), Err(ConicError::Unbounded { .. })));
        program.nonnegative(Affine::from(x) - 2.0);
        assert!(matches!(program.solve(), Err(ConicError::Infeasible { .. })));
    }

    #[test]
    fn the_same_program_gives_the_same_bits() {
        let solve = || {
            let mut program = Program::new();
            let v: Vec<_> = (0..5).map(|_| program.variable()).collect();
            let parts: Vec<Affine> = v.iter().map(|x| Affine::from(*x) - 0.3).collect();
            program.within(Affine::constant(1.0), &parts);
            program.minimize(0.2 * v[0] + 0.7 * v[1] - 0.4 * v[2] + 0.1 * v[3] - v[4]);
            program.solve().unwrap()
        };
        assert_eq!(solve(), solve());
    }
}
