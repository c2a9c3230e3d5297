//! `visibility`: which fraction of each light every receiver sees.

use std::borrow::Cow;
use std::collections::BTreeMap;

use softshadow_plan::{AdapterInfo, Host, PassWork, RunReport, StageReport, Timing};
use softshadow_scene::{Light, LocalFrame, Receivers, Scene};
use softshadow_techniques::depth_complexity::LIST_COUNTS;
use softshadow_techniques::depth_complexity::blended::{LARGEST_COUNTS, Largest};
use softshadow_techniques::occlusion_camera::{CAMERA_COUNTS, CameraCounts};
use softshadow_techniques::occlusion_layers::{CASTER_BOUNDS, NEAR_COUNTS, edge_on_share};
use softshadow_techniques::parts::VISIBILITY;
use softshadow_techniques::parts::interleaving::NOISY_BYTES;
use softshadow_techniques::parts::receivers::{RECEIVER_BYTES, RECEIVERS, Receiver};
use softshadow_techniques::parts::resolve::{BLOCKED, STANDARD_ERROR};
use softshadow_techniques::parts::shading::COLOR;
use softshadow_techniques::penumbra_map::STRAYS;
use softshadow_techniques::ray_traced::TRACE_COUNTS;
use softshadow_techniques::{
    Block, ReceiverSource, SceneContents, Shading, Technique, VisibilityProgram, Wants, blocks,
};

use crate::Progress;
use crate::context::{Context, Device};
use crate::error::Error;
use crate::info::{Info, Preparation, edge_on_note, notes};
use crate::scene_cache::Prepared;

/// What a caller may want beside the values, and how much memory a call may take.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Bytes that receivers and their results may take on the device; receivers are processed in blocks within it.
    pub memory_limit_bytes: u64,
    /// Return the standard error of every value.
    pub standard_error: bool,
    /// Return the receivers as every technique used them.
    pub receivers: bool,
    /// Return which samples were blocked, of the last progressive pass: those to which nothing passes. Only techniques that trace
    /// every sample have them.
    pub sample_masks: bool,
    /// How passes are timed.
    pub timing: Timing,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            memory_limit_bytes: 1 << 30,
            standard_error: false,
            receivers: false,
            sample_masks: false,
            timing: Timing::Device,
        }
    }
}

/// Visibility of every light from every receiver.
#[derive(Debug, Clone, PartialEq)]
pub struct Visibility {
    /// Number of lights.
    pub lights: usize,
    /// Number of receivers.
    pub receivers: usize,
    /// 1, or 3 where a light of the call has a texture.
    pub channels: usize,
    /// `[width, height]` where a camera was given; receivers are its pixels, row by row.
    pub image: Option<[u32; 2]>,
    /// lights × receivers × channels; 1 = fully lit, NaN only where the camera sees nothing.
    pub values: Vec<f32>,
    /// Whether each receiver sees anything; false only for pixels of the background.
    pub valid: Vec<bool>,
    /// Standard error of each value, where it was asked for and the technique has one.
    pub standard_error: Option<Vec<f32>>,
    /// The receivers, where they were asked for.
    pub placed: Option<Placed>,
    /// Which samples were blocked, where that was asked for.
    pub masks: Option<SampleMasks>,
    /// What made this result.
    pub info: Info,
}

/// Receivers as every technique used them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Placed {
    /// World positions of the stored float32 origins, lifted off their surface.
    pub positions: Vec<[f64; 3]>,
    /// Unit normals; zero without.
    pub normals: Vec<[f32; 3]>,
    /// The caller's triangle id; −1 without.
    pub triangles: Vec<i64>,
}

/// One bit a sample, set where the sample is blocked: where nothing passes to it. Semi-opaque triangles alone block none, unless what
/// passes them is nothing in float32.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SampleMasks {
    /// Words of 32 bits a receiver; sample `i` is bit `i % 32` of word `i / 32`.
    pub words: usize,
    /// lights × receivers × words.
    pub bits: Vec<u32>,
}

impl SampleMasks {
    /// lights × receivers × samples: whether each of the first `samples` samples is visible.
    #[must_use]
    pub fn visible(&self, samples: usize) -> Vec<bool> {
        let row = |words: &[u32]| (0..samples).map(|i| words[i / 32] >> (i % 32) & 1 == 0).collect::<Vec<bool>>();
        self.bits.chunks_exact(self.words.max(1)).flat_map(row).collect()
    }
}

