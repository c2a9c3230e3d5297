//! The WGSL of softshadow: plain files, joined by a small linker, validated and described by naga.
//!
//! A file imports others by comments at its top, `//#import shared/light.wgsl`. Only files outside `shared/` declare bindings;
//! those of one file share one numbering, and plans bind by name.

mod errors;
mod link;
mod reflect;

use std::collections::BTreeMap;
use std::sync::OnceLock;

pub use errors::ShaderError;
pub use link::{Linked, Sources, link};
pub use reflect::{Access, Binding, BindingKind, EntryPoint, Module, Stage, StructLayout, TextureShape};

/// Every file of `shaders_wgsl/`, by path.
pub static EMBEDDED: Sources<'static> = include!(concat!(env!("OUT_DIR"), "/sources.rs"));

/// The linked, validated module of a file, made at first use and kept.
///
/// # Errors
/// [`ShaderError`] with the file and line that a person can open.
pub fn module(file: &str) -> Result<&'static Module, ShaderError> {
    static MODULES: OnceLock<BTreeMap<&'static str, OnceLock<Result<Module, ShaderError>>>> = OnceLock::new();
    let modules = MODULES.get_or_init(|| EMBEDDED.iter().map(|(name, _)| (*name, OnceLock::new())).collect());
    let slot = modules.get(file).ok_or_else(|| ShaderError::UnknownFile { file: file.to_owned() })?;
    slot.get_or_init(|| Module::new(link(EMBEDDED, file)?)).as_ref().map_err(Clone::clone)
}
