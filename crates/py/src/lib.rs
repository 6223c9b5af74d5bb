//! Python extension module `cohaul._cohaul`: conversions and exceptions around `cohaul-sim`, no logic.
#![expect(clippy::needless_pass_by_value, reason = "arguments of Python functions are owned")]

mod command;
mod contact;
mod convert;
mod curve;
mod error;
mod experiment;
mod flow;
mod log;
mod mission;
mod planning;

/// What the Python package `cohaul` is made of. Import `cohaul` instead.
#[pyo3::pymodule]
mod _cohaul {
    #[pymodule_export]
    const VERSION: &str = cohaul_sim::mission::VERSION;
    #[pymodule_export]
    const REVISION: &str = cohaul_sim::mission::REVISION;

    #[pymodule_export]
    use crate::command::cli_main;
    #[pymodule_export]
    use crate::contact::LimitSurface;
    #[pymodule_export]
    use crate::curve::{Assignments, ShortestCurve, dubins_curve, optimal_assignment, reeds_shepp_curve};
    #[pymodule_export]
    use crate::experiment::{experiments, reproduce};
    #[pymodule_export]
    use crate::flow::flow;
    #[pymodule_export]
    use crate::log::{Recording, compare, recover, replay};
    #[pymodule_export]
    use crate::mission::{Mission, Scenario, schema};
    #[pymodule_export]
    use crate::planning::{Instance, Planned, generate_instance};
}
