//! What a module declares, read from naga: entry points, bindings by name, and the layout of its structs.

use std::collections::BTreeMap;

use naga::valid::{Capabilities, GlobalUse, ValidationFlags, Validator};

use crate::errors::ShaderError;
use crate::link::Linked;

/// A linked and validated module.
#[derive(Debug, Clone)]
pub struct Module {
    /// The joined text.
    pub linked: Linked,
    /// Entry points by name.
    pub entry_points: BTreeMap<String, EntryPoint>,
    /// Structs by name.
    pub structs: BTreeMap<String, StructLayout>,
}

/// One entry point and what it uses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EntryPoint {
    /// The pipeline stage.
    pub stage: Stage,
    /// Invocations a group; `[0, 0, 0]` outside compute.
    pub workgroup_size: [u32; 3],
    /// What it reads and writes, in the order of binding numbers.
    pub bindings: Vec<Binding>,
}

/// A pipeline stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Vertex shader.
    Vertex,
    /// Fragment shader.
    Fragment,
    /// Compute shader.
    Compute,
}

/// A resource that an entry point uses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Binding {
    /// Its WGSL name, by which plans bind.
    pub name: String,
    /// `@group`.
    pub group: u32,
    /// `@binding`.
    pub binding: u32,
    /// What kind of resource it takes.
    pub kind: BindingKind,
    /// What the entry point does with it.
    pub access: Access,
}

/// Kinds of bindings that the shaders use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BindingKind {
    /// `var<uniform>` of so many bytes.
    Uniform {
        /// Bytes of the type.
        bytes: u32,
    },
    /// `var<storage>`.
    Storage {
        /// Declared `read`, not `read_write`.
        read_only: bool,
    },
    /// A texture that is loaded from.
    Texture(TextureShape),
}

/// What a texture binding takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextureShape {
    /// `texture_depth_…`.
    pub depth: bool,
    /// `texture_…<u32>` instead of `<f32>`.
    pub unsigned: bool,
    /// `…_2d_array`.
    pub array: bool,
}

/// Whether an entry point reads or writes a binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Access {
    /// It reads.
    pub reads: bool,
    /// It writes.
    pub writes: bool,
}

/// Offsets of a struct's members.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StructLayout {
    /// Bytes of the whole.
    pub bytes: u32,
    /// Name and offset of each member.
    pub members: Vec<(String, u32)>,
}

impl Module {
    /// Parses and validates a linked text, with no capability beyond core WebGPU.
    ///
    /// # Errors
    /// [`ShaderError::Rejected`] with the file and line of naga's complaint.
    pub fn new(linked: Linked) -> Result<Self, ShaderError> {
        let rejected = |line: Option<u32>, message: String| {
            let (file, line) = linked.locate(line.unwrap_or(1) as usize);
            ShaderError::Rejected { file: file.to_owned(), line, message }
        };
        let module = naga::front::wgsl::parse_str(&linked.text).map_err(|error| {
            rejected(error.location(&linked.text).map(|l| l.line_number), error.message().to_owned())
        })?;
        let info =
            Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).map_err(|error| {
                // The shortest span is the expression; longer ones are the function around it.
                let span = error.spans().min_by_key(|(span, _)| span.to_range().map_or(usize::MAX, |r| r.len()));
                let line = span.map(|(span, _)| span.location(&linked.text).line_number);
                let mut message = error.as_inner().to_string();
                let mut source = std::error::Error::source(error.as_inner());
                while let Some(cause) = source {
                    message = format!("{message}: {cause}");
                    source = cause.source();
                }
                rejected(line, message)
            })?;
        let mut entry_points = BTreeMap::new();
        for (index, entry) in module.entry_points.iter().enumerate() {
            let used = info.get_entry_point(index);
            let mut bindings: Vec<Binding> = module
                .global_variables
                .iter()
                .filter(|(handle, _)| !used[*handle].is_empty())
                .filter_map(|(handle, variable)| {
                    let place = variable.binding.as_ref()?;
                    Some(Binding {
                        name: variable.name.clone().unwrap_or_default(),
                        group: place.group,
                        binding: place.binding,
                        kind: kind(&module, variable)?,
                        access: access(used[handle]),
                    })
                })
                .collect();
            bindings.sort_by_key(|b| (b.group, b.binding));
            let stage = match entry.stage {
                naga::ShaderStage::Vertex => Stage::Vertex,
                naga::ShaderStage::Fragment => Stage::Fragment,
                _ => Stage::Compute,
            };
            let workgroup_size = entry.workgroup_size;
            entry_points.insert(entry.name.clone(), EntryPoint { stage, workgroup_size, bindings });
        }
        let structs = module.types.iter().filter_map(|(_, ty)| layout(ty)).collect();
        Ok(Self { linked, entry_points, structs })
    }
}

