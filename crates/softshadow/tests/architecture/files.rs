//! The texts that the rules judge.

use std::path::{Path, PathBuf};

/// Path and text of a file. Paths are relative to the workspace and use slashes.
pub(crate) type Text = (String, String);

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Every file below a folder of the workspace that has this extension.
pub(crate) fn below(folder: &str, extension: &str) -> Vec<Text> {
    let mut texts = Vec::new();
    collect(&root().join(folder), extension, &mut texts);
    texts.sort();
    texts
}

fn collect(folder: &Path, extension: &str, texts: &mut Vec<Text>) {
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            collect(&path, extension, texts);
        } else if path.extension().is_some_and(|e| e == extension) {
            let name = path.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/");
            texts.push((name, std::fs::read_to_string(&path).unwrap()));
        }
    }
}

/// Name and manifest of every crate.
pub(crate) fn manifests() -> Vec<Text> {
    let found: Vec<Text> =
        below("crates", "toml").into_iter().filter(|(name, _)| name.ends_with("/Cargo.toml")).collect();
    assert!(found.len() >= 8, "manifests are found: {found:?}");
    found.into_iter().map(|(path, text)| (path.split('/').nth(1).unwrap().to_owned(), text)).collect()
}

/// The code of a source file: what stands before a comment on every line.
pub(crate) fn code(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// Whether a text has this name as a whole word.
pub(crate) fn has_word(text: &str, word: &str) -> bool {
    let joins = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    text.match_indices(word)
        .any(|(at, _)| !joins(text[..at].chars().next_back()) && !joins(text[at + word.len()..].chars().next()))
}

#[test]
fn comments_are_no_code_and_parts_of_names_no_words() {
    assert_eq!(code("use a; // not b\n// c\nfn d() {}"), "use a; \n\nfn d() {}");
    assert!(has_word("use crate::ray_traced::BLOCKED;", "ray_traced"));
    assert!(!has_word("fn ray_traced_points() {}", "ray_traced") && !has_word("array_traced", "ray_traced"));
}
