//! Techniques stand side by side: none imports another, no shared part and no engine knows any of them.

use softshadow_techniques::Technique;

use crate::files::{Text, below, code, has_word};

/// Module and type name of every technique: `ray_traced`, `RayTraced`.
fn names() -> Vec<[String; 2]> {
    let camel = |name: &str| -> String { name.split('_').map(|word| word[..1].to_uppercase() + &word[1..]).collect() };
    Technique::defaults().iter().map(|technique| [technique.name().to_owned(), camel(technique.name())]).collect()
}

/// The technique to which a file belongs: its stem, or the folder that it stands in.
fn owner<'a>(path: &str, names: &'a [[String; 2]]) -> Option<&'a str> {
    let inside = path.split_once("/src/").map_or(path, |(_, inside)| inside);
    let room = inside.split('/').next().unwrap_or_default().trim_end_matches(".rs");
    names.iter().map(|[module, _]| module.as_str()).find(|module| *module == room)
}

/// Every mention of a technique by a file that is not its own.
fn foreign_mentions(sources: &[Text], names: &[[String; 2]]) -> Vec<String> {
    let mut found = Vec::new();
    for (path, text) in sources {
        let code = code(text);
        for [module, kind] in names.iter().filter(|[module, _]| owner(path, names) != Some(module)) {
            found.extend(
                [module, kind].iter().filter(|word| has_word(&code, word)).map(|word| format!("{path}: {word}")),
            );
        }
    }
    found
}

#[test]
fn no_technique_and_no_part_names_another_technique() {
    let sources: Vec<Text> = below("crates/softshadow_techniques/src", "rs")
        .into_iter()
        // The closed list of techniques is the one place that names them all.
        .filter(|(name, _)| !name.ends_with("/src/lib.rs"))
        .collect();
    let names = names();
    for [module, _] in &names {
        assert!(sources.iter().any(|(path, _)| owner(path, &names) == Some(module)), "{module} has a file or a folder");
        assert!(
            !below("shaders_wgsl", "wgsl").iter().all(|(p, _)| !p.contains(&format!("/{module}/"))),
            "{module} has shaders"
        );
    }
    assert_eq!(foreign_mentions(&sources, &names), Vec::<String>::new());
}

#[test]
fn engines_name_no_technique() {
    for engine in ["crates/softshadow_engine/src", "crates/softshadow_native/src/engine"] {
        let sources = below(engine, "rs");
        assert!(sources.len() >= 5);
        assert_eq!(foreign_mentions(&sources, &names()), Vec::<String>::new());
    }
}

#[test]
fn a_mention_is_seen_wherever_it_stands() {
    let names = names();
    let mentions = |path: &str, text: &str| foreign_mentions(&[(path.into(), text.into())], &names);
    let other = "crates/softshadow_techniques/src/hard_shadow_map.rs";
    assert_eq!(mentions(other, "use crate::ray_traced::VISIBILITY;"), [format!("{other}: ray_traced")]);
    assert_eq!(mentions(other, "use crate::{ray_traced, parts};"), [format!("{other}: ray_traced")]);
    assert_eq!(mentions(other, "use super::RayTraced;"), [format!("{other}: RayTraced")]);
    assert_eq!(mentions(other, "file: \"ray_traced/begin.wgsl\""), [format!("{other}: ray_traced")]);
    assert_eq!(mentions(other, "//! Unlike `ray_traced`.\nuse crate::hard_shadow_map::X;"), Vec::<String>::new());
    let inner = "crates/softshadow_techniques/src/ray_traced/rounds.rs";
    assert_eq!(mentions(inner, "use super::RayTraced; use crate::HardShadowMap;"), [format!("{inner}: HardShadowMap")]);
    let part = "crates/softshadow_techniques/src/parts/shading.rs";
    assert_eq!(mentions(part, "crate::ray_traced::BLOCKED"), [format!("{part}: ray_traced")]);
    let engine = "crates/softshadow_engine/src/run.rs";
    assert_eq!(mentions(engine, "Technique::RayTraced(_) => {}"), [format!("{engine}: RayTraced")]);
}
