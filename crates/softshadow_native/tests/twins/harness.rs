//! Runs a program on both engines and finds the first pass after which a buffer differs.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use softshadow_engine::{AdapterChoice, WgpuEngine};
use softshadow_native::{NativeEngine, NativeSettings};
use softshadow_plan::{
    AdapterInfo, Content, ContentKey, Engine, EngineError, Features, Host, OnStage, Origin, Plan, Program, ResourceId,
    RunReport, Shape, Stage, StageReport, Step, Timing, Work,
};
use softshadow_scene::{Camera, Light, LightShape, LocalScene, Points, Scene, look_at, procedural};
use softshadow_techniques::parts::occluder_buffers::boundary_of;
use softshadow_techniques::{
    OccluderContents, ReceiverSource, SceneContents, Technique, VisibilityProgram, Wants, blocks,
};

/// Mesa's software driver; there must be one.
pub(crate) fn device() -> &'static WgpuEngine {
    static DEVICE: OnceLock<WgpuEngine> = OnceLock::new();
    DEVICE.get_or_init(|| WgpuEngine::new(AdapterChoice::Software).expect("a software Vulkan driver"))
}

/// What both engines can do.
pub(crate) fn host() -> Host {
    Host { features: Features { raster: false, float32_blendable: false }, ..device().host() }
}

/// A scene that comes with the library, with its light and a view of it.
pub(crate) fn shipped(name: &str, size: [u32; 2]) -> (Scene, Light, Source) {
    let shipped = procedural::shipped(name).unwrap();
    let (light, camera) = (shipped.light(), shipped.camera());
    let shape = match light.shape {
        procedural::LightShape::Rectangle { width, height } => LightShape::Rectangle { width, height },
        procedural::LightShape::Disc { radius } => LightShape::Disc { radius },
        procedural::LightShape::Sphere { radius } => LightShape::Sphere { radius },
        procedural::LightShape::Sun { angular_diameter_deg } => {
            LightShape::Sun { angular_diameter: angular_diameter_deg.to_radians() }
        }
    };
    let light = Light::new(shape, look_at(light.position, light.target, Some(light.up)).unwrap()).unwrap();
    let camera = Camera::look_at(camera.eye, camera.target, Some(camera.up), camera.fov_y_deg, size).unwrap();
    (shipped.build().unwrap(), light, Source::Camera(camera))
}

/// What a call is made of.
pub(crate) struct Call {
    pub(crate) technique: Technique,
    pub(crate) scene: SceneContents,
    pub(crate) lights: Vec<Light>,
    pub(crate) receivers: Source,
    pub(crate) wants: Wants,
    /// Receivers of a block at most.
    pub(crate) block: usize,
    /// The label of the pass with which every stage ends before it is begun.
    pub(crate) until: Option<&'static str>,
    /// Labels of passes before it that both engines leave out.
    pub(crate) without: &'static [&'static str],
    /// A buffer that gets so many bytes instead of its own.
    pub(crate) room: Option<(&'static str, u64)>,
}

/// Where receivers come from.
pub(crate) enum Source {
    Camera(Camera),
    Points(Points),
}

impl Source {
    fn as_source(&self) -> ReceiverSource<'_> {
        match self {
            Self::Camera(camera) => ReceiverSource::Camera(camera),
            Self::Points(points) => ReceiverSource::Points(points),
        }
    }
}

/// How the contents of a buffer are compared.
#[derive(Clone, Copy)]
pub(crate) enum Same {
    /// Bit for bit.
    Bits,
    /// As float32 within this distance, not-a-numbers alike.
    Within(f32),
    /// After both were brought into an order of their own.
    Sorted(fn(&[u32]) -> Vec<Vec<u32>>),
    /// As what all buffers say together.
    Said(fn(&Buffers) -> Vec<Vec<u32>>),
    /// Not at all, for this reason.
    Apart(&'static str),
}

impl Call {
    pub(crate) fn new(technique: Technique, scene: &Scene, lights: Vec<Light>, receivers: Source) -> Self {
        let scene = SceneContents::new(LocalScene::new(scene, None, host().limits.storage_binding_bytes));
        let wants = Wants::default();
        Self { technique, scene, lights, receivers, wants, block: 1 << 20, until: None, without: &[], room: None }
    }

    /// Cuts the scene into parts of so many bytes.
    pub(crate) fn cut_scene(&mut self, scene: &Scene, bytes: u64) {
        self.scene = SceneContents::new(LocalScene::new(scene, None, bytes));
    }

