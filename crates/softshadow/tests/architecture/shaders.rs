//! WGSL: folders import themselves and `shared/`, and only files with entry points declare bindings.

use crate::files::{Text, below, code};

/// The folder of a path below `shaders_wgsl/`.
fn folder(path: &str) -> &str {
    path.trim_start_matches("shaders_wgsl/").split('/').next().unwrap_or_default()
}

/// Every import that leaves its folder for another than `shared/`.
fn strays(sources: &[Text]) -> Vec<String> {
    let mut found = Vec::new();
    for (path, text) in sources {
        for import in text.lines().filter_map(|line| line.strip_prefix("//#import ")).map(str::trim) {
            if folder(import) != "shared" && folder(import) != folder(path) {
                found.push(format!("{path} imports {import}"));
            }
        }
    }
    found
}

/// Files that declare bindings without an entry point, or from within `shared/`.
fn stray_bindings(sources: &[Text]) -> Vec<&str> {
    let has_entry = |code: &str| ["@compute", "@vertex", "@fragment"].iter().any(|word| code.contains(word));
    let stray = |path: &str, text: &str| {
        let code = code(text);
        let binds = code.contains("@binding") || code.contains("@group");
        binds && !has_entry(&code) || folder(path) == "shared" && (binds || has_entry(&code))
    };
    sources.iter().filter(|(path, text)| stray(path, text)).map(|(path, _)| path.as_str()).collect()
}

#[test]
fn folders_import_themselves_and_shared() {
    let sources = below("shaders_wgsl", "wgsl");
    assert!(sources.len() >= 10);
    assert_eq!(strays(&sources), Vec::<String>::new());
    let importing = |path: &str, import: &str| strays(&[(path.into(), format!("// Why.\n//#import {import}\n"))]);
    assert_eq!(
        importing("shaders_wgsl/hard_shadow_map/look_up.wgsl", "ray_traced/hierarchy.wgsl"),
        ["shaders_wgsl/hard_shadow_map/look_up.wgsl imports ray_traced/hierarchy.wgsl"]
    );
    assert_eq!(
        importing("shaders_wgsl/shared/light.wgsl", "ray_traced/hierarchy.wgsl"),
        ["shaders_wgsl/shared/light.wgsl imports ray_traced/hierarchy.wgsl"]
    );
    assert!(importing("shaders_wgsl/ray_traced/trace.wgsl", "ray_traced/hierarchy.wgsl").is_empty());
}

#[test]
fn only_entry_files_declare_bindings() {
    assert_eq!(stray_bindings(&below("shaders_wgsl", "wgsl")), Vec::<&str>::new());
    let binding = "@group(0) @binding(0) var<uniform> light: Light;\n";
    let entry = "@compute @workgroup_size(64)\nfn trace() {}\n";
    let stray = |path: &str, text: String| !stray_bindings(&[(path.into(), text)]).is_empty();
    assert!(stray("shaders_wgsl/ray_traced/hierarchy.wgsl", binding.into()));
    assert!(stray("shaders_wgsl/shared/light.wgsl", format!("{binding}{entry}")));
    assert!(stray("shaders_wgsl/shared/light.wgsl", entry.into()));
    assert!(!stray("shaders_wgsl/ray_traced/trace.wgsl", format!("{binding}{entry}")));
    assert!(!stray("shaders_wgsl/shared/light.wgsl", format!("// Not a {binding}")));
}