/// Computes visibility.
///
/// # Errors
/// Any [`Error`]; the context stays usable.
pub fn visibility(
    context: &Context,
    scene: &Scene,
    lights: &[Light],
    receivers: &Receivers,
    technique: &Technique,
    options: &Options,
    on_progress: Progress<'_>,
) -> Result<Visibility, Error> {
    let device = context.device([technique])?;
    Ok(run(device, scene, lights, receivers, technique, options, None, on_progress)?.0)
}

/// Computes visibility and, with `picture`, linear colour a receiver.
#[expect(clippy::too_many_arguments, reason = "the union of what its two callers take")]
pub(crate) fn run(
    device: &Device,
    scene: &Scene,
    lights: &[Light],
    receivers: &Receivers,
    technique: &Technique,
    options: &Options,
    picture: Option<Shading>,
    on_progress: Progress<'_>,
) -> Result<(Visibility, Vec<[f32; 4]>), Error> {
    let engine = device.engine()?;
    let host = engine.host();
    check_call(lights, receivers, technique, &host)?;
    check_results(lights.len(), receivers, technique, options)?;
    let hidden = hidden_lights(lights, receivers, technique);
    let prepared = device.prepare(scene, receivers, hidden)?;
    let contents = &prepared.contents;
    technique.check_scene(contents)?;
    let channels = channels_of(lights);
    let notes = notes(scene, lights, technique, &contents.local).into_iter().chain(device.stands_in()).collect();
    let mut collector =
        Collector::new(device.adapter(), notes, lights, receivers, technique, options, contents, channels, true);
    collector.result.info.preparation = prepared.preparation.clone();
    let Some(program) = program(&prepared, lights, receivers, technique, options, picture, host)? else {
        return Ok(collector.finish(RunReport::default()));
    };
    collector.describe(&program);
    let uploads = prepared.uploads();
    let total = program.stages() as u64;
    let mut done = 0;
    let report = engine.run(&program, &uploads, options.timing, &mut |stage: Option<StageReport<'_>>| {
        if let Some(stage) = &stage {
            done += 1;
            collector.add_stage(&program, stage);
        }
        on_progress(done, total)
    })?;
    collector.check(technique)?;
    if report.stages as u64 != total {
        return Err(Error::Gpu(format!("only {} of {total} stages ran", report.stages)));
    }
    Ok(collector.finish(report))
}

/// What is checked before anything is made.
pub(crate) fn check_call(
    lights: &[Light],
    receivers: &Receivers,
    technique: &Technique,
    host: &Host,
) -> Result<(), Error> {
    technique.check()?;
    if lights.is_empty() {
        return Err(Error::Settings("at least one light is needed".into()));
    }
    technique.check_call(source_of(receivers), lights, host)?;
    if let Receivers::Camera(camera) = receivers {
        let (needed, limit) = (u64::from(camera.size()[0].max(camera.size()[1])), u64::from(host.limits.texture_size));
        if needed > limit {
            return Err(Error::TooLarge { what: "pixels of the image's longer side".into(), needed, limit });
        }
    }
    Ok(())
}

/// The lights for which a call has to know what hides them.
pub(crate) fn hidden_lights<'a>(lights: &'a [Light], receivers: &Receivers, technique: &Technique) -> &'a [Light] {
    let wants_occluders = technique.wants_occluders() && receivers.count() > 0;
    if wants_occluders { lights } else { &[] }
}

/// Channels of a value: three where a light of the call has a texture.
pub(crate) fn channels_of(lights: &[Light]) -> usize {
    if lights.iter().any(|l| l.texture().is_some()) { 3 } else { 1 }
}

/// Samples of a technique that has them, and so a standard error.
pub(crate) fn samples_of(technique: &Technique) -> Option<u32> {
    match technique {
        Technique::RayTraced(settings) => Some(settings.samples),
        Technique::DepthComplexity(settings) => Some(settings.samples),
        _ => None,
    }
}

pub(crate) fn source_of(receivers: &Receivers) -> ReceiverSource<'_> {
    match receivers {
        Receivers::Camera(camera) => ReceiverSource::Camera(camera),
        Receivers::Points(points) => ReceiverSource::Points(points),
    }
}

