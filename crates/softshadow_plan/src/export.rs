//! Plans as plain data for hosts in other languages: what the types here say by name, and reflection and the schedule by number.

use serde::Serialize;
use softshadow_shaders::{BindingKind, ShaderError};

use crate::check::{PlanError, bindings, check};
use crate::engine::Timing;
use crate::host::Host;
use crate::plan::{Plan, SLICE};
use crate::resource::ResourceId;
use crate::schedule::{Dispatch, schedule};

/// A checked plan, complete but for the text of its shaders, the contents of its uploads and the values of its parameters, which are
/// bytes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Exported<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// What each pass binds in group 0, in the order of the passes.
    pub bindings: Vec<Vec<ExportedBinding>>,
    /// Dispatches, grouped into submissions.
    pub submissions: Vec<Vec<Dispatch>>,
}

/// A binding of a pass, with what is bound.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ExportedBinding {
    /// Its WGSL name.
    pub name: String,
    /// `@binding`.
    pub binding: u32,
    /// What is bound; `None` for the part of the items that a dispatch covers.
    pub resource: Option<ResourceId>,
    /// Whether a texture is bound with all its layers.
    pub is_array: bool,
}

impl<'a> Exported<'a> {
    /// Checks a plan and describes it for a host.
    ///
    /// # Errors
    /// As [`check`].
    pub fn new(plan: &'a Plan, host: &Host) -> Result<Self, PlanError> {
        check(plan, host)?;
        let describe = |pass: &crate::pass::Pass| {
            let described = bindings(pass)?.into_iter().map(|declared| ExportedBinding {
                resource: pass.bindings.iter().find(|(name, _)| *name == declared.name).map(|(_, id)| *id),
                is_array: matches!(declared.kind, BindingKind::Texture(shape) if shape.array),
                name: declared.name,
                binding: declared.binding,
            });
            // `check` has seen that all but this one are bound.
            Ok(described.filter(|b| b.resource.is_some() || b.name == SLICE).collect())
        };
        let bindings = plan.passes.iter().map(describe).collect::<Result<_, PlanError>>()?;
        Ok(Self { plan, bindings, submissions: schedule(plan, host, Timing::Device) })
    }
}

/// The WGSL of a kernel's file, with everything that it imports.
///
/// # Errors
/// [`ShaderError`] where there is no such file.
pub fn shader_text(file: &str) -> Result<&'static str, ShaderError> {
    softshadow_shaders::module(file).map(|module| module.linked.text.as_str())
}
