//! Where the bytes of a glTF buffer may come from: base64 inside the file, or a `.bin` at or below its folder.

use std::path::{Component, Path, PathBuf};

/// What a buffer's URI names.
pub(super) enum BufferSource {
    /// The bytes themselves.
    Inline(Vec<u8>),
    /// A file, already joined to the folder of the `.gltf`.
    File(PathBuf),
}

/// Resolves a buffer's URI. Paths that could leave the folder of `gltf_path` are refused with the reason: a scene
/// from a stranger must not read other files of its reader.
pub(super) fn resolve(uri: &str, gltf_path: &Path) -> Result<BufferSource, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = data.split_once(";base64,").ok_or("its data: URI is not base64")?;
        return decode_base64(text).map(BufferSource::Inline).ok_or_else(|| "its base64 is malformed".into());
    }
    let name = decode_percent(uri).ok_or("its URI has a malformed % escape")?;
    // A colon starts a scheme or a drive letter, a backslash is a separator on Windows only.
    if name.contains([':', '\\', '\0']) {
        return Err(format!("its URI '{name}' is not a relative path; put the .bin beside the .gltf"));
    }
    let relative = Path::new(&name);
    if name.is_empty() || !relative.components().all(|c| matches!(c, Component::Normal(_))) {
        return Err(format!("its URI '{name}' leaves the folder of the .gltf; put the .bin beside it"));
    }
    let extension = relative.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !matches!(extension.as_str(), "bin" | "glbin") {
        return Err(format!("its URI '{name}' does not end in .bin or .glbin"));
    }
    Ok(BufferSource::File(gltf_path.parent().unwrap_or(Path::new("")).join(relative)))
}

fn decode_percent(text: &str) -> Option<String> {
    let mut bytes = Vec::new();
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(if byte == b'%' {
            let digit = |b: Option<u8>| char::from(b?).to_digit(16);
            u8::try_from(digit(rest.next())? * 16 + digit(rest.next())?).ok()?
        } else {
            byte
        });
    }
    String::from_utf8(bytes).ok()
}

/// RFC 4648 base64 with or without padding; `None` for any other character or an impossible length.
fn decode_base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut bits = 0_u32;
        for &symbol in group {
            let value = match symbol {
                b'A'..=b'Z' => symbol - b'A',
                b'a'..=b'z' => symbol - b'a' + 26,
                b'0'..=b'9' => symbol - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                _ => return None,
            };
            bits = bits << 6 | u32::from(value);
        }
        match (group.len(), bits.to_be_bytes()) {
            (4, [_, a, b, c]) => bytes.extend([a, b, c]),
            (3, _) => bytes.extend_from_slice(&(bits >> 2).to_be_bytes()[2..]),
            (2, _) => bytes.extend_from_slice(&(bits >> 4).to_be_bytes()[3..]),
            _ => return None,
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_decodes_every_remainder_and_refuses_rubbish() {
        for (text, bytes) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg", "foob")] {
            assert_eq!(decode_base64(text).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        for text in ["Z", "Zm9vY", "Zm 9", "Zm9\u{e9}", "Z=9v"] {
            assert_eq!(decode_base64(text), None, "{text}");
        }
    }

    #[test]
    fn only_paths_at_or_below_the_folder_resolve() {
        let path = Path::new("models/a.gltf");
        let file = |uri| match resolve(uri, path) {
            Ok(BufferSource::File(path)) => Some(path),
            _ => None,
        };
        assert_eq!(file("my%20mesh.bin"), Some(PathBuf::from("models/my mesh.bin")));
        assert_eq!(file("parts/a.BIN"), Some(PathBuf::from("models/parts/a.BIN")));
        for uri in [
            "../a.bin",
            "%2e%2e/a.bin",
            "parts/../../a.bin",
            "/etc/a.bin",
            "%2Fa.bin",
            "c:a.bin",
            "file:///a.bin",
            "http://host/a.bin",
            "a\\b.bin",
            "a.bin%00",
            "a%2",
            "a%zz.bin",
            "",
            "a.txt",
        ] {
            assert_eq!(file(uri), None, "{uri}");
        }
    }
}