/// The checked program of a call; `None` where no receiver sees anything.
pub(crate) fn program<'a>(
    prepared: &'a Prepared,
    lights: &'a [Light],
    receivers: &'a Receivers,
    technique: &'a Technique,
    options: &Options,
    picture: Option<Shading>,
    host: Host,
) -> Result<Option<VisibilityProgram<'a>>, Error> {
    let (contents, channels, source) = (&prepared.contents, channels_of(lights), source_of(receivers));
    let sees_nothing = matches!(receivers, Receivers::Camera(_)) && contents.local.sub_scenes.is_empty();
    if receivers.count() == 0 || sees_nothing {
        return Ok(None);
    }
    let wants = Wants { standard_error: options.standard_error, sample_masks: options.sample_masks, picture };
    let most = receivers_per_block(technique, options, channels, picture.is_some(), &host, source.row(), contents)?;
    let program = VisibilityProgram {
        technique,
        scene: contents,
        lights,
        occluders: &prepared.occluders,
        receivers: source,
        blocks: blocks(source.count(), source.row(), technique.halo_rows() as usize, most),
        channels: channels as u32,
        wants,
        host,
    };
    program.check()?;
    Ok(Some(program))
}

/// What the results of a call may take.
const MAX_RESULT_BYTES: u64 = 1 << 36;

/// Checks that there is room for the results of a call, before it computes any.
fn check_results(lights: usize, receivers: &Receivers, technique: &Technique, options: &Options) -> Result<(), Error> {
    // Values and standard errors in three channels, whether a sample is visible (a bit, then a byte), positions, normals and triangles.
    let samples = if options.sample_masks { u64::from(technique.samples()) } else { 0 };
    let each =
        u128::from(24 + samples + samples.div_ceil(32) * 4) * lights as u128 + if options.receivers { 45 } else { 1 };
    let needed = u64::try_from(each * u128::from(receivers.count())).unwrap_or(u64::MAX);
    if needed > MAX_RESULT_BYTES {
        return Err(Error::TooLarge { what: "bytes of results".into(), needed, limit: MAX_RESULT_BYTES });
    }
    // A vector that finds no room ends the process; this one does not.
    if Vec::<u8>::new().try_reserve_exact(needed as usize).is_err() {
        return Err(Error::OutOfMemory(format!(
            "no room for {needed} bytes of results; ask for fewer receivers or lights at a time"
        )));
    }
    Ok(())
}

/// The work of a call, pass by pass, without running it: that of its first stage, and how many such stages there are.
pub(crate) fn work(
    device: &Device,
    scene: &Scene,
    lights: &[Light],
    receivers: &Receivers,
    technique: &Technique,
) -> Result<(Vec<PassWork>, usize), Error> {
    let host = device.engine()?.host();
    check_call(lights, receivers, technique, &host)?;
    let prepared = device.prepare(scene, receivers, hidden_lights(lights, receivers, technique))?;
    technique.check_scene(&prepared.contents)?;
    technique.check_occluders(&prepared.occluders)?;
    let program = program(&prepared, lights, receivers, technique, &Options::default(), None, host)?;
    let Some((program, task)) = program.and_then(|program| program.task(0).map(|task| (program, task))) else {
        return Ok((Vec::new(), 0));
    };
    let found = program.blocks[task.block].count as f64;
    Ok((program.plan(task, &[]).work(found), program.stages()))
}

/// Rays that a block may need at most, but for a block of a single row: some seconds on a slow software driver. A caller can stop
/// between blocks.
const RAYS_PER_BLOCK: u64 = 1 << 26;

/// How many receivers fit the memory limit and the device's bindings.
fn receivers_per_block(
    technique: &Technique,
    options: &Options,
    channels: usize,
    picture: bool,
    host: &Host,
    row: usize,
    scene: &SceneContents,
) -> Result<usize, Error> {
    let sub_scenes = scene.local.sub_scenes.len() as u64;
    let technique_bytes = technique.bytes_per_receiver(channels as u64, sub_scenes, scene.opacity.is_some());
    // Rays of a block are bounded, so that a dispatch over them ends in time and a caller can stop between blocks.
    let most_for_rays = RAYS_PER_BLOCK / u64::from(technique.samples()).max(1);
    // The receiver, the point it came from, and the picture's colour, before and after it is averaged.
    let colors = if technique.interleaves() { 16 + NOISY_BYTES } else { 16 };
    let each = 2 * RECEIVER_BYTES + technique_bytes + if picture { colors } else { 0 };
    let largest_buffer = technique_bytes.max(RECEIVER_BYTES);
    let binding = host.limits.storage_binding_bytes.min(host.limits.buffer_bytes);
    let most = (options.memory_limit_bytes / each).min(binding / largest_buffer).min(1 << 30) as usize;
    let rows = 1 + 2 * technique.halo_rows() as usize;
    let most = most.min((most_for_rays as usize).max(row * rows));
    if most < row * rows {
        let needed = (row * rows) as u64 * each;
        let what = format!("bytes for {rows} row(s) of receivers at these settings");
        return Err(Error::TooLarge {
            what,
            needed,
            limit: options.memory_limit_bytes.min(binding / largest_buffer * each),
        });
    }
    Ok(most)
}

