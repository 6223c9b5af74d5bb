//! Rust errors as the exceptions of `python/cohaul/errors.py`.

use std::io::ErrorKind;

use cohaul_core::geometry::shape::ShapeError;
use cohaul_core::record::RecordError;
use cohaul_core::scenario::{ScenarioError, Warning};
use cohaul_planner::io::FormatError;
use cohaul_sim::compare::CompareError;
use cohaul_sim::error::{SimError, chain};
use cohaul_sim::experiment::trials::TrialError;
use cohaul_sim::files::FileError;
use pyo3::PyErr;

/// The exceptions that Python code defines.
mod python {
    pyo3::import_exception!(cohaul.errors, CompareError);
    pyo3::import_exception!(cohaul.errors, ContactError);
    pyo3::import_exception!(cohaul.errors, ControlError);
    pyo3::import_exception!(cohaul.errors, ExperimentError);
    pyo3::import_exception!(cohaul.errors, FileError);
    pyo3::import_exception!(cohaul.errors, InstanceError);
    pyo3::import_exception!(cohaul.errors, MissingFileError);
    pyo3::import_exception!(cohaul.errors, PlanError);
    pyo3::import_exception!(cohaul.errors, RecordError);
    pyo3::import_exception!(cohaul.errors, ScenarioError);
    pyo3::import_exception!(cohaul.errors, ScenarioWarning);
    pyo3::import_exception!(cohaul.errors, SimError);
}

/// Arguments of an exception that knows its place in a scenario.
macro_rules! place {
    ($problem:expr) => {{
        let p = $problem;
        let file = p.file().to_owned();
        (p.to_string(), p.message(), file, p.line(), p.column(), p.remedy(), p.overrides().to_vec())
    }};
}

pub fn scenario(error: &ScenarioError) -> PyErr {
    python::ScenarioError::new_err(place!(error))
}

pub fn warning(warning: &Warning) -> PyErr {
    python::ScenarioWarning::new_err(place!(warning))
}

/// A planning instance or a plan that is refused.
fn instance(error: &FormatError) -> PyErr {
    let (text, message) = (error.to_string(), error.message());
    let file = error.file().to_owned();
    python::InstanceError::new_err((text, message, file, error.line(), error.column(), error.remedy()))
}

/// A value that planning cannot take.
pub fn plan(message: String) -> PyErr {
    python::PlanError::new_err(message)
}

/// A value or an array that the contact model cannot take.
pub fn contact(message: String) -> PyErr {
    python::ContactError::new_err(message)
}

pub fn shape(error: &ShapeError) -> PyErr {
    contact(error.to_string())
}

pub fn file(error: FileError) -> PyErr {
    match error {
        FileError::Scenario(error) => scenario(&error),
        FileError::Sim(error) => sim(&error),
        FileError::Format(error) => instance(&error),
        FileError::Formation(_)
        | FileError::LoadPath(_)
        | FileError::Capacity(_)
        | FileError::Reform(_)
        | FileError::Generate(_) => python::PlanError::new_err(chain(&error)),
        FileError::Io { source, path, .. } if source.kind() == ErrorKind::NotFound => {
            python::MissingFileError::new_err((source.raw_os_error(), reason(&source), path.into_os_string()))
        }
        FileError::Io { source, path, .. } => {
            python::FileError::new_err((source.raw_os_error(), reason(&source), path.into_os_string()))
        }
        FileError::Trials(error @ (TrialError::Other { .. } | TrialError::Busy { .. })) => experiment(chain(&error)),
        error => python::FileError::new_err(chain(&error)),
    }
}

/// An experiment that does not exist, or a folder that holds other trials.
pub fn experiment(message: String) -> PyErr {
    python::ExperimentError::new_err(message)
}

/// Results that do not fit together.
pub fn compare(error: CompareError) -> PyErr {
    match error {
        CompareError::File(error) => file(error),
        error => python::CompareError::new_err(chain(&error)),
    }
}

pub fn sim(error: &SimError) -> PyErr {
    let text = chain(error);
    match error {
        SimError::Parse(error) => scenario(error),
        SimError::Control(_) => python::ControlError::new_err(text),
        SimError::Record(RecordError::Io(_)) => python::FileError::new_err(text),
        SimError::Record(_) => python::RecordError::new_err(text),
        _ => python::SimError::new_err(text),
    }
}

/// What the system says, without the number that Rust puts behind it.
fn reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_owned()
}
