//! What can be wrong with a plan, found before any driver is asked.

use std::collections::BTreeSet;

use softshadow_shaders::{Access, Binding, BindingKind, EntryPoint, ShaderError, Stage, TextureShape};

use crate::host::Host;
use crate::pass::{Blend, ColorTarget, Count, Over, Pass, Raster, VertexSource, Work};
use crate::plan::{Plan, SLICE};
use crate::resource::{Origin, Resource, ResourceId, Shape, TextureFormat};

/// Bytes of one corner of [`VertexSource::Corners`].
const CORNER_BYTES: u64 = 16;

/// A plan that cannot run, with the pass, the binding or the resource that is at fault.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A shader is broken or missing.
    #[error("pass '{pass}': {error}")]
    Shader {
        /// The pass.
        pass: String,
        /// The shader's error.
        error: ShaderError,
    },
    /// Something about a pass contradicts its kernel.
    #[error("pass '{pass}', binding '{binding}': {problem}")]
    Binding {
        /// The pass.
        pass: String,
        /// The WGSL name.
        binding: String,
        /// What is wrong.
        problem: String,
    },
    /// A label stands twice.
    #[error("the label '{label}' stands twice")]
    DuplicateLabel {
        /// The label.
        label: String,
    },
    /// A pass reads what nothing has written.
    #[error("pass '{pass}' reads '{resource}' before anything is written to it")]
    ReadBeforeWrite {
        /// The pass.
        pass: String,
        /// The resource.
        resource: String,
    },
    /// A size that the host does not take.
    #[error("'{what}' needs {needed}, the host allows {limit}")]
    TooLarge {
        /// The resource or pass.
        what: String,
        /// Bytes, texels or counts needed.
        needed: u64,
        /// How many the host takes.
        limit: u64,
    },
    /// An ability that the host lacks.
    #[error("pass '{pass}' needs {feature}, which the host lacks")]
    MissingFeature {
        /// The pass.
        pass: String,
        /// The ability.
        feature: &'static str,
    },
}

/// Checks labels, bindings, kinds, order of writes and reads, and the host's limits.
///
/// # Errors
/// The first [`PlanError`] found.
pub fn check(plan: &Plan, host: &Host) -> Result<(), PlanError> {
    let mut labels = BTreeSet::new();
    let passes = plan.passes.iter().map(|p| (true, p.label.as_str()));
    for (is_pass, label) in passes.chain(plan.resources.iter().map(|r| (false, r.label.as_str()))) {
        if !labels.insert((is_pass, label)) {
            return Err(PlanError::DuplicateLabel { label: label.to_owned() });
        }
    }
    for resource in &plan.resources {
        check_size(resource, host)?;
    }
    // Persistent contents were written by an earlier stage, or are zero on purpose.
    let mut written: BTreeSet<ResourceId> = (0..plan.resources.len() as u32)
        .map(ResourceId)
        .filter(|id| !matches!(plan.resources[id.index()].origin, Origin::Transient))
        .collect();
    for pass in &plan.passes {
        check_pass(plan, pass, host, &mut written)?;
    }
    for output in plan.outputs.iter().chain(&plan.decision) {
        require_written("output", plan, *output, &written)?;
        require_buffer("output", plan, *output, 4)?;
    }
    Ok(())
}

fn check_size(resource: &Resource, host: &Host) -> Result<(), PlanError> {
    let too_large = |needed: u64, limit: u64| {
        if needed <= limit {
            return Ok(());
        }
        Err(PlanError::TooLarge { what: resource.label.clone(), needed, limit })
    };
    let meaningless = |problem: &str| {
        let (pass, binding) = ("resources".to_owned(), resource.label.clone());
        Err(PlanError::Binding { pass, binding, problem: problem.to_owned() })
    };
    match resource.shape {
        Shape::Buffer { bytes } => too_large(bytes, host.limits.buffer_bytes),
        Shape::Texture { .. } if matches!(resource.origin, Origin::Uploaded(_) | Origin::Parameter) => {
            meaningless("only buffers are uploaded")
        }
        Shape::Texture { size: [0, _] | [_, 0], .. } | Shape::Texture { layers: 0, .. } => meaningless("has no texel"),
        Shape::Texture { size, layers, .. } => {
            too_large(u64::from(size[0].max(size[1])), u64::from(host.limits.texture_size))?;
            too_large(u64::from(layers), u64::from(host.limits.texture_layers))
        }
    }
}

