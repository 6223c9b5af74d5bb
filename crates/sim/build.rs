//! Tells the program from which revision of the source it was built.
#![expect(clippy::disallowed_methods, reason = "a build script may ask git")]

use std::process::Command;

fn main() {
    let revision = git(&["describe", "--always", "--abbrev=12", "--exclude=*"]);
    println!("cargo:rustc-env=COHAUL_REVISION={}", revision.as_deref().unwrap_or("unknown"));
    // a path that does not exist would run this again with every build
    println!("cargo:rerun-if-changed=build.rs");
    for name in ["HEAD", "logs/HEAD"] {
        if let Some(path) = git(&["rev-parse", "--path-format=absolute", "--git-path", name])
            && std::path::Path::new(&path).exists()
        {
            println!("cargo:rerun-if-changed={path}");
        }
    }
}

/// What git says about this source, if this is a checkout and there is a git.
fn git(arguments: &[&str]) -> Option<String> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let output = Command::new("git").args(["-C", root]).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok().filter(|_| output.status.success())?;
    Some(text.trim().to_owned())
}
