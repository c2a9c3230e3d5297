//! Embeds every file of `shaders_wgsl/` by its path from there. Linking and validation happen at first use and in tests.
//!
//! The folder beside this file is a link to that of the workspace, so that a package of this crate holds the files themselves.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

fn main() {
    // A checkout on a system without links has a file that names the folder.
    let folders = ["shaders_wgsl", "../../shaders_wgsl"].map(|path| Path::new(env!("CARGO_MANIFEST_DIR")).join(path));
    let root =
        folders.into_iter().find(|path| path.is_dir()).expect("the crate's folder holds the shaders or a link to them");
    println!("cargo::rerun-if-changed={}", root.display());
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    let mut table = String::from("&[\n");
    for file in files {
        println!("cargo::rerun-if-changed={}", file.display());
        let name = file.strip_prefix(&root).expect("collected below the root").display().to_string().replace('\\', "/");
        writeln!(table, "    ({name:?}, include_str!({:?})),", file.display().to_string())
            .expect("writing to a string");
    }
    table.push(']');
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("set by cargo")).join("sources.rs");
    std::fs::write(out, table).expect("the build folder is writable");
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    for path in entries.map(|entry| entry.expect("a readable folder").path()) {
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "wgsl") {
            files.push(path);
        }
    }
}