fn check_pass(plan: &Plan, pass: &Pass, host: &Host, written: &mut BTreeSet<ResourceId>) -> Result<(), PlanError> {
    let read = |id: ResourceId, written: &BTreeSet<ResourceId>| require_written(&pass.label, plan, id, written);
    match &pass.work {
        Work::Clear { target } => {
            require_buffer(&pass.label, plan, *target, 4)?;
            written.insert(*target);
        }
        Work::Copy { source, target, bytes } => {
            read(*source, written)?;
            require_buffer(&pass.label, plan, *source, 4)?;
            require_buffer(&pass.label, plan, *target, 4)?;
            if source == target || !bytes.is_multiple_of(4) {
                let problem = "copies go from one buffer to another, in multiples of four bytes".to_owned();
                return Err(PlanError::Binding { pass: pass.label.clone(), binding: "copy".into(), problem });
            }
            for id in [source, target] {
                let limit = plan.resources[id.index()].bytes();
                if *bytes > limit {
                    return Err(PlanError::TooLarge { what: pass.label.clone(), needed: *bytes, limit });
                }
            }
            written.insert(*target);
        }
        Work::Compute { kernel, over } => {
            let entry = entry_point(pass, kernel.file, kernel.entry, Stage::Compute)?;
            if let Over::Indirect(buffer) = over {
                read(*buffer, written)?;
                require_buffer(&pass.label, plan, *buffer, 12)?;
            }
            let takes_slice = entry.bindings.iter().any(|b| b.name == SLICE);
            if matches!(over, Over::Items { .. }) != takes_slice {
                let problem = "passes over items, and only they, have a kernel with this uniform".to_owned();
                return Err(PlanError::Binding { pass: pass.label.clone(), binding: SLICE.into(), problem });
            }
            check_bindings(plan, pass, host, entry.bindings.iter().filter(|b| b.name != SLICE), written)?;
        }
        Work::Raster(raster) => check_raster(plan, pass, raster, host, written)?,
    }
    Ok(())
}

