//! The arrows between the crates, the doors to foreign libraries, and the size of files (ARCHITECTURE.md).

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package, PackageId};

/// Which crates of the workspace a crate may depend on. `cohaul-tests` may use all of them.
const ARROWS: [(&str, &[&str]); 5] = [
    ("cohaul-core", &[]),
    ("cohaul-planner", &["cohaul-core"]),
    ("cohaul-sim", &["cohaul-core", "cohaul-planner"]),
    ("cohaul-agent", &["cohaul-core", "cohaul-planner"]),
    ("cohaul-py", &["cohaul-core", "cohaul-planner", "cohaul-sim"]),
];
const TESTS: &str = "cohaul-tests";

const ENGINES: &[&str] = &["rapier2d", "rapier3d", "rapier2d-f64", "rapier3d-f64"];
const SOLVERS: &[&str] = &["clarabel", "osqp"];
const ASYNC: &[&str] =
    &["tokio", "async-std", "async-executor", "async-io", "smol", "futures", "futures-executor", "mio", "polling"];
const THREADS: &[&str] = &["rayon", "rayon-core", "crossbeam-channel", "threadpool"];
const CLOCKS: &[&str] = &["chrono", "time", "jiff", "cpu-time"];
const FILES: &[&str] = &["tempfile", "walkdir", "memmap2", "notify", "dirs"];
const RANDOM: &[&str] = &["rand", "rand_core", "getrandom", "fastrand"];
const ROS: &[&str] = &["ros2-client", "rustdds"];

/// What a crate never reaches, however long the way.
const NEVER: [(&str, &[&[&str]]); 5] = [
    ("cohaul-core", &[ENGINES, SOLVERS, ASYNC, THREADS, CLOCKS, FILES, RANDOM, ROS]),
    ("cohaul-planner", &[ENGINES, ROS, ASYNC]),
    ("cohaul-sim", &[ROS, ASYNC]),
    ("cohaul-agent", &[ENGINES]),
    ("cohaul-py", &[ROS, ASYNC]),
];

/// Libraries whose types stay behind one door: name in the source, and where it may stand.
const DOORS: [(&str, &[&str]); 4] = [
    ("parry2d_f64", &["crates/core/src/geometry/query.rs"]),
    ("glam", &["crates/core/src/geometry/query.rs", "crates/sim/src/world/"]),
    ("rapier", &["crates/sim/src/world/"]),
    ("clarabel", &["crates/planner/src/conic.rs"]),
];

/// Lines after which a file is split.
const LONGEST_FILE: usize = 600;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// What cargo prints.
fn run(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO")).current_dir(root()).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn metadata() -> Metadata {
    // of this platform only: the others' packages need not have been downloaded
    let version = run(&["-vV"]);
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let options = ["--locked", "--filter-platform", host].map(String::from).to_vec();
    MetadataCommand::new().manifest_path(root().join("Cargo.toml")).other_options(options).exec().unwrap()
}

/// Packages that `package` reaches over normal dependencies, itself left out.
fn reached<'a>(metadata: &'a Metadata, package: &'a Package) -> BTreeSet<&'a str> {
    let nodes: BTreeMap<&PackageId, _> =
        metadata.resolve.as_ref().unwrap().nodes.iter().map(|node| (&node.id, node)).collect();
    let mut seen = BTreeSet::from([&package.id]);
    let mut open = vec![&package.id];
    while let Some(id) = open.pop() {
        for dependency in &nodes[id].deps {
            let normal = dependency.dep_kinds.iter().any(|kind| kind.kind == DependencyKind::Normal);
            if normal && seen.insert(&dependency.pkg) {
                open.push(&dependency.pkg);
            }
        }
    }
    seen.remove(&package.id);
    seen.into_iter().map(|id| metadata[id].name.as_str()).collect()
}

/// Direct dependencies of any kind, development included.
fn direct(package: &Package) -> BTreeSet<&str> {
    package.dependencies.iter().map(|dependency| dependency.name.as_str()).collect()
}

#[test]
fn crates_depend_only_along_the_arrows() {
    let metadata = metadata();
    let arrows = BTreeMap::from(ARROWS);
    for package in metadata.workspace_packages() {
        let name = package.name.as_str();
        if name == TESTS {
            continue;
        }
        let allowed = arrows.get(name).unwrap_or_else(|| panic!("{name} has no place in the arrows"));
        for dependency in direct(package) {
            let inside = dependency.starts_with("cohaul-");
            assert!(!inside || allowed.contains(&dependency), "{name} must not use {dependency}");
        }
    }
}

#[test]
fn no_crate_reaches_what_it_must_never_use() {
    let metadata = metadata();
    let never = BTreeMap::from(NEVER);
    for package in metadata.workspace_packages() {
        let Some(banned) = never.get(package.name.as_str()) else { continue };
        let mut uses = reached(&metadata, package);
        // a development dependency counts where it is direct: tests of core are pure too, but for their generators
        uses.extend(direct(package).into_iter().filter(|name| !["proptest", "criterion"].contains(name)));
        for name in banned.iter().copied().flatten() {
            assert!(!uses.contains(name), "{} must never reach {name}", package.name);
        }
    }
}

