//! The `cohaul` command.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

fn main() -> ExitCode {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    // without a handler Ctrl-C still ends the process, only less politely
    let _ = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            #[expect(clippy::disallowed_methods, reason = "the second Ctrl-C does not wait for anything")]
            std::process::exit(cohaul_sim::cli::INTERRUPTED);
        }
    });
    let status = cohaul_sim::cli::main(std::env::args().collect(), &|| interrupted.load(Ordering::Relaxed));
    ExitCode::from(u8::try_from(status).unwrap_or(1))
}
