//! Every shader parses and validates with core WebGPU alone; nothing in `shared/` is unused or declares a binding.

use std::collections::BTreeSet;

use softshadow_shaders::{EMBEDDED, module};

#[test]
fn every_file_validates() {
    assert!(EMBEDDED.len() >= 10, "the shaders are embedded");
    let failures: Vec<String> =
        EMBEDDED.iter().filter_map(|(file, _)| module(file).err()).map(|error| error.to_string()).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn only_entry_files_declare_bindings() {
    for (file, text) in EMBEDDED {
        let has_entry = text.contains("@compute") || text.contains("@vertex");
        assert_eq!(text.contains("@binding"), has_entry, "{file}: bindings stand where entry points stand");
        assert!(!(file.starts_with("shared/") && has_entry), "{file}: shared files have no entry point");
    }
}

#[test]
fn shared_files_are_imported_and_folders_keep_to_themselves() {
    let mut imported = BTreeSet::new();
    for (file, _) in EMBEDDED {
        let folder = file.split('/').next().unwrap();
        for part in module(file).unwrap().linked.files().filter(|part| part != file) {
            imported.insert(part.to_owned());
            let home = part.split('/').next().unwrap();
            assert!(home == "shared" || home == folder, "{file} imports {part}");
        }
    }
    for (file, _) in EMBEDDED.iter().filter(|(file, _)| file.starts_with("shared/")) {
        assert!(imported.contains(*file), "nobody imports {file}");
    }
}
