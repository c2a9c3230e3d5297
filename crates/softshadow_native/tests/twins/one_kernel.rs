//! One kernel alone, on contents that a test makes up: what whole programs rarely hand it, it meets here.

use std::collections::BTreeMap;

use softshadow_native::{NativeEngine, NativeSettings};
use softshadow_plan::{Content, Kernel, Over, Plan, Program, ResourceId, SLICE, Step, Values};
use softshadow_shaders::BindingKind;

use crate::harness::{Same, device, differing, host, outputs};

/// Numbers that look random and are the same in every run (splitmix64).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn word(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as u32
    }

    /// Below `end`.
    pub(crate) fn below(&mut self, end: u32) -> u32 {
        self.word() % end
    }

    /// From 0 to 1, without 1.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.word() >> 8) as f32 / (1 << 24) as f32
    }

    /// From −1 to 1.
    pub(crate) fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }
}

/// `Receiver` of `shared/receiver.wgsl`.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Receiver {
    pub(crate) position: [f32; 3],
    pub(crate) triangle: u32,
    pub(crate) normal: [f32; 3],
    pub(crate) kind: u32,
}

impl Receiver {
    pub(crate) fn new(position: [f32; 3], triangle: u32, normal: [f32; 3], kind: u32) -> Self {
        Self { position, triangle, normal, kind }
    }
}

/// A kernel, and the contents of its buffers by the names of its bindings. What the kernel does not use is left out, so that several can
/// share their contents; a buffer that it writes has its contents before it runs, and what it leaves alone must stay.
#[derive(Clone)]
pub(crate) struct Case {
    kernel: Kernel,
    items: u32,
    contents: BTreeMap<&'static str, Vec<u32>>,
}

/// Writes any words: the one kernel whose result can be any bits.
const WRITE: Kernel = Kernel { file: "resolve/mask_samples.wgsl", entry: "mask_samples" };

impl Case {
    pub(crate) fn new(file: &'static str, entry: &'static str) -> Self {
        Self { kernel: Kernel { file, entry }, items: 1, contents: BTreeMap::new() }
    }

    /// The same contents for another kernel.
    pub(crate) fn kernel(&self, file: &'static str, entry: &'static str) -> Self {
        Self { kernel: Kernel { file, entry }, ..self.clone() }
    }

    /// The same contents for another entry of the file.
    pub(crate) fn entry(&self, entry: &'static str) -> Self {
        self.kernel(self.kernel.file, entry)
    }

    /// The contents of a uniform or a buffer, instead of those it had.
    pub(crate) fn with<T: bytemuck::NoUninit>(mut self, name: &'static str, records: &[T]) -> Self {
        self.contents.insert(name, bytemuck::pod_collect_to_vec(records));
        self
    }

    /// How many items the pass is over.
    pub(crate) fn items(mut self, count: usize) -> Self {
        self.items = count as u32;
        self
    }

    /// Runs the kernel on both engines and compares the buffers that it writes. `same` chooses by the name of the binding.
    pub(crate) fn compare(&self, same: impl Fn(&str) -> Same) {
        if let Some(difference) = self.difference(&same) {
            panic!("{} {difference}", self.kernel);
        }
    }

    /// The first difference, in words.
    pub(crate) fn difference(&self, same: &impl Fn(&str) -> Same) -> Option<String> {
        let (plan, values, uploads) = self.plan();
        let contents = uploads.into_iter().map(|content| (content.key, content)).collect();
        let program = Once { plan, values };
        let native = NativeEngine::new(NativeSettings::default());
        let [theirs, ours] = [device() as &dyn softshadow_plan::Engine, &native]
            .map(|engine| outputs(engine, &program, &contents, None).remove(0));
        differing(&theirs, &ours, same)
    }

    fn plan(&self) -> (Plan, Values, Vec<Content>) {
        let mut making = Making { plan: Plan::new("one kernel"), values: Values::new(), uploads: Vec::new() };
        let module = softshadow_shaders::module(self.kernel.file).unwrap();
        let mut bound: Vec<(&'static str, ResourceId)> = Vec::new();
        for binding in module.entry_points[self.kernel.entry].bindings.iter().filter(|b| b.name != SLICE) {
            let found = self.contents.get_key_value(binding.name.as_str());
            let (name, words) = found.unwrap_or_else(|| panic!("{}: no contents for '{}'", self.kernel, binding.name));
            let id = match binding.kind {
                BindingKind::Uniform { .. } => making.parameter(name, words),
                BindingKind::Storage { read_only: true } => making.uploaded(name, words),
                BindingKind::Storage { read_only: false } => making.written(name, words),
                BindingKind::Texture(_) => panic!("'{name}' is a texture"),
            };
            bound.push((name, id));
        }
        // So much work that engines split it: natively after 1024 items.
        let over = Over::Items { count: self.items, work_per_item: 1 << 14 };
        let pass = making.plan.compute(KERNEL, "is tested", self.kernel, over);
        for (name, id) in bound {
            pass.bind(name, id);
        }
        (making.plan, making.values, making.uploads)
    }
}

const KERNEL: &str = "kernel";

struct Making {
    plan: Plan,
    values: Values,
    uploads: Vec<Content>,
}

impl Making {
    fn parameter(&mut self, label: &str, words: &[u32]) -> ResourceId {
        self.values.insert(label.to_owned(), bytemuck::cast_slice(words).to_vec());
        self.plan.parameter(label, 4 * words.len() as u64)
    }

    fn uploaded(&mut self, label: &str, words: &[u32]) -> ResourceId {
        let content = Content::new(bytemuck::cast_slice(words));
        let id = self.plan.uploaded(label, &content);
        self.uploads.push(content);
        id
    }

    /// A buffer that a kernel may write, with contents: uploads may not be written, nor copied, so another kernel puts them there.
    fn written(&mut self, label: &str, words: &[u32]) -> ResourceId {
        let bits = |word: &u32| std::array::from_fn(|bit| if word >> bit & 1 == 0 { 1.0 } else { 0.0 });
        let bits: Vec<[f32; 32]> = words.iter().map(bits).collect();
        let bits = self.uploaded(&format!("bits of {label}"), bytemuck::cast_slice(&bits));
        let (count, words_each) = (32, 1);
        let sampling = self.parameter(&format!("sampling of {label}"), &[count, words_each, count, 0, 1, 1, 0, 0]);
        let target = self.plan.buffer(label, 4 * words.len() as u64);
        let over = Over::Items { count: words.len() as u32, work_per_item: 1 };
        self.plan
            .compute(format!("fill {label}"), "writes what the kernel finds", WRITE, over)
            .bind("sampling", sampling)
            .bind("sample_transmittance", bits)
            .bind("blocked", target);
        target
    }
}

struct Once {
    plan: Plan,
    values: Values,
}

impl Program for Once {
    fn step(&self, index: usize, _: &[u32]) -> Step {
        match index {
            0 => {
                softshadow_plan::check(&self.plan, &host()).unwrap();
                Step::run(self.plan.clone(), self.values.clone())
            }
            _ => Step::Done,
        }
    }
}