#[test]
fn every_crate_takes_the_lints_of_the_workspace() {
    for package in metadata().workspace_packages() {
        let manifest = fs::read_to_string(&package.manifest_path).unwrap();
        assert!(manifest.contains("[lints]\nworkspace = true\n"), "{} has lints of its own", package.name);
    }
    // one inside a crate would replace the one of the root
    let strays: Vec<_> = sources("toml").into_iter().filter(|path| path.ends_with("clippy.toml")).collect();
    assert_eq!(strays, Vec::<String>::new());
}

/// Files under version control's folders with this extension, relative to the root, with forward slashes.
fn sources(extension: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut open: Vec<PathBuf> = ["crates", "tests", "python"].iter().map(|folder| root().join(folder)).collect();
    while let Some(folder) = open.pop() {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        for path in entries.map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| e == extension) {
                found.push(path.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}

#[test]
fn foreign_types_stay_behind_their_doors() {
    for path in sources("rs").iter().filter(|path| path.starts_with("crates/")) {
        let text = fs::read_to_string(root().join(path)).unwrap();
        let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        for (name, doors) in DOORS {
            let open = doors.iter().any(|door| path.starts_with(door));
            assert!(open || !code.contains(name), "{path} mentions {name}, which belongs to {doors:?}");
        }
    }
}

/// What the certifier may name: of the planner only data, of other crates only mathematics.
const CERTIFIER_MAY: [&str; 8] = [
    "crate::instance",
    "crate::outcome",
    "crate::plan",
    "cohaul_core::geometry",
    "cohaul_core::se2",
    "nalgebra::",
    "serde::",
    "std::",
];

/// Paths that begin with `root` in code, up to the end of their second part.
fn paths<'a>(code: &'a str, root: &str) -> Vec<&'a str> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(root)
        .filter(|(at, _)| !code[..*at].ends_with(is_word) && !code[..*at].ends_with("::"))
        .map(|(at, _)| {
            let end = code[at + root.len()..].find(|c| !is_word(c)).map_or(code.len(), |end| at + root.len() + end);
            &code[at..end]
        })
        .collect()
}

/// A plan is checked by code that shares nothing but data types with the code that made it: an error of a search must not
/// be able to hide itself.
#[test]
fn the_certifier_shares_only_data_with_the_planners() {
    let files: Vec<String> =
        sources("rs").into_iter().filter(|path| path.starts_with("crates/planner/src/certify/")).collect();
    assert!(files.len() > 5, "{files:?}");
    let mut shared = BTreeSet::new();
    for path in &files {
        let text = fs::read_to_string(root().join(path)).unwrap();
        let code: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        let code = code.join("\n");
        assert!(!code.contains("super::super"), "{path} leaves the certifier by another way");
        assert!(!code.contains("include!") && !code.contains("#[path"), "{path} takes in foreign source");
        for line in code.lines().filter_map(|line| line.trim_start().strip_prefix("use ")) {
            let inside = ["super::", "crate::"].iter().any(|start| line.starts_with(start));
            let is_module = files.iter().any(|file| {
                let name = file.rsplit('/').next().unwrap().trim_end_matches(".rs");
                path.ends_with("/mod.rs") && line.starts_with(&format!("{name}::"))
            });
            let may = inside || is_module || CERTIFIER_MAY.iter().any(|name| line.starts_with(name));
            assert!(may, "{path} uses {line}");
        }
        for foreign in ["crate::", "cohaul_core::", "cohaul_planner::"] {
            for name in paths(&code, foreign) {
                assert!(CERTIFIER_MAY.contains(&name), "{path} names {name}");
                shared.insert(name.to_owned());
            }
        }
    }
    // it does read the data, so the search for names works
    assert!(shared.contains("crate::plan") && shared.contains("cohaul_core::se2"), "{shared:?}");
}

#[test]
fn files_are_small() {
    for extension in ["rs", "py", "js", "css"] {
        for path in sources(extension) {
            let lines = fs::read_to_string(root().join(&path)).unwrap().lines().count();
            assert!(lines <= LONGEST_FILE, "{path} has {lines} lines, more than {LONGEST_FILE}: split it");
        }
    }
}

/// Packages with their features as cargo would build them, one line each.
fn features(arguments: &[&str]) -> BTreeSet<String> {
    let text = run(&[&["tree", "--locked", "--prefix=none", "--format={p} [{f}]"], arguments].concat());
    text.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).filter(|line| !line.is_empty()).collect()
}

/// The wheel once compiled the physics engines a second time, because the tests had asked for one more feature of a crate
/// below them. What differs goes into crates/py/Cargo.toml.
#[test]
fn the_wheel_is_built_from_what_the_tests_have_compiled() {
    let tests = features(&["--workspace", "--edges=normal,build,dev"]);
    let wheel = features(&["--package=cohaul-py", "--edges=normal,build"]);
    let again: Vec<_> = wheel.difference(&tests).collect();
    assert!(again.is_empty(), "compiled twice: {again:#?}");
}
