//! Scenario files: the good ones, the bad ones, overrides, drawn values, the schema.

use std::fs;
use std::path::{Path, PathBuf};

use cohaul_core::scenario::document::{Scenario, Variant};
use cohaul_core::scenario::{self, Override, Parsed, Problem, ScenarioError};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.to_string_lossy().ends_with(ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

const FLAT: &str = include_str!("../../scenarios/r2p2/flat.yaml");

fn with(overrides: &[&str]) -> Result<Parsed, ScenarioError> {
    let overrides: Vec<_> = overrides.iter().map(|text| Override::parse(text).unwrap()).collect();
    scenario::parse("flat.yaml", FLAT.as_bytes(), &overrides)
}

#[test]
fn every_scenario_of_the_repository_is_valid_without_warnings() {
    let files = files(&root().join("scenarios"), ".yaml");
    assert!(files.len() >= 3);
    for path in files {
        let parsed = scenario::parse(&path.to_string_lossy(), &fs::read(&path).unwrap(), &[]);
        let parsed = parsed.unwrap_or_else(|error| panic!("{error}; {}", error.remedy()));
        assert!(parsed.warnings.is_empty(), "{}", parsed.warnings[0]);
        assert_eq!(Some(parsed.scenario.name.as_ref()), path.file_stem().unwrap().to_str());
    }
}