    /// Compares every buffer that a pass writes, after every stage. `same` chooses by the buffer's label.
    pub(crate) fn compare(&self, same: impl Fn(&str) -> Same) {
        if let Some(difference) = self.difference(&NativeEngine::new(NativeSettings::default()), None, &same) {
            panic!("{difference}");
        }
    }

    /// Compares what each chosen pass of the first stage leaves, run alone on what the device left before it.
    pub(crate) fn compare_alone(&self, chosen: impl Fn(&str) -> bool, same: impl Fn(&str) -> Same) {
        let native = NativeEngine::new(NativeSettings::default());
        if let Some(difference) = self.difference_alone(&native, chosen, &same) {
            panic!("{difference}");
        }
    }

    /// Compares what the first passes of the first stage leave.
    pub(crate) fn compare_first(&self, passes: usize, same: impl Fn(&str) -> Same) {
        let native = NativeEngine::new(NativeSettings::default());
        if let Some(difference) = self.difference(&native, Some((0, passes)), &same) {
            panic!("{difference}");
        }
    }

    /// The first difference between the device and another engine, in words; of a program that ends after so many passes of a stage.
    pub(crate) fn difference(
        &self,
        native: &dyn Engine,
        end: Option<(usize, usize)>,
        same: &impl Fn(&str) -> Same,
    ) -> Option<String> {
        self.difference_between([device(), native], end, same)
    }

    /// The first difference between two engines.
    pub(crate) fn difference_between(
        &self,
        engines: [&dyn Engine; 2],
        end: Option<(usize, usize)>,
        same: &impl Fn(&str) -> Same,
    ) -> Option<String> {
        self.with_program(|program, contents| difference(program, contents, engines, end, same))
    }

    /// The first difference between the device and another engine that runs each chosen pass of the first stage alone, on what the device
    /// left before it.
    pub(crate) fn difference_alone(
        &self,
        native: &dyn Engine,
        chosen: impl Fn(&str) -> bool,
        same: &impl Fn(&str) -> Same,
    ) -> Option<String> {
        self.with_program(|program, contents| {
            let Step::Run(stage) = program.step(0, &[]) else { unreachable!("a program has a stage") };
            let passes = stage.plan.passes.iter().enumerate().filter(|(_, pass)| chosen(&pass.label));
            let passes: Vec<usize> = passes.map(|(at, _)| at).collect();
            assert!(!passes.is_empty(), "no such pass");
            passes.into_iter().find_map(|at| {
                let [before, after] =
                    [at, at + 1].map(|end| outputs(device(), program, contents, Some((0, end))).remove(0));
                let ours = outputs(native, &alone(&stage, at, &before), contents, None).remove(1);
                let after = after.into_iter().filter(|(label, _)| ours.contains_key(label)).collect();
                let words = differing(&after, &ours, same)?;
                Some(format!("'{}' alone: {words}", stage.plan.passes[at].label))
            })
        })
    }

    /// The program of the call, and what it uploads.
    fn with_program<T>(&self, run: impl FnOnce(&dyn Program, &Contents) -> T) -> T {
        let occluders: Vec<Arc<OccluderContents>> = if self.technique.wants_occluders() {
            let local = &self.scene.local;
            let of = |light| Arc::new(OccluderContents::new(local, boundary_of(local, light)).unwrap());
            self.lights.iter().map(of).collect()
        } else {
            Vec::new()
        };
        let source = self.receivers.as_source();
        let textured = self.lights.iter().any(|light| light.texture().is_some());
        let program = VisibilityProgram {
            technique: &self.technique,
            scene: &self.scene,
            lights: &self.lights,
            occluders: &occluders,
            receivers: source,
            blocks: blocks(source.count(), source.row(), self.technique.halo_rows() as usize, self.block),
            channels: if textured { 3 } else { 1 },
            wants: self.wants,
            host: host(),
        };
        program.check().unwrap();
        let contents = self.scene.contents().chain(occluders.iter().flat_map(|o| o.contents()));
        let contents: BTreeMap<ContentKey, Content> = contents.map(|c| (c.key, c.clone())).collect();
        run(&Part { program: &program, until: self.until, without: self.without, room: self.room }, &contents)
    }
}

type Contents = BTreeMap<ContentKey, Content>;

fn difference(
    program: &dyn Program,
    contents: &Contents,
    engines: [&dyn Engine; 2],
    end: Option<(usize, usize)>,
    same: &impl Fn(&str) -> Same,
) -> Option<String> {
    let whole = engines.map(|engine| outputs(engine, program, contents, end));
    let stage = (0..whole[0].len()).find(|i| differing(&whole[0][*i], &whole[1][*i], same).is_some())?;
    let Step::Run(broken) = program.step(stage, &[]) else { unreachable!("it ran") };
    // Which pass was the first to go astray for good: where the device goes on in another pass, twins are ahead of it for a while.
    let after = |passes| {
        let [theirs, ours] =
            engines.map(|engine| outputs(engine, program, contents, Some((stage, passes))).remove(stage));
        differing(&theirs, &ours, same)
    };
    let last = end.map_or(broken.plan.passes.len(), |(_, passes)| passes);
    let whole = (last, differing(&whole[0][stage], &whole[1][stage], same).unwrap_or_default());
    let astray = (1..=last).rev().map_while(|passes| Some((passes, after(passes)?))).last();
    let (passes, words) = astray.unwrap_or(whole);
    Some(format!("stage {stage}, after '{}': {words}", broken.plan.passes[passes - 1].label))
}

/// A program whose stages end before a pass, and leave others out.
struct Part<'a> {
    program: &'a dyn Program,
    until: Option<&'static str>,
    without: &'static [&'static str],
    room: Option<(&'static str, u64)>,
}