fn check_raster(
    plan: &Plan,
    pass: &Pass,
    raster: &Raster,
    host: &Host,
    written: &mut BTreeSet<ResourceId>,
) -> Result<(), PlanError> {
    let missing = |feature| PlanError::MissingFeature { pass: pass.label.clone(), feature };
    if !host.features.raster {
        return Err(missing("raster"));
    }
    let targets = raster.colors.len() as u64;
    if targets > u64::from(host.limits.color_targets) {
        let limit = u64::from(host.limits.color_targets);
        return Err(PlanError::TooLarge { what: pass.label.clone(), needed: targets, limit });
    }
    let bytes =
        raster.colors.iter().map(|c| plan.resources[c.texture.index()].shape).map(Shape::texel_bytes).sum::<u64>();
    if bytes > u64::from(host.limits.color_bytes) {
        let limit = u64::from(host.limits.color_bytes);
        return Err(PlanError::TooLarge { what: format!("{}, bytes of a pixel", pass.label), needed: bytes, limit });
    }
    if raster.colors.iter().any(|c| c.blend != Blend::Replace) && !host.features.float32_blendable {
        return Err(missing("float32-blendable"));
    }
    let draws_floats = |c: &ColorTarget| {
        matches!(plan.resources[c.texture.index()].shape, Shape::Texture { format: TextureFormat::Rgba32Float, .. })
    };
    if raster.colors.iter().any(draws_floats) && !host.features.float32_drawable {
        return Err(missing("rgba32float colour targets"));
    }
    match raster.vertices {
        VertexSource::Corners { buffer, count } => {
            require_written(&pass.label, plan, buffer, written)?;
            let resource = &plan.resources[buffer.index()];
            let needed = u64::from(count) * CORNER_BYTES;
            if !matches!(resource.shape, Shape::Buffer { bytes } if bytes >= needed.max(CORNER_BYTES)) {
                let problem = format!("must be a buffer of at least {needed} bytes of corners");
                return Err(PlanError::Binding { pass: pass.label.clone(), binding: resource.label.clone(), problem });
            }
        }
        VertexSource::Generated(Count::Indirect(buffer)) => {
            require_written(&pass.label, plan, buffer, written)?;
            require_buffer(&pass.label, plan, buffer, 16)?;
        }
        VertexSource::Generated(Count::Fixed(_)) => {}
    }
    check_bindings(plan, pass, host, bindings(pass)?.iter(), written)?;
    let colors = raster.colors.iter().map(|c| (c.texture, c.layer, c.clear, false));
    let depth = raster.depth.iter().map(|d| (d.texture, d.layer, d.clear.map(f64::from), true));
    for (texture, layer, clear, is_depth) in colors.chain(depth) {
        let resource = &plan.resources[texture.index()];
        let wrong = |problem: &str| {
            let (pass, binding) = (pass.label.clone(), resource.label.clone());
            Err(PlanError::Binding { pass, binding, problem: problem.to_owned() })
        };
        let Shape::Texture { layers, format, .. } = resource.shape else {
            return wrong("is drawn to but is a buffer");
        };
        if is_depth != (format == TextureFormat::Depth32Float) {
            return wrong("depth goes to a depth texture, colour to another");
        }
        if layer >= layers {
            let (needed, limit) = (u64::from(layer) + 1, u64::from(layers));
            return Err(PlanError::TooLarge { what: resource.label.clone(), needed, limit });
        }
        if clear.is_some_and(|value| !value.is_finite()) {
            return wrong("is cleared to a number that is not finite, which not every host takes");
        }
        if clear.is_none() {
            require_written(&pass.label, plan, texture, written)?;
        }
        written.insert(texture);
    }
    Ok(())
}

fn check_bindings<'a>(
    plan: &Plan,
    pass: &Pass,
    host: &Host,
    declared: impl Iterator<Item = &'a Binding> + Clone,
    written: &mut BTreeSet<ResourceId>,
) -> Result<(), PlanError> {
    let fail = |name: &str, problem: String| {
        Err(PlanError::Binding { pass: pass.label.clone(), binding: name.to_owned(), problem })
    };
    for (name, _) in &pass.bindings {
        if !declared.clone().any(|b| b.name == *name) {
            return fail(name, "the kernel uses no such binding".into());
        }
    }
    let buffers = declared.clone().filter(|b| matches!(b.kind, BindingKind::Storage { .. })).count() as u64;
    if buffers > u64::from(host.limits.storage_buffers) {
        let limit = u64::from(host.limits.storage_buffers);
        return Err(PlanError::TooLarge { what: pass.label.clone(), needed: buffers, limit });
    }
    for binding in declared {
        let mut bound = pass.bindings.iter().filter(|(name, _)| *name == binding.name);
        let (Some((_, id)), None) = (bound.next(), bound.next()) else {
            return fail(&binding.name, "must be bound exactly once".into());
        };
        let resource = &plan.resources[id.index()];
        if let Some(problem) = mismatch(binding, resource, host) {
            return fail(&binding.name, problem);
        }
        let Access { reads, writes } = binding.access;
        if reads && !writes {
            require_written(&pass.label, plan, *id, written)?;
        }
        if writes {
            written.insert(*id);
        }
    }
    Ok(())
}