/// An output's records, where they lie if they can be read there.
fn records<T: bytemuck::Pod>(bytes: &[u8]) -> Cow<'_, [T]> {
    bytemuck::try_cast_slice(bytes).map_or_else(|_| Cow::Owned(bytemuck::pod_collect_to_vec(bytes)), Cow::Borrowed)
}

/// Puts the blocks' outputs where they belong.
pub(crate) struct Collector<'a> {
    pub(crate) result: Visibility,
    colors: Vec<[f32; 4]>,
    frame: LocalFrame,
    caller_ids: &'a [u32],
    /// Rays that the driver cut short.
    unfinished: u64,
    /// Receivers with more attenuation than a sum holds.
    overflowed: u64,
    /// Receivers that no wedge is sure to reach.
    astray: u64,
    /// Receivers that no texel of a penumbra map shows.
    unmapped: u64,
}

impl<'a> Collector<'a> {
    #[expect(clippy::too_many_arguments, reason = "everything that a result reports")]
    pub(crate) fn new(
        adapter: &AdapterInfo,
        notes: Vec<String>,
        lights: &[Light],
        receivers: &Receivers,
        technique: &Technique,
        options: &Options,
        contents: &'a SceneContents,
        channels: usize,
        reads_values: bool,
    ) -> Self {
        let count = if reads_values { receivers.count() as usize } else { 0 };
        let size = lights.len() * count * channels;
        let sampled = samples_of(technique);
        let has_error = sampled.is_some();
        let info = Info {
            adapter: adapter.clone(),
            technique: technique.clone(),
            lights: lights.len(),
            receivers: receivers.count() as usize,
            valid_receivers: None,
            traced_receivers: 0,
            area_receivers: 0,
            silhouette_edges: 0,
            colliding_receivers: 0,
            camera_steps: 0,
            camera_bias: 0.0,
            occluder_units: Vec::new(),
            cut_triangles: 0,
            touching_triangles: 0,
            triangles_behind: 0,
            preparation: Preparation::default(),
            wall_ms: 0.0,
            pass_ms: Vec::new(),
            bytes: Vec::new(),
            submissions: 0,
            blocks: 0,
            zero_area_triangles: contents.local.dropped.zero_area,
            unresolved_triangles: contents.local.dropped.below_resolution,
            invisible_triangles: contents.local.dropped.invisible,
            notes,
            error_kind: if has_error { "statistical" } else { "none" },
            standard_error: None,
            choice: None,
            plan: String::new(),
        };
        let masks = sampled.filter(|_| options.sample_masks).map(|samples| {
            let words = samples.div_ceil(32) as usize;
            SampleMasks { words, bits: vec![u32::MAX; lights.len() * count * words] }
        });
        let placed = options.receivers.then(|| Placed {
            positions: vec![[f64::NAN; 3]; count],
            normals: vec![[0.0; 3]; count],
            triangles: vec![-1; count],
        });
        let result = Visibility {
            lights: lights.len(),
            receivers: count,
            channels,
            image: match receivers {
                Receivers::Camera(camera) => Some(camera.size()),
                Receivers::Points(_) => None,
            },
            values: vec![f32::NAN; size],
            valid: vec![false; count],
            standard_error: (options.standard_error && has_error).then(|| vec![f32::NAN; size]),
            placed,
            masks,
            info,
        };
        let frame = contents.local.frame;
        let caller_ids = &contents.local.caller_ids;
        Self { result, colors: Vec::new(), frame, caller_ids, unfinished: 0, overflowed: 0, astray: 0, unmapped: 0 }
    }

