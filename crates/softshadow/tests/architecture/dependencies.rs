//! Which crate may use which.

use crate::files::{Text, below, code, has_word, manifests};

/// A crate's dependencies of one kind, by name.
#[derive(Debug, Clone, Default, PartialEq)]
struct Dependencies {
    /// What its library needs.
    library: Vec<String>,
    /// What only its tests need.
    tests: Vec<String>,
}

/// Reads `[…dependencies]` and `[…dependencies.name]`; a renamed package counts under its own name.
fn read(manifest: &str) -> Dependencies {
    let mut found = Dependencies::default();
    let mut section = "";
    for line in manifest.lines().map(|line| line.split('#').next().unwrap_or_default().trim()) {
        if let Some(header) = line.strip_prefix('[') {
            section = header.trim_end_matches(']');
            if let Some((kind, name)) = section.rsplit_once("dependencies.") {
                found.list(kind).push(name.to_owned());
            }
        } else if let (Some(kind), Some((key, value))) = (section.strip_suffix("dependencies"), line.split_once('=')) {
            let renamed = value.split_once("package").and_then(|(_, rest)| rest.split('"').nth(1));
            let name = renamed.unwrap_or(key.split('.').next().unwrap_or_default().trim());
            found.list(kind).push(name.to_owned());
        } else if section.contains("dependencies.") && line.starts_with("package") {
            found.library.extend(line.split('"').nth(1).map(str::to_owned));
        }
    }
    found
}

impl Dependencies {
    fn list(&mut self, kind: &str) -> &mut Vec<String> {
        if kind.ends_with("dev-") { &mut self.tests } else { &mut self.library }
    }
}

/// What each crate may use of ours. A crate that is not named here is refused.
const ALLOWED: [(&str, &[&str]); 10] = [
    ("softshadow_scene", &[]),
    ("softshadow_shaders", &[]),
    ("softshadow_measure", &["softshadow_scene"]),
    ("softshadow_plan", &["softshadow_shaders"]),
    ("softshadow_techniques", &["softshadow_plan", "softshadow_scene", "softshadow_shaders"]),
    ("softshadow_engine", &["softshadow_plan", "softshadow_shaders"]),
    ("softshadow_native", &["softshadow_plan", "softshadow_scene"]),
    (
        "softshadow",
        &[
            "softshadow_engine",
            "softshadow_measure",
            "softshadow_native",
            "softshadow_plan",
            "softshadow_scene",
            "softshadow_techniques",
        ],
    ),
    // Both use the front door alone, and nobody uses them.
    ("softshadow_python", &["softshadow"]),
    ("softshadow_bench", &["softshadow"]),
];

/// Every use that the table does not allow. Tests may use more, but never what stands behind the front door's users.
fn forbidden_uses(manifests: &[Text]) -> Vec<String> {
    let mut broken = Vec::new();
    for (name, text) in manifests {
        let Some((_, allowed)) = ALLOWED.iter().find(|(known, _)| known == name) else {
            broken.push(format!("{name} has no row in the table"));
            continue;
        };
        let dependencies = read(text);
        for used in dependencies.library.iter().filter(|used| used.starts_with("softshadow")) {
            if !allowed.contains(&used.as_str()) {
                broken.push(format!("{name} uses {used}"));
            }
        }
        for used in
            dependencies.tests.iter().filter(|used| ["softshadow_python", "softshadow_bench"].contains(&used.as_str()))
        {
            broken.push(format!("tests of {name} use {used}"));
        }
        let wgpu = dependencies.library.iter().chain(&dependencies.tests).find(|used| used.starts_with("wgpu"));
        if let Some(used) = wgpu.filter(|_| name != "softshadow_engine") {
            broken.push(format!("{name} uses {used}"));
        }
    }
    broken
}

/// Sources outside the engine that name wgpu all the same, through whatever exports it.
fn names_wgpu(sources: &[Text]) -> Vec<&str> {
    let outside = sources.iter().filter(|(name, _)| !name.starts_with("crates/softshadow_engine/src/"));
    outside.filter(|(_, text)| has_word(&code(text), "wgpu")).map(|(name, _)| name.as_str()).collect()
}

