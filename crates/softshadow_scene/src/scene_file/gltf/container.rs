//! A `.glb`'s chunks (section 4.4 of the specification), or a `.gltf`'s text as it is.

/// The JSON, and the binary chunk where there is one.
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

/// Decides by the magic number, so that a wrong extension does no harm.
pub(super) fn split(bytes: &[u8]) -> Result<Container<'_>, String> {
    if !bytes.starts_with(b"glTF") {
        return Ok(Container { json: bytes, binary: None });
    }
    let truncated = || "the file is truncated".to_string();
    let version = u32_at(bytes, 4).ok_or_else(truncated)?;
    if version != 2 {
        return Err(format!("binary glTF version {version} cannot be read; 2 can"));
    }
    let length = u32_at(bytes, 8).ok_or_else(truncated)?;
    let mut rest = bytes
        .get(12..length as usize)
        .ok_or_else(|| format!("its header says {length} bytes, the file has {}; it is truncated", bytes.len()))?;
    let (mut json, mut binary) = (None, None);
    while !rest.is_empty() {
        let chunk_length = u32_at(rest, 0).ok_or_else(truncated)? as usize;
        let kind = rest.get(4..8).ok_or_else(truncated)?;
        let (chunk, after) = rest.split_at(8).1.split_at_checked(chunk_length).ok_or_else(truncated)?;
        match kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            // Chunks of other kinds must be skipped, says the specification.
            _ => {}
        }
        rest = after;
    }
    Ok(Container { json: json.ok_or("it has no JSON chunk")?, binary })
}

fn u32_at(bytes: &[u8], offset: usize) -> Option<u32> {
    bytes.get(offset..)?.first_chunk().map(|four| u32::from_le_bytes(*four))
}