/// Why a resource does not fit a binding.
fn mismatch(binding: &Binding, resource: &Resource, host: &Host) -> Option<String> {
    let label = &resource.label;
    match (binding.kind, resource.shape) {
        (BindingKind::Uniform { bytes }, Shape::Buffer { bytes: given }) if u64::from(bytes) != given => {
            Some(format!("the uniform has {bytes} bytes, '{label}' has {given}"))
        }
        (BindingKind::Uniform { .. }, Shape::Buffer { .. }) if resource.origin != Origin::Parameter => {
            Some(format!("a uniform is a parameter, '{label}' is none"))
        }
        (BindingKind::Storage { .. }, Shape::Buffer { bytes: 0 }) => Some(format!("'{label}' is empty")),
        (BindingKind::Storage { .. }, Shape::Buffer { bytes }) if bytes > host.limits.storage_binding_bytes => {
            let limit = host.limits.storage_binding_bytes;
            Some(format!("'{label}' has {bytes} bytes, the host binds at most {limit}"))
        }
        (BindingKind::Storage { read_only: false }, Shape::Buffer { .. })
            if matches!(resource.origin, Origin::Uploaded(_) | Origin::Parameter) =>
        {
            Some(format!("'{label}' is uploaded and must not be written"))
        }
        (BindingKind::Uniform { .. } | BindingKind::Storage { .. }, Shape::Buffer { .. }) => None,
        (BindingKind::Texture(TextureShape { depth, unsigned, array }), Shape::Texture { format, layers, .. }) => {
            // A depth texture may also be read as plain float32.
            let fits = (!depth || format == TextureFormat::Depth32Float)
                && unsigned == (format == TextureFormat::R32Uint)
                && (array || layers == 1);
            (!fits).then(|| format!("the shader's texture type does not fit '{label}'"))
        }
        _ => Some(format!("a buffer meets a texture: '{label}'")),
    }
}

/// What the kernel of a pass binds, each once: that of both stages where it draws, and nothing where it has no kernel.
///
/// # Errors
/// [`PlanError::Shader`] where the kernel does not exist.
pub fn bindings(pass: &Pass) -> Result<Vec<Binding>, PlanError> {
    let raster = match &pass.work {
        Work::Clear { .. } | Work::Copy { .. } => return Ok(Vec::new()),
        Work::Compute { kernel, .. } => {
            return Ok(entry_point(pass, kernel.file, kernel.entry, Stage::Compute)?.bindings.clone());
        }
        Work::Raster(raster) => raster,
    };
    let mut found = entry_point(pass, raster.kernel.file, raster.kernel.vertex, Stage::Vertex)?.bindings.clone();
    if let Some(fragment) = raster.kernel.fragment {
        for binding in &entry_point(pass, raster.kernel.file, fragment, Stage::Fragment)?.bindings {
            match found.iter_mut().find(|b| b.name == binding.name) {
                Some(shared) => {
                    shared.access.reads |= binding.access.reads;
                    shared.access.writes |= binding.access.writes;
                }
                None => found.push(binding.clone()),
            }
        }
    }
    Ok(found)
}

fn entry_point(pass: &Pass, file: &str, entry: &str, stage: Stage) -> Result<&'static EntryPoint, PlanError> {
    let module =
        softshadow_shaders::module(file).map_err(|error| PlanError::Shader { pass: pass.label.clone(), error })?;
    let found = module.entry_points.get(entry).filter(|e| e.stage == stage);
    found.ok_or_else(|| PlanError::Shader {
        pass: pass.label.clone(),
        error: ShaderError::UnknownFile { file: format!("{file}:{entry}") },
    })
}

/// A buffer that passes write: it can be read back, copied, and used as a count.
fn require_buffer(pass: &str, plan: &Plan, id: ResourceId, at_least: u64) -> Result<(), PlanError> {
    let resource = &plan.resources[id.index()];
    let fail =
        |problem: String| Err(PlanError::Binding { pass: pass.to_owned(), binding: resource.label.clone(), problem });
    match (resource.shape, resource.origin) {
        (Shape::Texture { .. }, _) => fail("is a texture where a buffer is needed".into()),
        (_, Origin::Uploaded(_)) => fail("is uploaded and must not be written or read back".into()),
        (_, Origin::Parameter) => fail("is a parameter and must not be written or read back".into()),
        (Shape::Buffer { bytes }, _) if bytes < at_least => fail(format!("has {bytes} bytes, {at_least} are needed")),
        _ => Ok(()),
    }
}

fn require_written(pass: &str, plan: &Plan, id: ResourceId, written: &BTreeSet<ResourceId>) -> Result<(), PlanError> {
    if written.contains(&id) {
        return Ok(());
    }
    Err(PlanError::ReadBeforeWrite { pass: pass.to_owned(), resource: plan.resources[id.index()].label.clone() })
}
