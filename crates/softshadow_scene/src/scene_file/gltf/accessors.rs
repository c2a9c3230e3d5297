//! Positions and indices from a glTF's buffers. What an accessor asks for is compared with the bytes that are there,
//! in checked 64-bit arithmetic, before one of them is read.

use std::borrow::Cow;
use std::path::Path;

use ::gltf::json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use ::gltf::json::buffer::Buffer;
use ::gltf::json::validation::Checked;
use ::gltf::json::{Index, Root};

use crate::error::SceneError;
use crate::scene_file::uri::{self, BufferSource};
use crate::scene_file::{MAX_FILE_BYTES, RegularFile, invalid};

/// The bytes of every buffer of a document.
pub(super) struct Buffers<'a>(Vec<Cow<'a, [u8]>>);

impl<'a> Buffers<'a> {
    /// Reads the binary chunk, `data:` URIs and files beside the `.gltf`; each must hold the bytes that it announces.
    pub(super) fn read(path: &Path, root: &Root, binary: Option<&'a [u8]>) -> Result<Self, SceneError> {
        let needed = root.buffers.iter().fold(0_u64, |sum, buffer| sum.saturating_add(buffer.byte_length.0));
        if needed > MAX_FILE_BYTES {
            let what = format!("bytes of the buffers of {}", path.display());
            return Err(SceneError::TooLarge { what, needed, limit: MAX_FILE_BYTES });
        }
        let read_buffer = |(index, buffer): (usize, &Buffer)| {
            let broken = |reason: &str| invalid(path, format!("buffer {index}: {reason}"));
            let announced = buffer.byte_length.0;
            let bytes: Cow<'a, [u8]> = match (&buffer.uri, binary) {
                (Some(uri), _) => match uri::resolve(uri, path).map_err(|reason| broken(&reason))? {
                    BufferSource::Inline(bytes) => bytes.into(),
                    // The sum above holds for what is announced, so no more than that is read.
                    BufferSource::File(file) => RegularFile::open(&file)?.read(announced)?.into(),
                },
                (None, Some(chunk)) if index == 0 => chunk.into(),
                (None, _) => return Err(broken("it has no URI and there is no binary chunk for it")),
            };
            if announced > bytes.len() as u64 {
                let held = bytes.len();
                return Err(broken(&format!("{announced} bytes announced, {held} there; it is truncated")));
            }
            Ok(bytes)
        };
        root.buffers.iter().enumerate().map(read_buffer).collect::<Result<_, _>>().map(Self)
    }

    pub(super) fn positions(&self, root: &Root, index: Index<Accessor>) -> Result<Positions<'_>, String> {
        let accessor = accessor(root, index)?;
        match (component_type(accessor), &accessor.type_) {
            (Some(ComponentType::F32), Checked::Valid(Type::Vec3)) => {}
            _ => return Err(format!("accessor {index} holds positions, which must be float VEC3")),
        }
        self.elements(root, index, accessor, 12).map(Positions)
    }

    pub(super) fn indices(&self, root: &Root, index: Index<Accessor>) -> Result<Indices<'_>, String> {
        let accessor = accessor(root, index)?;
        let size = match (component_type(accessor), &accessor.type_) {
            (Some(ComponentType::U8), Checked::Valid(Type::Scalar)) => 1,
            (Some(ComponentType::U16), Checked::Valid(Type::Scalar)) => 2,
            (Some(ComponentType::U32), Checked::Valid(Type::Scalar)) => 4,
            _ => return Err(format!("accessor {index} holds indices, which must be unsigned SCALAR")),
        };
        self.elements(root, index, accessor, size).map(Indices)
    }

    fn elements(
        &self,
        root: &Root,
        index: Index<Accessor>,
        accessor: &Accessor,
        size: usize,
    ) -> Result<Elements<'_>, String> {
        if accessor.sparse.is_some() {
            return Err(format!("accessor {index} is sparse, which cannot be read; export it without"));
        }
        let view_index = accessor.buffer_view.ok_or_else(|| format!("accessor {index} has no buffer view"))?;
        let view =
            root.get(view_index).ok_or_else(|| format!("accessor {index}: buffer view {view_index} is not there"))?;
        let buffer = self.0.get(view.buffer.value());
        let buffer = buffer.ok_or_else(|| format!("buffer view {view_index}: buffer {} is not there", view.buffer))?;

        let bytes = slice(buffer, view.byte_offset.map_or(0, |o| o.0), view.byte_length.0)
            .ok_or_else(|| format!("buffer view {view_index} reaches past the end of buffer {}", view.buffer))?;
        let stride = view.byte_stride.map_or(size, |s| s.0);
        if stride < size {
            return Err(format!("buffer view {view_index}: elements of {size} bytes, {stride} bytes apart, overlap"));
        }
        let count = accessor.count.0;
        let needed = match count.checked_sub(1) {
            None => Some(0),
            Some(gaps) => gaps.checked_mul(stride as u64).and_then(|bytes| bytes.checked_add(size as u64)),
        };
        let bytes = needed
            .and_then(|needed| slice(bytes, accessor.byte_offset.map_or(0, |o| o.0), needed))
            .ok_or_else(|| format!("accessor {index}: {count} elements reach past the end of its buffer view"))?;
        Ok(Elements { bytes, stride, size, count })
    }
}

fn accessor(root: &Root, index: Index<Accessor>) -> Result<&Accessor, String> {
    root.get(index).ok_or_else(|| format!("accessor {index} is not there"))
}

fn component_type(accessor: &Accessor) -> Option<ComponentType> {
    match accessor.component_type {
        Checked::Valid(GenericComponentType(component_type)) => Some(component_type),
        Checked::Invalid => None,
    }
}

fn slice(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let end = offset.checked_add(length)?;
    bytes.get(usize::try_from(offset).ok()?..usize::try_from(end).ok()?)
}

/// Elements that are known to lie inside their buffer: the last one ends where `bytes` does.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: u64,
}

impl<'a> Elements<'a> {
    fn iter(&self) -> impl Iterator<Item = &'a [u8]> {
        let size = self.size;
        self.bytes.chunks(self.stride).map_while(move |chunk| chunk.get(..size))
    }
}

/// Float positions.
pub(super) struct Positions<'a>(Elements<'a>);

impl Positions<'_> {
    pub(super) fn len(&self) -> u64 {
        self.0.count
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = [f64; 3]> {
        self.0.iter().map_while(|element| {
            let [x, y, z] = element.as_chunks::<4>().0.first_chunk()?;
            Some([x, y, z].map(|&component| f64::from(f32::from_le_bytes(component))))
        })
    }
}

/// Unsigned indices of 1, 2 or 4 bytes.
pub(super) struct Indices<'a>(Elements<'a>);

impl Indices<'_> {
    pub(super) fn len(&self) -> u64 {
        self.0.count
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = u32> {
        // Little endian: the first byte counts least.
        self.0.iter().map(|element| element.iter().rev().fold(0, |index, &byte| index << 8 | u32::from(byte)))
    }
}
