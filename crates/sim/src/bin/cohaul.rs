//! The `cohaul` command.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    // the others are over soon, or have nothing to finish: they end at once
    let finishes = arguments.get(1).is_some_and(|verb| matches!(verb.as_str(), "run" | "reproduce" | "plan"));
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    // without a handler Ctrl-C still ends the process, only less politely
    let _ = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) || !finishes {
            #[expect(clippy::disallowed_methods, reason = "the second Ctrl-C waits for nothing")]
            std::process::exit(cohaul_sim::cli::INTERRUPTED);
        }
    });
    let status = cohaul_sim::cli::main(arguments, &|| interrupted.load(Ordering::Relaxed));
    ExitCode::from(u8::try_from(status).unwrap_or(1))
}