impl Program for Part<'_> {
    fn step(&self, index: usize, decision: &[u32]) -> Step {
        let Step::Run(mut stage) = self.program.step(index, decision) else { return Step::Done };
        let passes = &mut stage.plan.passes;
        if let Some(label) = self.until {
            let end = passes.iter().position(|pass| pass.label == label).expect("a pass of this label");
            passes.truncate(end);
            stage.plan.decision = None;
        }
        passes.retain(|pass| !self.without.contains(&pass.label.as_str()));
        if let Some((label, bytes)) = self.room {
            let id = stage.plan.find(label).expect("a buffer of this label");
            stage.plan.resources[id.index()].shape = Shape::Buffer { bytes };
        }
        Step::Run(stage)
    }
}

/// One pass of a stage, on buffers that already hold something.
struct Alone([Stage; 2]);

impl Program for Alone {
    fn step(&self, index: usize, _: &[u32]) -> Step {
        let Some(Stage { plan, values }) = self.0.get(index) else { return Step::Done };
        Step::run(plan.clone(), values.clone())
    }
}

/// A pass alone. What passes before it wrote is given as parameters to a stage without passes: the native engine keeps buffers by their
/// labels from stage to stage, whatever made them.
fn alone(stage: &Stage, pass: usize, before: &Buffers) -> Alone {
    let Stage { plan, values } = stage;
    let (mut plan, mut given, mut contents) = (plan.clone(), Plan::new("what came before"), values.clone());
    contents.clear();
    let pass = plan.passes.swap_remove(pass);
    plan.passes = vec![pass];
    for resource in &mut plan.resources {
        if let Some(words) = before.get(&resource.label) {
            resource.origin = Origin::Persistent;
            let bytes: &[u8] = bytemuck::cast_slice(words);
            given.parameter(resource.label.clone(), bytes.len() as u64);
            contents.insert(resource.label.clone(), bytes.to_vec());
        }
    }
    plan.outputs = written(&plan);
    Alone([Stage { plan: given, values: contents }, Stage { plan, values: values.clone() }])
}

/// A program whose stages give out every buffer that their passes write; one stage may end early.
struct Open<'a> {
    program: &'a dyn Program,
    cut: Option<(usize, usize)>,
}

impl Program for Open<'_> {
    fn step(&self, index: usize, decision: &[u32]) -> Step {
        let Step::Run(stage) = self.program.step(index, decision) else { return Step::Done };
        let Stage { mut plan, values } = *stage;
        match self.cut {
            Some((stage, _)) if index > stage => return Step::Done,
            Some((stage, passes)) if index == stage => {
                plan.passes.truncate(passes);
                plan.decision = None;
            }
            _ => {}
        }
        plan.outputs = written(&plan);
        Step::run(plan, values)
    }
}

fn written(plan: &Plan) -> Vec<ResourceId> {
    let mut found = Vec::new();
    for pass in &plan.passes {
        let targets = match &pass.work {
            Work::Clear { target } | Work::Copy { target, .. } => vec![*target],
            _ => pass.bindings.iter().map(|(_, id)| *id).collect(),
        };
        for id in targets {
            let resource = &plan.resources[id.index()];
            let is_made = matches!(resource.origin, Origin::Transient | Origin::Persistent);
            if is_made && matches!(resource.shape, Shape::Buffer { .. }) && !found.contains(&id) {
                found.push(id);
            }
        }
    }
    found
}

