//! The command, and Ctrl-C while the interpreter waits.

use std::cell::RefCell;

use cohaul_sim::cli;
use pyo3::prelude::*;

/// Runs the command line `argv`, the program's name first, and returns its exit status.
#[pyfunction]
pub fn cli_main(py: Python<'_>, argv: Vec<String>) -> i32 {
    // a command asks again and again; one that was told once must be told the same at its end
    py.detach(|| {
        let signals = RefCell::new(Signals::default());
        cli::main(argv, &|| signals.borrow_mut().are_raised())
    })
}

#[expect(clippy::redundant_closure_for_method_calls, reason = "the method itself does not fit every lifetime")]
fn check_signals() -> PyResult<()> {
    Python::attach(|py| py.check_signals())
}

/// Ctrl-C and other signals whose Python handlers raise.
#[derive(Debug, Default)]
pub struct Signals {
    raised: Option<PyErr>,
}

impl Signals {
    /// Runs the handlers of signals that came in; whether one of them raised. Only Python's main thread ever does.
    pub fn are_raised(&mut self) -> bool {
        // the first one counts: whoever asks again must not lose it
        if self.raised.is_none() {
            self.raised = check_signals().err();
        }
        self.raised.is_some()
    }

    /// # Errors
    /// What a handler raised.
    pub fn check(self) -> PyResult<()> {
        self.raised.map_or(Ok(()), Err)
    }
}
