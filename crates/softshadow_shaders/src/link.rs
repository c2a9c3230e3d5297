//! The linker: whole files, each once, depth first, in the order of their imports; no substitution and no conditionals.

use crate::errors::ShaderError;

/// Files by path.
pub type Sources<'a> = &'a [(&'a str, &'a str)];

const IMPORT: &str = "//#import ";

/// One WGSL text joined from several files, and where each of its lines was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Linked {
    /// The file that was asked for.
    pub file: String,
    /// The whole text.
    pub text: String,
    /// For each joined file its name and the first of its lines in `text`, counted from 0.
    parts: Vec<(String, usize)>,
}

impl Linked {
    /// File and line (from 1) in which line `line` (from 1) of the joined text was written.
    #[must_use]
    pub fn locate(&self, line: usize) -> (&str, usize) {
        let line = line.max(1) - 1;
        let part = self.parts.partition_point(|(_, first)| *first <= line).max(1) - 1;
        let (file, first) = &self.parts[part];
        (file, line - first + 1)
    }

    /// The files of which the text consists.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.parts.iter().map(|(file, _)| file.as_str())
    }
}

/// Joins `file` with everything it imports.
///
/// # Errors
/// Unknown, circular and late imports, with the importing line.
pub fn link(sources: Sources<'_>, file: &str) -> Result<Linked, ShaderError> {
    let mut linked = Linked { file: file.to_owned(), text: String::new(), parts: Vec::new() };
    let Some((_, text)) = sources.iter().find(|(name, _)| *name == file) else {
        return Err(ShaderError::UnknownFile { file: file.to_owned() });
    };
    append(sources, file, text, &mut vec![file.to_owned()], &mut linked)?;
    Ok(linked)
}

fn append(
    sources: Sources<'_>,
    file: &str,
    text: &str,
    open: &mut Vec<String>,
    linked: &mut Linked,
) -> Result<(), ShaderError> {
    let mut code_has_begun = false;
    for (index, row) in text.lines().enumerate() {
        let Some(import) = row.strip_prefix(IMPORT).map(str::trim) else {
            code_has_begun |= !row.trim().is_empty() && !row.starts_with("//");
            continue;
        };
        let (file, line, import) = (file.to_owned(), index + 1, import.to_owned());
        if code_has_begun {
            return Err(ShaderError::LateImport { file, line });
        }
        if open.contains(&import) {
            return Err(ShaderError::CircularImport { file, line, import });
        }
        if linked.parts.iter().any(|(done, _)| *done == import) {
            continue;
        }
        let Some((_, imported)) = sources.iter().find(|(name, _)| *name == import) else {
            return Err(ShaderError::UnknownImport { file, line, import });
        };
        open.push(import.clone());
        append(sources, &import, imported, open, linked)?;
        open.pop();
    }
    linked.parts.push((file.to_owned(), linked.text.lines().count()));
    linked.text.push_str(text);
    if !text.ends_with('\n') {
        linked.text.push('\n');
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCES: Sources<'_> = &[
        ("shared/a.wgsl", "// a\nfn a() -> u32 { return 1u; }\n"),
        ("shared/b.wgsl", "//#import shared/a.wgsl\nfn b() -> u32 { return a(); }"),
        ("entry.wgsl", "// page\n//#import shared/b.wgsl\n//#import shared/a.wgsl\n\nfn c() -> u32 { return b(); }\n"),
        ("lost.wgsl", "//#import shared/z.wgsl\n"),
        ("late.wgsl", "fn f() {}\n//#import shared/a.wgsl\n"),
        ("x.wgsl", "//#import y.wgsl\n"),
        ("y.wgsl", "\n//#import x.wgsl\n"),
    ];

    #[test]
    fn files_are_joined_once_and_lines_find_home() {
        let linked = link(SOURCES, "entry.wgsl").unwrap();
        assert_eq!(linked.files().collect::<Vec<_>>(), ["shared/a.wgsl", "shared/b.wgsl", "entry.wgsl"]);
        for (number, row) in linked.text.lines().enumerate() {
            let (file, line) = linked.locate(number + 1);
            let (_, text) = SOURCES.iter().find(|(name, _)| *name == file).unwrap();
            assert_eq!(text.lines().nth(line - 1).unwrap(), row);
        }
    }

    #[test]
    fn bad_imports_are_errors_with_their_line() {
        let words = |file| link(SOURCES, file).unwrap_err().to_string();
        assert_eq!(words("lost.wgsl"), "lost.wgsl:1: imports 'shared/z.wgsl', which does not exist");
        assert_eq!(words("late.wgsl"), "late.wgsl:2: imports stand at the top of a file");
        assert_eq!(words("x.wgsl"), "y.wgsl:2: importing 'x.wgsl' closes a circle");
        assert_eq!(words("nowhere.wgsl"), "no shader file 'nowhere.wgsl'");
    }
}
