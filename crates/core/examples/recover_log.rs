//! Makes a valid log of an unfinished or damaged one: `recover_log IN OUT`. Prints what was saved.

use cohaul_core::record::recover;

#[expect(clippy::disallowed_methods, reason = "an example opens its files itself")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(input), Some(output)) = (arguments.next(), arguments.next()) else {
        return Err("usage: recover_log IN OUT".into());
    };
    let report = recover(std::fs::File::open(input)?, std::fs::File::create(output)?)?;
    println!("messages {}", report.messages);
    println!("missing {}", report.missing);
    println!("reason {}", report.lost_reason.as_deref().unwrap_or("none"));
    Ok(())
}