fn access(used: GlobalUse) -> Access {
    // A query alone (arrayLength, textureDimensions) reads no content.
    Access { reads: used.contains(GlobalUse::READ), writes: used.contains(GlobalUse::WRITE) }
}

fn kind(module: &naga::Module, variable: &naga::GlobalVariable) -> Option<BindingKind> {
    let ty = &module.types[variable.ty];
    match (variable.space, &ty.inner) {
        (naga::AddressSpace::Uniform, inner) => Some(BindingKind::Uniform { bytes: inner.size(module.to_ctx()) }),
        (naga::AddressSpace::Storage { access }, _) => {
            Some(BindingKind::Storage { read_only: !access.contains(naga::StorageAccess::STORE) })
        }
        (_, naga::TypeInner::Image { arrayed, class, .. }) => Some(BindingKind::Texture(TextureShape {
            depth: matches!(class, naga::ImageClass::Depth { .. }),
            unsigned: matches!(class, naga::ImageClass::Sampled { kind: naga::ScalarKind::Uint, .. }),
            array: *arrayed,
        })),
        _ => None,
    }
}

fn layout(ty: &naga::Type) -> Option<(String, StructLayout)> {
    let naga::TypeInner::Struct { members, span } = &ty.inner else { return None };
    let members = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset)).collect();
    Some((ty.name.clone()?, StructLayout { bytes: *span, members }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{Sources, link};

    fn check(text: &str) -> Result<Module, ShaderError> {
        let sources: Sources<'_> =
            &[("shared/one.wgsl", "// one\nfn one() -> f32 { return 1.0; }\n"), ("e.wgsl", text)];
        Module::new(link(sources, "e.wgsl")?)
    }

    #[test]
    fn errors_name_the_file_and_line_that_was_written() {
        let type_error = check("//#import shared/one.wgsl\n\nfn f() -> u32 {\n    return one();\n}\n").unwrap_err();
        assert!(matches!(&type_error, ShaderError::Rejected { file, line: 4, .. } if file == "e.wgsl"), "{type_error}");
        let syntax = check("//#import shared/one.wgsl\nfn f( {}\n").unwrap_err();
        assert!(matches!(&syntax, ShaderError::Rejected { file, line: 2, .. } if file == "e.wgsl"), "{syntax}");
    }

    #[test]
    fn capabilities_beyond_core_are_refused() {
        assert!(check("@compute @workgroup_size(1) fn f() { var x: f64 = 1.0lf; _ = x; }").is_err());
    }

    #[test]
    fn bindings_are_read_one_entry_at_a_time() {
        let module = check(
            "struct S { a: vec3<f32>, b: u32, c: vec3<f32> }
             @group(0) @binding(0) var<uniform> s: S;
             @group(0) @binding(1) var<storage, read> source: array<f32>;
             @group(0) @binding(2) var<storage, read_write> into: array<f32>;
             @group(0) @binding(3) var ids: texture_2d<u32>;
             @compute @workgroup_size(4, 2) fn one() { into[0] = source[s.b]; }
             @compute @workgroup_size(1) fn two() { into[textureLoad(ids, vec2<u32>(0u), 0).x] = 1.0; }",
        )
        .unwrap();
        let names = |entry: &str| -> Vec<String> {
            module.entry_points[entry].bindings.iter().map(|b| b.name.clone()).collect()
        };
        assert_eq!(names("one"), ["s", "source", "into"]);
        assert_eq!(names("two"), ["into", "ids"]);
        let one = &module.entry_points["one"];
        assert_eq!(one.workgroup_size, [4, 2, 1]);
        assert_eq!(one.bindings[0].kind, BindingKind::Uniform { bytes: 32 });
        assert_eq!(one.bindings[1].access, Access { reads: true, writes: false });
        assert_eq!(one.bindings[2].access, Access { reads: false, writes: true });
        assert_eq!(module.structs["S"].members[2], ("c".to_owned(), 16));
    }
}