    /// Says what a program is going to do.
    pub(crate) fn describe(&mut self, program: &VisibilityProgram<'_>) {
        let (info, occluders) = (&mut self.result.info, program.occluders);
        if let Technique::DepthComplexity(settings) = program.technique {
            info.occluder_units = occluders.iter().map(|o| settings.unit_used(o)).collect();
        }
        let touching = occluders.iter().filter_map(|o| o.touching.as_ref());
        info.touching_triangles = touching.map(|t| t.count as usize).sum();
        if let (Technique::PenumbraMap(_), count @ 1..) = (program.technique, info.touching_triangles) {
            info.notes.push(format!("{count} triangles touch a ball of light: penumbra_map gives them hard shadows"));
        }
        info.cut_triangles = occluders.iter().map(|o| o.cut_triangles).sum();
        info.triangles_behind = occluders.iter().map(|o| o.triangles_behind).sum();
        info.plan = program.task(0).map_or_else(String::new, |task| program.plan(task, &[]).explain());
        info.blocks = program.blocks.len();
    }

    /// Adds what a stage found.
    pub(crate) fn add_stage(&mut self, program: &VisibilityProgram<'_>, stage: &StageReport<'_>) {
        if let Some(task) = program.task(stage.index) {
            self.add(program.blocks[task.block], task.light, &stage.outputs);
        }
        // The plan of a later stage follows from what the first one found.
        if let (0, Some(task), Some(found)) =
            (stage.index, program.task(1).filter(|task| task.stage == 1), stage.outputs.get(LARGEST_COUNTS))
        {
            self.result.info.plan += &program.plan(task, &records(found)).explain();
        }
    }

    /// Fails where receivers were left unfinished.
    pub(crate) fn check(&self, technique: &Technique) -> Result<(), Error> {
        if self.overflowed > 0 {
            let count = self.overflowed;
            return Err(Error::Gpu(format!(
                "{count} receivers have more semi-opaque layers before them than sums of depth_complexity hold; use ray_traced"
            )));
        }
        if self.unfinished > 0 {
            let count = self.unfinished;
            return Err(Error::Gpu(match technique {
                Technique::DepthComplexity(_) if self.result.info.occluder_units.contains(&"edges") => format!(
                    "{count} receivers have more silhouette edges before them than fit: the scene is too dense for edges; use \
                     depth_complexity with unit triangles, or use ray_traced"
                ),
                Technique::DepthComplexity(_) => format!(
                    "{count} receivers have more triangles before them than can be tried: the scene is too dense for depth_complexity; \
                     use ray_traced"
                ),
                _ => format!(
                    "the driver ended {count} rays before they were done: the scene is too dense for its limit on loops; use another \
                     device, or split the scene"
                ),
            }));
        }
        if self.astray > 0 {
            let count = self.astray;
            return Err(Error::Gpu(format!(
                "{count} receivers stand too far from the middle of their pixels for wedges to reach them, on triangles thinner than a \
                 pixel; use evaluation 'tiled'"
            )));
        }
        Ok(())
    }