pub(crate) type Buffers = BTreeMap<String, Vec<u32>>;

/// What every stage leaves in its buffers.
pub(crate) fn outputs(
    engine: &dyn Engine,
    program: &dyn Program,
    contents: &Contents,
    cut: Option<(usize, usize)>,
) -> Vec<Buffers> {
    let mut found = Vec::new();
    let mut keep = |stage: Option<StageReport>| {
        if let Some(stage) = stage {
            let words = |(label, bytes): (String, Cow<'_, [u8]>)| (label, bytemuck::pod_collect_to_vec(&bytes));
            found.push(stage.outputs.into_iter().map(words).collect());
        }
        true
    };
    engine.run(&Open { program, cut }, contents, Timing::Device, &mut keep).unwrap();
    found
}

pub(crate) fn differing(theirs: &Buffers, ours: &Buffers, same: &impl Fn(&str) -> Same) -> Option<String> {
    assert!(theirs.keys().eq(ours.keys()), "the same buffers");
    let all = [theirs, ours];
    theirs.iter().find_map(|(label, theirs)| {
        let ours = &ours[label];
        let close = |within: f32, a: u32, b: u32| {
            let (a, b) = (f32::from_bits(a), f32::from_bits(b));
            a.to_bits() == b.to_bits() || (a - b).abs() <= within || (a.is_nan() && b.is_nan())
        };
        match same(label) {
            Same::Apart(reason) => {
                assert!(!reason.is_empty(), "what is not compared has a reason");
                None
            }
            Same::Bits => first_of(label, theirs, ours, |a, b| a == b),
            Same::Within(most) => first_of(label, theirs, ours, |a, b| close(most, a, b)),
            Same::Sorted(rows) => first_row(label, [rows(theirs), rows(ours)]),
            Same::Said(rows) => first_row(label, all.map(rows)),
        }
    })
}

fn first_row(label: &str, mut rows: [Vec<Vec<u32>>; 2]) -> Option<String> {
    rows.iter_mut().for_each(|rows| rows.sort());
    let [a, b] = rows;
    let at = (0..a.len().max(b.len())).find(|i| a.get(*i) != b.get(*i))?;
    Some(format!("'{label}', row {at}: {:?} there, {:?} here", a.get(at), b.get(at)))
}

fn first_of(label: &str, theirs: &[u32], ours: &[u32], same: impl Fn(u32, u32) -> bool) -> Option<String> {
    assert_eq!(theirs.len(), ours.len(), "'{label}'");
    let count = theirs.iter().zip(ours).filter(|(a, b)| !same(**a, **b)).count();
    let at = theirs.iter().zip(ours).position(|(a, b)| !same(*a, *b))?;
    let (a, b) = (theirs[at], ours[at]);
    let floats = [f32::from_bits(a), f32::from_bits(b)];
    Some(format!(
        "'{label}', word {at}: {a:#x} there, {b:#x} here ({floats:?} as floats); {count} of {} differ",
        ours.len()
    ))
}

/// An engine of whose first word of one output a bit is turned.
pub(crate) struct Spoilt<'a> {
    pub(crate) engine: &'a dyn Engine,
    pub(crate) label: &'static str,
}

impl Engine for Spoilt<'_> {
    fn adapter(&self) -> &AdapterInfo {
        self.engine.adapter()
    }

    fn host(&self) -> Host {
        self.engine.host()
    }

    fn is_lost(&self) -> bool {
        self.engine.is_lost()
    }

    fn destroy(&self) {
        self.engine.destroy();
    }

    fn forget(&self, contents: &[ContentKey]) {
        self.engine.forget(contents);
    }

    fn run(
        &self,
        program: &dyn Program,
        contents: &BTreeMap<ContentKey, Content>,
        timing: Timing,
        on_stage: OnStage<'_>,
    ) -> Result<RunReport, EngineError> {
        let mut spoil = |mut stage: Option<StageReport>| {
            if let Some(bytes) = stage.as_mut().and_then(|stage| stage.outputs.get_mut(self.label)) {
                bytes.to_mut()[0] ^= 1;
            }
            on_stage(stage)
        };
        self.engine.run(program, contents, timing, &mut spoil)
    }
}
