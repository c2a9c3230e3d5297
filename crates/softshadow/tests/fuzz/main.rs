//! Hostile input: each reader and the settings of a call are given changed files for as long as `SOFTSHADOW_FUZZ_SECONDS` says, two
//! seconds where it says nothing. Nothing may panic, hang, or take memory out of proportion to the file.
//!
//! `tests/fuzz/corpus/` has inputs to begin with. `make fuzz` gives every target a minute and another seed each time, prints the figures,
//! and leaves inputs with new outcomes and findings in `target/fuzz/`.

#![expect(clippy::print_stdout, reason = "the measured figures, shown by --nocapture")]

mod files;
mod growth;
mod harness;
mod memory;
mod mutate;
mod settings;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::harness::{Target, fuzz};

fn from_environment(variable: &str, default: u64) -> u64 {
    std::env::var(variable).map_or(default, |text| text.parse().expect("a whole number"))
}

fn inputs(target: &Target) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fuzz/corpus").join(target.name);
    let mut paths: Vec<PathBuf> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    // Folders have no order, and a seed has to lead to the same inputs.
    paths.sort();
    assert!(paths.len() >= 3, "inputs to begin with are in {}", folder.display());
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

fn check(target: &Target) {
    let seed = from_environment("SOFTSHADOW_FUZZ_SEED", 1);
    let seconds = from_environment("SOFTSHADOW_FUZZ_SECONDS", 2);
    let figures = fuzz(target, inputs(target), seed, Duration::from_secs(seconds));
    println!("{}: {figures}; seed {seed}", target.name);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../fuzz").join(target.name);
    fs::create_dir_all(&folder).unwrap();
    let keep = |kind: &str, index: usize, input: &[u8]| {
        let path = folder.join(format!("{kind}-{seed}-{index}"));
        fs::write(&path, input).unwrap();
        path.display().to_string()
    };
    figures.news.iter().enumerate().for_each(|(index, input)| drop(keep("new", index, input)));
    let found = figures.findings.iter().enumerate();
    let found: Vec<String> =
        found.map(|(index, (finding, input))| format!("{finding:?}: {}", keep("red", index, input))).collect();
    assert!(found.is_empty(), "{}:\n{}", target.name, found.join("\n"));
    assert!(figures.executions > 100 && figures.outcomes > 10, "{}: too little was tried: {figures}", target.name);
}

#[test]
fn gltf() {
    check(&files::GLTF);
}

#[test]
fn obj() {
    check(&files::OBJ);
}

#[test]
fn ply() {
    check(&files::PLY);
}

#[test]
fn stl() {
    check(&files::STL);
}

#[test]
fn scene_json() {
    check(&files::SCENE_JSON);
}

#[test]
fn settings() {
    check(&settings::SETTINGS);
}