    fn add(&mut self, block: Block, light: usize, outputs: &BTreeMap<String, Cow<'_, [u8]>>) {
        let start = block.first + block.skip;
        if let Some(bytes) = outputs.get(RECEIVERS) {
            self.add_receivers(start, &records(bytes)[block.skip..block.skip + block.keep]);
        }
        for (_, bytes) in outputs.iter().filter(|(label, _)| label.starts_with(TRACE_COUNTS)) {
            let counts = records::<u32>(bytes);
            self.result.info.traced_receivers += counts.first().map_or(0, |n| u64::from(*n));
            self.unfinished += counts.get(1).map_or(0, |n| u64::from(*n));
        }
        if let Some(bytes) = outputs.get(LIST_COUNTS) {
            let counts = records::<u32>(bytes);
            self.result.info.silhouette_edges += u64::from(counts[2]);
            self.unfinished += u64::from(counts[3]);
            self.result.info.area_receivers += u64::from(counts[4]);
            self.overflowed += u64::from(counts[5]);
        }
        if let Some(bytes) = outputs.get(NEAR_COUNTS) {
            let counts = records::<u32>(bytes);
            self.unfinished += u64::from(counts[1]);
        }
        if let Some(bytes) = outputs.get(CASTER_BOUNDS) {
            let share = edge_on_share(&records::<u32>(bytes));
            let note = edge_on_note(light, share).filter(|note| !self.result.info.notes.contains(note));
            self.result.info.notes.extend(note);
        }
        if let Some(bytes) = outputs.get(LARGEST_COUNTS) {
            self.astray += records::<Largest>(bytes).iter().map(|l| u64::from(l.astray)).sum::<u64>();
        }
        if let Some(bytes) = outputs.get(STRAYS) {
            let counts = records::<u32>(bytes);
            self.unmapped += counts.iter().map(|n| u64::from(*n)).sum::<u64>();
        }
        if let Some(bytes) = outputs.get(CAMERA_COUNTS) {
            let info = &mut self.result.info;
            for found in records::<CameraCounts>(bytes).iter() {
                info.colliding_receivers += u64::from(found.colliding);
                info.camera_steps = info.camera_steps.max(found.steps);
                let bias = f64::from(f32::from_bits(found.bias)) / self.frame.local_length(1.0);
                info.camera_bias = info.camera_bias.max(bias);
            }
        }
        let (count, channels) = (self.result.receivers, self.result.channels);
        let copy = |label: &str, width: usize, into: &mut [f32]| {
            let Some(bytes) = outputs.get(label) else { return };
            let values = records::<f32>(bytes);
            let at = (light * count + start) * width;
            into[at..at + block.keep * width]
                .copy_from_slice(&values[block.skip * width..(block.skip + block.keep) * width]);
        };
        copy(VISIBILITY, channels, &mut self.result.values);
        if let Some(errors) = &mut self.result.standard_error {
            copy(STANDARD_ERROR, channels, errors);
        }
        if let (Some(masks), Some(bytes)) = (&mut self.result.masks, outputs.get(BLOCKED)) {
            let words = records::<u32>(bytes);
            let at = (light * count + start) * masks.words;
            masks.bits[at..at + block.keep * masks.words]
                .copy_from_slice(&words[block.skip * masks.words..(block.skip + block.keep) * masks.words]);
        }
        if let Some(bytes) = outputs.get(COLOR) {
            let colors = records::<[f32; 4]>(bytes);
            self.colors.resize(count, [0.0; 4]);
            self.colors[start..start + block.keep].copy_from_slice(&colors[block.skip..block.skip + block.keep]);
        }
    }

    fn add_receivers(&mut self, start: usize, records: &[Receiver]) {
        self.result.valid[start..].iter_mut().zip(records).for_each(|(valid, record)| *valid = record.kind != 0);
        let Some(placed) = &mut self.result.placed else { return };
        for (index, record) in (start..).zip(records).filter(|(_, record)| record.kind != 0) {
            placed.positions[index] = self.frame.world_from_local(record.position);
            placed.normals[index] = record.normal;
            placed.triangles[index] = self.caller_ids.get(record.triangle as usize).map_or(-1, |id| i64::from(*id));
        }
    }

    fn finish(mut self, report: RunReport) -> (Visibility, Vec<[f32; 4]>) {
        let (count, channels) = (self.result.receivers, self.result.channels);
        let valid = &self.result.valid;
        // A value where there is no receiver would be a number that nobody measured.
        let blank = |values: &mut [f32]| {
            for light in values.chunks_exact_mut((count * channels).max(1)) {
                let rows = light.chunks_exact_mut(channels).zip(valid);
                rows.filter(|(_, valid)| !**valid).for_each(|(row, _)| row.fill(f32::NAN));
            }
        };
        blank(&mut self.result.values);
        if let Some(errors) = &mut self.result.standard_error {
            blank(errors);
            // Outside the penumbra all samples agree, and the estimate of their error is 0.
            let in_penumbra = |v: &f32| *v > 0.002 && *v < 0.998;
            let pairs = errors.iter().zip(&self.result.values);
            let known: Vec<f64> = pairs.filter(|(_, v)| in_penumbra(v)).map(|(e, _)| f64::from(*e)).collect();
            if !known.is_empty() {
                let mean_square = known.iter().map(|e| e * e).sum::<f64>() / known.len() as f64;
                self.result.info.standard_error = Some(mean_square.sqrt());
            }
        }
        if self.unmapped > 0 {
            let count = self.unmapped;
            self.result.info.notes.push(format!("{count} receivers are not on what penumbra_map shows there, and lit"));
        }
        self.result.info.valid_receivers = Some(valid.iter().filter(|v| **v).count());
        self.result.info.add_run(report);
        (self.result, self.colors)
    }
}