/// Sources of the truth that touch what they judge: the hierarchy of `scene`, or a line of WGSL.
fn shares_with_the_judged(sources: &[Text]) -> Vec<&str> {
    let words = ["Bvh", "BvhNode", "bvh", "LocalScene", "wgsl"];
    let touches = |text: &str| words.iter().any(|word| has_word(&code(text), word));
    sources.iter().filter(|(_, text)| touches(text)).map(|(name, _)| name.as_str()).collect()
}

#[test]
fn crates_use_what_they_may() {
    assert_eq!(forbidden_uses(&manifests()), Vec::<String>::new());
}

#[test]
fn a_forbidden_use_is_seen() {
    let broken = |name: &str, text: &str| forbidden_uses(&[(name.into(), text.into())]);
    let uses = |of: &str| format!("[package]\nname = \"x\"\n\n[dependencies]\n{of}\n");
    for (name, of, words) in [
        ("softshadow_scene", "softshadow_plan.workspace = true", "softshadow_scene uses softshadow_plan"),
        ("softshadow_measure", "softshadow_shaders = { path = \"..\" }", "softshadow_measure uses softshadow_shaders"),
        ("softshadow_techniques", "softshadow_engine.workspace = true", "softshadow_techniques uses softshadow_engine"),
        ("softshadow_engine", "softshadow_techniques.workspace = true", "softshadow_engine uses softshadow_techniques"),
        ("softshadow_python", "softshadow_scene.workspace = true", "softshadow_python uses softshadow_scene"),
        ("softshadow", "softshadow_python.workspace = true", "softshadow uses softshadow_python"),
        ("softshadow", "wgpu.workspace = true # why", "softshadow uses wgpu"),
        ("softshadow_plan", "gpu = { version = \"30\", package = \"wgpu\" }", "softshadow_plan uses wgpu"),
        ("softshadow_new", "", "softshadow_new has no row in the table"),
    ] {
        assert_eq!(broken(name, &uses(of)), [words]);
    }
    let section = |header: &str| broken("softshadow_scene", &format!("[{header}]\nversion = \"1\"\n"));
    assert_eq!(section("dependencies.softshadow_plan"), ["softshadow_scene uses softshadow_plan"]);
    assert_eq!(section("build-dependencies.softshadow_plan"), ["softshadow_scene uses softshadow_plan"]);
    assert_eq!(section("target.'cfg(unix)'.dependencies.wgpu"), ["softshadow_scene uses wgpu"]);
    assert_eq!(section("dev-dependencies.softshadow_bench"), ["tests of softshadow_scene use softshadow_bench"]);
    assert_eq!(section("dev-dependencies.softshadow_plan"), Vec::<String>::new());
    assert_eq!(
        broken("softshadow_measure", &uses("softshadow_scene.workspace = true\nrayon = \"1\"")),
        Vec::<String>::new()
    );
}

#[test]
fn only_the_engine_names_wgpu() {
    assert_eq!(
        names_wgpu(&below("crates", "rs").into_iter().filter(|(n, _)| n.contains("/src/")).collect::<Vec<_>>()),
        Vec::<&str>::new()
    );
    let source = |name: &str, text: &str| [(name.to_owned(), text.to_owned())];
    let through = source("crates/softshadow/src/lib.rs", "use softshadow_engine::wgpu::Device;");
    assert_eq!(names_wgpu(&through), ["crates/softshadow/src/lib.rs"]);
    assert!(names_wgpu(&source("crates/softshadow_engine/src/run.rs", "wgpu::Device")).is_empty());
    assert!(names_wgpu(&source("crates/softshadow_plan/src/lib.rs", "//! Not wgpu.")).is_empty());
}

#[test]
fn the_truth_shares_nothing_with_what_it_judges() {
    let sources = below("crates/softshadow_measure/src", "rs");
    assert!(sources.len() >= 5);
    assert_eq!(shares_with_the_judged(&sources), Vec::<&str>::new());
    for text in ["use softshadow_scene::Bvh;", "include_str!(\"../../shaders_wgsl/shared/triangle.wgsl\")"] {
        assert_eq!(shares_with_the_judged(&[("rays.rs".into(), text.into())]), ["rays.rs"]);
    }
}
